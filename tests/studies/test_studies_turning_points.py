"""What is kept and told of fits to turning points, against pendulums whose law is known."""

import numpy as np
import pytest
import xarray as xr
from scipy.special import ellipk
from turning import turning_points

from swingdown.errors import InputError
from swingdown.fitting.turning_points import Turns, Unmet, fit_turns
from swingdown.measurement.points.points_recording import COUNTED, PASSED, READ
from swingdown.measurement.points.turning_points import BOTH_SIDES, PASSAGES
from swingdown.pendulum.model import Model
from swingdown.studies.turning_points import (
    amplitude_share,
    as_told,
    passages_told,
    period_of_passages,
    record_of,
    row_of,
    rows_of,
)

VALUES = {"natural_frequency": 5.0, "viscous_ratio": 0.004}


def test_the_period_of_a_pendulum_depends_on_the_amplitude_as_its_weight_makes_it():
    """A share of 1, also where turning points are left out; a fit of another law tells it nearly."""
    times, angles = turning_points(VALUES, 0.6, 30)
    halves = np.delete(np.arange(30), [3, 4, 11])
    turns = Turns(times[halves], halves, angles[halves], True, True)
    for restoring, near in (("sine", 1e-3), ("linear", 0.05)):
        share, _ = amplitude_share(fit_turns(Model("viscous", restoring=restoring), turns))
        assert share == pytest.approx(1, abs=near)


def test_a_record_lasts_from_the_first_point_to_the_last():
    angle = xr.Dataset(coords={"time": ("time", [2.5, 3.0, 7.0])})
    assert record_of(angle.assign_attrs(points=READ)) == 4.5
    assert np.isnan(record_of(angle.assign_attrs(points=COUNTED)))


def test_the_period_is_a_turn_over_the_frequency():
    of_each = {"value": 5.0, "standard_error": 0.02}
    norms = xr.Dataset(
        {name: (("fitted", "parameter"), [[one]]) for name, one in of_each.items()},
        {"parameter": ["natural_frequency"]},
    )
    assert period_of_passages(norms) == pytest.approx((2 * np.pi / 5, 2 * np.pi / 5 * 0.004))


def test_a_model_that_no_turning_point_meets_leaves_the_others(monkeypatch):
    """A gate's speeds may leave one law of damping no swing at all; where no law has one, that is told of the recording."""
    times, angles = turning_points(VALUES, 0.6, 30)
    given = {"time": times, "angle": ("time", angles), "half_swings": ("time", np.arange(30))}
    about = {"points": READ, "kind": BOTH_SIDES, "u_times": np.nan, "u_angles": np.nan, "time_step": 1e-3, "angle_step": 1e-3}  # fmt: skip
    data = xr.Dataset(given).assign_attrs(**about, recording="gate")
    models = [Model("viscous"), Model(("viscous", "presliding"))]

    def unmet(model, *more, only=("viscous", "presliding")):
        if set(only) <= set(model.names):
            raise Unmet("turning points", "no swing", "a pendulum's", "check")
        return fit_turns(model, *more)

    monkeypatch.setattr("swingdown.studies.turning_points.fit_turns", unmet)
    first, second = rows_of(data, models, ["natural_frequency", "viscous_ratio"])
    assert first["value"][0] == pytest.approx(VALUES["natural_frequency"], rel=1e-4)
    assert np.isnan(second["bic"]) and not second["converged"]
    with pytest.raises(InputError, match="recording gate"):
        rows_of(data, models[1:], ["natural_frequency", "viscous_ratio"])


def read(noise=True, **more):
    """Turning points of both sides of a pendulum whose scale is a little off its middle."""
    times, angles = turning_points(VALUES, 0.6, 30)
    rng = np.random.default_rng(3)
    late, off = (size * rng.standard_normal(30) * noise for size in (2e-3, 1e-3))
    return Turns(times + late, np.arange(30), angles + off + 0.02, True, True, **more)


def test_the_dependence_on_the_amplitude_is_one_more_straight_line():
    """Of what is left of the times: by ordinary least squares beside a first time and a period."""
    fit = fit_turns(Model("viscous"), read())
    size = np.abs(fit.angles)
    longer = 2 / np.pi * ellipk(np.sin((size[1:] + size[:-1]) / 4) ** 2) - 1
    more = np.pi / fit.known["natural_frequency"] * np.r_[0, np.cumsum(longer)]
    columns = np.column_stack([np.ones(30), np.arange(30), more])
    found = np.linalg.lstsq(columns, fit.turns.times - fit.times)[0]
    error = fit.scatter[0] * np.sqrt(np.linalg.inv(columns.T @ columns)[2, 2])
    assert amplitude_share(fit) == pytest.approx((1 + found[2], error), rel=1e-6)
    counted = fit_turns(Model("viscous"), read()._replace(times=np.arange(30) / 2, timed=False))
    assert np.isnan(amplitude_share(counted)).all()


@pytest.mark.parametrize("timed", [True, False])
def test_a_row_keeps_what_the_fit_found(timed):
    names = ["natural_frequency", "quadratic_coefficient", "viscous_ratio"]
    turns = read() if timed else read()._replace(times=np.arange(30) / 2, timed=False)
    fit = fit_turns(Model("viscous"), turns, clock=1e-4)
    row, known = row_of(fit, names), fit.known
    left = turns.angles - fit.angles
    random = dict(zip(fit.free, np.sqrt(np.diag(fit.random)), strict=True))
    omega = known.get("natural_frequency", 2 * np.pi)
    frequency = random.get("natural_frequency", np.nan)
    assert row["value"] == pytest.approx([omega, np.nan, known["viscous_ratio"]], nan_ok=True)
    assert row["random_standard_error"] == pytest.approx([frequency, np.nan, random["viscous_ratio"]], nan_ok=True)  # fmt: skip
    clock = omega * 1e-4 if timed else np.nan
    assert row["systematic_standard_error"] == pytest.approx([clock, np.nan, 0], nan_ok=True)
    assert row["systematic"][:, 0] == pytest.approx([-clock, np.nan, 0], nan_ok=True)
    whole = np.hypot(row["random_standard_error"], row["systematic_standard_error"])
    assert row["standard_error"] == pytest.approx(whole, nan_ok=True)
    assert np.diag(row["covariance"]) == pytest.approx(whole**2, nan_ok=True)
    assert np.diag(row["correlation"])[2] == pytest.approx(1)
    if timed:
        shared = row["covariance"][0, 2] / (whole[0] * whole[2])
        assert row["correlation"][0, 2] == pytest.approx(shared)
        assert row["time_residual"] == pytest.approx(turns.times - fit.times)
    assert np.isnan(row["time_scatter"]) == (not timed) and row["angle_scatter"] == fit.scatter[1]
    errors = np.sqrt(np.diag(fit.covariance))
    ends = np.linalg.eigvalsh(fit.covariance / np.outer(errors, errors))[[0, -1]]
    assert row["condition_number"] == pytest.approx(ends[1] / ends[0])
    assert row["aicc"] - row["bic"] == pytest.approx(len(fit.free) * (2 - np.log(30)))
    assert row["norm"] == pytest.approx(np.degrees(np.sqrt(np.mean(left**2))))
    assert row["share_left"] == pytest.approx(np.sqrt(np.sum(left**2) / np.sum(turns.angles**2)))
    assert row["largest_angle"] == pytest.approx(0.6, abs=2e-3)  # about its middle, not the scale's
    assert row["release_angle"] == known["release_angle"] and row["release_velocity"] == 0
    assert row["residual"] == pytest.approx(left) and row["fit"] == pytest.approx(fit.angles)


def passages(times):
    given = {"time": times, "half_swings": ("time", np.arange(times.size))}
    about = {"points": PASSED, "kind": PASSAGES, "u_times": np.nan, "u_angles": np.nan, "time_step": 0.0, "angle_step": 0.0}  # fmt: skip
    return xr.Dataset(given).assign_attrs(**about, recording="gate")


def test_passages_without_speeds_have_a_frequency_and_nothing_of_the_damping():
    names = ["natural_frequency", "viscous_ratio"]
    times = 0.7 * np.arange(60) + 1e-4 * np.random.default_rng(1).standard_normal(60)
    one, other = rows_of(passages(times), [Model("viscous"), Model("load_coulomb")], names)
    slope, intercept = np.polyfit(np.arange(60), times, 1)
    assert one["value"] == pytest.approx([np.pi / slope, np.nan], rel=1e-5, nan_ok=True)
    u = 1e-4 / np.sqrt(60**3 / 12) * np.pi / slope**2
    assert one["standard_error"][0] == pytest.approx(u, rel=0.4)
    assert one["period_first"] == pytest.approx(1.4, abs=5 * one["period_first_u"])
    assert one["time_residual"] == pytest.approx(times - intercept - slope * np.arange(60), abs=1e-4)
    assert np.isnan([one["norm"], one["largest_angle"], one["amplitude_share"], *one["fit"]]).all()
    assert one["bic"] == other["bic"] == 0 and one["converged"]


def told(row=None, alike=(), **more):
    """The row of ``as_told``, and its notes."""
    own = {"angle_scatter": 2e-3, "time_scatter": 3e-3, "period_first": np.nan, "period_first_u": np.nan, "period_change": np.nan,
           "period_change_u": np.nan, "amplitude_share": 1.04, "amplitude_share_u": 0.05, "points_scale": 250.0} | more  # fmt: skip
    frequency = {"value": [5.0], "standard_error": [0.02]}
    norms = xr.Dataset(
        {name: ("fitted", [one]) for name, one in own.items() if not isinstance(one, str)}
        | {name: (("fitted", "parameter"), [one]) for name, one in frequency.items()},
        {"fitted": ["viscous"], "parameter": ["natural_frequency"]},
    )
    norms["points"], norms["points_unit"] = own.get("points", READ), own.get("points_unit", "rad")
    whole = {"model": "viscous", "amplitude_rad": 0.4, "residual_rad": 1e-3, "decay_time_s": 30.0, "natural_frequency_u": 0.02,
             "period_s": 1.25, "load_friction": 0.1, "viscous_ratio": 0.01}  # fmt: skip
    found = as_told(whole | (row or {}), norms, alike)
    return found, found["note"].split("; ")


def test_what_is_to_be_known_of_turning_points_is_told():
    found, notes = told(alike=["quadratic_drag", "load_coulomb"])
    assert notes[0].startswith("the data do not distinguish") and ", or " in notes[0]
    assert notes[1] == "amplitudes scatter by 2 mrad and times by 3 ms"
    assert notes[2] == "small swings take 1.2566(50) s"
    assert notes[3] == "the period grows with the amplitude 1.040(50) times as fast as weight makes it"
    assert found["or_model"] == "quadratic_drag; load_coulomb" and found["amplitude_rad"] == 0.4
    assert "shows no dependence on the amplitude" in told(amplitude_share_u=0.4)[0]["note"]
    assert told()[1][0].startswith("amplitudes scatter")  # of one law there is no other


def test_an_amplitude_is_told_in_the_unit_it_was_read_in():
    found, notes = told(points_unit="mm")
    assert notes[0] == "amplitudes scatter by 0.5 mm and times by 3 ms"
    assert found["amplitude_text"] == "100 mm" and np.isnan([found["amplitude_rad"], found["residual_rad"]]).all()  # fmt: skip
    assert "load_friction" not in found and "viscous_ratio" in found
    assert not any("small swings" in one for one in notes)


def test_a_count_has_no_seconds():
    found, notes = told(points=COUNTED, time_scatter=np.nan, amplitude_share=np.nan)
    assert "period_s" not in found and "natural_frequency_u" not in found
    assert found["decay_swings"] == 30.0 and "decay_time_s" not in found
    assert notes[0] == "amplitudes scatter by 2 mrad"


def test_passages_have_their_own_period_and_its_change():
    of_pace = {"period_first": 1.3, "period_first_u": 0.01, "period_change": -0.02, "period_change_u": 0.001}
    found, notes = told(**of_pace, amplitude_share=np.nan)
    assert (found["period_s"], found["period_s_u"]) == (1.3, 0.01) and found["period_s_text"] == "1.300(10)"
    assert notes[0] == "speeds scatter by 2 mrad and times by 3 ms"
    assert notes[1] == "the period changes by -20.0(1.0) ms from the first one to the last"
    assert "natural_frequency_u" not in found
    norms = xr.Dataset({name: ("fitted", [one]) for name, one in of_pace.items()})
    cells = passages_told(norms.assign(angle_scatter=("fitted", [np.nan]), time_scatter=("fitted", [1e-3])))
    assert cells["note"].split("; ")[:2] == ["times scatter by 1 ms", notes[1]]
    assert "damping is not in the data" in cells["note"]
