"""The fit's residual and everything that could move it, to first order: the space in which effects are looked for."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.linalg import block_diag, qr
from scipy.optimize import lsq_linear

from ...arrays import Floats
from ...engine.trajectory import TrajectoryError, sensitivities, simulate
from ...fitting.problem import RELEASE
from ...fitting.result import Fit
from ...pendulum.catalogue import ANGLE, RATE
from ...pendulum.effect import Effect
from ..data.campaign import Swing

_BEYOND = 1e100  # sensitivities that say nothing: of motions that grow without end
_ADDS_NOTHING = 1e-6  # of its size: a column that is so little outside the others' span is left out


@dataclass(frozen=True)
class Frame:
    """A fit seen to first order: each swing's residual (rad), and what the fit can do to it.

    ``residual`` is data minus fit with every swing below the other; ``slopes`` (samples, free) are the fit's own
    sensitivities, of the values ``names`` of the swings ``of`` (-1: of all);
    ``slices`` tell which samples are whose. What is known beforehand of what the measurement leaves open stands below the
    samples, as residuals of its own: a row for each nuisance value.
    """

    fit: Fit
    swings: tuple[Swing, ...]
    residual: Floats
    slopes: Floats
    slices: tuple[slice, ...]
    names: tuple[str, ...]
    of: tuple[int, ...]

    @cached_property
    def basis(self) -> Floats:
        """Orthonormal columns (samples, rank) that span the slopes."""
        return orthonormal(self.slopes)

    @cached_property
    def factors(self) -> tuple[Floats, Floats]:
        """The slopes, each of length one, as orthonormal columns times a triangle: two arrays."""
        size = np.linalg.norm(self.slopes, axis=0)
        factors = np.linalg.qr(self.slopes / np.where(size == 0, 1.0, size))
        return factors.Q, factors.R

    @property
    def samples(self) -> int:
        """The number of samples of all swings."""
        return self.slices[-1].stop

    def apart(self, column: Floats) -> Floats:
        """A column over the samples (sample,) as one for each recording, nothing outside it (sample, recording)."""
        return block_diag(*(column[rows, np.newaxis] for rows in self.slices))

    def padded(self, columns: Floats) -> Floats:
        """Columns over the samples with nothing below them: they do not touch what is known of the measurement."""
        below = self.residual.size - columns.shape[0]
        return np.concatenate([columns, np.zeros((below, *columns.shape[1:]))]) if below else columns

    def outside(self, columns: Floats) -> Floats:
        """The part of the columns (samples, any) that the fit cannot absorb by its own parameters, as long as ``residual``."""
        columns = self.padded(columns)
        return columns - self.basis @ (self.basis.T @ columns)

    def without(self, names: Collection[str]) -> "Frame":
        """What the frame of a fit is to first order without some of its effects, by name; its values keep what they had."""
        model = self.fit.model
        gone = {one.name: one for name in names for one in model.catalogue[name].parameters}
        kept = [k for k, name in enumerate(self.names) if name not in gone]
        residual = self.residual.copy()
        for k, name in enumerate(self.names):
            if name in gone and gone[name].role == "size":
                residual += self.slopes[:, k] * self.fit.models[max(self.of[k], 0)].values[name]
        names, of = [self.names[k] for k in kept], [self.of[k] for k in kept]
        return replace(self, residual=residual, slopes=self.slopes[:, kept], names=tuple(names), of=tuple(of))

    @property
    def room(self) -> tuple[Floats, Floats]:
        """How far each column's value can go down and up from where it is, within the catalogue's bounds: two arrays."""
        definitions = {definition.name: definition for definition in self.fit.model.definitions}
        values = [model.values for model in self.fit.models]
        low, high = np.full(len(self.names), -np.inf), np.full(len(self.names), np.inf)
        for k, (name, swing) in enumerate(zip(self.names, self.of, strict=True)):
            if name in definitions:
                value = values[max(swing, 0)][name]
                low[k], high[k] = definitions[name].lower - value, definitions[name].upper - value
        return np.minimum(low, 0.0), np.maximum(high, 0.0)


@dataclass(frozen=True)
class Step:
    """The linear step that explains most: the sum of squares (rad^2) it takes away beyond the fit, the coefficients of
    the columns that were offered, and the changes of the fit's own values that go with them."""

    squares: float
    coefficients: Floats
    own: Floats


def frame(fit: Fit, swings: Sequence[Swing]) -> Frame:
    """The ``Frame`` of a joint fit to these swings."""
    edges = np.concatenate([[0], np.cumsum([swing.times.size for swing in swings])])
    slices = tuple(slice(int(a), int(b)) for a, b in zip(edges, edges[1:], strict=False))
    residual = np.concatenate(
        [swing.angle - one.angle for swing, one in zip(swings, fit.swings, strict=True)]
    )
    own = tuple(fit.swings[0].own)
    shared = [name for name in fit.model.parameters if name not in own]
    each = [*own, *RELEASE]
    slopes = np.zeros((residual.size, len(shared) + len(each) * len(swings)))
    for k, (swing, one) in enumerate(zip(swings, fit.swings, strict=True)):
        release = one.release_angle, one.release_velocity
        rows = sensitivities(one.model, swing.times, *release, free=[*shared, *each])[1]
        slopes[slices[k], : len(shared)] = rows[: len(shared)].T
        first = len(shared) + k * len(each)
        slopes[slices[k], first : first + len(each)] = rows[len(shared) :].T
    residual, slopes = _with_knowledge(fit, residual, slopes, shared)  # type: ignore[assignment]
    names = (*shared, *(each * len(swings)))
    of = (*(-1 for _ in shared), *(k for k in range(len(swings)) for _ in each))
    return Frame(fit, tuple(swings), residual, slopes, slices, names, of)


def motion(fit: Fit, swings: Sequence[Swing]) -> tuple[Floats, Floats]:
    """Angles (rad) and angular velocities (rad/s) of a fit at all samples, one swing below the other.

    Of a sensor of angles the angles are what it reads, and the velocities their differences; behind a rate stands the motion.
    """
    pairs = list(zip(fit.swings, swings, strict=True))
    if fit.model.reading == ANGLE:
        return fit.angle, np.concatenate([np.gradient(one.angle, swing.times) for one, swing in pairs])
    angles, velocities = (
        [simulate(one.model.motion.of(what), swing.times, one.release_angle, one.release_velocity) for one, swing in pairs]
        for what in (ANGLE, RATE)
    )  # fmt: skip
    return np.concatenate(angles), np.concatenate(velocities)


def _with_knowledge(
    fit: Fit, residual: Floats, slopes: Floats, shared: Sequence[str]
) -> tuple[Floats, Floats]:
    """Residual and slopes with rows for what is known of the model's nuisance values, weighed as its fit weighs it."""
    slack = fit.model.slack
    if not slack.names:
        return residual, slopes
    root = np.linalg.cholesky(slack.precision).T
    rows = np.zeros((len(slack.names), slopes.shape[1]))
    rows[:, [shared.index(name) for name in slack.parameters]] = root
    values = np.array([fit.model.values[name] for name in slack.parameters])
    return np.concatenate([residual, -root @ values]), np.vstack([slopes, rows])


def orthonormal(columns: Floats) -> Floats:
    """An orthonormal basis of the columns' span (samples, rank), those that add nothing left out."""
    size = np.linalg.norm(columns, axis=0)
    kept = columns[:, size > 0] / size[size > 0]
    basis, triangle, _ = qr(kept, mode="economic", pivoting=True, check_finite=False)
    return basis[:, np.abs(np.diag(triangle)) > _ADDS_NOTHING]


def columns_of(
    frame: Frame, effect: Effect, values: Mapping[str, float], free: Sequence[str], rough: bool = False
) -> Floats:
    """What each of the ``free`` parameters of one further effect does to the angles, at the given values of all of them.

    An array (samples, len(free)), or where a parameter is each recording's own, (samples, swings * len(free)) with zeros
    outside the recording; ``rough`` as in ``sensitivities``. TrajectoryError where the engine cannot follow it, or what it follows grows
    without end.
    """
    blocks = []
    for swing, one in zip(frame.swings, frame.fit.swings, strict=True):
        wider = one.model  # of a free form that the model already has
        if effect.name not in wider.names:
            wider = wider.with_effects((*wider.names, effect.name), {**wider.values, **values})
        release = one.release_angle, one.release_velocity
        blocks.append(sensitivities(wider, swing.times, *release, free=free, rough=rough)[1].T)
        if not np.max(np.abs(blocks[-1])) < _BEYOND:
            raise TrajectoryError(f"{effect.name}: what it does grows without end")
    if not effect.each:
        return np.concatenate(blocks)
    wide = np.zeros((frame.samples, len(blocks) * len(free)))
    for k, block in enumerate(blocks):
        wide[frame.slices[k], k * len(free) : (k + 1) * len(free)] = block
    return wide


def explained(frame: Frame, columns: Floats) -> tuple[float, int]:
    """The sum of squares (rad^2) of the residual that the columns explain beyond the fit, and how many of them count."""
    outside = frame.outside(columns)
    size, kept = np.linalg.norm(columns, axis=0), np.linalg.norm(outside, axis=0)
    kept = kept > _ADDS_NOTHING * size
    if not kept.any():
        return 0.0, 0
    basis = orthonormal(outside[:, kept] / size[kept])
    return float(np.sum((basis.T @ frame.residual) ** 2)), basis.shape[1]


def bounded(columns: Floats, aim: Floats, low: Floats, high: Floats) -> Floats:
    """The coefficients of least squares between ``low`` and ``high``, in whatever unit the aim is: the search ends by how little is left."""
    size = float(np.linalg.norm(aim)) or 1.0
    return lsq_linear(columns, aim / size, (low / size, high / size), method="bvls", tol=1e-9).x * size


def best_step(frame: Frame, columns: Floats, low: Floats, high: Floats) -> Step:
    """The ``Step`` of least squares with the coefficients between ``low`` and ``high``, the fit's own values within theirs."""
    (basis, own), scale = frame.factors, np.linalg.norm(frame.slopes, axis=0)
    size = np.linalg.norm(columns, axis=0)
    scale, size = np.where(scale == 0, 1.0, scale), np.where(size == 0, 1.0, size)
    beside = frame.padded(columns) / size
    # of the triangle of all columns that of the fit's own is known: only what is offered is new
    inside = basis.T @ beside
    rest = beside - basis @ inside
    again = basis.T @ rest
    more, corner = np.linalg.qr(rest - basis @ again)
    triangle = np.block([[own, inside + again], [np.zeros((corner.shape[0], own.shape[1])), corner]])
    aim = np.concatenate([basis.T @ frame.residual, more.T @ frame.residual])
    size = np.concatenate([scale, size])
    own_low, own_high = frame.room
    low, high = np.concatenate([own_low, low]) * size, np.concatenate([own_high, high]) * size
    held = high - low <= 0
    step = np.zeros(size.size)
    step[~held] = bounded(triangle[:, ~held], aim, low[~held], high[~held])
    squares = float(aim @ aim - np.sum((aim - triangle @ step) ** 2))
    step = step / size
    return Step(squares, step[own.shape[1] :], step[: own.shape[1]])
