"""What the words of a header say: the quantity, its unit, and which column a name belongs to."""

import numpy as np
import pytest
from exports import SWING, TIME, rows

from swingdown.errors import InputError
from swingdown.measurement.files.columns import choose, meaning


@pytest.mark.parametrize(
    ("header", "kind", "unit"),
    [
        ("Angle (°)", "an angle", "deg"),
        ("theta [rad]", "an angle", "rad"),
        ("θ", "an angle", ""),
        ("theta_rad", "an angle", "rad"),
        ("angle_deg", "an angle", "deg"),
        ("Latest: Angle (º)", "an angle", "deg"),
        ("t (ms)", "a time", "ms"),
        ("t/s", "a time", "s"),
        ("millis", "a time", "ms"),
        ("msec", "a time", "ms"),
        ("m", "", ""),
        ("Epoch time ns", "a time", "ns"),
        ("Time (µs)", "a time", "us"),
        ("Gyroscope z (rad/s)", "an angular rate", "rad/s"),
        ("Gyroscope z (°/s)", "an angular rate", "deg/s"),
        ("v / rad/s", "an angular rate", "rad/s"),
        ("ω, рад/с", "an angular rate", "rad/s"),
        ("gyro_z_rad_s", "an angular rate", "rad/s"),
        ("gyro_deg_per_sec", "an angular rate", "deg/s"),
        ("v_m_s", "a speed", ""),
        ("t, s", "a time", "s"),
        # what an angle makes in a second is no time
        ("angle/second", "an angular rate", ""),
        ("theta/s", "an angular rate", ""),
        ("Winkel pro Sekunde", "an angular rate", ""),
        ("angle (second)", "an angle", ""),
        ("time of angle (s)", "a time", "s"),
        ("SampleTimeFine", "a time", ""),
        ("begTime=-406.21", "", ""),
        ("Euler_X", "an angle", ""),
        ("orient_y", "an angle", ""),
        ("compass_x", "something else", ""),
        ("mag_y", "something else", ""),
        ("Zeit / Âµs", "a time", "us"),
        ("Winkel / Â°", "an angle", "deg"),
        ("Gyroscope z (rpm)", "an angular rate", ""),
        ("Angular velocity", "an angular rate", ""),
        ("Temperature (°C)", "something else", ""),
        ("x (m)", "a length", ""),
        ("Potential (mV)", "a voltage", ""),
        ("voltage_V", "a voltage", "V"),
        ("angle (filtered)", "an angle", ""),
        ("signal", "", ""),
        # by its word
        ("phi in Grad", "an angle", "deg"),
        ("Winkelgeschwindigkeit in Grad/s", "an angular rate", "deg/s"),
        ("Winkelgeschwindigkeit in rad/s", "an angular rate", "rad/s"),
        ("Auslenkung in cm", "a length", ""),
        ("Zeit in s", "a time", "s"),
        ("Zeit in Millisekunden", "a time", "ms"),
        ("angle en degrés", "an angle", "deg"),
        ("temps en secondes", "a time", "s"),
        ("angolo in gradi", "an angle", "deg"),
        ("velocità in gradi/s", "an angular rate", "deg/s"),
        ("ángulo en grados", "an angle", "deg"),
        ("ângulo em graus", "an angle", "deg"),
        ("tempo em segundos", "a time", "s"),
        # to some a 400th of a turn
        ("phi in grad", "an angle", ""),
        ("phi (Grad)", "an angle", ""),
        ("Temperatur in Grad", "something else", ""),
        ("température en degrés", "something else", ""),
        ("temperatura (gradi)", "something else", ""),
    ],
)
def test_what_a_header_says(header, kind, unit):
    found = meaning(header)
    assert (found.kind, found.unit) == (kind, unit)


@pytest.mark.parametrize(
    "header",
    ["Zeit in s;Winkel in Grad", "temps en s;angle en degrés", "tiempo en segundos;ángulo en grados"],
)
def test_degrees_by_their_word_need_no_other(take, header):
    made = take(header + "\n" + rows(TIME, np.degrees(SWING)).replace(",", ";"))
    assert made["signal"].attrs["units"] == "deg" and made["time"].values == pytest.approx(TIME, abs=1e-6)


def test_a_column_without_a_name_has_the_one_above_it(take):
    """As OpenSim's and Cortex' .trc have it: the clock one line above the letters of the axes."""
    head = (
        "PathFileType\t4\t(X/Y/Z)\tbob.trc\nDataRate\tCameraRate\tNumFrames\tUnits\n100.00\t100.00\t2000\tmm\n"
        "Frame#\tTime\tbob\t\t\n\t\tX1\tY1\tZ1\n\n"
    )
    x, y = 400 * np.sin(SWING), 1000 - 400 * np.cos(SWING)
    made = take(head + rows(np.arange(TIME.size), TIME, x, y, 0 * x, separator="\t"))
    assert "`Time` as s" in made.attrs["taken"] and "`X1` and `Y1` as positions" in made.attrs["taken"]
    assert np.ptp(made["signal"].values) == pytest.approx(np.ptp(SWING), rel=1e-3)


def test_rotations_beside_positions_under_the_same_letters_are_asked_about(take):
    """As Motive exports a rigid body: a type, a name and X, Y, Z above each column, the letters twice."""
    text = (
        "Format Version,1.23,Take Name,bob,Export Frame Rate,100.0,Length Units,Meters\n\n"
        ",,Rotation,Rotation,Rotation,Position,Position,Position\nFrame,Time (Seconds),X,Y,Z,X,Y,Z\n"
    )
    zero = np.zeros_like(TIME)
    columns = (
        np.arange(TIME.size),
        TIME,
        zero,
        zero,
        np.degrees(SWING),
        np.sin(SWING),
        1 - np.cos(SWING),
        zero,
    )
    with pytest.raises(InputError, match="no unit is stated: are they positions"):
        take(text + rows(*columns))


@pytest.mark.parametrize(
    ("header", "kind", "unit", "written"),
    [
        ("Winkelgeschwindigkeit in Grad pro Sekunde", "an angular rate", "deg/s", "deg/s"),
        ("velocidad angular en grados por segundo", "an angular rate", "deg/s", "deg/s"),
        ("vitesse angulaire (radians par seconde)", "an angular rate", "rad/s", "rad/s"),
        ("Gyro [Grad / Sekunde]", "an angular rate", "deg/s", "deg/s"),
        ("degrees per second", "an angular rate", "deg/s", "deg/s"),
        ("omega rad/s", "an angular rate", "rad/s", "rad/s"),
        ("velocity_rad/s", "an angular rate", "rad/s", "rad/s"),
        ("v (Meter pro Sekunde)", "a speed", "", "m/s"),
        ("a (metros por segundo al cuadrado)", "something else", "", "m/s^2"),
        ("x en metros", "a length", "", "m"),
        ("samples per second", "", "", ""),
        ("Zeit in Sekunden", "a time", "s", "Sekunden"),
    ],
)
def test_a_unit_may_be_written_in_words(header, kind, unit, written):
    found = meaning(header)
    assert (found.kind, found.unit, found.written) == (kind, unit, written)


LIKELIER = ("v (m/s)", "s (cm)", "Gyroscope z (rad/s)", "Potential (V)", "signal", "theta", "phi (deg)")


@pytest.mark.parametrize("count", range(1, len(LIKELIER) + 1))
def test_the_likeliest_column_is_the_swing(count):
    _, (swing,) = choose(["t (s)", *LIKELIER[:count]], "", "", "")
    assert swing.name == LIKELIER[count - 1]


@pytest.mark.parametrize(("stated", "name"), [("rad/s", "Gyroscope z (rad/s)"), ("deg", "signal")])
def test_a_rate_is_taken_where_a_unit_of_rates_is_stated(stated, name):
    _, (swing,) = choose(["t (s)", "signal", "Gyroscope z (rad/s)"], "", "", "", ("", stated))
    assert swing.name == name
