"""What a fitted model says of a swing beyond the samples it was fitted to, with its uncertainty."""

from typing import Any

import numpy as np

from swingdown.arrays import Floats
from swingdown.engine.trajectory import checked_times, sensitivities
from swingdown.fitting.problem import RELEASE
from swingdown.fitting.result import Fit
from swingdown.fitting.uncertainty import Uncertainty


def predict_reading(fit: Fit, known: Uncertainty, times: Any, swing: int = 0) -> tuple[Floats, Floats]:
    """The reading (rad) of a fitted swing and its standard uncertainty, both of the shape of ``times``, without a sample's noise.

    Parameters
    ----------
    fit, known
        The fit and the ``Uncertainty`` of its values.
    times
        In s; the first is that of the swing's release. The same clock is taken to go on.
    swing
        Which of the fitted swings.
    """
    times = checked_times(times)
    one = fit.swings[swing]
    own = [*one.own, *(RELEASE if RELEASE[0] in fit.free else ())]
    shared = len(fit.free) - len(own) * len(fit.swings)
    where = np.r_[:shared, shared + swing * len(own) : shared + (swing + 1) * len(own)]
    release = one.release_angle, one.release_velocity
    series, slopes = sensitivities(one.model, times, *release, free=[fit.free[i] for i in where])
    systematic = known.systematic[where][:, :-1]  # all but the clock
    covariance = known.random[np.ix_(where, where)] + systematic @ systematic.T
    held = ~np.isfinite(np.diag(covariance))
    slopes, covariance = slopes[~held], covariance[np.ix_(~held, ~held)]
    return series, np.sqrt(np.einsum("it,ij,jt->t", slopes, covariance, slopes))
