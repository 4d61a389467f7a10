"""Three readings of the paper's "maximum deviation lines", which it does not define."""

import numpy as np
from scipy.optimize import linprog

from ..arrays import Floats
from ..measurement.straight_line import Line

KINDS = ("extreme", "one-sigma", "covariance")
_FACTORS = tuple(2.0**k for k in range(8))


def deviation_lines(line: Line, x: Floats, y: Floats, half_x: Floats, half_y: Floats) -> tuple[Floats, float]:
    """Intercept and slope of a lower and an upper line for each of ``KINDS``, of shape (3, 2, 2), and a box factor.

    ``extreme`` has the least and the greatest slope of a line through every error box; boxes are enlarged by the box factor until
    there is one. ``one-sigma`` is (intercept + u, slope - u) and (intercept - u, slope + u). ``covariance`` is slope ± u about the
    line's centre.

    Parameters
    ----------
    line
        The line.
    x, y, half_x, half_y
        The points and the half sides of their boxes, of shape (point,).
    """
    u_intercept, u_slope = line.uncertainties
    centre = -line.covariance[0, 1] / line.covariance[1, 1]
    middle = line.intercept + line.slope * centre
    sign = np.array([-1.0, 1.0])
    extreme, factor = extreme_lines(x, y, half_x, half_y)
    one_sigma = np.column_stack([line.intercept - sign * u_intercept, line.slope + sign * u_slope])
    slopes = line.slope + sign * u_slope
    asymptotes = np.column_stack([middle - slopes * centre, slopes])
    return np.stack([extreme, one_sigma, asymptotes]), factor


def extreme_lines(x: Floats, y: Floats, half_x: Floats, half_y: Floats) -> tuple[Floats, float]:
    """The lines of the least and of the greatest slope through all boxes.

    Parameters
    ----------
    x, y
        The boxes' middles, of shape (point,).
    half_x, half_y
        Their half widths, of shape (point,).

    Returns
    -------
    lines
        (intercept, slope) of both, of shape (2, 2).
    factor
        By which the boxes were enlarged so that there is a line; both are nan where none goes through the largest.
    """
    direction = np.sign(np.polyfit(x, y, 1)[0]) or 1.0
    for factor in _FACTORS:
        # |y - a - b x| <= half_y + |b| half_x, with the sign of b as the points have it
        wide, high = factor * np.asarray(half_x), factor * np.asarray(half_y)
        ones = np.ones_like(x)
        above = np.column_stack([ones, x - direction * wide])
        below = np.column_stack([-ones, -x - direction * wide])
        matrix, bound = np.vstack([above, below]), np.concatenate([y + high, high - y])
        ends = [
            linprog([0, way], matrix, bound, bounds=[(None, None)] * 2, method="highs") for way in (1, -1)
        ]
        if all(end.success for end in ends):
            return np.array([end.x for end in ends]), factor
    return np.full((2, 2), np.nan), np.nan
