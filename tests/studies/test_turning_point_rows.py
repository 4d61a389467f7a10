"""What is kept and told of fits to turning points, against pendulums whose law is known."""

import numpy as np
import pytest
import xarray as xr
from turning import turning_points

from swingdown.errors import InputError
from swingdown.fitting.turning_points import Turns, Unmet, fit_turns
from swingdown.measurement.points.points_recording import COUNTED, READ
from swingdown.measurement.points.turning_points import BOTH_SIDES
from swingdown.pendulum.model import Model
from swingdown.studies.turning_points import amplitude_share, period_of_passages, record_of, rows_of

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
