"""One call from arrays, tables or labelled arrays to an answer: the same whatever holds the numbers, or a refusal by name."""

import json
import subprocess
import sys

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import swingdown
from swingdown.engine.trajectory import simulate
from swingdown.errors import InputError
from swingdown.pendulum.model import PAPER_MODELS, Model
from swingdown.studies.comparison import bic_effective
from swingdown.studies.quantities import UNITS, cycle, quantities

TIMES = np.arange(1201) / 100
TRUTH = Model("viscous", {"natural_frequency": 7.25, "viscous_ratio": 0.008})
NOISE = 0.002 * np.random.default_rng(3).standard_normal(TIMES.size)
ANGLE = simulate(TRUTH, TIMES, 0.35) + NOISE
FEW = {"fitted": ["viscous", "load_coulomb", "viscous+load_coulomb"]}
COLUMNS = pd.DataFrame({"t (ms)": 1e3 * TIMES, "Angle (°)": np.degrees(ANGLE)})


@pytest.fixture(scope="module")
def plain():
    return swingdown.fit(TIMES, ANGLE, **FEW)


@pytest.mark.parametrize(
    "given",
    [
        (list(TIMES), list(ANGLE)),
        (np.column_stack([TIMES, ANGLE]),),
        (pd.Series(ANGLE, index=TIMES),),
        (pd.Series(ANGLE, index=pd.to_timedelta(TIMES, unit="s")),),
        (pd.Series(np.degrees(ANGLE), index=TIMES, name="theta_deg"),),
        (COLUMNS,),
        (xr.DataArray(np.degrees(ANGLE), {"time": TIMES}, attrs={"units": "degrees"}),),
        (xr.Dataset({"angle": ("time", ANGLE, {"units": "rad"})}, {"time": TIMES}),),
    ],
    ids=["lists", "columns", "series", "durations", "series-deg", "frame", "labelled-deg", "dataset"],
)
def test_the_same_numbers_give_the_same_answer_however_they_are_held(plain, given):
    found = swingdown.fit(*given, **FEW)
    for name, (value, error, unit) in plain.quantities.items():
        assert found.quantities[name][2] == unit
        assert abs(found.quantities[name][0] - value) < 1e-3 * error, name


def test_degrees_are_degrees_when_said_so(plain):
    found = swingdown.fit(TIMES, np.degrees(ANGLE), unit="deg", **FEW)
    assert found.quantities["period"][0] == pytest.approx(plain.quantities["period"][0], abs=1e-7)


def test_degrees_without_a_word_are_taken_and_told():
    answer = swingdown.fit(TIMES, np.degrees(ANGLE), **FEW)
    assert "TAKEN AS DEGREES" in answer.remarks[0]
    plain = swingdown.fit(TIMES, ANGLE, **FEW)
    assert answer.row["period_s"] == pytest.approx(plain.row["period_s"], rel=1e-9)


def test_a_disc_asks_whether_a_spring_pulls_it_back():
    with pytest.raises(InputError, match="restoring='linear'"):
        swingdown.fit(TIMES, 10 * ANGLE, unit="rad", **FEW)


def test_missing_and_unordered_samples_are_put_right_and_told():
    angle = np.where(TIMES == 3, np.nan, ANGLE)
    answer = swingdown.fit(TIMES[::-1], angle[::-1], **FEW)
    assert "1 of 1201 samples hold no number" in answer.remarks[0] and "turned round" in answer.remarks[0]
    plain = swingdown.fit(TIMES, ANGLE, **FEW)
    assert answer.row["period_s"] == pytest.approx(plain.row["period_s"], abs=3 * plain.row["period_s_u"])


def test_it_finds_the_truth_and_says_so(plain):
    for name, value in TRUTH.values.items():
        found, error, _ = plain.quantities[name]
        assert abs(found - value) < 4 * error
    assert plain.model.label == plain.label == "viscous"
    told = str(plain)
    for words in ("period", "natural frequency", "quality Q", "decay time", "viscous"):
        assert words in told
    value, error, _ = plain.quantities["quality"]
    assert f"{value:.1f}"[:3] in told


def test_a_friction_that_winds_up_over_less_than_can_be_told_has_a_period():
    """Constant Coulomb friction, and the one noise of many with which presliding over 2e-5(4e-5) rad comes nearest: a step below that is none."""
    model = Model("constant_coulomb", {"natural_frequency": 8.232249097789463, "constant_friction": 0.05839923863998866})  # fmt: skip
    rng, times = np.random.default_rng(), np.arange(2176) / 100
    rng.bit_generator.state = {
        "bit_generator": "PCG64",
        "state": {
            "state": 116665956580426594952504896056104661975,
            "inc": 60804517828637344299932890193562703917,
        },
        "has_uint32": 0,
        "uinteger": 0,
    }
    exact = simulate(model, times, 0.5380735602994619)
    found = swingdown.fit(times, exact + 2.3539440235662752e-4 * rng.standard_normal(times.size), unit="rad")
    assert found.label == "viscous+presliding"
    angle, period = found.quantities["presliding_angle"], found.quantities["period"]
    assert 1e-5 < angle.value < angle.u
    assert period.u < 1e-4 and period.value == pytest.approx(cycle(model, 0.538).period, abs=4 * period.u)


def test_several_swings_share_their_pendulum(plain):
    second = simulate(TRUTH, TIMES, 0.2) + NOISE[::-1]
    found = swingdown.fit([TIMES, TIMES], [ANGLE, second], names=["large", "small"], **FEW)
    assert list(found.table["recording"]) == ["large", "small", "(joint)"]
    assert found.quantities["viscous_ratio"][1] < plain.quantities["viscous_ratio"][1]
    again = swingdown.fit(TIMES, [ANGLE, second], **FEW)
    assert again.quantities["quality"] == found.quantities["quality"]


def test_an_explanation_has_a_verdict_a_picture_and_plain_numbers():
    found = swingdown.explain(TIMES, ANGLE, base=["viscous"], rounds=1, **FEW)
    assert found.verdict["status"] == "consistent"
    assert "Nothing is missing" in str(found)
    content = json.loads(json.dumps(found.to_dict()))
    assert content["verdict"]["status"] == "consistent"
    assert content["quantities"]["period"]["unit"] == "s"
    assert {one.held_out for one in found.shown} == {True, False}
    assert sum(one.times.size for one in found.shown) == TIMES.size
    figure = found.plot()
    assert [axes.get_ylabel() for axes in figure.axes] == ["angle (°)", "data − fit (°)"]
    html = found._repr_html_()
    assert "data:image/png;base64," in html and "Nothing is missing" in html and "quality Q" in html


def test_what_is_emulated_says_so_in_the_picture():
    data = xr.DataArray(ANGLE, {"time": TIMES}, attrs={"units": "rad", "emulated": "yes"})
    found = swingdown.fit(data, **FEW)
    assert found.to_dict()["emulated"] and "emulated" in str(found)
    assert "emulated" in found.plot().get_supxlabel()


@pytest.mark.parametrize("unit", ["V", None])
def test_of_volts_period_and_decay_are_told_and_how_to_make_them_angles(unit):
    volts = 2.5 + 4 * ANGLE
    given = (TIMES, volts) if unit else (pd.Series(volts, index=TIMES, name="u (V)"),)
    found = swingdown.fit(*given, unit=unit, **FEW)
    known = swingdown.fit(TIMES, ANGLE, **FEW)
    assert found["decay_time"].value == pytest.approx(known["decay_time"].value, rel=0.02)
    assert "PERIOD AND DECAY ALONE" in str(found) and "unit='deg', the readings multiplied" in str(found)
    assert "sheet" not in str(found)
    with pytest.raises(InputError, match="no scale"):
        swingdown.explain(*given, unit=unit)


@pytest.mark.parametrize(
    ("times", "angles", "told"),
    [
        (TIMES, ANGLE[:-1], "1200 angles for 1201 times"),
        (TIMES, np.where(TIMES > 3, np.nan, ANGLE), "sample 301: not a finite number"),
        (0 * TIMES, ANGLE, "one time"),
        (TIMES, 0 * ANGLE, "constant"),
        (TIMES[:5], ANGLE[:5], "5 samples"),
        (TIMES, None, "the times bring none along"),
        ([], [], "swing: it is empty"),
        ([[], []], [[], []], "swing 1: it is empty"),
        ([], None, "they are empty"),
        (pd.DataFrame(), None, "DataFrame: it has no column"),
        (pd.DataFrame({"t": TIMES, "Gyroscope z (1/s)": ANGLE}), None, "an angular rate"),
        (pd.DataFrame({"t": TIMES, "Position x (m)": ANGLE}), None, "'Position x .m.' holds no angle"),
        (xr.DataArray(ANGLE, {"time": TIMES}, attrs={"units": "m"}), None, "their unit is 'm'"),
    ],
)
def test_what_is_no_swing_is_refused_by_name(times, angles, told):
    with pytest.raises(InputError, match=told):
        swingdown.fit(times, angles, **FEW)


@pytest.mark.parametrize(
    ("names", "told"), [(["x", "x"], "the name 'x' is there twice"), (["x"], "names given: 1, swings: 2")]
)
def test_each_swing_has_a_name_of_its_own(names, told):
    with pytest.raises(InputError, match=told):
        swingdown.fit([TIMES, TIMES], [ANGLE, ANGLE], names=names, **FEW)


def test_importing_the_package_loads_nothing_of_what_a_call_needs():
    code = "import sys, swingdown; print(sorted(m for m in ('numpy', 'pandas', 'matplotlib', 'swingdown.answer') if m in sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
    code = "import sys, swingdown; swingdown.fit, swingdown.explain; print('matplotlib' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"


@pytest.fixture(scope="module")
def with_presliding():
    """Times, angles and the truth of a pendulum that lacks presliding friction in every model of damping."""
    values = {"natural_frequency": 7.25, "viscous_ratio": 0.004, "load_friction": 0.003, "presliding_friction": 0.1, "presliding_angle": 0.006}  # fmt: skip
    truth = Model(("viscous", "load_coulomb", "presliding"), values)
    times = np.arange(2000) / 100
    noise = np.random.default_rng(3).normal(0, 1e-3, times.size)
    return times, simulate(truth, times, 0.5) + noise, truth


def test_the_quantities_of_an_explanation_are_those_of_the_model_it_ends_with(with_presliding):
    """The truth's, where the paper's models of damping give others; and the whole recording counts, held-out parts too."""
    times, angles, truth = with_presliding
    found = swingdown.explain(times, angles, zero_tolerance=0.0)
    assert found.model.label == truth.label
    expected = quantities(truth, found.row["amplitude_rad"])
    told = found.quantities
    assert set(told) == set(expected)
    for name, (value, uncertainty, unit) in told.items():
        assert unit == expected[name].unit
        assert abs(value - expected[name].value) < 4 * uncertainty, name
    first = swingdown.fit(times, angles, fitted=PAPER_MODELS).quantities
    assert abs(first["decay_time"][0] - expected["decay_time"].value) > 3 * told["decay_time"][1]
    ended = found.verdict["conclusion"]
    covariance = np.array(ended["covariance"], dtype=float)
    at = ended["parameters"].index("presliding_angle")
    # what the model may lack is in the value's uncertainty alone
    assert np.sqrt(covariance[at, at]) == pytest.approx(told["presliding_angle"][1], rel=1e-3)
    assert np.sqrt(covariance[at, at]) <= told["presliding_angle"][1]


def test_first_answer_and_verdict_agree_where_they_have_one_model():
    times, truth = np.arange(2000) / 100, {"natural_frequency": 7.25, "viscous_ratio": 0.004, "load_friction": 0.003}  # fmt: skip
    noise = np.random.default_rng(3).normal(0, 1e-3, times.size)
    angles = simulate(Model(("viscous", "load_coulomb"), truth), times, 0.5) + noise
    first, last = swingdown.fit(times, angles), swingdown.explain(times, angles)
    assert first.label == last.label
    expected = quantities(Model(("viscous", "load_coulomb"), truth), last.row["amplitude_rad"])
    for name, (value, uncertainty, _) in last.quantities.items():
        before, error, _ = first.quantities[name]
        # means over laws of damping, which the verdict asks on parts of the recording, and beside whatever else may be there: a model
        # of a few percent makes it less sure; a parameter is as sure as the laws that have it, of which the verdict leaves out one that a
        # part of the swings puts at a bound
        assert value == pytest.approx(before, abs=0.5 * uncertainty)
        assert uncertainty < (3.0 * error if name in UNITS else 0.01 * value)
        assert 0.5 * error < uncertainty or name not in UNITS
        right = expected[name].value
        assert abs(value - right) < 2.5 * uncertainty and abs(before - right) < 2.5 * error


@pytest.mark.slow("a search")
def test_a_power_law_beside_says_nothing_of_the_part_whose_work_it_does():
    """A viscous ratio that swings tell to half a percent is not told to a third of it because a power of the speed would do it too."""
    times, truth = np.arange(1801) / 10, {"natural_frequency": 0.62, "viscous_ratio": 0.012, "quadratic_coefficient": 0.16}  # fmt: skip
    noise = 1e-3 * np.random.default_rng(7).standard_normal(times.size)
    angles = (
        simulate(Model("viscous+quadratic_drag", truth, restoring="linear"), times, np.radians(14)) + noise
    )
    first, last = (one(times, angles, restoring="linear") for one in (swingdown.fit, swingdown.explain))
    for name in ("viscous_ratio", "quadratic_coefficient"):
        assert abs(last[name].value - truth[name]) < 3 * last[name].u
        assert last[name].u == pytest.approx(first[name].u, rel=0.2) and last[name].u < 0.02 * truth[name]


def test_a_value_of_a_law_is_told_beside_the_probability_of_the_law():
    """Eight seconds of a film: the viscous ratio is known to half a percent if nothing else stops it, which they leave open."""
    times = np.arange(240) / 30
    film = swingdown.simulate("viscous", times, 0.4, noise=0.003, seed=1, natural_frequency=6.0, viscous_ratio=0.0204)  # fmt: skip
    found = swingdown.fit(film, fitted=["viscous", "structural_damping", "viscous+quadratic_drag"])
    own = found.fits.sel(fitted="viscous", recording="swing")
    alone = float(own["standard_error"].sel(parameter="viscous_ratio"))
    assert alone < 0.005 * 0.0204 < 3 * alone < found["viscous_ratio"].u
    evidence = bic_effective(found.fits)
    share = np.exp((evidence[0] - evidence) / 2).sum()  # of all laws over this one's: the first is viscous
    told = found.to_dataframe()["holds"]
    assert told["viscous_ratio"] == f"if it is viscous (P {1 / share:.3f})" and 0.6 < 1 / share < 0.95
    assert "if it is" not in told["quality"] + told["period"]
    assert found.to_dict()["quantities"]["viscous_ratio"]["holds"] == told["viscous_ratio"]
    assert swingdown.explain(film)["viscous_ratio"].u == pytest.approx(found["viscous_ratio"].u, rel=0.5)
    sure = swingdown.simulate("quadratic_drag", times, 0.4, noise=1e-4, seed=1, natural_frequency=6.0, quadratic_coefficient=0.06)  # fmt: skip
    assert "P 0." not in swingdown.fit(sure, fitted=["viscous", "quadratic_drag"]).to_dataframe()["holds"].sum()  # fmt: skip


def test_a_verdict_that_misses_nothing_knows_that_another_law_would_do():
    """A weak drag with the square of the speed, in noise in which viscous drag is as good: the decay times of the two differ by half."""
    times = np.arange(0, 20, 0.02)
    truth = Model("quadratic_drag", {"natural_frequency": 6.93, "quadratic_coefficient": 0.0032})
    noise = np.random.default_rng(6).normal(0, 4.4e-3, times.size)
    found = swingdown.explain(times, simulate(truth, times, 0.26) + noise, unit="rad")
    assert found.verdict["status"] == "consistent"
    expected = quantities(truth, found.row["amplitude_rad"])
    for name in ("quality", "decay_time"):
        value, uncertainty, _ = found.quantities[name]
        assert abs(value - expected[name].value) < 2 * uncertainty
        assert uncertainty < 0.3 * value
