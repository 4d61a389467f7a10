"""Exports of oscilloscopes and of LabVIEW: settings above the rows, a clock that is stated once, volts that the settings state."""

import numpy as np
import pytest

from swingdown.errors import InputError
from swingdown.measurement.recording import ingest
from swingdown.measurement.sheet import COLUMNS

STEP = 0.02
TIMES = STEP * np.arange(1200) - 12
VOLTS = 2.5 + 0.4 * np.exp(-0.01 * TIMES) * np.cos(4.4 * TIMES)
LABVIEW = """LabVIEW Measurement\t
Time\t10:22:31.123
***End_of_Header***\t
Channels\t2\t\t
Samples\t1200\t1200\t
Time\t10:22:31.123\t10:22:31.123\t
Y_Unit_Label\tVolts\tVolts\t
X_Dimension\tTime\tTime\t
X0\t0.0000000000000000E+0\t0.0E+0\t
Delta_X\t0.020000\t0.020000\t
***End_of_Header***\t\t\t
X_Value\tVoltage_0\tVoltage_1\tComment
"""
TEKTRONIX = "Model,MSO2024B\nHorizontal Units,s,\n,,\nSample Interval,0.02,\nVertical Units,V,\n,,\nLabel,,\nTIME,CH1\n"
GW = "Memory Length,1200,\nVertical Units,V,\nSincET Mode,Real Time,\nSampling Period,2.000e-02,\nTime,\nMode,Fast,\nWaveform Data,\n"


def each(form, *more):
    return "".join(
        form.format(k, *cells, t=t, v=v) + "\n"
        for k, (t, v, *cells) in enumerate(zip(TIMES, VOLTS, *more, strict=True))
    )


EXPORTS = {
    "start and step in the header": (
        "X,CH1,Start,Increment,\nSequence,Volt,-1.200000e+01,2.000000e-02\n" + each("{0},{v:.4e},"),
        "`Volt` as volts",
    ),
    "start and step in the first row": (
        "Sequence,Volt,Start,Increment\n" + each("{0},{v:.4e},").replace(",\n", ",-1.2e1,2e-2\n", 1),
        "`Volt` as volts",
    ),
    "an empty column of times": ("Time(s),CH1V,t0 = -12, tInc = 0.02\n" + each(",{v:.4e}"), "`CH1V`"),
    "no column of times": ("CH1V,t0 = -1.2e+01, tInc = 2.0e-02,\n" + each("{v:.4e},"), "`CH1V`"),
    "settings above": (TEKTRONIX + each("{t:.5e},{v:.4f}"), "`CH1` as volts"),
    "a setting that looks like names": (GW + each("{t:.6e},{v:.4e},"), "`column 2` as volts"),
    "LabVIEW": (LABVIEW + each("{t:.6f}\t{v:.6f}\t0.01\t"), "`Voltage_0` as volts"),
    "LabVIEW without times": (LABVIEW + each("\t{v:.6f}\t0.01\t"), "`Voltage_0` as volts"),
    "mV": ("#timebase=2500000(us)\n#,time(S),CH1(mV)\n" + each("{0},{t:.6f},{v:.6f}"), "`CH1(mV)` as volts"),
}


def taken(folder, text, **cells):
    path = folder / "export.csv"
    path.write_text(text)
    return ingest({**COLUMNS, "recording": "export", "file": str(path), "scale": "relative", **cells})


@pytest.mark.parametrize(("text", "words"), EXPORTS.values(), ids=EXPORTS)
def test_an_instruments_export_is_read_in_volts_by_its_clock(tmp_path, text, words):
    found = taken(tmp_path, text)
    assert words in found.attrs["taken"] and "rad" not in found.attrs["taken"]
    assert np.allclose(np.diff(found["time"]), STEP, rtol=1e-3)
    assert abs(np.corrcoef(found["signal"], VOLTS)[0, 1]) > 0.999


def test_a_gates_voltage_with_noise_on_both_levels_holds_its_passages(tmp_path):
    """Dips of some samples, as an oscilloscope shows a gate; whether two are a swing is asked."""
    noise = np.random.default_rng(3).choice([0.0, 0.8], TIMES.size)
    text = "Sequence,Volt,Start,Increment\n0,8.8,-12,0.02\n"
    text += "".join(f"{k},{8 + n if t % 0.62 > 0.06 else n:.2f},,\n" for k, (t, n) in enumerate(zip(TIMES, noise, strict=True)) if k)  # fmt: skip
    with pytest.raises(InputError, match=r"0\.62 s apart: is that a half-swing, a whole period"):
        taken(tmp_path, text)
    found = taken(tmp_path, text, signal_kind="passages")
    assert np.allclose(np.diff(found["time"]), 0.62, atol=0.025)


@pytest.mark.parametrize(
    ("head", "factor", "column"),
    [
        ("t (s),angle (mrad)", (1, 1e3), "angle (mrad)"),
        ("t (min),angle (arcmin)", (1 / 60, 10_800 / np.pi), "angle (arcmin)"),
        ("t [1/10 s],phi (gon)", (10, 200 / np.pi), "phi (gon)"),
    ],
)
def test_units_that_are_a_known_number_of_others(tmp_path, head, factor, column):
    angle = 0.1 * (VOLTS - 2.5)
    rows = "".join(f"{t * factor[0]:.8f},{a * factor[1]:.8f}\n" for t, a in zip(TIMES, angle, strict=True))
    found = taken(tmp_path, f"{head}\n{rows}", scale="")
    assert (
        found.attrs["taken"].startswith(f"took `{column}` as rad")
        and "is read in rad" in found.attrs["remarks"]
    )
    assert np.allclose(found["time"], TIMES, atol=1e-4) and np.allclose(found["signal"], angle, atol=1e-6)


def test_grad_is_a_degree_to_some_and_is_asked(tmp_path):
    with pytest.raises(InputError, match="'grad' is no angle in a unit known here"):
        taken(tmp_path, "t (s),phi (grad)\n" + each("{t:.3f},{v:.4f}"), scale="")


def test_names_stand_above_their_symbols(tmp_path):
    """As Logger Pro writes a gate: the symbol G says nothing, its name does."""
    rows = "".join(f"{0.7 * k:.4f}\t1\t\n{0.7 * k + 0.02:.4f}\t0\t\n" for k in range(30))
    found = taken(tmp_path, f"Vernier Format 2\nLatest\nTime\tGate State\tPeriod\nt\tG\tT\ns\t\ts\n\n{rows}")
    assert "`Gate State` as a light gate's" in found.attrs["taken"]


def test_a_setting_above_the_names_is_none_of_them(tmp_path):
    text = "Mass,60\nAngle,60\nt,θ\n" + each("{t:.3f},{v:.4f}")
    assert taken(tmp_path, text).attrs["taken"].startswith("took `θ`")


@pytest.mark.parametrize("names", ["Tiempo;Canal A;Canal B", "Time (s);Channel A (V);Channel B (mV)", "t (s);ang vel;ang pos"])  # fmt: skip
@pytest.mark.parametrize("of", [slice(None), slice(None, None, 2)])
def test_a_channel_of_noise_is_no_swing_beside_one_that_swings(tmp_path, names, of):
    noise = 0.65 + 0.02 * np.random.default_rng(2).standard_normal(TIMES.size)
    rows = "".join(f"{t:.4f};{n:.5f};{100 * v:.4f}\n" for t, n, v in zip(TIMES[of], noise[of], VOLTS[of], strict=True))  # fmt: skip
    found = taken(tmp_path, f"{names}\n{rows}", scale="relative")
    _, first, second = names.split(";")
    assert f"took `{second}`" in found.attrs["taken"]
    assert f"`{first}` holds noise alone: left out" in found.attrs["remarks"]
    assert f"took `{first}`" in taken(tmp_path, f"{names}\n{rows}", scale="relative", signal_column=first).attrs["taken"]  # fmt: skip


def test_of_several_angles_the_one_that_swings_is_taken_beside_the_noise_of_a_sensor_that_rests(tmp_path):
    """The first link of a double pendulum is held; its potentiometer reads in steps, and remembers a little."""
    rng, angle = np.random.default_rng(2), VOLTS - 2.5
    white = rng.standard_normal(TIMES.size + 1)
    held = 3.33 + 0.003 * np.round(white[1:] + 0.2 * white[:-1])
    rows = "".join(f"{t:.4f},{n:.4f},{a:.5f}\n" for t, n, a in zip(TIMES, held, angle, strict=True))
    found = taken(tmp_path, f"t (s),theta_1,theta_2\n{rows}", signal_unit="rad", scale="")
    assert "took `theta_2`" in found.attrs["taken"]
    assert "`theta_1` holds noise alone: left out" in found.attrs["remarks"]


def moku(first, second):
    """A file of Moku:Go, whose heading ends in two columns that hold nothing."""
    head = "% Moku:Go Data Logger,,,,\n% Acquisition rate: 5.0e+01 Hz,,,\n% Time (s), Input A (V), Input B (V),,\n"
    return head + "".join(
        f"{t:.4f},{a:.4f},{b:.4f},,\n" for t, a, b in zip(TIMES, first, second, strict=True)
    )


def test_of_two_channels_the_one_that_is_not_taken_is_named(tmp_path):
    motor = 1.5 * np.sin(2 * np.pi * TIMES / 1.1)
    found = taken(tmp_path, moku(motor, VOLTS), scale="relative")
    assert "took `Input A (V)`" in found.attrs["taken"]
    assert "the first column of volts, and not `Input B (V)`" in found.attrs["remarks"]
    named = taken(tmp_path, moku(motor, VOLTS), scale="relative", signal_column="Input B (V)")
    assert "first column" not in named.attrs["remarks"]


def test_where_a_channel_is_refused_the_other_is_offered_and_no_empty_column(tmp_path):
    clipped = np.clip(1.7 * np.sin(2 * np.pi * TIMES / 1.1), -1.5, 1.5)
    with pytest.raises(InputError, match="saturated") as caught:
        taken(tmp_path, moku(clipped, VOLTS), scale="relative")
    assert caught.value.mend.endswith(": Input A (V), Input B (V)")


def test_a_short_swing_is_not_left_out_for_a_column_that_swings_more_often(tmp_path):
    short = np.cos(2 * np.pi * TIMES / 9)  # five half-swings
    rows = each("{t:.4f};{1:.5f};{v:.4f}", short)
    found = taken(tmp_path, f"Tiempo;Canal A;Canal B\n{rows}", scale="relative")
    assert "took `Canal A`" in found.attrs["taken"] and "noise" not in found.attrs["remarks"]


def test_a_swing_that_dies_into_its_noise_is_not_left_out_as_noise(tmp_path):
    """It passes its middle often and never in step, as noise does: most of it is noise."""
    since = TIMES - TIMES[0]
    dies = np.exp(-since / 2) * np.cos(2 * np.pi * since / 1.3) + 0.12 * np.random.default_rng(4).standard_normal(TIMES.size)  # fmt: skip
    rows = each("{t:.4f};{1:.5f};{v:.4f}", dies)
    found = taken(tmp_path, f"Tiempo;Canal A;Canal B\n{rows}", scale="relative")
    assert "took `Canal A`" in found.attrs["taken"] and "noise" not in found.attrs["remarks"]


def test_units_that_a_program_alone_knows_stand_below_the_names(tmp_path):
    """As a class's boards write them: two pendulums, each with its own times, and a gate, under remarks."""
    rows = "".join(f"{t:.3f}\t{500 + 100 * v:.0f}\t{t + 0.01:.3f}\t{480 + 90 * v:.0f}\n" for t, v in zip(TIMES + 12, VOLTS, strict=True))  # fmt: skip
    text = f"#Creator: board\n#Time A\tPos A\tTime B\tPos B\n#[s]\t[au]\t[s]\t[au]\n{rows}"
    with pytest.raises(InputError, match="run A"):
        taken(tmp_path, text)
    found = taken(tmp_path, text, run="run B", scale="")
    assert "took `Pos B [au]` as readings of unknown scale" in found.attrs["taken"]
    edges = "".join(f"{2 * k}\t0\t{k + 0.1 * (k % 2):.6f}\n{2 * k + 1}\t1\t{k + 0.1 * (k % 2) + 0.05:.6f}\n" for k in range(40))  # fmt: skip
    gate = taken(tmp_path, f"#Creator: board\n#Id\tEdge\tTime\n#[]\t[b]\t[s]\n{edges}", scale="")
    assert "`Edge [b]` as a light gate's" in gate.attrs["taken"]
