"""Positions of a bob, as a video gives them, to the angle about a fitted pivot."""

from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from ..arrays import Floats
from ..errors import InputError

LEAST_ARC = 0.1  # rad; a shorter arc does not tell the radius
TIGHT = 0.02  # residual over radius of what is tracked in a video
LOOSEST = 0.1  # residual over radius, beyond which the points lie on no circle


class Circle(NamedTuple):
    """A pivot and radius in the positions' unit, their standard uncertainties, and the RMS distance from the circle."""

    x: float
    y: float
    radius: float
    u_x: float
    u_y: float
    u_radius: float
    residual: float


def fit_circle(x: Floats, y: Floats, place: str = "positions") -> Circle:
    """The circle with the least squared distances from the points; x, y and the result in one unit.

    It starts from Taubin's algebraic fit (IEEE Trans. PAMI 13, 1115 (1991)) in the form of Chernov, *Circular
    and Linear Regression* (2010), and minimises the true distances from there. The uncertainties are those of least squares
    with the scatter as seen; errors that neighbouring samples share are not in them. InputError for points that
    lie on a straight line, on too short an arc, or on no circle.
    """
    middle = np.array([x.mean(), y.mean()])
    u, v = x - middle[0], y - middle[1]
    scale = float(np.sqrt(np.mean(u**2 + v**2)))
    if not scale > 0:
        raise InputError(place, "the position never changes", "a swing", "check which columns are x and y")
    u, v = u / scale, v / scale
    a, b, radius = _taubin(u, v, place)
    fit = least_squares(
        lambda p: np.hypot(u - p[0], v - p[1]) - p[2],
        (a, b, radius),
        jac=lambda p: _slopes(u - p[0], v - p[1]),
        x_scale=(1, 1, 1),
    )
    a, b, radius = map(float, fit.x)
    residual = float(np.sqrt(2 * fit.cost / max(len(u) - 3, 1)))
    angles = np.unwrap(np.arctan2(v - b, u - a))
    arc = float(np.ptp(angles))
    if arc < LEAST_ARC or not residual < LOOSEST * radius or not fit.success:
        raise InputError(
            place,
            f"the positions tell no pivot: an arc of {arc:.3g} rad, {residual / radius:.2g} of the radius away from a circle",
            f"points on an arc of {LEAST_ARC:g} rad or more about a pivot that stands still",
            "record a larger swing with the camera still, or export the angle",
        )
    slopes = _slopes(u - a, v - b)
    spread = residual * np.sqrt(np.diag(np.linalg.inv(slopes.T @ slopes)))
    values = np.array([a, b, radius, *spread, residual]) * scale
    values[:2] += middle
    return Circle(*map(float, values))


def check_no_positions(x: Floats, y: Floats, place: str) -> None:
    """None for two columns without names unless they are as positions of a bob are: on a circle about a pivot. InputError then."""
    try:
        circle = fit_circle(x, y)
    except InputError:
        return
    if circle.residual < TIGHT * circle.radius and np.ptp(to_angles(x, y, circle)) < 2 * np.pi:
        raise InputError(
            place,
            f"they lie on a circle, {circle.residual / circle.radius:.1g} of its radius from it, as positions x and y of a bob do; "
            "the file does not say what they hold",
            "names of the columns",
            "write a first line with names above the numbers, such as `t x y`, or name the column of the angle in the cell "
            "signal_column of the sheet",
        )


def _slopes(u: Floats, v: Floats) -> Floats:
    distance = np.hypot(u, v)
    return np.column_stack([-u / distance, -v / distance, -np.ones_like(u)])


def _taubin(u: Floats, v: Floats, place: str) -> tuple[float, float, float]:
    """Centre and radius of centred points, from the singular vector that Taubin's constraint leaves."""
    square = u**2 + v**2
    mean = float(square.mean())
    design = np.column_stack([(square - mean) / (2 * np.sqrt(mean)), u, v])
    first, second, third = np.linalg.svd(design, full_matrices=False)[2][-1]
    first = first / (2 * np.sqrt(mean))
    if abs(first) < 1e-9:
        raise InputError(
            place, "the positions lie on a straight line", "an arc about a pivot", "export both coordinates"
        )
    a, b = -second / (2 * first), -third / (2 * first)
    return float(a), float(b), float(np.sqrt(second**2 + third**2 + 4 * first**2 * mean) / (2 * abs(first)))


def to_angles(x: Floats, y: Floats, circle: Circle) -> Floats:
    """The angle (rad) of each point about the pivot, 0 straight below it and rising towards larger x.

    Below is the side of the pivot on which the bob swings: its middle. So y may count up or, as in pictures, down.
    """
    down = 1.0 if np.median(y) > circle.y else -1.0
    return np.unwrap(np.arctan2(x - circle.x, down * (y - circle.y)))
