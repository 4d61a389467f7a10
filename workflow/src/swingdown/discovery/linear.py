"""The fit's residual and everything that could move it, to first order: the space in which effects are looked for."""

from dataclasses import dataclass

import numpy as np

from ..model import Model
from ..trajectory import sensitivities


@dataclass(frozen=True)
class Frame:
    """A fit seen to first order: each swing's residual (rad), the orthonormal basis of what the fit can do to it.

    ``residual`` is data minus fit with every swing below the other; ``basis`` (samples, rank) spans the fit's own
    sensitivities ``slopes`` (samples, free), whose columns are of the values ``names`` of the swings ``of`` (-1: of all);
    ``slices`` tell which samples are whose.
    """

    fit: object
    swings: tuple
    residual: np.ndarray
    slopes: np.ndarray
    basis: np.ndarray
    slices: tuple
    names: tuple
    of: tuple

    @property
    def scale(self):
        """The size of each column of ``slopes``, 1 for empty ones."""
        size = np.linalg.norm(self.slopes, axis=0)
        return np.where(size > 0, size, 1.0)

    def outside(self, columns):
        """The part of the columns (samples, any) that the fit cannot absorb by its own parameters."""
        return columns - self.basis @ (self.basis.T @ columns)


def each_model(fit):
    """The model of each swing of a joint fit: shared values with the swing's own."""
    own = fit.own or ({},) * len(fit.release_angle)
    return [fit.model.with_values(fit.model.values | one) for one in own]


def frame(fit, swings):
    """The ``Frame`` of a joint fit to these swings."""
    sizes = [swing.times.size for swing in swings]
    edges = np.concatenate([[0], np.cumsum(sizes)])
    slices = tuple(slice(int(a), int(b)) for a, b in zip(edges, edges[1:], strict=False))
    residual = np.concatenate([swing.angle - series for swing, series in zip(swings, fit.angle, strict=True)])
    models = each_model(fit)
    shared = [name for name in fit.model.parameters if not any(name in one for one in fit.own)]
    each = [*(fit.own[0] if fit.own else ()), "release_angle", "release_velocity"]
    slopes = np.zeros((residual.size, len(shared) + len(each) * len(swings)))
    for k, (swing, one) in enumerate(zip(swings, models, strict=True)):
        rows = sensitivities(one, swing.times, fit.release_angle[k], fit.release_velocity[k], free=[*shared, *each])[1]
        slopes[slices[k], : len(shared)] = rows[: len(shared)].T
        first = len(shared) + k * len(each)
        slopes[slices[k], first : first + len(each)] = rows[len(shared) :].T
    names = (*shared, *(each * len(swings)))
    of = (*(-1 for _ in shared), *(k for k in range(len(swings)) for _ in each))
    return Frame(fit, tuple(swings), residual, slopes, orthonormal(slopes), slices, names, of)


def orthonormal(columns):
    """An orthonormal basis of the columns' span, those that add nothing left out."""
    size = np.linalg.norm(columns, axis=0)
    kept = columns[:, size > 0] / size[size > 0]
    left, singular, _ = np.linalg.svd(kept, full_matrices=False)
    return left[:, singular > 1e-7 * singular[0]]


def columns_of(frame, effect, values, free):
    """What each of the ``free`` parameters of one further effect does to the angles, at the given values of all of them.

    An array (samples, len(free)), or where a parameter is each recording's own, (samples, swings * len(free)) with zeros
    outside the recording.
    """
    separate = any(parameter.own for parameter in effect.parameters)
    blocks = []
    for k, (swing, one) in enumerate(zip(frame.swings, each_model(frame.fit), strict=True)):
        wider = Model((*one.effects, effect.name), one.values | values, restoring=one.restoring, form=one.form)
        release = frame.fit.release_angle[k], frame.fit.release_velocity[k]
        blocks.append(sensitivities(wider, swing.times, *release, free=free)[1].T)
    if not separate:
        return np.concatenate(blocks)
    wide = np.zeros((frame.residual.size, len(blocks) * len(free)))
    for k, block in enumerate(blocks):
        wide[frame.slices[k], k * len(free) : (k + 1) * len(free)] = block
    return wide


def explained(frame, columns):
    """The sum of squares (rad^2) of the residual that the columns explain beyond the fit, their rank, and their coefficients."""
    outside = frame.outside(columns)
    size = np.linalg.norm(columns, axis=0)
    kept = np.linalg.norm(outside, axis=0) > 1e-6 * size
    coefficients = np.zeros(columns.shape[1])
    if not kept.any():
        return 0.0, 0, coefficients
    basis = orthonormal(outside[:, kept])
    coefficients[kept] = np.linalg.lstsq(outside[:, kept], frame.residual, rcond=1e-9)[0]
    return float(np.sum((basis.T @ frame.residual) ** 2)), basis.shape[1], coefficients
