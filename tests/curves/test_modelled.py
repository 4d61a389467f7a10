"""A model's half-swings by amplitude, and what its uncertain parameters do to them."""

import numpy as np
import pytest
from scipy.special import ellipk

from swingdown.curves.modelled import course_of, effects_on
from swingdown.engine.trajectory import simulate
from swingdown.pendulum.model import Model

FREQUENCY = 5.0  # rad/s


def model(label, restoring="sine", **values):
    return Model(label, {"natural_frequency": FREQUENCY, **values}, restoring=restoring)


def turns(of, release, duration=4.0, step=1e-4):
    """Times (s) and signed sizes (rad) of the turning points of a simulated swing, from the middle of a dense series."""
    times = np.arange(0, duration, step)
    angle = simulate(of, times, release)
    k = np.flatnonzero(np.diff(angle)[1:] * np.diff(angle)[:-1] < 0) + 1
    return times[k], angle[k]


@pytest.mark.parametrize("passages", [True, False])
def test_an_exponential_decay_on_a_spring_has_one_loss_and_one_period(passages):
    ratio = 0.02
    found = course_of(model("viscous", "linear", viscous_ratio=ratio), 0.1, 0.8, passages)
    own = np.sqrt(1 - ratio**2)
    loss, period = found.at(np.array([0.1, 0.3, 0.8]))
    assert loss == pytest.approx(np.pi * ratio / own, rel=1e-6)
    assert period == pytest.approx(2 * np.pi / FREQUENCY / own, rel=1e-7)
    assert np.isnan(found.at(np.array([0.05, 1.5]))).all()


@pytest.mark.parametrize("passages", [True, False])
def test_a_pendulum_s_period_is_that_of_the_elliptic_integral(passages):
    found = course_of(model("viscous", viscous_ratio=1e-5), 0.1, 2.5, passages)
    at = np.array([0.1, 1.0, 2.4])
    assert found.at(at)[1] == pytest.approx(4 * ellipk(np.sin(at / 2) ** 2) / FREQUENCY, rel=1e-6)


@pytest.mark.parametrize("torque", [2.0, -2.0])
def test_a_constant_torque_moves_the_middle_and_takes_nothing(torque):
    """Both sides are measured from where it hangs: on a spring the decay is the same as without."""
    ratio = 0.01
    at = np.array([0.2, 0.6])
    tilted = course_of(model("viscous+constant_torque", "linear", viscous_ratio=ratio, constant_torque=torque), 0.2, 0.6)  # fmt: skip
    plain = course_of(model("viscous", "linear", viscous_ratio=ratio), 0.2, 0.6)
    assert np.array(tilted.at(at)) == pytest.approx(np.array(plain.at(at)), rel=1e-6)
    # a pendulum hangs where weight and torque are equal, and swings slower about it than about the vertical
    hung = course_of(
        model("viscous+constant_torque", viscous_ratio=ratio, constant_torque=torque * 5), 0.02, 0.05
    )
    slower = np.sqrt(np.sqrt(1 - (torque * 5 / FREQUENCY**2) ** 2))
    assert hung.at(np.array([0.04]))[1][0] == pytest.approx(2 * np.pi / FREQUENCY / slower, rel=1e-3)


def test_dry_friction_takes_the_same_from_each_swing_and_ends_what_it_holds():
    friction = 0.4
    found = course_of(model("constant_coulomb", "linear", constant_friction=friction), 0.02, 0.8)
    lost = 2 * friction / FREQUENCY**2
    begun = found.amplitude * np.exp(found.loss / 2)
    assert begun * (1 - np.exp(-found.loss)) == pytest.approx(lost, rel=1e-5)
    assert found.amplitude[0] > 0 and begun.min() > lost  # from closer it does not reach the other side


def test_a_torque_that_winds_up_is_that_of_a_swing_that_goes_on():
    """The half-swing after a release differs: the spring of the contact begins unwound."""
    wound = model("presliding", "linear", presliding_friction=0.2, presliding_angle=0.2)
    times, angle = turns(wound, 0.7)
    first, second = np.log(0.7 / -angle[0]), np.log(-angle[0] / angle[1])
    assert first != pytest.approx(second, rel=0.05)
    loss, period = course_of(wound, 0.3, 0.8, False).at(np.sqrt(np.array([-angle[0] * angle[1]])))
    assert loss == pytest.approx(second, rel=1e-3)
    assert period == pytest.approx(2 * (times[1] - times[0]), rel=1e-3)


def test_a_model_that_never_comes_back_has_no_curve():
    found = course_of(model("viscous", "linear", viscous_ratio=1.5), 0.1, 0.5)
    assert found.amplitude.size == 0 and np.isnan(found.at(np.array([0.2, 0.3]))).all()


def test_errors_of_parameters_reach_what_is_derived_by_their_covariance():
    of = model("viscous", viscous_ratio=0.01)
    covariance = np.array([[4e-4, -3e-6], [-3e-6, 1e-7]])
    slope = np.array([[2.0, 30.0], [0.0, -5.0], [1.0, 0.0]])
    effects = effects_on(lambda one: slope @ one.vector(), of, covariance)
    assert effects @ effects.T == pytest.approx(slope @ covariance @ slope.T)
    # what has no standard error is known
    alone = np.array([[4e-4, np.nan], [np.nan, np.nan]])
    effects = effects_on(lambda one: slope @ one.vector(), of, alone)
    assert effects @ effects.T == pytest.approx(4e-4 * np.outer(slope[:, 0], slope[:, 0]))
    assert effects_on(lambda one: slope @ one.vector(), of, np.zeros((2, 2))).shape == (3, 0)
