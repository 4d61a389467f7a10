"""What friction and stiffness do to a half-swing, held against what one can derive by hand."""

import numpy as np
import pytest
from scipy.special import ellipk

from swingdown.curves.torques import (
    Ideal,
    beyond_durations,
    durations,
    friction,
    losses,
    lost,
    stiffness,
    swung,
)

AMPLITUDES = np.geomspace(0.05, 1.5, 9)
BOTH = pytest.mark.parametrize("ideal", [Ideal("sine"), Ideal("linear")], ids=lambda ideal: ideal.restoring)


@BOTH
def test_the_ideal_torque_is_the_slope_of_the_energy_and_has_the_slope_that_is_told(ideal):
    angle, step = np.linspace(-2.5, 2.5, 21), 1e-5
    assert np.gradient([ideal.energy(angle - step), ideal.energy(angle), ideal.energy(angle + step)], step, axis=0)[1] == pytest.approx(ideal.torque(angle), abs=1e-8)  # fmt: skip
    steeper = (ideal.torque(angle + step) - ideal.torque(angle - step)) / (2 * step)
    assert steeper == pytest.approx(ideal.slope(angle), abs=1e-8)
    assert ideal.speed(AMPLITUDES) ** 2 / 2 == pytest.approx(ideal.energy(AMPLITUDES))


def test_a_pendulum_is_slower_at_large_amplitudes_and_turns_over_and_a_spring_never_is():
    assert Ideal("sine").lengthening(AMPLITUDES) == pytest.approx(ellipk(np.sin(AMPLITUDES / 2) ** 2) * 2 / np.pi)  # fmt: skip
    assert Ideal("linear").lengthening(AMPLITUDES) == pytest.approx(1.0)
    assert 2.0 < Ideal("sine").widest(2.0) < np.pi and Ideal("linear").widest(2.0) > 1e9


def test_each_law_of_friction_takes_from_a_spring_what_its_work_is():
    """A constant torque takes 2 c a half-swing, a viscous one the share π k / 2, a quadratic one 4 k a² / 3."""
    ideal = Ideal("linear")
    basis = friction(ideal, AMPLITUDES)
    taken = losses(ideal, basis, AMPLITUDES)
    share = AMPLITUDES / basis.scale
    by_hand = np.column_stack(
        [2 / AMPLITUDES, np.pi / 2 * np.ones(9) / basis.scale, 4 / 3 * share / basis.scale]
    )
    assert taken[:, :3] == pytest.approx(by_hand, rel=1e-3)
    assert lost(ideal, lambda speed: 0.02 * speed**2, AMPLITUDES) == pytest.approx(0.08 / 3 * AMPLITUDES, rel=1e-6)  # fmt: skip


@BOTH
def test_any_smooth_friction_is_a_sum_of_the_curves_and_takes_as_much_as_they_do(ideal):
    basis = friction(ideal, AMPLITUDES)
    fast = np.geomspace(*ideal.speed(AMPLITUDES[[0, -1]]), 60)

    def stribeck(speed):
        return 0.01 * np.exp(-speed / 0.4) + 0.02 * speed

    share = np.linalg.lstsq(basis.at(fast), stribeck(fast), rcond=None)[0]
    assert basis.at(fast) @ share == pytest.approx(stribeck(fast), rel=2e-2)
    curve = losses(ideal, basis, AMPLITUDES) @ share
    assert curve == pytest.approx(lost(ideal, lambda speed: (basis.at(speed.ravel()) @ share).reshape(speed.shape), AMPLITUDES))  # fmt: skip
    # between the nodes straight lines, which together are the law that they are drawn over
    assert basis.at(fast)[:, 3:].sum(axis=1) == pytest.approx(fast / basis.scale)
    # a slower speed than any that was measured has what the slowest has, in proportion
    slow = basis.at(np.array([1e-6, 2e-6]))[:, 3]
    assert slow[1] == pytest.approx(2 * slow[0]) and slow[0] > 0


def test_a_stiffer_spring_swings_faster():
    """By half of a constant share, by 3/8 ε a² of a cubic torque: Duffing's spring to first order; a constant share to all orders by its root."""
    ideal, basis = Ideal("linear"), stiffness(AMPLITUDES)
    shorter = durations(ideal, basis, AMPLITUDES)
    assert shorter[:, 0] == pytest.approx(-0.5)
    assert shorter[:, 1] == pytest.approx(-3 / 8 * (AMPLITUDES / basis.scale) ** 2, rel=1e-6)
    assert shorter[:, 2:].sum(axis=1) == pytest.approx(-0.5)
    constant = np.eye(shorter.shape[1])[0]
    whole = beyond_durations(ideal, basis, 0.3 * constant, AMPLITUDES) + 0.3 * shorter[:, 0]
    assert 1 + whole == pytest.approx(1.3**-0.5)


def test_half_swings_with_viscous_friction_are_those_of_the_text_books():
    ratio = 0.1
    found = swung(Ideal("linear"), lambda speed: 2 * ratio * speed, AMPLITUDES)
    own = np.sqrt(1 - ratio**2)
    assert found.loss == pytest.approx(np.pi * ratio / own, rel=1e-5)
    assert found.duration == pytest.approx(np.pi / own, rel=1e-5)
    assert found.passage == pytest.approx((np.pi - np.arctan2(own, ratio)) / own, rel=1e-6)
    assert found.amplitude == pytest.approx(AMPLITUDES * np.exp(-found.loss / 2))


def test_half_swings_with_dry_friction_turn_about_where_it_holds_them_and_weak_ones_stay():
    begun = np.array([1.0, 0.3, 0.04])
    found = swung(Ideal("linear"), lambda speed: np.full_like(speed, 0.05), begun)
    reached = begun[:2] - 2 * 0.05
    assert found.loss[:2] == pytest.approx(np.log(begun[:2] / reached), rel=1e-6)
    assert found.duration[:2] == pytest.approx(np.pi, rel=1e-6)
    assert found.passage[:2] == pytest.approx(np.arccos(-0.05 / (begun[:2] - 0.05)), rel=1e-6)
    assert np.isnan([found.loss[2], found.duration[2], found.passage[2]]).all()


def test_half_swings_of_a_pendulum_without_friction_last_as_long_as_the_elliptic_integral_says():
    found = swung(Ideal("sine"), np.zeros_like, np.array([0.1, 1.0, 2.5]))
    assert found.loss == pytest.approx(0.0, abs=1e-5)
    assert found.duration == pytest.approx(2 * ellipk(np.sin(np.array([0.05, 0.5, 1.25])) ** 2), rel=1e-6)
    assert found.passage == pytest.approx(found.duration / 2, rel=1e-6)
