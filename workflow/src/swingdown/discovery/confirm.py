"""Held-out swings: a model is asked about swings that it never saw, with only their releases (and phases) refitted."""

import numpy as np

from ..fitting.fit import fit_jointly
from ..pendulum import catalogue as effects


def predict(fit, swings):
    """The ``Fit`` of a model's fixed parameters to further swings, each with its own release."""
    model = fit.model
    own = [p.name for name in model.effects for p in effects.effect(name).parameters if p.own]
    fixed = {name: value for name, value in model.values.items() if name not in own}
    return fit_jointly(model.effects, [swing.pair for swing in swings], guess=model, bounded=True, own=own, fixed=fixed,
                       restoring=model.restoring, form=model.form)  # fmt: skip


def gap(fit, noise):
    """The residual's RMS in units of the measured noise."""
    return float(fit.rms / noise.deviation)


def better(before, after, noise):
    """The fall of the held-out sum of squares in units of the noise at the pendulum's frequencies; above 0 is better."""
    return float((before.rss - after.rss) / noise.slow_variance)


def per_swing(fit, noise):
    """The residual's RMS of each swing in units of the noise."""
    return np.asarray(fit.swing_rms) / noise.deviation
