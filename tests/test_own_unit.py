"""A wheel or a mass on a spring whose readings have no scale: searched in their own unit."""

import re

import numpy as np
import pytest

from swingdown import explain, fit, read
from swingdown.answer import of_swings, searchable
from swingdown.engine.trajectory import simulate
from swingdown.errors import InputError
from swingdown.measurement.sharing import sharing
from swingdown.own_unit import OF_AN_ANGLE, Own, axis, has_size, own_of, shown, small, speed
from swingdown.pendulum.catalogue import SHIPPED
from swingdown.pendulum.model import Model

STEP, TIMES = 3.0, np.arange(0, 60, 0.02)
HIDDEN = {
    "natural_frequency": 3.1,
    "viscous_ratio": 0.004,
    "constant_friction": 0.002,
    "cubic_stiffness": 30.0,
}


def _values(name):
    """Values of an effect that show it in a swing of 0.1 rad."""
    each = {"presliding_angle": 0.01, "power_law_exponent": 1.6, "stribeck_velocity": 0.1, "wind_speed": 0.1}
    return {p.name: each.get(p.name, p.typical) for p in SHIPPED[name].parameters}


@pytest.mark.parametrize(
    "name", [one.name for one in SHIPPED if one.name not in OF_AN_ANGLE and one.beside != "sine"]
)
def test_a_parameter_in_the_readings_unit_moves_the_reading_as_it_moves_the_angle(name):
    own, times = Own("V", STEP), TIMES[:700]
    known = {"natural_frequency": 3.1, "viscous_ratio": 0.02} | _values(name)
    model = Model(tuple({"viscous": 0, name: 0}), known, {}, "linear")
    told = {key: own.told(key, model.units[key])[0] * value for key, value in known.items()}
    if name == "power_law_drag":  # told at the speed of one step a second
        told["power_law_coefficient"] *= STEP ** -known["power_law_exponent"]
    if name == "base_vibration":  # the direction of the floor is one of space: small angles alone have none
        times = times[:20]
    reading = simulate(model.with_values(told), times, STEP * 0.1)
    np.testing.assert_allclose(
        reading, STEP * simulate(model, times, 0.1), atol=2e-3 if name == "base_vibration" else 1e-6
    )


def test_what_turns_keeps_its_rad_and_the_unit_is_told_in_full():
    own = Own("cm", 2.0)
    assert own.told("natural_frequency", "rad/s") == (1.0, "rad/s")
    assert own.told("viscous_ratio", "1") == (1.0, "1")
    assert own.told("constant_friction", "rad/s^2") == (2.0, "cm/s^2")
    assert own.told("quadratic_coefficient", "s") == (0.5, "s/cm")
    assert own.told("cubic_stiffness", "1/s^2") == (0.25, "1/s^2/cm^2")
    assert own.told("magnet_depth", "1/s^2") == (4.0, "cm^2/s^2")
    assert has_size("constant_friction", "rad/s^2") and not has_size("viscous_ratio", "1")


def test_values_errors_and_covariances_are_told_in_the_readings_unit():
    """A friction in steps of 2 cm, a frequency as it is: their covariance by both, what is not known stays unknown."""
    own = Own("cm", 2.0)
    found = {
        "constant_friction": {"value": 0.5, "standard_error": 0.1, "u_sensor": None, "unit": "rad/s^2"},
        "natural_frequency": {"value": 3.0, "standard_error": 0.2, "unit": "rad/s"},
    }
    told = own.entries(found)
    assert told["constant_friction"] == {
        "value": 1.0,
        "standard_error": 0.2,
        "u_sensor": None,
        "unit": "cm/s^2",
    }
    assert told["natural_frequency"] == found["natural_frequency"]
    units = ["rad/s^2", "rad/s"]
    assert own.covariance(list(found), units, [[1.0, 3.0], [3.0, None]]) == [[4.0, 6.0], [6.0, None]]
    assert own_of({"own_unit": "cm", "own_step": "2.0"}) == own and own_of({"unit": "rad"}) is None


@pytest.mark.parametrize(
    ("unit", "values", "symbol", "words", "name", "speeds"),
    [
        ("rad", 90.0, "°", "1.57e+03 mrad", "angle (°)", "angular speed (rad/s)"),
        ("rad/s", 90.0, "°/s", "1.57e+03 mrad/s", "angular rate (°/s)", "angular speed (rad/s)"),
        ("V", np.pi / 2, "V", "1.57 V", "reading (V)", "speed (V/s)"),
    ],
)
def test_figures_and_words_have_degrees_and_milliradians_or_the_readings_unit(
    unit, values, symbol, words, name, speeds
):
    found, told = shown([np.pi / 2], unit)
    assert found == pytest.approx([values]) and told == symbol
    assert (small(np.pi / 2, unit), axis(unit), speed(unit)) == (words, name, speeds)


def _wheel(tmp_path, times_as_large, head, seed=4, name="wheel"):
    """A file of a wheel with a cubic spring; its swing of 0.1 rad is so many times as large in the file."""
    model = Model(("viscous", "constant_coulomb", "cubic_stiffness"), HIDDEN, {}, "linear")
    noise = np.random.default_rng(seed).normal(0, 1e-4, TIMES.size)
    series = times_as_large * (simulate(model, TIMES, 0.1) + noise)
    path = tmp_path / f"{name}.csv"
    np.savetxt(
        path, np.column_stack([TIMES, series]), delimiter=",", header=f"t (s),{head}", comments="", fmt="%.9g"
    )
    return path


def test_the_period_of_a_wheel_needs_no_scale(tmp_path):
    note = read(_wheel(tmp_path, 20.0, "U (V)"), restoring="linear").fit().row["note"]
    assert "the period goes from" in note and "needs the scale" not in note


@pytest.mark.slow("a search")
def test_a_wheel_in_volts_is_searched_in_volts(tmp_path):
    found = read(_wheel(tmp_path, 20.0, "U (V)"), restoring="linear")
    assert any("SIZES ARE IN UNITS OF THE READING (V)" in one for one in found.remarks)
    answer = found.explain()
    verdict = answer.verdict
    assert verdict["unit"] == "V" and verdict["status"] in ("named", "ambiguous")
    named = {name for one in verdict["effects"] for name in (one["name"], *one["tied_with"])}
    assert "cubic_stiffness" in named
    one = next(one for one in verdict["effects"] if "cubic_stiffness" in (one["name"], *one["tied_with"]))
    if one["name"] == "cubic_stiffness":
        size = one["parameters"]["cubic_stiffness"]
        assert size["unit"] == "1/s^2/V^2"
        assert abs(size["value"] - 30 / 400) < 4 * size["standard_error"]
    assert verdict["noise_rms_rad"] == pytest.approx(20e-4, rel=0.2)  # in V, as unit says
    told = "\n".join([verdict["sentence"], verdict["next_measurement"] or "", str(answer)])
    assert " V" in told and not re.search(r"°|mrad|\brad\b(?!/s)|rad/s\^2|rad/s²", told)
    assert answer.shown[0].unit == "V" and np.ptp(answer.shown[0].angle) > 3


@pytest.mark.slow("a search")
def test_the_unit_in_which_a_reading_is_written_changes_its_sizes_alone(tmp_path):
    volts, counts = (
        read(_wheel(tmp_path, size, head, name=name), restoring="linear").explain().verdict
        for size, head, name in ((2.0, "U (V)", "volts"), (2000.0, "y (px)", "pixels"))
    )
    assert (volts["unit"], counts["unit"]) == ("V", "px")
    assert volts["status"] == counts["status"]
    assert [one["name"] for one in volts["effects"]] == [one["name"] for one in counts["effects"]]
    assert counts["noise_rms_rad"] == pytest.approx(1000 * volts["noise_rms_rad"], rel=1e-6)
    friction, many = (one["model"]["constant_friction"] for one in (volts, counts))
    assert many["value"] == pytest.approx(1000 * friction["value"], rel=1e-3)
    assert many["unit"] == "px/s^2"


@pytest.mark.parametrize(("head", "unit"), [("U [Volts]", "V"), ("adc", "units"), ("y (cm)", "cm")])
def test_the_unit_is_told_as_one_writes_it(tmp_path, head, unit):
    found = read(_wheel(tmp_path, 20.0, head), restoring="linear")
    assert found.swings[0].attrs["own_unit"] == unit


@pytest.mark.parametrize(("head", "unit"), [("a (m/s^2)", "m/s^2"), ("Linear acceleration y", "units")])
def test_the_acceleration_of_a_mass_on_a_spring_swings_as_its_place(tmp_path, head, unit):
    place, itself = (
        read(_wheel(tmp_path, 20.0, one), restoring="linear", column=one) for one in ("y (px)", head)
    )
    assert itself.swings[0].attrs["own_unit"] == unit
    assert searchable("spring", itself.swings).unit == unit
    assert itself.fit().row["decay_time_s"] == pytest.approx(place.fit().row["decay_time_s"])
    assert any("loss itself shows in it" in one for one in itself.remarks)
    with pytest.raises(InputError, match="an acceleration.* is no angle"):
        read(_wheel(tmp_path, 20.0, head), column=head)


@pytest.mark.parametrize("head", ["F (N)", "velocity (m/s)"])
def test_a_force_and_a_speed_are_no_deflection_to_search_in(tmp_path, head):
    found = read(_wheel(tmp_path, 20.0, head), restoring="linear", column=head)
    assert found.swings[0].attrs["mode"] == "unknown scale"
    assert "own_unit" not in found.swings[0].attrs
    with pytest.raises(InputError, match="no scale"):
        found.explain()


def test_a_pendulum_without_a_scale_is_still_asked_for_it(tmp_path):
    found = read(_wheel(tmp_path, 20.0, "U (V)"))
    assert "own_unit" not in found.swings[0].attrs
    assert any("state the degrees" in one for one in found.remarks)
    with pytest.raises(InputError, match="no scale"):
        found.explain()


def test_two_of_unknown_scale_share_no_model_and_each_is_searched_alone(tmp_path):
    one, other = (
        read(_wheel(tmp_path, 20.0, "x (px)", seed, str(seed)), restoring="linear").swings[0]
        for seed in (1, 2)
    )
    assert sharing([one]) == ([0], {})
    together, alone = sharing([one, other])
    assert together == [] and "make it a campaign of its own" in alone[1].mend
    assert "linear" not in alone[0].mend  # that is stated


def _runs(tmp_path, unit):
    """Two swings of one mass on a spring, the second half as wide, in a column each."""
    values = {name: HIDDEN[name] for name in ("natural_frequency", "viscous_ratio", "constant_friction")}
    model = Model("viscous+constant_coulomb", values, restoring="linear")
    noise = 0.0005 * np.random.default_rng(4).standard_normal((2, TIMES.size))
    each = (simulate(model, TIMES, begin) + own for begin, own in zip((0.1, 0.05), noise, strict=True))
    columns = [TIMES, *(6000 * one for one in each)]
    head = ",".join(["time (s)", *(f"Position ({unit}) Run #{k}" for k in (1, 2))])
    path = tmp_path / "runs.csv"
    np.savetxt(path, np.column_stack(columns), delimiter=",", header=head, comments="", fmt="%.5f")
    found = (read(path, restoring="linear", column=name).swings[0] for name in head.split(",")[1:])
    return [one.assign_attrs(recording=str(k)) for k, one in enumerate(found)]


def test_runs_in_one_unit_of_length_are_one_pendulum(tmp_path):
    given = _runs(tmp_path, "mm")
    assert sharing(given) == ([0, 1], {})
    whole = searchable("pendulum", given)
    wide, narrow = sorted((one.amplitude for one in whole.whole), reverse=True)
    assert whole.unit == "mm" and narrow == pytest.approx(wide / 2, rel=0.02)
    assert whole.own.step * wide == pytest.approx(600, rel=0.05)  # mm
    found = of_swings(given, ["viscous", "viscous+constant_coulomb"], restoring="linear")
    together = found.fitted_model
    for one in given:
        alone = of_swings([one], ["viscous+constant_coulomb"], restoring="linear").fitted_model
        friction = alone.values["constant_friction"] * one.attrs["own_step"]
        assert together.values["constant_friction"] * whole.own.step == pytest.approx(friction, rel=0.05)
    largest = [begin.angle for begin in found.begins.values()]
    assert max(largest) == pytest.approx(2 * min(largest), rel=0.02)


def test_runs_in_pixels_are_not(tmp_path):
    """The camera may have stood elsewhere."""
    assert sharing(_runs(tmp_path, "px"))[0] == []


def test_arrays_without_a_unit_are_read_as_a_file_without_one(tmp_path):
    path = _wheel(tmp_path, 60.0, "reading")
    times, values = np.loadtxt(path, delimiter=",", skiprows=1).T
    found = read(path, restoring="linear")
    answer = fit(times, values, restoring="linear")
    (one,), (other,) = found.swings, answer.swings
    assert other.attrs["own_unit"] == one.attrs["own_unit"] == "units"
    assert other.attrs["own_step"] == pytest.approx(one.attrs["own_step"], rel=1e-9)
    np.testing.assert_allclose(other["angle"].values, one["angle"].values, atol=1e-12)
    assert "SIZES ARE IN UNITS OF THE READING (units)" in other.attrs["remarks"]
    assert answer.row["period_s"] == pytest.approx(found.fit().row["period_s"], rel=1e-9)


@pytest.mark.slow("a search")
def test_a_notebook_searches_in_the_readings_own_unit_as_the_command_does(tmp_path):
    path = _wheel(tmp_path, 60.0, "reading")
    times, values = np.loadtxt(path, delimiter=",", skiprows=1).T
    file, arrays = read(path, restoring="linear").explain(), explain(times, values, restoring="linear")
    one, other = file.verdict, arrays.verdict
    assert other["unit"] == one["unit"] == "units" and other["status"] == one["status"]
    assert [effect["name"] for effect in other["effects"]] == [effect["name"] for effect in one["effects"]]
    for name, told in one["model"].items():
        assert other["model"][name]["unit"] == told["unit"]
        assert other["model"][name]["value"] == pytest.approx(told["value"], rel=1e-6)
