"""A model's curves with a discrepancy beside them: the friction over the speed and the stiffness over the angle that its half-swings say it lacks.

Both are Gaussian processes of unknown size (Kennedy and O'Hagan, J. R. Stat. Soc. B 63, 425 (2001)). The model was fitted to the same swings, so
that its values count for next to nothing here: the half-swings, each of which is known for itself, tell them anew beside the discrepancy.
"""

from typing import NamedTuple

import numpy as np

from ..arrays import Floats
from ..pendulum.model import Model
from ..pendulum.static import drag, resting, static
from ..studies.quantities import steady
from .free import (
    LEAST_LOSS,
    LEAST_STIFFNESS,
    OF_STIFFNESS,
    Free,
    marked,
    of_losses,
    of_marks,
    timed_of,
    typical_of,
)
from .modelled import Course, course_of, effects_on
from .regression import SHARE, Posterior, Prior, kernel
from .second_order import Table
from .torques import beyond_durations, durations, losses, lost

_GRID = 41  # amplitudes between which the model's loss and period are interpolated
_DIFFERENCES = 10  # releases of a model by which differences between two are told
_WIDER = 10.0  # times its standard errors that a model's values may be off: what its fit knew then counts for a hundredth
_LEAST_LACK = 1e-3  # of what a model lacks of the loss, or of the stiffness, over the whole
_SMOOTH = 1.8  # of the logarithm of the speed: what the friction of a model changes over
_ROUGH = 1e-3  # of the loss: how closely a friction of speed alone has to take what a model takes


class Known(NamedTuple):
    """A curve of the model ``alone``; ``value`` with what it lacks, standard uncertainty ``u``, and the k of a band of 95 %."""

    alone: Floats
    value: Floats
    u: Floats
    factor: Floats


def with_discrepancy(
    found: Free, model: Model, covariance: Floats | None, amplitude: Floats, angle: Floats, speed: Floats
) -> dict[str, Known]:
    """Period (s) and loss of the logarithm of the amplitude in a half-swing of a model, its restoring torque and friction (rad/s²).

    By name: ``period`` and ``loss`` over the amplitude, ``restoring`` over the angle, ``friction`` over the speed; nan where the model does
    not swing, and of what nothing timed tells. ``found`` is what the same half-swings tell free of the model, which has values; ``covariance``
    that of its parameters, None where nothing is known of them but the values. The curves are asked for at these amplitudes (rad), angles
    (rad; none is zero) and speeds (rad/s).
    """
    grid = np.geomspace(found.low, found.high, _GRID)
    inverse, spread = _friction_of(found, grid)
    beyond = found.beyond.at(grid)[:, 0]
    fast = found.friction.at(speed / found.scale) * found.scale**2

    def elsewhere(one: Model, loss: Floats) -> Floats:
        """The loss beside that of the friction in the middle."""
        slow = drag(one)
        return loss - beyond - lost(found.ideal, lambda rad: slow(rad * found.scale) / found.scale**2, grid)

    def of(one: Model, course: Course) -> Floats:
        loss, period = (_filled(grid, part) for part in course.at(grid))
        torque, middle = static(one), resting(one)
        pull = (torque(middle - angle) - torque(middle + angle)) / 2
        slow = drag(one)(speed) + fast @ (inverse @ elsewhere(one, loss))
        return np.concatenate([period, loss, pull, slow])

    def derived(one: Model) -> Floats:
        return of(one, course_of(one, found.low, found.high, found.passages, _DIFFERENCES))

    bare = steady(model.motion)
    course = course_of(bare, found.low, found.high, found.passages)
    at = [model.parameters.index(name) for name in bare.parameters]
    known = np.zeros((len(at), len(at))) if covariance is None else covariance[np.ix_(at, at)]
    whole = of(bare, course)
    over = {"period": amplitude, "loss": amplitude, "restoring": angle, "friction": speed}
    nothing = {name: Known(*[np.full(one.size, np.nan)] * 4) for name, one in over.items()}
    effects = effects_on(derived, bare, known) * _WIDER / SHARE
    if not (np.isfinite(whole).all() and np.isfinite(effects).all()):
        return nothing
    edges = np.cumsum([_GRID, _GRID, angle.size])
    parts = zip(np.split(whole, edges), np.split(effects, edges), strict=True)
    period, loss, restoring, friction = (_Part(*one) for one in parts)
    # what is no friction of speed alone leaves that one as open as is its share
    rest = np.abs(elsewhere(bare, loss.alone)).sum() / np.abs(loss.alone).sum()
    spread = min(rest, 1.0) ** 2 * spread
    known_at = np.where(np.isfinite(course.at(amplitude)[0]), amplitude, np.nan)
    taken = _taken(found, grid, loss, friction, known_at, (fast, spread))
    return nothing | taken | _timed(found, grid, period, restoring, known_at, angle)


class _Part(NamedTuple):
    """Quantities of the model ``alone``, and what errors of its parameters that may be made do to them (quantity, error)."""

    alone: Floats
    effects: Floats

    def beside(self, curve: Floats, scale: float) -> Floats:
        """The rows of what is unknown: the model's values, whose coefficients are of that scale, and the ``curve`` beside them."""
        return np.hstack([self.effects / scale, curve])


def _taken(
    found: Free, grid: Floats, loss: _Part, friction: _Part, amplitude: Floats, speeds: tuple[Floats, Floats]
) -> dict[str, Known]:
    """Loss and friction, by the turning points; of ``speeds`` the rows of a friction, and the covariance of what the model's leaves open."""
    scale = typical_of(found.courses)
    known = Table(grid, loss.alone[:, np.newaxis])
    unknown = Table(grid, loss.beside(losses(found.ideal, found.friction, grid), scale))
    prior = Prior.any_size(loss.effects.shape[1], found.friction.nodes, scale, _LEAST_LACK, LEAST_LOSS)
    told = of_losses(found.swings, found.courses, known, unknown, prior)
    taken, lost = known.at(amplitude)[:, 0], unknown.at(amplitude)
    fast, spread = speeds
    left = np.sqrt(np.maximum(np.einsum("si,ij,sj->s", fast, spread, fast), 0.0))
    return {
        "loss": _known(taken, *told.band(lost)),
        "friction": _known(friction.alone, *told.band(friction.beside(fast, scale), left)),
    }


def _timed(
    found: Free, grid: Floats, period: _Part, restoring: _Part, amplitude: Floats, angle: Floats
) -> dict[str, Known]:
    """Period and restoring torque, by the marks of time; nothing where there are none."""
    timed, ideal = timed_of(found.swings, found.courses), found.ideal
    if not timed:
        return {}
    halves = _Part(period.alone / 2, period.effects / 2)
    known = Table(grid, halves.alone[:, np.newaxis])
    longer = np.pi / found.scale * ideal.lengthening(grid)[:, np.newaxis]
    curve = longer * durations(ideal, found.stiffness, grid)
    unknown = Table(grid, halves.beside(curve, OF_STIFFNESS))
    marks = [marked(*one, known)[:, 0] for one in timed]
    first = period.effects.shape[1]
    prior = Prior.any_size(first, found.stiffness.nodes, OF_STIFFNESS, _LEAST_LACK, LEAST_STIFFNESS)

    def beyond(told: Posterior) -> Table:
        lacks = told.mean[first : first + curve.shape[1]]
        return Table(grid, longer * beyond_durations(ideal, found.stiffness, lacks, grid)[:, np.newaxis])

    told = of_marks(timed, marks, unknown, prior, beyond)
    usual = found.scale**2 * ideal.torque(angle)[:, np.newaxis]
    stiff = restoring.beside(usual * found.stiffness.at(angle), OF_STIFFNESS)
    alone = 2 * known.at(amplitude)[:, 0]
    lacking, u, factor = told.band(2 * unknown.at(amplitude), alone * found.period_off(amplitude))
    off = restoring.alone * found.restoring_off(angle)
    return {
        "period": _known(alone, lacking + 2 * beyond(told).at(amplitude)[:, 0], u, factor),
        "restoring": _known(restoring.alone, *told.band(stiff, off)),
    }


def _known(alone: Floats, lacking: Floats, u: Floats, factor: Floats) -> Known:
    return Known(alone, alone + lacking, u, factor)


def _filled(grid: Floats, values: Floats) -> Floats:
    """The values with the nearest one where there is none; nan where there are none at all."""
    there = np.isfinite(values)
    return np.interp(grid, grid[there], values[there]) if there.any() else values


def _friction_of(found: Free, amplitude: Floats) -> tuple[Floats, Floats]:
    """The matrix from a loss at these amplitudes (rad) to the coefficients of a friction of speed alone that takes it, the smoothest, and the
    covariance of what it leaves open of them."""
    rows = losses(found.ideal, found.friction, amplitude)
    typical = float(np.mean(np.abs(found.loss_at(amplitude)[0])))
    laws, nodes = len(found.friction.powers), found.friction.nodes
    usual = np.eye(rows.shape[1])
    usual[laws:, laws:] = kernel(nodes, _SMOOTH)
    usual *= (SHARE * typical_of(found.courses)) ** 2
    spread = usual @ rows.T
    inverse = spread @ np.linalg.inv(rows @ spread + (_ROUGH * typical) ** 2 * np.eye(amplitude.size))
    return inverse, usual - inverse @ spread.T
