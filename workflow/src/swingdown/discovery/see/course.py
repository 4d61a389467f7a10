"""When a model lacks a torque: its course in time, finer than a discrepancy has it."""

from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from scipy.integrate import cumulative_trapezoid

from ...arrays import Floats
from ...pendulum.effect import NATURAL_FREQUENCY
from ..data.noise import Noise
from .green import Motion, motions_of
from .linear import Frame

COURSE = ["swing", "time_s", "torque", "band"]
_COURSE_POINTS = 24  # a period
_MEMORY = 1 / 8  # of a period: how long a torque in time hangs together


class Course(NamedTuple):
    """The torque over the time of the fitted swings: a ``table`` of ``COURSE`` (s, torque and standard error in rad/s^2), its ``size``
    (rad/s^2) that is most likely, and its log-likelihood above that of none (``gain``)."""

    table: pd.DataFrame
    size: float
    gain: float


NO_COURSE = Course(pd.DataFrame(columns=COURSE), 0.0, 0.0)


def course(frame: Frame, noise: Noise) -> Course:
    """The ``Course`` of what a fit lacks, to first order."""
    motions = motions_of(frame)
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
    gain = float(likelihood[best] - likelihood[0])
    return Course(pd.concat(tables, ignore_index=True), float(sizes[best]), gain)


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
