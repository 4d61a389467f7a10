"""Times alone: the period by a line through them, and how it changes."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.polynomial.legendre import legder, legval, legvander

from ..arrays import Floats
from ..errors import InputError
from .turning_points import middle

_FEWEST = 3  # terms: a first time, the period, and its change
_MOST = 10  # terms: more, and the ends swing
_IDLE = 2  # terms, one even and one odd, that say no more: of all beyond one would by chance
_EACH = 3  # passages for each term, and two for each of four: a steep fall bends


class Pace(NamedTuple):
    """The period (s) in the middle of a recording, the first one, and the change from there to the last one (s), the standard uncertainty
    of each, the scatter of the times (s), and their residuals (s)."""

    period: float
    u_period: float
    first: float
    u_first: float
    change: float
    u_change: float
    scatter: float
    residuals: Floats


def pace(times: Floats, halves: np.ndarray, clock: float = 0.0, step: float = 0.0) -> Pace:
    """The ``Pace`` of passages, by least squares with the colour and rounding of the residuals.

    Parameters
    ----------
    times
        In s, of shape (passage,).
    halves
        Half-swings since the first passage, of shape (passage,).
    clock
        The standard uncertainty of the clock's rate, as a share.
    step
        That in which the times come, in s.

    Raises
    ------
    InputError
        If there are too few.
    """
    if times.size < _FEWEST + 2:
        problem = f"there are {times.size} of them"
        raise InputError("passages", problem, f"at least {_FEWEST + 2}", "record longer")
    half = (halves[-1] - halves[0]) / 4  # of the recording, in swings
    at = (halves - halves[0]) / (2 * half) - 1
    slopes = _by_evidence(times, lambda terms: legvander(at, terms - 1))
    found = np.linalg.lstsq(slopes, times)[0]
    left = times - slopes @ found
    terms = slopes.shape[1]
    least = max(step / np.sqrt(12), 1e-12 * float(np.ptp(times)))
    scatter = max(float(np.sqrt(left @ left / (times.size - terms))), least)
    inverse = np.linalg.inv(slopes.T @ slopes)
    scores, _ = middle(slopes, left / scatter, step / scatter, times / scatter)
    covariance = inverse @ scores @ inverse * scatter**2
    edge = 1 - 1 / (2 * half)  # the middle of the last period, a half-swing before its end
    places = np.array([-edge, 0.0, edge])
    # the slopes of each Legendre polynomial there
    first, now, last = np.array([legval(places, legder(one)) for one in np.eye(terms)]).T / half

    def told(rates: Floats, clocked: float) -> tuple[float, float]:
        value = float(rates @ found)
        return value, float(np.hypot(np.sqrt(rates @ covariance @ rates), clocked * value))

    return Pace(*told(now, clock), *told(first, clock), *told(last - first, clock), scatter, left)


def _by_evidence(times: Floats, slopes: Callable[[int], Floats]) -> Floats:
    """Of the slopes for so many terms those with the lowest Bayesian information criterion for these times."""

    def bic(one: Floats) -> float:
        left = times - one @ np.linalg.lstsq(one, times)[0]
        power = max(float(left @ left), (1e-12 * float(np.ptp(times))) ** 2)
        return times.size * np.log(power / times.size) + one.shape[1] * np.log(times.size)

    most = max(_FEWEST, min(4, times.size // 2), min(_MOST, times.size // _EACH))
    found, idle = slopes(_FEWEST), 0
    for terms in range(_FEWEST + 1, most + 1):
        more = slopes(terms)
        idle = 0 if bic(more) < bic(found) else idle + 1
        if idle == _IDLE:
            break
        found = found if idle else more
    return found


def both_ways(times: Floats, halves: np.ndarray) -> Floats:
    """The times (s) without what every second one is late: a gate beside the middle, passed one way and the other.

    The lateness grows as the amplitude falls; where every second passage is missing there is nothing to take off.
    """
    signs = (-1.0) ** halves
    fewer = min(np.count_nonzero(signs > 0), np.count_nonzero(signs < 0))
    if fewer < 2 * _FEWEST:
        return times
    at = 2 * (halves - halves[0]) / (halves[-1] - halves[0]) - 1

    def both(terms: int) -> Floats:
        one = legvander(at, terms - 1)
        return np.hstack([one, signs[:, np.newaxis] * one])

    slopes = _by_evidence(times, both)
    found, terms = np.linalg.lstsq(slopes, times)[0], slopes.shape[1] // 2
    return times - slopes[:, terms:] @ found[terms:]
