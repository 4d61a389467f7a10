"""A measured drive: what somebody or something did to the pendulum, as a curve through its samples, and the ways in which it acts."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..arrays import Floats
from ..errors import InputError

KINDS = {"torque": "rad/s^2", "pivot_acceleration": "g", "pivot_position": "m", "pivot_angle": "rad"}
"""What was measured, and its unit: a torque over the inertia (in any other unit with a gain to be fitted), the horizontal acceleration of the
pivot in units of gravity, its horizontal position, or of a wheel the angle of the spring's other end."""
FREE = ("gain", "delay")
"""What the sensor of a drive may have wrong, and a fit may find."""
BETWEEN = ("curve", "line", "hold")
"""What a drive does between two samples: it follows the cubic spline through all of them, a straight line, or it keeps the last one."""


@dataclass(frozen=True, eq=False)
class Drive:
    """A drive u(t) with its ``kind``, a key of ``KINDS``: from knot to knot (n + 1, in s of the recording's clock) a cubic.

    ``coefficients`` (n, 4) are those of the powers of the time since a piece's first knot, the lowest first. Before the first sample
    and after the last one a curve goes on straight, and all else stays as it was. ``free`` names what a fit is to find of its sensor: ``gain``, ``delay``.
    """

    kind: str
    knots: Floats = field(repr=False)
    coefficients: Floats = field(repr=False)
    between: str = "curve"
    free: tuple[str, ...] = ()

    @property
    def effect(self) -> str:
        """The name of the catalogue's effect by which it acts."""
        return effect_name(self.kind, self.free)

    def at(self, times: Any) -> Floats:
        """The drive, in the unit of its kind.

        Parameters
        ----------
        times
            In s, of any shape, which the result has too.
        """
        return self.derivatives(times)[0]

    def derivatives(self, times: Any) -> tuple[Floats, Floats, Floats]:
        """The drive, and its first and second derivative by time.

        Parameters
        ----------
        times
            In s, of any shape.

        Returns
        -------
        tuple of numpy.ndarray
            Each of the times' shape, in the unit of the kind, by s and by s².
        """
        times = np.asarray(times, dtype=float)
        piece = np.clip(np.searchsorted(self.knots, times, side="right") - 1, 0, len(self.coefficients) - 1)
        (a, b, c, d), x = self.coefficients[piece].T, times - self.knots[piece]
        return a + x * (b + x * (c + x * d)), b + x * (2 * c + x * 3 * d), 2 * c + x * 6 * d


def effect_name(kind: str, free: tuple[str, ...]) -> str:
    """The name of the effect of a drive of that kind, of whose sensor so much is to be found."""
    return "_".join([f"{kind}_input", *(name for name in FREE if name in free)])


def drive(times: Any, values: Any, kind: str, between: str = "curve", free: Any = None) -> Drive:
    """The ``Drive`` through samples of what was measured.

    Parameters
    ----------
    times
        In s, increasing, of shape (sample,).
    values
        In the unit of ``KINDS``, of shape (sample,).
    kind
        ``torque``, ``pivot_acceleration``, ``pivot_position`` or ``pivot_angle``.
    between
        What it does between samples: ``curve``, ``line`` or ``hold``.
    free
        What of its sensor a fit is to find, of ``FREE``. Default: the gain of a torque, of others nothing.

    Raises
    ------
    InputError
        If the kind is unknown, times do not increase, or a value is not finite; it names the first such place.
    """
    times, values = np.ascontiguousarray(times, dtype=float), np.ascontiguousarray(values, dtype=float)
    for key, given, known in (("input_kind", kind, tuple(KINDS)), ("input_between", between, BETWEEN)):
        if given not in known:
            raise InputError(f"input, {key}", f"unknown {key} {given!r}", " or ".join(known))
    left = ("gain",) if free is None and kind == "torque" else tuple(free or ())
    if unknown := [name for name in left if name not in FREE]:
        raise InputError("input, input_free", f"unknown {unknown[0]!r}", " or ".join(FREE))
    if between == "hold" and "delay" in left:
        raise InputError(
            "input, input_free", "a drive that jumps from sample to sample has no rate, and so no delay that a fit could find",
            "input_between: curve or line", "leave `delay` out, or say what the drive does between its samples",
        )  # fmt: skip
    if times.shape != values.shape or times.ndim != 1 or times.size < 4:
        problem = f"{values.size} values for {times.size} times"
        raise InputError("input", problem, "one for each time, four at least")
    if not np.all(np.diff(times) > 0):
        raise InputError("input", "its times do not increase", "times in s, each later than the time before")
    if not np.isfinite(values).all():
        problem = f"no number at {float(times[~np.isfinite(values)][0]):.6g} s"
        mend = "leave that part out (⟨start_s⟩ and ⟨stop_s⟩)"
        raise InputError("input", problem, "numbers throughout", mend)
    first, last = times[0] - (times[1] - times[0]), times[-1] + (times[-1] - times[-2])
    pieces = _pieces(times, values, between)
    rises = 0.0, 0.0  # where it begins and ends
    if between == "curve":
        (_, b, c, d), x = pieces[-1], times[-1] - times[-2]
        rises = pieces[0, 1], float(b + x * (2 * c + x * 3 * d))
    before, after = [values[0] + rises[0] * (first - times[0]), rises[0], 0, 0], [values[-1], rises[1], 0, 0]
    whole = np.concatenate([[before], pieces, [after]])
    return Drive(kind, np.concatenate([[first], times, [last]]), whole, between, left)


def _pieces(times: Floats, values: Floats, between: str) -> Floats:
    """The coefficients (n - 1, 4) of the curve between the samples."""
    found = np.zeros((times.size - 1, 4))
    found[:, 0] = values[:-1]
    if between == "line":
        found[:, 1] = np.diff(values) / np.diff(times)
    elif between == "curve":
        from scipy.interpolate import CubicSpline  # takes long to import

        # natural: with the straight ends its second derivative has no jump, by which a delay would have to be told
        found[:] = CubicSpline(times, values, bc_type="natural").c[::-1].T
    return found
