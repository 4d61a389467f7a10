"""Held-out swings: a model is asked about swings that it never saw, with only their releases (and phases) refitted."""

from collections.abc import Sequence

import numpy as np

from ...arrays import Floats
from ...fitting.least_squares import fit_jointly
from ...fitting.result import Fit
from ..data.campaign import Swing
from ..data.noise import Noise
from ..move.refit import as_candidate


def predict(fit: Fit, swings: Sequence[Swing]) -> Fit:
    """The ``Fit`` of a model's fixed parameters to further swings, each with its own release; TrajectoryError where there is none."""
    model = fit.model
    fixed = {name: value for name, value in model.values.items() if name not in model.each}
    with as_candidate():
        return fit_jointly(
            model, [swing.pair for swing in swings], guess=model, bounded=True, own=model.each, fixed=fixed
        )


def gap(fit: Fit, noise: Noise) -> float:
    """The residual's RMS in units of the measured noise."""
    return float(fit.rms / noise.deviation)


def per_swing(fit: Fit, noise: Noise) -> Floats:
    """The residual's RMS of each swing in units of the noise."""
    return np.array([swing.rms for swing in fit.swings]) / noise.deviation
