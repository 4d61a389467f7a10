"""Fits that leave open what the measurement leaves open: the reading's gain, zero and curvature within what is known of them."""

import numpy as np

from ..pendulum.slack import ZERO, Slack
from .least_squares import fit_jointly
from .problem import Swings
from .result import Begin, Fit
from .uncertainty import uncertainty

_ROUNDS = 2  # the residuals that what is known is weighed against are those of the fit itself
_LEAST = 1e-6  # of the readings' RMS: beside less noise, as of an exact simulation, what is known beforehand would be lost in rounding
_LITTLE = 1e-5  # of the variance of what is known: so little is left by the data that what is known beforehand changes nothing


def begun_with(slack: Slack) -> Slack | None:
    """What is open from the first fit on: the clock, or a zero alone, of which data tell more than was known; None where no value is,
    as of a gain, which the data of small swings do not tell."""
    if not slack.names:
        return slack
    return slack.weighed(0.0) if slack.names == (ZERO,) else None


def allowing(fit: Fit, swings: Swings, slack: Slack, *, start: str = "free") -> Fit:
    """The fit of the same swings once more, with the nuisance values of the measurement free within what is known of them.

    What is known is weighed against the fit's own residuals as they are at the pendulum's frequencies: beside a model that
    misses much, the data have little to say on the sensor.

    Parameters
    ----------
    fit
        Its values are where this begins. Without nuisance values it keeps them, and takes the clock's uncertainty into its covariance.
    swings
        Those of the fit.
    slack
        What the measurement leaves open.
    start
        As of the fit: how swings begin.
    """
    begun = fit.model.slack.names == slack.names
    if begun and slack.names == (ZERO,) and _told_by_data(fit, slack):
        return fit
    least = _LEAST * float(np.sqrt(sum(series @ series for _, series in swings) / fit.n))
    for _ in range(1 if begun else _ROUNDS):  # with the same values free, its residuals are those of this fit
        weighed = slack.weighed(max(uncertainty(fit, swings).noise, least)) if slack.names else slack
        model = fit.model.with_slack(weighed)
        begin = Begin(model, fit.begin.swings)
        fit = fit_jointly(model, swings, start=start, guess=begin, seen=False, grown=False)
    return fit


def _told_by_data(fit: Fit, slack: Slack) -> bool:
    """Whether the data leave so little of a zero open that what was known of it is nothing beside them."""
    (name,) = slack.parameters
    at = fit.free.index(name)
    return bool(fit.covariance[at, at] < _LITTLE * slack.covariance[0, 0])
