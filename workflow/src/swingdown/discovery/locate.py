"""Where model and measurement disagree: score tests by group, in trajectory space, before any effect has a name.

Torques of a general form are pushed through the equations of variation at the fit; what the fit's own parameters can do
is projected out; the share of the residual that each group explains is a chi-square. No noisy data are differentiated.
"""

from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2

from .. import effects
from .linear import columns_of, explained

KINDS = {
    "position": "restoring",
    "velocity": "dissipative",
    "time": "time-dependent",
    "sensor": "sensor",
    "line": "spectral line",
}


@dataclass(frozen=True)
class Group:
    """One group's score test: explained chi-square (noise at the pendulum's frequencies), degrees of freedom, p, share."""

    name: str
    chi_square: float
    freedom: int
    p: float
    share: float


def groups(frame, noise):
    """The ``Group`` of position, velocity, time, sensor and spectral line at a fit, in that order.

    ``share`` is the part of the residual beyond the noise that the group explains to first order. The line is the
    strongest of the joint periodogram; its p counts how many were looked at.
    """
    beyond = max(float(np.sum(frame.residual**2)) - noise.deviation**2 * frame.residual.size, 1e-300)
    found = []
    for name, columns in _probes(frame).items():
        squares, rank, _ = explained(frame, columns)
        statistic = squares / noise.slow_variance
        found.append(Group(name, statistic, rank, float(chi2.sf(statistic, rank)), min(1.0, squares / beyond)))
    frequency, squares, looked = line(frame)
    count = 2 * len(frame.swings)
    statistic = squares / noise.slow_variance
    found.append(Group("line", statistic, count, float(-np.expm1(looked * np.log1p(-min(chi2.sf(statistic, count), 1 - 1e-16)))),
                       min(1.0, squares / beyond)))  # fmt: skip
    return found


def _probes(frame):
    """The columns of each group's general form."""
    angle = max(float(np.max(np.abs(series))) for series in frame.fit.angle)
    speed = max(float(np.max(np.abs(np.gradient(s, w.times)))) for s, w in zip(frame.fit.angle, frame.swings, strict=True))
    ranges = {"position": ("unnamed_position", angle), "velocity": ("unnamed_velocity", speed), "time": ("unnamed_time", None)}
    columns = {}
    for name, (entry, scale) in ranges.items():
        effect = effects.effect(entry)
        free = [parameter.name for parameter in effect.parameters if not parameter.grid]
        values = dict.fromkeys(free, 0.0) | ({f"{entry}_range": scale} if scale else {})
        columns[name] = columns_of(frame, effect, values, free)
    series = np.concatenate(frame.fit.angle)
    slow = np.concatenate([np.gradient(s, w.times) for s, w in zip(frame.fit.angle, frame.swings, strict=True)])
    columns["sensor"] = np.column_stack([np.ones_like(series), series, np.cos(series), np.sin(series), slow])
    return columns


def line(frame, low=0.3):
    """The frequency (Hz) at which sines of every recording's own phase explain most of the residual, the sum of squares
    (rad^2) explained there, and how many frequencies were looked at.
    """
    outside = frame.outside(frame.residual)
    longest = max(swing.times[-1] - swing.times[0] for swing in frame.swings)
    fastest = max((swing.times[-1] - swing.times[0]) / (swing.times.size - 1) for swing in frame.swings)
    grid = np.arange(max(low, 2 / longest), 0.45 / fastest, 0.25 / longest)
    power = np.zeros(grid.size)
    for swing, rows in zip(frame.swings, frame.slices, strict=True):
        interval = (swing.times[-1] - swing.times[0]) / (swing.times.size - 1)
        size = int(2 ** np.ceil(np.log2(8 * swing.times.size)))
        spectrum = np.abs(np.fft.rfft(outside[rows], size)) ** 2 * 2 / swing.times.size
        power += np.interp(grid, np.fft.rfftfreq(size, interval), spectrum)
    best = int(np.argmax(power))
    return float(grid[best]), float(power[best]), max(1, grid.size // 2)
