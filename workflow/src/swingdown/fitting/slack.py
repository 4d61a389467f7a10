"""Fits that leave open what the measurement leaves open: the reading's gain, zero and curvature within what is known of them."""

from ..pendulum.slack import Slack
from .least_squares import fit_jointly
from .problem import Swings
from .result import Begin, Fit
from .uncertainty import uncertainty

_ROUNDS = 2  # the residuals that what is known is weighed against are those of the fit itself


def allowing(fit: Fit, swings: Swings, slack: Slack, *, start: str = "free", bounded: bool = False) -> Fit:
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
    start, bounded
        As of the fit: how swings begin, and whether parameters keep their bounds.
    """
    for _ in range(_ROUNDS if slack.names else 1):
        weighed = slack.weighed(uncertainty(fit, swings).noise) if slack.names else slack
        model = fit.model.with_slack(weighed)
        begin = Begin(model, fit.begin.swings)
        fit = fit_jointly(model, swings, start=start, guess=begin, bounded=bounded, seen=False, grown=False)
    return fit
