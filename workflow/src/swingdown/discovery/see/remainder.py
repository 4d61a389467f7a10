"""What a model still lacks, without a name: a torque over angle and speed together, and the torque's course in time."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from scipy.integrate import cumulative_trapezoid
from scipy.linalg import block_diag
from scipy.optimize import minimize_scalar

from ...arrays import Floats
from ...pendulum.effect import NATURAL_FREQUENCY
from ..data.noise import Noise
from .green import Motion, motions_of, plane, responses
from .linear import Frame

MAP = ["angle_rad", "speed_rad_per_s", "torque", "band", "known", "seen"]
COURSE = ["swing", "time_s", "torque", "band"]
_ANGLES, _SPEEDS = 11, 6  # nodes of the map: angles, and speeds to either side
_SMOOTH = 0.35  # of the largest angle and speed: how far neighbouring torques hang together
_IMITATED = 0.02  # of a torque's work: one that leaves less beyond the fit is the fit's own
_COURSE_POINTS = 24  # a period
_MEMORY = 1 / 8  # of a period: how long a torque in time hangs together


@dataclass(frozen=True)
class Remainder:
    """What a fit leaves: ``map``, a table of ``MAP`` (rad, rad/s, torque and its standard error in rad/s^2, how much of it
    the data determine, 0 to 1, and the share of the time spent around there), the share of the excess over the noise that a torque over the
    angle alone (``position``), the speed alone (``velocity``), one added to the other (``sum``) and both together (``map``) explains, and ``course``, a table of
    ``COURSE`` (s, torque and standard error in rad/s^2) for the fitted swings. ``torque`` (rad/s^2) is the size of the torque in
    time that is most likely, and ``gain`` its log-likelihood above that of none."""

    map: pd.DataFrame
    shares: dict[str, float]
    course: pd.DataFrame
    torque: float
    gain: float


def remainder(frame: Frame, noise: Noise) -> Remainder:
    """The ``Remainder`` of a fit to first order: smooth torques, as large as the data ask for (maximum of the evidence)."""
    motions = motions_of(frame)
    table, shares = _map(frame, motions, noise)
    course, torque, gain = _course(frame, motions, noise)
    return Remainder(table, shares, course, torque, gain)


def _map(frame: Frame, motions: Sequence[Motion], noise: Noise) -> tuple[pd.DataFrame, dict[str, float]]:
    """The table of the torque over angle and speed, and the shares of the shapes."""
    over = plane(motions, _ANGLES, _SPEEDS)
    seen = np.concatenate(over.torques).sum(axis=0)
    columns = responses(motions, over.torques)
    basis, triangle = np.linalg.qr(frame.outside(columns))
    size = np.linalg.qr(columns, mode="r")
    residual = frame.outside(frame.residual)
    near_angle, near_speed = _near(_ANGLES, -1), np.kron(np.eye(2), _near(_SPEEDS, 0))
    over_angle = np.kron(np.eye(_ANGLES), np.ones((2 * _SPEEDS, 1)))
    over_speed = np.kron(np.ones((_ANGLES, 1)), np.eye(2 * _SPEEDS))
    shapes = {
        "position": (over_angle, near_angle),
        "velocity": (over_speed, near_speed),
        "sum": (np.hstack([over_angle, over_speed]), block_diag(near_angle, near_speed)),
        "map": (np.eye(seen.size), np.kron(near_angle, near_speed)),
    }
    along = basis.T @ residual
    whole = float(residual @ residual)
    excess = whole - noise.slow_variance * frame.samples
    shares: dict[str, float] = {}
    for name, (shape, near) in shapes.items():
        told = _smooth(
            (triangle @ shape, size @ shape), along, near, noise.slow_variance, whole, frame.samples
        )
        shares[name] = float(np.clip((whole - told.left) / excess, 0, 1)) if excess > 0 else 0.0
    places = np.meshgrid(over.angles, np.r_[over.speeds, -over.speeds], indexing="ij")
    shown = (places[0].ravel(), places[1].ravel(), told.value, told.error, told.known, seen / seen.sum())
    return pd.DataFrame(dict(zip(MAP, shown, strict=True))), shares


def _near(count: int, least: float) -> Floats:
    """How far the torques at so many nodes from ``least`` to 1 hang together: a correlation that falls with their distance."""
    nodes = np.linspace(least, 1, count)
    return np.exp(-0.5 * np.square((nodes[:, np.newaxis] - nodes) / _SMOOTH)) + 1e-6 * np.eye(nodes.size)


class _Smooth(NamedTuple):
    """Coefficients, their standard errors, how much of each the data determine (0 to 1), and the sum of squares left."""

    value: Floats
    error: Floats
    known: Floats
    left: float


class Shrunk(NamedTuple):
    """How large coefficients most likely are: their variance ``size``, the share of each that the data determine (``kept``), the variance that
    counts as noise, and the sum of squares that is left."""

    size: float
    kept: Floats
    variance: float
    left: float


def most_likely(singular: Floats, seen: Floats, variance: float, whole: float, samples: int) -> Shrunk:
    """The ``Shrunk`` of most evidence for coefficients along directions that do so much to the readings (``singular``), of which the
    residual, whose sum of squares is ``whole``, has so much (``seen``). What is left of it beyond the noise's ``variance`` counts as noise."""
    for _ in range(3):

        def cost(logarithm: float, variance: float = variance) -> float:
            power = variance + np.exp(logarithm) * singular**2
            return float(np.sum(np.log(power) + seen**2 / power))

        scale = np.log(variance / np.max(singular) ** 2)
        size = float(np.exp(minimize_scalar(cost, bounds=(scale - 5, scale + 40), method="bounded").x))
        kept = size * singular**2 / (variance + size * singular**2)
        squares = whole - float(np.sum((1 - (1 - kept) ** 2) * seen**2))
        variance = max(variance, squares / samples)
    return Shrunk(size, kept, variance, squares)


def _smooth(
    columns: tuple[Floats, Floats], along: Floats, near: Floats, variance: float, whole: float, samples: int
) -> _Smooth:
    """Coefficients of columns with a Gaussian prior of the correlation ``near``, of the size that is most likely.

    ``columns`` are what is left of them beyond the fit, and they themselves, each in a basis of its own; ``along`` is the
    residual in the first one and ``whole`` its sum of squares. What is left of it beyond the noise's
    ``variance`` counts as noise. What the fit's own values could imitate is not determined, and stays at nothing.
    """
    root = np.linalg.cholesky(near)
    left, singular, right = np.linalg.svd(columns[0] @ root, full_matrices=False)
    own = singular < _IMITATED * np.linalg.norm(columns[1] @ root @ right.T, axis=0)
    singular, seen = np.where(own, 0.0, singular), np.where(own, 0.0, left.T @ along)
    if not np.any(singular > 0) or not np.all(
        np.isfinite(singular)
    ):  # the fit's own values could do all of it
        nothing = np.zeros(root.shape[0])
        return _Smooth(nothing, nothing, nothing, whole)
    told = most_likely(singular, seen, variance, whole, samples)
    kept, variance, squares = told.kept, told.variance, told.left
    inverse = np.where(singular > 0, kept / np.where(singular > 0, singular, 1.0), 0.0)
    shape = root @ right.T
    prior = np.einsum("ij,ij->i", shape, shape)
    return _Smooth(
        shape @ (inverse * seen),
        np.sqrt(variance * np.einsum("ij,j,ij->i", shape, inverse**2, shape)),
        np.einsum("ij,j,ij->i", shape, kept, shape) / prior,
        squares,
    )


def _course(frame: Frame, motions: Sequence[Motion], noise: Noise) -> tuple[pd.DataFrame, float, float]:
    """The torque over time of each swing, its most likely size (rad/s^2), and the log-likelihood gained by it."""
    chains = [
        _chain(one, frame.residual[rows], frame.fit.model.values[NATURAL_FREQUENCY.name])
        for one, rows in zip(motions, frame.slices, strict=True)
    ]
    reach = max(float(np.std(chain.residual)) for chain in chains)
    fastest = frame.fit.model.values[NATURAL_FREQUENCY.name] ** 2
    sizes = np.r_[0.0, reach * fastest * np.logspace(-4, 1.5, 12)]
    likelihood = np.sum([_filtered(chain, sizes, noise.slow_variance)[0] for chain in chains], axis=0)
    best = int(np.argmax(likelihood))
    tables = []
    for swing, chain in zip(frame.swings, chains, strict=True):
        torque, band = _smoothed(chain, float(sizes[best]), noise.slow_variance)
        columns = (swing.name, chain.times, torque, band)
        tables.append(pd.DataFrame(dict(zip(COURSE, columns, strict=True))))
    return pd.concat(tables, ignore_index=True), float(sizes[best]), float(likelihood[best] - likelihood[0])


class _Chain(NamedTuple):
    """A swing as a chain of times (s): means of residual (rad) and of the reading's slopes, of so many samples each; what a
    torque until the next time adds to the release coordinates; and how much of a torque is left by then."""

    times: Floats
    residual: Floats
    slopes: Floats
    each: int
    pull: Floats
    memory: Floats


def _chain(one: Motion, residual: Floats, natural_frequency: float) -> _Chain:
    samples = one.times[one.at]
    period = 2 * np.pi / natural_frequency
    own = int(period / _COURSE_POINTS * (samples.size - 1) / (samples[-1] - samples[0]))
    each = min(max(1, own), samples.size)  # a model may swing more slowly than a record is long
    whole = samples.size // each * each

    def mean(series: Floats) -> Floats:
        return series[..., :whole].reshape(*series.shape[:-1], -1, each).mean(axis=-1)

    times = mean(samples)
    moved = cumulative_trapezoid(one.pull, one.times, axis=1, initial=0.0)
    pull = np.diff([np.interp(times, one.times, row) for row in moved], axis=1)
    memory = np.exp(-np.diff(times) / (_MEMORY * period))
    return _Chain(times, mean(residual), mean(one.slopes), each, pull, memory)


def _filtered(chain: _Chain, sizes: Floats, variance: float) -> tuple[Floats, list[tuple[Floats, ...]]]:
    """The log-likelihood of a chain for torques of each size (Kalman's filter), and the filter's means and covariances."""
    count, told = sizes.size, variance / chain.each
    mean: Any = np.zeros((count, 3))
    cov: Any = np.zeros((count, 3, 3))
    wide = 1e6 * max(told, float(np.mean(chain.residual**2)))
    for k in (0, 1):  # a release that may be anything
        cov[:, k, k] = wide / max(float(np.mean(chain.slopes[k] ** 2)), 1e-300)
    cov[:, 2, 2] = sizes**2
    total: Any = np.zeros(count)
    steps: list[tuple[Floats, ...]] = []
    for k in range(chain.times.size):
        before = mean, cov
        row = np.array([chain.slopes[0, k], chain.slopes[1, k], 0.0])
        gain = cov @ row
        spread = gain @ row + told
        off = chain.residual[k] - mean @ row
        total -= 0.5 * (np.log(spread) + off**2 / spread)
        mean = mean + gain * (off / spread)[:, np.newaxis]
        cov = cov - gain[:, :, np.newaxis] * gain[:, np.newaxis, :] / spread[:, np.newaxis, np.newaxis]
        steps.append((*before, mean, cov))
        if k < chain.memory.size:
            move = _move(chain, k)
            mean, cov = mean @ move.T, move @ cov @ move.T
            cov[:, 2, 2] += sizes**2 * (1 - chain.memory[k] ** 2)
    return total, steps


def _move(chain: _Chain, k: int) -> Floats:
    return np.array([[1, 0, chain.pull[0, k]], [0, 1, chain.pull[1, k]], [0, 0, chain.memory[k]]])


def _smoothed(chain: _Chain, size: float, variance: float) -> tuple[Floats, Floats]:
    """The torque over a chain's times and its standard error (rad/s^2): the smoother of Rauch, Tung and Striebel (1965)."""
    steps = _filtered(chain, np.array([size]), variance)[1]
    torque, band = np.zeros((2, chain.times.size))
    mean, cov = steps[-1][2][0], steps[-1][3][0]
    torque[-1], band[-1] = mean[2], cov[2, 2]
    for k in range(chain.times.size - 2, -1, -1):
        ahead, spread = steps[k + 1][0][0], steps[k + 1][1][0]
        own, known = steps[k][2][0], steps[k][3][0]
        scale = np.sqrt(np.maximum(np.diag(spread), 1e-300))
        back = known @ _move(chain, k).T / scale @ np.linalg.pinv(spread / np.outer(scale, scale)) / scale
        mean, cov = own + back @ (mean - ahead), known + back @ (cov - spread) @ back.T
        torque[k], band[k] = mean[2], cov[2, 2]
    return torque, np.sqrt(np.maximum(band, 0.0))
