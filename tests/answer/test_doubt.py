"""Other people's files that are no free swing, or whose zero is elsewhere: a right number, or a refusal that says what is wrong."""

import re
import warnings

import numpy as np
import pandas as pd
import pytest
import xarray as xr
import yaml
from scipy.integrate import solve_ivp
from somebody import NOISE, TIMES, TRUTH, holds_the_truth, swing, written

import swingdown
from swingdown.__main__ import main
from swingdown.answer.given import swings
from swingdown.engine.trajectory import simulate
from swingdown.errors import InputError
from swingdown.pendulum.catalogue import catalogue
from swingdown.pendulum.model import Model
from swingdown.planning.settings import complete
from swingdown.studies.doubt import DoubtfulFit, NotFree, ask_counted, check_free, fit_any, unit_in_doubt
from swingdown.studies.pendulums import by_verdict
from swingdown.studies.quantities import cycle, quantities


def test_a_camera_that_hangs_askew_spoils_no_answer(tmp_path, first):
    """Positions tell the pivot and not which way is down."""
    askew = swing() + 0.045
    path = written(
        tmp_path / "video.csv", "t,x,y", TIMES, 380 + 217 * np.sin(askew), 80 + 217 * np.cos(askew)
    )
    holds_the_truth(first(path))


@pytest.mark.parametrize("about", [90, -90, 7.4])
def test_a_zero_elsewhere_is_taken_away(tmp_path, first, capsys, about):
    """As of an angle from the horizontal, or of an encoder that was switched on beside the vertical."""
    path = written(tmp_path / "a.csv", "time (s),angle (deg)", TIMES, np.degrees(swing()) + about)
    row = first(path)
    assert f"({about}" in (told := capsys.readouterr().out) and "this is taken away" in told
    holds_the_truth(row)
    holds_the_truth(swingdown.fit(TIMES, swing() + np.radians(about)).row)


def test_of_an_encoder_too(tmp_path, first):
    counts = np.round((swing() + 1.1) * 4096 / (2 * np.pi))
    path = written(tmp_path / "a.csv", "t_s,counts", TIMES, counts)
    holds_the_truth(first(path, "--counts-per-revolution", "4096"))


def isochronous(decay=0.01, seconds=300):
    """A swing whose period does not know its amplitude, as no pendulum's: it is soon out of step with any."""
    times = np.arange(seconds * 20) / 20
    return times, 0.55 * np.exp(-decay * times) * np.cos(4.8 * times)


def braked(seconds=60):
    """A free pendulum whose friction grows tenfold halfway, as where a card slips into its way: no damping of one size follows it."""
    times = np.arange(seconds * 20) / 20
    half, model = times.size // 2, Model("viscous", {"natural_frequency": 4.8, "viscous_ratio": 0.001})
    step = np.append(times[: half + 1], times[half] + 1e-4)
    before = simulate(model, step, 0.55)
    slowed = model.with_values({"natural_frequency": 4.8, "viscous_ratio": 0.01}, {})
    after = simulate(slowed, times[half:], before[-2], (before[-1] - before[-2]) / 1e-4)
    return times, np.concatenate([before[:-2], after])


def creeping():
    """A computed swing whose step adds a little energy each period."""
    angle, rate, step, found = 0.3, 0.0, 1 / 60, []
    for _ in range(400):
        found.append(angle)
        angle, rate = angle + step * rate, rate - step * (38 * np.sin(angle) + 0.6 * rate)
    return TIMES[:400], np.array(found)


@pytest.mark.parametrize(
    ("made", "words"),
    [
        (isochronous, "the best model of damping leaves"),
        (creeping, "it gains energy: a fit needs viscous ratio below 0"),
    ],
)
def test_what_no_pendulum_does_gives_no_number(made, words):
    with pytest.raises(InputError, match=words) as caught:
        swingdown.fit(*made(), unit="rad")
    assert caught.value.mend


def test_a_wheel_on_a_spring_has_a_linear_restoring_torque(tmp_path, first):
    times, angle = isochronous()
    noise = NOISE * np.random.default_rng(3).standard_normal(times.size)
    path = written(tmp_path / "wheel.csv", "t_s,angle_rad", times, angle + noise)
    row = first(path, "--restoring", "linear")
    truth = np.hypot(4.8, 0.01)
    assert abs(row["natural_frequency_rad_per_s"] - truth) < 4 * row["natural_frequency_rad_per_s_u"] < 1e-3
    assert abs(row["viscous_ratio"] - 0.01 / truth) < 4 * row["viscous_ratio_u"]
    settings = yaml.safe_load((tmp_path / "study" / "study.yaml").read_text())
    assert settings["model"] == {"restoring": "linear"}
    assert complete(settings)["discovery"]["base"] == ["viscous", "constant_coulomb"]
    found = swingdown.fit(times, angle, restoring="linear").row
    assert found["period_s"] == pytest.approx(2 * np.pi / 4.8, rel=1e-4)


def test_a_model_that_lacks_much_is_told():
    with pytest.warns(DoubtfulFit, match="leaves 14 % of swing"):
        swingdown.fit(*braked(), unit="rad")


def test_of_a_model_that_lacks_much_the_period_is_that_of_the_passages():
    """A steady swing that then dies away: no damping has the period of both together."""
    times = np.arange(0, 20, 0.02)
    size = np.where(times < 6, 1.2, 1.2 * np.exp(-(times - 6) / 10))
    pace = 2 * np.pi / (0.9 * (1 + size**2 / 16))
    with pytest.warns(DoubtfulFit, match="leaves 17 % of swing"):
        row = swingdown.fit(times, size * np.cos(np.cumsum(pace) * 0.02), unit="rad").row
    assert row["period_s"] == pytest.approx(0.9 * (1 + 1.2**2 / 16), abs=1e-3)
    assert "by passages of the middle" in row["note"] and row["period_of"] == "passages"
    small, u = (row[f"natural_frequency_rad_per_s{end}"] for end in ("", "_u"))
    assert abs(small - 2 * np.pi / 0.9) < 2 * u < 1.0  # the model's amplitude is 6 % too large


def test_of_small_swings_that_a_model_follows_badly_the_frequency_is_that_of_the_passages():
    """A model's own would be as uncertain as it is wrong, and a series would take it for the period."""
    times = np.arange(0, 20, 0.02)
    size = np.where(times < 6, 0.14, 0.14 * np.exp(-(times - 6) / 5))
    with pytest.warns(DoubtfulFit, match="leaves 14 % of swing"):
        row = swingdown.fit(times, size * np.cos(2 * np.pi / 0.9 * times), unit="rad").row
    small, u = (row[f"natural_frequency_rad_per_s{end}"] for end in ("", "_u"))
    assert row["period_of"] == "passages" and u < 1e-3 * small
    assert small == pytest.approx(2 * np.pi / 0.9 * (1 + 0.14**2 / 16), abs=2 * u)


def test_of_swings_too_few_to_count_a_model_that_lacks_much_tells_no_period():
    """As of a weight on a hard spring that stops after two swings."""
    times = np.arange(0, 1.9, 0.01)
    sine = np.exp(-times / 1.5) * np.cos(2 * np.pi * times)
    peaked = 0.3 * np.sign(sine) * np.abs(sine) ** 2.2 + 1e-3 * np.random.default_rng(1).standard_normal(
        times.size
    )
    with pytest.raises(NotFree, match="leaves 13 % of it, and its swings are too few to count") as caught:
        swingdown.fit(times, peaked, unit="rad")
    assert "record longer" in caught.value.mend


def test_what_a_motor_drives_gives_no_number():
    phase = 2 * np.pi * np.arange(0, 30, 0.05) / 2.7
    driven = 0.5 * np.sin(phase) + 0.075 * np.sin(1.5 * phase + 1)
    with pytest.raises(NotFree, match="do not shrink, and .* as where a motor drives it"):
        swingdown.fit(np.arange(0, 30, 0.05), driven, unit="rad")


def test_of_what_a_hand_moves_first_it_is_told_from_where_on_it_swings():
    times = np.arange(0, 40, 0.02)
    jerks = (
        np.convolve(np.random.default_rng(5).standard_normal(times.size + 49), np.hanning(50), "valid") / 10
    )
    freely = 0.4 * np.exp(-0.01 * times) * np.cos(5 * times)
    with pytest.raises(NotFree, match="it does not move as a pendulum") as caught:
        swingdown.fit(times, np.where(times < 15, jerks, freely), unit="rad")
    begin, end = map(
        float, re.search(r"from (\S+) to (\S+) s alone its swings are in step", str(caught.value)).groups()
    )
    assert 14.5 < begin < 16.5 and end > 38
    swingdown.fit(times[times > begin], freely[times > begin], unit="rad")


def test_what_passes_its_middle_unevenly_has_no_period():
    """A sensor's whims beside a pendulum at rest, of which some model leaves little enough."""
    jolts = np.cumsum(np.random.default_rng(5).choice([0.2, 0.7, 1.6], 20))
    jolts = jolts[jolts < TIMES[-1]]
    uneven = 0.3 * np.sin(np.pi * np.interp(TIMES, [0, *jolts], np.arange(len(jolts) + 1.0)))
    fits = fit_any(swings(TIMES, swing(), "rad")[0], [Model("viscous")]).assign(share_left=("fitted", [0.17]))
    with pytest.warns(DoubtfulFit):
        check_free(fits, swings(TIMES, swing(), "rad")[0], "viscous")
    with pytest.raises(NotFree, match="it passes its middle unevenly"):
        check_free(fits, swings(TIMES, uneven, "rad")[0], "viscous")


def test_of_a_program_that_stamps_its_samples_late_the_clock_is_told():
    """As of one that waits for a disk now and then: the turning points fall evenly, and the times between them do not."""
    rng = np.random.default_rng(1)
    times = np.arange(0.0, 200.0, 0.1)
    angle = 0.4 * np.exp(-times / 150) * np.cos(2 * np.pi * times / 1.9)
    waits = np.interp(times, np.arange(0.0, 201.0, 0.5), rng.exponential(0.35, 402))
    stamps = np.maximum.accumulate(times + waits) + 1e-4 * np.arange(times.size)
    with pytest.raises(NotFree, match="its times are not those of its samples"):
        swingdown.fit(stamps, angle)


def test_it_spoils_only_its_own_row_of_a_class(tmp_path, first, capsys):
    (tmp_path / "class").mkdir()
    written(tmp_path / "class" / "driven.csv", "t_s,angle_rad", *isochronous())
    written(tmp_path / "class" / "good.csv", "t_s,angle_rad", TIMES, swing())
    assert first("class")["recording"] == "good"
    assert "Beware: it does not move as a pendulum" in capsys.readouterr().out
    assert list(pd.read_csv("study/left_out.csv")["recording"]) == ["driven"]


@pytest.mark.parametrize("noise", [0.03, 0.05, 0.07])
def test_a_noisy_swing_gives_a_right_number_or_none(noise):
    noisy = swing(seed=3) + noise * np.random.default_rng(8).standard_normal(TIMES.size)
    try:
        found = swingdown.fit(TIMES, noisy).row
    except InputError:
        assert noise > 0.03
    else:
        assert abs(found["natural_frequency_rad_per_s"] - 6.2) < 4 * found["natural_frequency_rad_per_s_u"]


def test_the_command_names_its_options_and_the_line(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    written(tmp_path / "a.csv", "t_s,angle_rad", TIMES, np.degrees(swing()))
    written(tmp_path / "b.csv", "t_s,angle_rad", TIMES, swing()).open("a").write("15.1,lots\n" * 90)
    for name, words in (("a.csv", "write deg with --unit"), ("b.csv", "line 902, column angle_rad: 90 of")):
        with pytest.raises(SystemExit):
            main([name, "--quick"])
        told = capsys.readouterr()
        assert words in told.err and words not in told.out


@pytest.mark.slow("a search")
def test_what_damping_alone_does_not_follow_is_explained_where_a_name_is_found():
    """A spring that softens so much that a pendulum's period is wrong by whole swings."""
    values = {"natural_frequency": 6.2, "viscous_ratio": 0.004, "quadratic_stiffness": -10.0}
    times = np.arange(2400) / 40
    exact = simulate(Model("viscous+quadratic_stiffness", values), times, 1.2)
    angle = exact + NOISE * np.random.default_rng(1).standard_normal(times.size)
    with pytest.raises(NotFree, match="it does not move as a pendulum"):
        swingdown.fit(times, angle)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        found = swingdown.explain(times, angle)
    assert [one["name"] for one in found.verdict["effects"]] == ["quadratic_stiffness"]
    value, error, _ = found.quantities["natural_frequency"]
    assert abs(value - 6.2) < 4 * error
    # of the some hundred models that were compared nothing is said, and of the one that is told there is nothing to say
    assert not [one for one in told if "model viscous and quadratic" in str(one.message)]
    assert len({str(one.message) for one in told}) <= 1


def test_where_nothing_is_established_the_numbers_are_those_of_damping():
    """What imitates something else has no values, and moves those of the pendulum."""
    row = {
        "period_s": 1.01,
        "period_s_u": 0.001,
        "period_s_text": "1.0100(10)",
        "model": "viscous",
        "model_of": "damping",
    }
    row |= {"residual_rad": 0.02}
    other = {"value": 1.02, "standard_uncertainty": 0.0001, "unit": "s"}
    concluded = {
        "model": "viscous+magnet",
        "amplitude_rad": 0.3,
        "residual": 0.01,
        "quantities": {"period": other},
    }
    assert by_verdict(row, {"status": "unknown", "conclusion": concluded}) == row
    found = by_verdict(row, {"status": "partial", "conclusion": concluded})
    assert (found["period_s"], found["model_of"]) == (1.02, "search")


def test_a_wheel_that_nobody_calls_one_is_asked_about():
    times, angle = isochronous()
    with pytest.raises(InputError, match="degrees taken for rad, or a spring's pull"):
        swingdown.fit(times, angle)


def test_each_pendulum_of_a_folder_has_its_doubts_in_its_own_row(tmp_path, first, capsys):
    (tmp_path / "class").mkdir()
    for name in "abcde":
        written(tmp_path / "class" / f"{name}.csv", "t_s,angle_rad", *braked())
    written(tmp_path / "class" / "good.csv", "t_s,angle_rad", TIMES, swing())
    first("class")
    table = pd.read_csv("study/first_answer.csv", keep_default_na=False).set_index("recording")
    for name in "abcde":
        assert f"leaves 14 % of {name}: it lacks something" in table.loc[name, "remark"]
    assert table.loc["good", "remark"] == ""
    assert capsys.readouterr().out.count("it lacks something") == 5


def test_a_swing_of_which_the_law_lacks_something_has_the_amplitude_and_the_period_with_which_it_begins():
    """The best law begins 6 % too far out, where no swing was; free courses beside it say where it began, and the period is the one timed."""
    bowl = {"bowl": {"torque": "c*theta**5", "parameters": {"c": {"unit": "1/s^2", "lower": 0.0}}}}
    values = {"natural_frequency": 3.3, "viscous_ratio": 0.015, "bowl_c": 0.4}
    truth, times = Model("viscous+bowl", values, catalogue=catalogue(bowl)), np.arange(0, 20, 0.01)
    angle = simulate(truth, times, 1.34) + 10 * NOISE * np.random.default_rng(3).standard_normal(times.size)
    found = swingdown.fit(times, angle)
    assert found.row["amplitude_rad"] == pytest.approx(1.34, rel=0.01)
    assert found["period"].value == pytest.approx(cycle(truth, 1.34).period, rel=0.01)


@pytest.mark.parametrize(("release", "told"), [(1.4, True), (0.25, False)])
def test_where_a_stop_watch_shows_it_the_course_of_the_period_is_told(release, told):
    model = Model("viscous", {"natural_frequency": 6.2, "viscous_ratio": 0.03})
    angle = simulate(model, TIMES, release) + NOISE * np.random.default_rng(3).standard_normal(TIMES.size)
    row = swingdown.fit(TIMES, angle).row
    ends = re.search(
        r"the first and the last swing the period goes from (\S+)\(\d+\) to (\S+)\(\d+\) s",
        str(row.get("note")),
    )
    assert bool(ends) == told
    if told:
        assert float(ends[1]) == pytest.approx(cycle(model, release).period, rel=1e-3)
        assert float(ends[2]) == pytest.approx(2 * np.pi / 6.2, rel=0.01)


def test_even_swings_that_keep_their_size_and_that_no_model_follows_tell_their_period_alone():
    """A weight on a spring that hardly loses anything in seven swings, beyond the reach of its sensor on one side."""
    times = np.arange(0, 5, 0.01)
    seen = np.minimum(np.sin(2 * np.pi * times / 0.72), 0.4) + 0.003 * np.random.default_rng(
        1
    ).standard_normal(times.size)
    with pytest.warns(DoubtfulFit):
        found = swingdown.fit(times, seen, unit="rad", restoring="linear")
    assert found["period"].value == pytest.approx(0.72, rel=3e-3)
    assert "does not die away" in found.sentence and set(found.quantities) <= {"period", "natural_frequency"}


def test_a_spring_needs_no_unit_for_its_period(first, tmp_path):
    """Readings from 10 to 22 of nobody knows what: in rad that is two turns, which a wheel may do."""
    spring = Model("viscous", TRUTH, restoring="linear")
    path = written(tmp_path / "cm.txt", "", TIMES, 16 + 6 * simulate(spring, TIMES, 1.0), separator="\t")
    row = first(path, "--restoring", "linear")
    assert (
        row["period_s"] == pytest.approx(2 * np.pi / 6.2, rel=1e-4)
        and row["amplitude_text"] == "the first swing"
    )


def test_a_model_without_a_period_is_no_answer():
    """As of what somebody turns over by hand, again and again: the nearest model does not swing."""
    given = swings(TIMES, swing(), "rad", None)
    told = {"recording": [str(given[0].attrs["recording"])], "period_s": [np.nan], "period_s_u": [np.nan]}
    with pytest.raises(NotFree, match="has no period"):
        ask_counted(pd.DataFrame(told), given)
    assert ask_counted(pd.DataFrame(told | {"period_s": [1.0134], "period_s_u": [1e-3]}), given) == {}


def test_of_angles_beside_rates_no_common_unit_is_in_doubt():
    """They are refused elsewhere, by what they are; here nothing is said of their unit."""
    angle, rate = (
        xr.Dataset({name: ("time", swing(), {"units": unit})}, {"time": TIMES}, {"unit_told": "no"})
        for name, unit in (("angle", "rad"), ("rate", "rad/s"))
    )
    assert unit_in_doubt([angle, rate]) == ""
    assert "taken for rad" in unit_in_doubt([angle.assign(angle=angle["angle"] * 0.01)])


def test_an_array_that_says_it_is_emulated_is_told_as_such():
    given = xr.DataArray(swing(), attrs={"units": "rad", "emulated": "yes"})
    assert swings(TIMES, given)[0].attrs["emulated"] == "yes"
    assert swings(TIMES, swing(), "rad")[0].attrs["emulated"] == "no"


@pytest.mark.parametrize("given", [np.zeros((50, 3)), np.zeros(50), np.zeros((2, 3, 2))])
def test_numbers_without_times_beside_them_are_refused(given):
    with pytest.raises(InputError, match="no angles are given, and the times bring none along"):
        swings(given)


@pytest.mark.parametrize(
    ("drive", "damping", "told"),
    [
        (1.67, 0.64, "it turns over and over: from end to end it makes 23.6 turns"),
        (0.0, 3.0, "comes to rest without a swing"),
    ],
)
def test_what_does_not_swing_is_refused_for_what_it_does(drive, damping, told):
    times = np.arange(0, 60, 0.02)
    angles = solve_ivp(
        lambda _, y: [y[1], drive - np.sin(y[0]) - damping * y[1]],
        (0, 60),
        [1.4, 0.0],
        t_eval=times,
        rtol=1e-9,
    ).y[0]
    with pytest.raises(InputError, match=told):
        swingdown.fit(times, angles + np.random.default_rng(1).normal(0, 2e-3, times.size), unit="rad")


@pytest.mark.parametrize("off", [0.0, 0.03])
def test_a_zero_that_is_off_changes_no_value(tmp_path, first, off):
    """No file says where its pendulum hangs: of one whose zero is 1.7° off, period and quality are those of one whose is right."""
    times = np.arange(0, 30, 0.02)
    truth = Model(
        "viscous+load_coulomb", {"natural_frequency": 5.0, "viscous_ratio": 0.002, "load_friction": 0.0005}
    )
    angle = simulate(truth, times, 0.3) + off + 1e-3 * np.random.default_rng(8).standard_normal(times.size)
    row = first(written(tmp_path / "swing.csv", "t_s,angle_rad", times, angle))
    known = quantities(truth, 0.3)
    assert abs(row["quality"] - known["quality"].value) < 3 * row["quality_u"] < 0.1 * row["quality"]
    assert abs(row["period_s"] - known["period"].value) < 3 * row["period_s_u"]
    if off:
        assert abs(row["sensor_zero_rad"] - off) < 4 * row["sensor_zero_rad_u"] < 1e-3
    else:
        assert "sensor_zero_rad" not in row


def test_a_zero_that_is_stated_is_not_sought():
    times = np.arange(0, 20, 0.02)
    truth = Model("viscous", {"natural_frequency": 5.0, "viscous_ratio": 0.002})
    angle = simulate(truth, times, 0.3) + 0.02 + 1e-3 * np.random.default_rng(8).standard_normal(times.size)
    assert "sensor_zero" in swingdown.fit(times, angle, unit="rad").quantities
    held = swingdown.fit(times, angle, unit="rad", zero_tolerance=0.0)
    assert "sensor_zero" not in held.quantities
    assert held.row["residual_rad"] > 0.015
    for wrong in (-0.1, 2.0, "a little"):
        with pytest.raises(InputError, match="zero_tolerance"):
            swingdown.fit(times, angle, unit="rad", zero_tolerance=wrong)
