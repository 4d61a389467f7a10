"""The paper's simplex beside the least squares."""

import numpy as np
import pytest
from swings import CASES, TIMES, paper_model

from swingdown.engine.trajectory import simulate
from swingdown.fitting.least_squares import fit_trajectory
from swingdown.fitting.nelder_mead import fit_nelder_mead


@pytest.mark.parametrize("label", ["viscous", "viscous+load_coulomb", "quadratic_drag+load_coulomb"])
@pytest.mark.parametrize("start", ["free", "rest"])
def test_nelder_mead_and_least_squares_agree(label, start):
    model, times = paper_model(label), TIMES[:301]
    noise = 0.003 * np.random.default_rng(7).standard_normal(times.size)
    angle = simulate(model, times, 0.35) + noise
    simplex = fit_nelder_mead(label, times, angle, start=start)
    squares = fit_trajectory(label, times, angle, start=start)
    assert simplex.converged and squares.converged
    assert simplex.rss == pytest.approx(squares.rss, rel=1e-6)
    assert simplex.rss >= squares.rss * (1 - 1e-9)
    assert np.abs((simplex.values - squares.values) / squares.standard_errors).max() < 0.02
    assert simplex.standard_errors == pytest.approx(squares.standard_errors, rel=0.01)
    assert (simplex.method, squares.method) == ("Nelder-Mead", "least squares")


def test_a_simplex_is_started_again_until_that_gains_nothing():
    angle, _ = CASES["seven"].noisy(14)
    once = fit_nelder_mead("viscous+presliding", TIMES[:200], angle[:200], restarts=1)
    again = fit_nelder_mead("viscous+presliding", TIMES[:200], angle[:200])
    assert not once.converged and again.converged and again.rss < once.rss
