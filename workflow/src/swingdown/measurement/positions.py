"""Positions of a bob, as a video or a ranger gives them, to the angle: about a fitted pivot, or by a length."""

from collections.abc import Sequence
from contextlib import suppress
from operator import itemgetter
from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from ..arrays import Bools, Floats
from ..errors import InputError
from ..pendulum.half_swings import half_swings, passages
from .plausibility import ENOUGH, in_a_row
from .stated import UNITS, read

LEAST_ARC = 0.1  # rad; a shorter arc does not tell the radius
MOST = 2.0  # times as far along an axis as beside it (standard deviations): they move along it
LINE = 0.1  # beside over along, of what lies on a line
TIGHT = 0.02  # residual over radius of what is tracked in a video
FAR = 6.0  # times the scatter of the others: a point that is none of the bob
NEAR = 2.0  # times the usual distance from the middle: of a swing that does not die none is further than 1.4 times
_PASSES = 10
SMALL = 0.1  # rad; below, the sine of an angle is the angle to a part in 600
GRAVITY = 9.81  # m/s^2; it varies by half a per cent over the Earth, and a length by it is an estimate
METRES = {name: factor for name, (dimension, factor) in UNITS.items() if dimension == "m"}
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
    """The ``Circle`` with the least squared distances from the points, in their unit.

    It starts from Taubin's algebraic fit (IEEE Trans. PAMI 13, 1115 (1991); Chernov, *Circular and Linear Regression*, 2010).
    Points far beside it do not count (``lost``). The uncertainties hold the scatter, not errors that neighbours share.

    Parameters
    ----------
    x, y
        Of shape (n,), in one unit.
    place
        What errors call them.

    Raises
    ------
    InputError
        For points on a straight line, on too short an arc, or on no circle.
    """
    usual, circle, kept = _settled(x, y, np.ones(x.size, dtype=bool), place)
    size = np.hypot(x - np.median(x), y - np.median(y))
    near = size <= NEAR * float(np.median(size))
    if not near.all():  # a few far off can draw a circle to themselves
        with suppress(InputError):
            usual, circle, kept = min((usual, circle, kept), _settled(x, y, near, place), key=itemgetter(0))
    arc = float(np.ptp(np.unwrap(np.arctan2(y[kept] - circle.y, x[kept] - circle.x))))
    if not circle.residual < LOOSEST * circle.radius:
        raise InputError(
            place,
            f"the positions lie on no circle: {circle.residual / circle.radius:.2g} of its radius away (RMS)",
            "one bob that swings about a pivot which stands still, with the camera still",
            "leave out with ⟨start_s⟩ and ⟨stop_s⟩ where something else was followed, track it anew, or export the angle",
        )
    if arc < LEAST_ARC:
        raise InputError(
            place,
            f"the positions show no pivot: they lie on an arc of {arc:.3g} rad",
            f"an arc of {LEAST_ARC:g} rad or more",
            "record a larger swing, export the angle, or name the horizontal coordinate ⟨in signal_column⟩ and state the "
            "length of the pendulum ⟨in length⟩",
        )
    return circle


def _settled(x: Floats, y: Floats, kept: Bools, place: str) -> tuple[float, Circle, Bools]:
    """The usual distance of all points from the circle through those that are ``kept`` at first, that circle, and which ones it then keeps."""
    for _ in range(_PASSES):
        circle = _circle(x[kept], y[kept], place)
        away = np.abs(np.hypot(x - circle.x, y - circle.y) - circle.radius)
        # by the usual distance: those of lost points would widen their own limit
        usual = max(1.4826 * float(np.median(away)), 1e-9 * circle.radius)
        again = away <= FAR * usual
        if (again == kept).all():
            break
        kept = again
    return usual, circle, kept


def _scatter(positions: Sequence[Floats]) -> tuple[Floats, Bools, Floats, Floats]:
    """Positions about their medians (axis, point), which of them are not far off, and the variances of these along their own axes, rising,
    with the axes."""
    about = np.stack([one - np.median(one) for one in positions])
    size = np.sqrt((about**2).sum(axis=0))
    kept = size <= FAR * max(float(np.median(size)), 1e-300)
    return about, kept, *np.linalg.eigh(np.cov(about[:, kept]))


def along_a_line(x: Floats, y: Floats) -> Floats | None:
    """How far along the line through them the points lie, where that is all that they tell: an arc too short for a pivot; else None."""
    both, kept, values, axes = _scatter([x, y])
    if not values[1] > 0 or values[0] > LINE**2 * values[1]:
        return None
    along, beside = axes[:, 1] @ both, axes[:, 0] @ both
    # the sagitta of an arc of LEAST_ARC to both sides is an eighth of it beside the line
    bend = np.polynomial.polynomial.polyfit(along[kept], beside[kept], 2)[2]
    if abs(bend) * 2 * float(np.ptp(along[kept])) > LEAST_ARC:
        return None
    return along


def in_their_plane(positions: Sequence[Floats]) -> tuple[Floats, Floats]:
    """How far positions of three coordinates lie along the two axes on which they move most."""
    all_, _, _, axes = _scatter(positions)
    return axes[:, 2] @ all_, axes[:, 1] @ all_


def along_most(times: Floats, x: Floats, y: Floats) -> Floats | None:
    """How far points lie along the axis on which they move most; None where no axis stands out and none swings in step.

    Of positions on no circle, as of a marker on a platform that turns about no fixed point, or before a camera that drifts, it is one
    coordinate. Where no axis stands out, it is that of x, y and the axes of their scatter which swings widest of those in step.
    """
    both, _, values, axes = _scatter([x, y])
    if values[1] > MOST**2 * values[0]:
        return np.asarray(axes[:, 1] @ both)
    swinging = [one for one in (*both, *(axes.T @ both)) if in_a_row(times, one) >= ENOUGH]
    return max(swinging, key=_usual_swing, default=None)


def _usual_swing(signal: Floats) -> float:
    return float(np.median(np.abs(np.diff(half_swings(signal).turns))))


def lost(x: Floats, y: Floats, circle: Circle) -> Bools:
    """Which points lie so far beside a circle, by the scatter of the others, that they are none of the bob."""
    away = np.abs(np.hypot(x - circle.x, y - circle.y) - circle.radius)
    return away > FAR * max(circle.residual, 1e-9 * circle.radius)


def _circle(x: Floats, y: Floats, place: str) -> Circle:
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
    residual = float(np.sqrt(2 * fit.cost / max(len(u) - 3, 1))) if fit.success else np.inf
    slopes = _slopes(u - a, v - b)
    spread = residual * np.sqrt(np.diag(np.linalg.pinv(slopes.T @ slopes)))
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
            f"its columns lie on a circle, {circle.residual / circle.radius:.1g} of its radius from it, as positions x and y of a bob do; "
            "the file does not say what they hold",
            "names of the columns",
            "write a first line with names above the numbers, such as `t x y`, or name the column of the angle "
            "⟨in signal_column⟩",
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
        problem = "the positions lie on a straight line"
        raise InputError(place, problem, "an arc about a pivot", "export both coordinates")
    a, b = -second / (2 * first), -third / (2 * first)
    return float(a), float(b), float(np.sqrt(second**2 + third**2 + 4 * first**2 * mean) / (2 * abs(first)))


def to_angles(x: Floats, y: Floats, circle: Circle) -> Floats:
    """The angle (rad) of each point about the pivot, 0 straight below it and rising towards larger x.

    Below is the side of the pivot on which the bob swings: its middle. So y may count up or, as in pictures, down.
    """
    down = 1.0 if np.median(y) > circle.y else -1.0
    return np.unwrap(np.arctan2(x - circle.x, down * (y - circle.y)))


def metres(length: str, unit: str, place: str, quiet: bool = False) -> float:
    """A length written as ``0.58``, ``58 cm`` or ``350 px`` in ``unit``; without a unit of its own it is in m, or in ``unit`` where that is
    no length known here. Its uncertainty (``0.583±0.001``) is left out. 0.0, or InputError unless ``quiet``, where the two do not go together.
    """
    found = read(length)
    number, own, wanted = (found.value, found.unit, unit.lower()) if found else (np.nan, "", unit.lower())
    # a length in px says that a coordinate without a unit is in px, and the other way round
    one_unit = own.lower() == wanted or not {own.lower(), wanted} & METRES.keys() and not (own and wanted)
    factor = 1.0 if one_unit else METRES.get(own.lower() or "m", 0.0) / METRES.get(wanted, np.inf)
    if np.isfinite(number) and number > 0 and factor:
        return number * factor
    if quiet:
        return 0.0
    raise InputError(
        f"{place}, column length",
        f"{length!r} is no length in the coordinate's unit, {unit or 'which nobody states'}",
        "a length in m, or with a unit, as 58 cm"
        + (f" or 350 {unit}" if unit and wanted not in METRES else "")
        + ("" if unit else "; and the unit of the coordinate"),
        "correct ⟨length⟩"
        if unit
        else "write the coordinate's unit into its name, as `x (cm)`, or ⟨length⟩ in it, without a unit",
    )


def by_length(x: Floats, length: float, place: str) -> Floats:
    """The angle (rad) of a bob ``length`` below its pivot from one horizontal coordinate, both in one unit: the arcsine about the middle."""
    away = x - _middle(x)
    if (reach := float(np.abs(away).max())) > length:
        problem = f"it swings by {reach:.4g} to a side, which a pendulum of length {length:.4g} cannot do"
        expected = "a length from the pivot to the middle of the bob, in the coordinate's unit"
        raise InputError(place, problem, expected, "correct ⟨length⟩")
    return np.arcsin(away / length)


def without_length(times: Floats, x: Floats, in_metres: float, place: str) -> tuple[Floats, list[str]] | None:
    """The angle (rad) of a small swing from one coordinate, ``in_metres`` each unit, and a remark: over the length that a bob on a string
    has with its period. None where the swing is not small: then sine and angle differ, and it may as well hang on a spring.
    """
    period = half_swings(x).period(times)
    if not np.isfinite(period):
        problem = "its swing is too short to give a period"
        raise InputError(place, problem, "three half-swings or more", "record longer")
    length = on_a_string(times, x) / in_metres
    away = x - _middle(x)
    if float(np.percentile(np.abs(away), 99.5)) / length > SMALL:
        return None
    remark = f"one coordinate and no length: the angle is its share of {length * in_metres:.3g} m, the length of a bob on a string of this period"
    return away / length, [remark]


def on_a_string(times: Floats, x: Floats) -> float:
    """The length (m) that a bob on a string has whose swings take as long as those of ``x``."""
    passed = passages(times, x, _middle(x))  # told between samples, of which a film has few
    period = float(np.median(passed[2:] - passed[:-2])) if len(passed) > 2 else half_swings(x).period(times)
    return GRAVITY * (period / (2 * np.pi)) ** 2


def _middle(x: Floats) -> float:
    centre = half_swings(x).centre()
    return centre if np.isfinite(centre) else float(np.median(x))
