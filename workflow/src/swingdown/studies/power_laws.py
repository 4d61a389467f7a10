"""How a quantity goes with another: power laws with errors in both, and g from periods over lengths."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq, least_squares
from scipy.special import chdtrc, stdtrit

from ..arrays import Floats, finite_or_none
from ..errors import InputError
from ..measurement.straight_line import FEWEST, Line, fit_line
from ..rounding import plus_minus, value_with_uncertainty

BEYOND = 0.05  # probability of chi2 below which the stated errors do not explain the scatter
_TWO = 0.9545  # what a normal distribution holds inside two standard deviations


@dataclass(frozen=True)
class Scatter:
    """How points scatter about a law: chi² by the stated errors, and its degrees of freedom (``dof``)."""

    chi2: float
    dof: int

    @property
    def birge(self) -> float:
        """The scatter over the stated errors: the root of chi2 over its degrees of freedom. NaN without any."""
        return float(np.sqrt(self.chi2 / self.dof)) if self.dof else float("nan")

    @property
    def p(self) -> float:
        """The probability of so much scatter by the stated errors alone."""
        return float(chdtrc(self.dof, self.chi2)) if self.dof else float("nan")

    @property
    def refuted(self) -> bool:
        """True where the stated errors do not explain the scatter."""
        return self.p < BEYOND

    @property
    def widening(self) -> float:
        """What standard uncertainties are multiplied by: the Birge ratio above 1; and Student's factor where the scatter alone tells them."""
        if not (self.dof and self.birge > 1):
            return 1.0
        return self.birge * (_student(self.dof) if self.refuted else 1.0)

    @property
    def sentence(self) -> str:
        """A sentence, if the points scatter by more than the stated errors; else an empty text."""
        if not self.widening > 1:
            return ""
        return f"the points scatter {float(f'{self.birge:.2g}'):g} times as far as their errors say, and the uncertainty is widened to that"


def _student(dof: int) -> float:
    """Student's factor, by which two standard uncertainties that a scatter of so few degrees of freedom tells hold 95 %."""
    return float(stdtrit(dof, (1 + _TWO) / 2) / 2)


def settled(
    x: Floats, y: Floats, u_x: Floats, u_y: Floats, share: Floats
) -> tuple[Line, Floats, Scatter, float]:
    """York's line through points, the covariance of (intercept, slope), the ``Scatter``, and a further error of y.

    Where points scatter farther than they state, each y gets a further error in proportion to ``share`` so that chi² is its
    expectation (Paule and Mandel 1982): what differs between recordings, the best known has as well as the others. The points
    do not tell whether their errors are all too small alike instead (Birge): the covariance is the larger one. All arguments are of shape
    (point,): points and their standard errors, and of each y the unit of the further error.
    """
    line = fit_line(x, y, u_x, u_y)
    scatter = Scatter(line.chi2, line.dof)
    if not scatter.widening > 1:
        return line, line.covariance, scatter, 0.0

    def more(extra: float) -> Line:
        return fit_line(x, y, u_x, np.hypot(u_y, extra * share))

    top = float(np.max(np.abs(line.residuals) / share))
    extra = _further(lambda at: more(at).chi2, scatter.dof, top, 1e-6)
    alike, line = line.covariance * scatter.widening**2, more(extra)
    covariance = line.covariance * _student(scatter.dof) ** 2
    larger = max(1.0, *(np.diag(alike) / np.diag(covariance)))
    return line, covariance * larger, scatter, extra


def _further(chi2: Callable[[float], float], dof: int, begin: float, share: float) -> float:
    """The further error with which chi² is its expectation, to this share of it; sought up to ``begin``, or as much farther as it takes."""
    while chi2(begin) > dof:
        begin *= 2
    return float(brentq(lambda extra: chi2(extra) - dof, 0.0, begin, rtol=share))


@dataclass(frozen=True)
class PowerLaw:
    """A power law, y = offset + factor (x / at)^exponent, with standard uncertainties.

    Attributes
    ----------
    exponent, factor, offset
        The law, each with its uncertainty (``u_…``), widened where the points scatter. ``offset`` is 0 and ``u_offset`` NaN where
        it is not fitted.
    at
        The x at which ``factor`` holds.
    scatter
        The ``Scatter`` of the points.
    residuals
        y less the law, of shape (point,).
    theory
        The exponent of theory; NaN for none.
    theory_factor, theory_offset
        The law with that exponent through the same points.
    """

    exponent: float
    u_exponent: float
    factor: float
    u_factor: float
    at: float
    offset: float
    u_offset: float
    scatter: Scatter
    residuals: Floats = field(repr=False)
    theory: float = float("nan")
    theory_factor: float = float("nan")
    theory_offset: float = 0.0

    def __call__(self, x: ArrayLike) -> Floats:
        return self.offset + self.factor * (np.asarray(x, float) / self.at) ** self.exponent

    def by_theory(self, x: ArrayLike) -> Floats:
        """The law with theory's exponent, of the shape of ``x``.

        Parameters
        ----------
        x
            In the unit of the points.
        """
        return self.theory_offset + self.theory_factor * (np.asarray(x, float) / self.at) ** self.theory

    @property
    def away(self) -> float:
        """The distance of the exponent from theory's, in standard uncertainties."""
        return abs(self.exponent - self.theory) / self.u_exponent

    def to_dict(self) -> dict[str, Any]:
        """A dict of plain numbers; None for what is not known."""
        names = ("exponent", "u_exponent", "factor", "u_factor", "at", "offset", "u_offset", "theory")
        found = {name: getattr(self, name) for name in names}
        found |= {"chi2": self.scatter.chi2, "dof": self.scatter.dof, "p": self.scatter.p, "birge_ratio": self.scatter.birge, "widened_by": self.scatter.widening}  # fmt: skip
        return {key: finite_or_none(one) if isinstance(one, float) else one for key, one in found.items()}


def power_law(
    x: ArrayLike, y: ArrayLike, u_x: ArrayLike, u_y: ArrayLike, theory: float = np.nan, offset: bool = False
) -> PowerLaw:
    """The ``PowerLaw`` through points with independent errors in both coordinates (York et al. 2004, on logarithms).

    Parameters
    ----------
    x, y
        The points, of shape (point,), in any units.
    u_x, u_y
        Standard errors, scalars or one a point; 0 is allowed in one coordinate.
    theory
        The exponent of theory, for comparison.
    offset
        Whether to fit an offset where no point is at x = 0; that takes four points. Points at x = 0 always give one.

    Raises
    ------
    InputError
        For fewer than three different x above 0, values below 0, and points without any error.
    """
    x, y = (np.asarray(one, dtype=float) for one in (x, y))
    u_x, u_y = (np.broadcast_to(np.asarray(one, dtype=float), x.shape) for one in (u_x, u_y))
    rest = x > 0
    if np.any(x < 0) or np.any(y[rest] <= 0) or np.unique(x[rest]).size < FEWEST:
        raise InputError(
            "series", f"{np.unique(x[rest]).size} different values above 0, of {x.size} points",
            f"at least {FEWEST} values above 0, and quantities above 0", "add recordings at other values",
        )  # fmt: skip
    base = y[~rest].mean() if rest.sum() < x.size else 0.0
    if base and np.all(y[rest] > base):
        return _with_offset(x, y, u_x, u_y, theory, float(base))
    if offset and np.unique(x).size > FEWEST:
        return _with_offset(x, y, u_x, u_y, theory, 0.5 * float(y[np.argmin(x)]))
    at = float(np.exp(np.mean(np.log(x[rest]))))
    logs = np.log(x[rest] / at), np.log(y[rest]), u_x[rest] / x[rest], u_y[rest] / y[rest]
    line, covariance, scatter, extra = settled(*logs, np.ones(logs[0].size))
    u_factor, u_exponent = np.sqrt(np.diag(covariance))
    factor = float(np.exp(line.intercept))
    law = PowerLaw(line.slope, float(u_exponent), factor, float(factor * u_factor), at, 0.0, float("nan"), scatter, np.empty(0), theory)  # fmt: skip
    if np.isfinite(theory):
        weight = 1 / (logs[3] ** 2 + extra**2 + (theory * logs[2]) ** 2 + np.finfo(float).tiny)
        held = np.exp(np.average(logs[1] - theory * logs[0], weights=weight))
        law = replace(law, theory_factor=float(held))
    return replace(law, residuals=y - law(x))


def _with_offset(x: Floats, y: Floats, u_x: Floats, u_y: Floats, theory: float, base: float) -> PowerLaw:
    """The ``PowerLaw`` with an offset: the points are moved along both errors until they lie on it."""
    if np.any(u_y <= 0):
        raise InputError("series", "a point has no uncertainty", "one of every quantity", "state it")
    at = float(np.exp(np.mean(np.log(x[x > 0]))))
    moves = np.flatnonzero((u_x > 0) & (x > 0))

    def left(values: Floats, exponent: float | None = None) -> Floats:
        power, own = (values[2], values[3:]) if exponent is None else (exponent, values[2:])
        placed = x.copy()
        placed[moves] = x[moves] + own * u_x[moves]
        away = y - values[0] - values[1] * (np.maximum(placed, 0) / at) ** power
        return np.concatenate([away / u_y, own])

    order = np.argsort(x)
    near = float(np.interp(at, x[order], y[order])) - base
    start = np.concatenate([[base, near, theory if np.isfinite(theory) else 1.0], np.zeros(moves.size)])
    scale = np.concatenate([[base, near, 1.0], np.ones(moves.size)])
    fit = least_squares(left, start, x_scale=scale, xtol=1e-12, ftol=1e-12)
    scatter = Scatter(float(2 * fit.cost), x.size - 3)
    u = np.sqrt(np.diag(np.linalg.inv(fit.jac.T @ fit.jac)))[:3] * scatter.widening
    offset, factor, exponent = map(float, fit.x[:3])
    law = PowerLaw(exponent, float(u[2]), factor, float(u[1]), at, offset, float(u[0]), scatter, np.empty(0), theory)  # fmt: skip
    if np.isfinite(theory):
        begin, sizes = np.delete(fit.x, 2), np.delete(scale, 2)
        held = least_squares(left, begin, x_scale=sizes, args=(theory,))
        law = replace(law, theory_offset=float(held.x[0]), theory_factor=float(held.x[1]))
    return replace(law, residuals=y - law(x))


class ShiftedLaw(NamedTuple):
    """A power law of values that may all be off by one amount, y = factor ((x + short) / at)^exponent, as the points say it.

    ``u_exponent`` is the standard uncertainty, widened where the points scatter. NaN for fewer than four points.
    """

    exponent: float = float("nan")
    u_exponent: float = float("nan")
    factor: float = float("nan")
    at: float = float("nan")
    short: float = float("nan")

    def __call__(self, x: ArrayLike) -> Floats:
        return self.factor * (np.maximum(np.asarray(x, float) + self.short, 0.0) / self.at) ** self.exponent


@dataclass(frozen=True)
class LengthsAndPeriods:
    """g from lengths and periods.

    Attributes
    ----------
    g, u_g
        In m/s², with its standard uncertainty.
    short, u_short
        By how much all lengths are too short, in m.
    points
        The lengths and periods with their standard uncertainties.
    line
        The line of T² over the length.
    scatter
        The ``Scatter`` of the points.
    """

    g: float
    u_g: float
    short: float
    u_short: float
    points: tuple[Floats, Floats, Floats, Floats] = field(repr=False)
    line: Line = field(repr=False)
    scatter: Scatter = field(repr=False)

    @cached_property
    def shifted(self) -> ShiftedLaw:
        """The power law by which T goes with lengths that are all off by one amount, whatever that is."""
        return _shifted(*self.points, self.short)

    def by_theory(self, x: ArrayLike) -> Floats:
        """The periods at this g, in s, of lengths with what they are short of.

        Parameters
        ----------
        x
            The lengths, in m.
        """
        return np.sqrt(np.maximum(self.line.intercept + self.line.slope * np.asarray(x, float), 0.0))

    @property
    def off(self) -> bool:
        """Whether all lengths are too short, or too long, by more than two standard uncertainties."""
        return abs(self.short) > 2 * self.u_short

    @property
    def sentence(self) -> str:
        """A sentence with g, and with a common error of the lengths where it exceeds two standard uncertainties."""
        told = f"g = {plus_minus(self.g, self.u_g)} m/s² by the slope of T² over the length"
        if self.off:
            size = f"{value_with_uncertainty(1e3 * abs(self.short), 1e3 * self.u_short)} mm"
            short, long = (
                f"the lengths are too short by {size}, all alike",
                f"the lengths are too long by {size}, all alike",
            )
            told += f"; {short if self.short > 0 else long}"
        return told

    def to_dict(self) -> dict[str, Any]:
        """A dict of plain numbers."""
        return {"g_m_per_s2": self.g, "u_g_m_per_s2": self.u_g, "lengths_too_short_by_m": self.short, "u_lengths_too_short_by_m": self.u_short, "exponent_of_lengths_so_off": finite_or_none(self.shifted.exponent), "u_exponent_of_lengths_so_off": finite_or_none(self.shifted.u_exponent), "birge_ratio": self.scatter.birge}  # fmt: skip


def gravity_of_lengths(
    lengths: ArrayLike, periods: ArrayLike, u_lengths: ArrayLike, u_periods: ArrayLike
) -> LengthsAndPeriods:
    """The ``LengthsAndPeriods`` of bobs on strings: g is the slope of T² over the length.

    The line need not go through 0: an error that all lengths share leaves the slope as it is.

    Parameters
    ----------
    lengths, u_lengths
        In m, with standard uncertainties, of shape (point,).
    periods, u_periods
        Of small swings, in s, with standard uncertainties, of shape (point,).

    Raises
    ------
    InputError
        For fewer than three points.
    """
    lengths, periods = np.asarray(lengths, dtype=float), np.asarray(periods, dtype=float)
    u_x = np.broadcast_to(np.asarray(u_lengths, dtype=float), lengths.shape)
    u_y = np.asarray(u_periods, dtype=float)
    line, covariance, scatter, _ = settled(lengths, periods**2, u_x, 2 * periods * u_y, periods**2)
    slope, short = line.slope, line.intercept / line.slope
    slopes = np.array([1 / slope, -short / slope])
    g = 4 * np.pi**2 / slope
    u_g, u_short = g / slope * np.sqrt(covariance[1, 1]), np.sqrt(slopes @ covariance @ slopes)
    points = lengths, periods, u_x, u_y
    return LengthsAndPeriods(g, float(u_g), short, float(u_short), points, line, scatter)


def _shifted(x: Floats, y: Floats, u_x: Floats, u_y: Floats, short: float) -> ShiftedLaw:
    """The ``ShiftedLaw`` through points, all its values free; NaN for fewer than four.

    Points that scatter farther than they state get a further error, as in ``settled``.
    """
    dof = x.size - 3
    if dof < 1:
        return ShiftedLaw()
    at, log_y = float(np.mean(x)), np.log(y)
    least = np.array([-np.inf, -np.inf, 1e-3 * x.min() - x.min()])
    start = np.array([float(np.mean(log_y)), 0.5, max(short, least[2] / 2)])

    def fit(extra: float) -> Any:
        def left(values: Floats) -> Floats:
            longer = x + values[2]
            error = np.sqrt((u_y / y) ** 2 + (values[1] * u_x / longer) ** 2 + extra**2)
            return (log_y - values[0] - values[1] * np.log(longer / at)) / error

        return least_squares(left, start, x_scale=[1.0, 0.1, at / 10], bounds=(least, np.inf))

    def uncertainty(found: Any) -> float:
        return float(np.sqrt(np.linalg.pinv(found.jac.T @ found.jac)[1, 1]))

    def law(found: Any, u: float) -> ShiftedLaw:
        log_factor, exponent, off = map(float, found.x)
        return ShiftedLaw(exponent, u, float(np.exp(log_factor)), at, off)

    found = fit(0.0)
    scatter = Scatter(float(2 * found.cost), dof)
    alike = uncertainty(found) * scatter.widening
    if not scatter.widening > 1:
        return law(found, alike)
    found = fit(_further(lambda extra: 2 * fit(extra).cost, dof, float(np.std(log_y)), 1e-4))
    return law(found, max(uncertainty(found) * _student(dof), alike))
