"""What cannot be followed is refused; what is followed less exactly than usual is told, with the size of the error."""

import re
import warnings

import numpy as np
import pytest
from cases import TIMES, friction
from scipy.integrate import solve_ivp

from swingdown.engine.trajectory import TrajectoryError, TrajectoryWarning, simulate
from swingdown.errors import InputError
from swingdown.pendulum.catalogue import catalogue
from swingdown.pendulum.model import Model
from swingdown_trials import second_pendulum as oracle


def test_friction_that_drives_is_told():
    """Beyond 90 degrees the rod is pushed, so friction in proportion to its pull feeds the swing; at the top it throws it."""
    values = {"natural_frequency": 5.0, "load_friction": 0.05}
    model = Model("load_coulomb", values)
    with pytest.warns(TrajectoryWarning, match="beyond 90°.*gains energy"):
        read = simulate(model, TIMES, np.radians(120))
    seen = oracle.trajectory(model.names, values, TIMES, np.radians(120))
    assert np.abs(read - seen.reading).max() < 1e-6, "to the letter all the same"
    with pytest.raises(TrajectoryError, match="not unique"):
        simulate(model, TIMES, np.radians(178))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        simulate(model, TIMES, np.radians(85))
        simulate(friction(3.0), TIMES, np.radians(178))  # held the same everywhere: no load in it


def test_what_cannot_be_followed_is_refused():
    softening = Model(
        "viscous+cubic_stiffness",
        {"natural_frequency": 3.0, "viscous_ratio": 0.01, "cubic_stiffness": -30.0},
        restoring="linear",
    )
    with pytest.raises(TrajectoryError, match="viscous_ratio 0.01"):
        simulate(softening, TIMES, 2.0)
    backwards = Model(
        "viscous+clock_drift", {"natural_frequency": 3.0, "viscous_ratio": 0.01, "clock_drift": -0.6}
    )
    with pytest.raises(TrajectoryError, match="clock"):
        simulate(backwards, TIMES, 0.5)


@pytest.mark.parametrize(
    ("times", "angle", "told"),
    [
        ([0.0, 2.0, 1.0], 0.5, "increasing"),
        ([0.0, 1.0, 1.0], 0.5, "increasing"),
        ([0.0, np.nan], 0.5, "finite"),
        ([[0.0, 1.0]], 0.5, "one dimension"),
        ([], 0.5, "at least one"),
        ([0.0, 1.0], np.nan, "finite"),
        ([0.0, 1.0], np.inf, "finite"),
    ],
)
def test_bad_input_is_told(times, angle, told):
    with pytest.raises(InputError, match=told):
        simulate(friction(0.4), times, angle)


def test_what_is_too_narrow_to_be_seen_is_refused():
    values = {"natural_frequency": 7.0, "viscous_ratio": 0.01, "eddy_coefficient": 0.5, "eddy_width": 0.001}
    with pytest.raises(InputError, match="eddy_width.*0.01 or more"):
        simulate(Model("viscous+eddy_brake", values), TIMES, 0.5)


def test_missing_values_are_named():
    with pytest.raises(InputError, match="viscous_ratio"):
        simulate(Model("viscous", {"natural_frequency": 7.0}), TIMES, 0.5)


def told_error(*arguments):
    """What ``simulate`` gives, and the error that its one warning tells, in the reading's unit."""
    with pytest.warns(TrajectoryWarning, match="beyond 150° small errors grow") as told:
        read = simulate(*arguments)
    (size,) = re.findall(r"off by some (\S+) rad", str(told[0].message))
    return read, float(size)


@pytest.mark.parametrize("reading", ["angle", "rate"])
def test_errors_that_grow_near_the_top_are_told_with_their_size(reading):
    """A strong spring beyond 150 degrees, held against the second pendulum: an estimate from the panels alone is 8 times too low."""
    values = {"natural_frequency": 11.4, "quadratic_stiffness": -0.8}
    model, times = Model("quadratic_stiffness", values).of(reading), np.arange(1001) / 100
    read, told = told_error(model, times, np.radians(175.8))
    true = oracle.trajectory(model.names, values, times, np.radians(175.8), reading=reading).reading
    assert told == pytest.approx(np.abs(read - true).max(), rel=0.5)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        simulate(model, times, np.radians(120))


def test_errors_that_grow_in_a_chaotic_torque_are_told_with_their_size():
    """A torque of one's own, several turns out, with two wells: a change of the release grows 800 times, off by 2e-4 rad."""
    pieces = (42.03, 48.65, 16.92, 33.62, 86.86, 0.0, -4.247)
    values = {"natural_frequency": 7.761, "viscous_ratio": 0.0001416}
    values |= {f"wells_c_{k}": piece for k, piece in enumerate(pieces)}
    powers = (0, 2, 3, 4, 5, 6, 7)
    term = " + ".join(f"c_{k}*(theta/4.033)**{power}" for k, power in enumerate(powers))
    own = catalogue({"wells": {"torque": term, "parameters": {f"c_{k}": {} for k in range(7)}}})
    times = np.arange(1001) / 100
    torque = np.polynomial.Polynomial([pieces[0], 0, *pieces[1:]])

    def motion(_, at):
        damping = 2 * values["viscous_ratio"] * 7.761
        return at[1], -(7.761**2) * np.sin(at[0]) - damping * at[1] + torque(at[0] / 4.033)

    true = solve_ivp(motion, (0, 10), (-4.651, 14.78), "DOP853", times, rtol=1e-13, atol=1e-15, max_step=0.02)
    read, told = told_error(Model("viscous+wells", values, catalogue=own), times, -4.651, 14.78)
    assert told == pytest.approx(np.abs(read - true.y[0]).max(), rel=0.5)
