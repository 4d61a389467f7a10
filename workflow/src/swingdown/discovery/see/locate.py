"""Where model and measurement disagree: score tests by group, in trajectory space, before any effect has a name.

Torques of a general form are pushed through the equations of variation at the fit; what the fit's own parameters can do
is projected out; the share of the residual that each group explains is a chi-square. No noisy data are differentiated.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.special import chdtrc

from ...arrays import Floats
from ...measurement.swings.even import evenly
from ...pendulum.catalogue import ANGLE
from ...pendulum.effect import NATURAL_FREQUENCY
from ..data.noise import Noise
from .curves import Form
from .linear import Frame, explained, motion

KINDS = {
    "position": "restoring",
    "constant": "constant torque",
    "velocity": "dissipative",
    "time": "time-dependent",
    "sensor": "sensor",
    "line": "spectral line",
    "other": "of no simple kind",
}
_SLOWEST = 0.3  # of the natural frequency: a slower line is none, but what changes in time
_CONSTANT = 0.95  # of what the position explains: a torque that is the same everywhere


@dataclass(frozen=True)
class Group:
    """One group's score test: explained chi-square (noise at the pendulum's frequencies), degrees of freedom, p, share."""

    name: str
    chi_square: float
    freedom: int
    p: float
    share: float


def groups(frame: Frame, noise: Noise, curves: Mapping[str, Form]) -> list[Group]:
    """The ``Group`` of position, its constant part, velocity, time (``curves.forms``), sensor, spectral line, and any other, in that order.

    ``share`` is the part of the residual beyond the noise, or of one that is below the noise of all of it, that the group explains to first order. The line is the
    strongest of the joint periodogram; its p counts how many were looked at. ``other`` is any reading error that angle,
    velocity and time determine: it asks whether anything is left, not what.
    """
    whole = float(np.sum(frame.residual**2))
    excess = whole - noise.deviation**2 * frame.samples
    beyond = excess if excess > 0 else max(whole, 1e-300)

    def group(name: str, squares: float, freedom: int, p: Callable[[float], float] | None = None) -> Group:
        statistic = squares / noise.slow_variance
        plain = float(chdtrc(freedom, statistic)) if freedom else 1.0
        chance = plain if p is None else p(statistic)
        return Group(name, statistic, freedom, chance, min(1.0, squares / beyond))

    found = [group(name, *explained(frame, columns)) for name, columns in probes(frame, curves).items()]
    _, squares, looked = line(frame)
    count = 2 * len(frame.swings)
    found.insert(
        -1,
        group(
            "line",
            squares,
            count,
            lambda s: float(-np.expm1(looked * np.log1p(-min(chdtrc(count, s), 1 - 1e-16)))),
        ),
    )
    return found


def kind(found: Iterable[Group]) -> str | None:
    """The key of ``KINDS`` for the group that explains most, or None where there are no groups."""
    shares = {group.name: group.share for group in found if group.name not in ("other", "constant")}
    if not shares:
        return None
    best = max(shares, key=lambda name: shares[name])
    constant = next((group.share for group in found if group.name == "constant"), 0.0)
    return "constant" if best == "position" and constant > _CONSTANT * shares[best] else best


def probes(frame: Frame, curves: Mapping[str, Form]) -> dict[str, Floats]:
    """The columns of each group's general form, by name."""
    columns = {over: form.columns for over, form in curves.items()}
    angle, speed = motion(frame.fit, frame.swings)
    since = np.concatenate([(w.times - w.times[0]) / (w.times[-1] - w.times[0]) for w in frame.swings])
    x, v = angle / np.max(np.abs(angle)), speed / np.max(np.abs(speed))
    if frame.fit.model.reading == ANGLE:
        sensor = np.column_stack(
            [np.ones_like(x), angle, np.cos(angle), np.sin(angle), speed, np.sign(speed)]
        )
    else:
        sensor = np.column_stack([np.ones_like(x), v, v**2, v**3])
    shapes = [x**i * v**j for i in range(6) for j in range(6 - i)]
    other = np.column_stack([shape * since**k for k in range(3) for shape in shapes])
    return {
        "position": columns["position"],
        "constant": columns["position"][:, :1],
        "velocity": columns["velocity"],
        "time": columns["time"],
        "sensor": sensor,
        "other": other,
    }


def line(frame: Frame) -> tuple[float, float, int]:
    """The frequency (Hz) at which sines of every recording's own phase explain most of the residual, the sum of squares
    (rad^2) explained there, and how many frequencies were looked at.

    Samples count at their times, and those that are missing for nothing: Deeming, Astrophys. Space Sci. 36, 137 (1975).
    """
    outside = frame.outside(frame.residual)
    pairs = zip(frame.swings, frame.slices, strict=True)
    swings = [evenly(swing.times, outside[rows]) for swing, rows in pairs]
    longest = max(one.times[-1] - one.times[0] for one in swings)
    slowest = max(_SLOWEST * frame.fit.model.values[NATURAL_FREQUENCY.name] / (2 * np.pi), 2 / longest)
    grid = np.arange(slowest, 0.45 / max(one.interval for one in swings), 0.25 / longest)
    power = np.zeros(grid.size)
    for one in swings:
        there = np.where(one.missing, 0.0, one.signal)
        size = int(2 ** np.ceil(np.log2(8 * there.size)))
        spectrum = np.abs(np.fft.rfft(there, size)) ** 2 * 2 / np.count_nonzero(~one.missing)
        power += np.interp(grid, np.fft.rfftfreq(size, one.interval), spectrum)
    best = int(np.argmax(power))
    return float(grid[best]), float(power[best]), max(1, grid.size // 2)
