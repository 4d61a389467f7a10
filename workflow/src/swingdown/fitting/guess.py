"""A first guess from the data alone: frequency from zero crossings, decay from successive peaks, release from the start."""

from dataclasses import dataclass
from math import pi
from typing import Any

import numpy as np

from ..arrays import Floats
from ..calmed import calmed
from ..errors import InputError
from ..pendulum.catalogue import ANGLE, RATE
from ..pendulum.formula import evaluate
from ..pendulum.half_swings import middle_crossings, quickening, reached
from ..pendulum.model import Model


@dataclass(frozen=True)
class Guess:
    """What a swing shows before any fit: natural frequency (rad/s), release (rad, rad/s), amplitude and its loss a half-swing (rad)."""

    natural_frequency: float
    release_angle: float
    release_velocity: float
    amplitude: float
    loss: float

    def damping(self, model: Model) -> dict[str, float]:
        """The size of each damping effect that would alone explain the loss a half-swing, by parameter (``Effect.damping``)."""
        loss = max(self.loss, 1e-6 * self.amplitude)
        seen = {"amplitude": self.amplitude, "omega_n": self.natural_frequency, "loss": loss}
        return {
            effect.size.name: float(evaluate(effect.damping, **seen))
            for effect in model.effects
            if effect.damping and effect.size
        }


def first_guess(times: Any, angle: Any, restoring: str = "sine", reading: str = ANGLE) -> Guess:
    """The ``Guess`` from which the fit of a swing begins.

    Parameters
    ----------
    times, angle
        In s and rad (of the reading ``rate`` in rad/s), both of shape (sample,).
    restoring
        ``sine`` or ``linear``.
    reading
        ``angle`` or ``rate``.

    Raises
    ------
    InputError
        If the swing crosses its middle fewer than twice.
    """
    times, angle = np.asarray(times, dtype=float), np.asarray(angle, dtype=float)
    if reading == RATE:
        return _guess_from_rate(times, angle, restoring)
    crossings, extremes = middle_crossings(times, angle)
    if crossings.size < 2:
        crossings, extremes = middle_crossings(times, angle - 0.5 * (angle.max() + angle.min()))
    if crossings.size < 2:
        problem = "the angle crosses its middle fewer than twice"
        expected = "at least one whole half-swing"
        raise InputError("swing", problem, expected, "record longer, or name the column of the angle")
    # the late, small ones are mostly noise or friction
    seen, reached = crossings.tolist(), extremes.tolist()
    used = [k for k, one in enumerate(reached) if one >= 0.5 * reached[0]]
    half = _median([seen[k + 1] - seen[k] for k in used])
    if (steps := times[1:] - times[:-1]).max() > half / 2:  # what a hole hides may be several half-swings
        shown = _without_hole(times, steps, crossings)
        used = [k for k in used if shown[k]] or [int(k) for k in shown.nonzero()[0]] or used
        half = _median([seen[k + 1] - seen[k] for k in used])
    amplitude = _median([reached[k] for k in used])
    frequency = pi / half / (quickening(amplitude) if restoring == "sine" else 1.0)
    loss = (reached[0] - reached[-1]) / (len(reached) - 1) if len(reached) > 1 else 0.01 * amplitude
    release, velocity = at_first(times, angle, half)
    return Guess(frequency, release, velocity, amplitude, loss)


def _without_hole(times: Floats, steps: Floats, crossings: Floats) -> np.ndarray:
    """Of each half-swing between crossings of the middle whether samples show it, no step between them being most of it."""
    before = times.searchsorted(crossings) - 1
    longest = np.array([steps[a : b + 1].max() for a, b in zip(before, before[1:], strict=False)])
    return longest < np.diff(crossings) / 2


def at_first(times: Floats, series: Floats, half: float) -> tuple[float, float]:
    """Value and slope (a second) at the first sample, of a parabola through an eighth of a half-swing.

    Parameters
    ----------
    times, series
        In s and any unit, both of shape (sample,).
    half
        How long a half-swing takes, in s.
    """
    few = max(4, min(times.size, int(times.searchsorted(times[0] + half / 8))))
    span = times[few - 1] - times[0]
    early = (times[:few] - times[0]) / span
    powers = np.ones((few, 3))
    powers[:, 0], powers[:, 1] = early * early, early
    local = np.linalg.lstsq(powers, series[:few])[0]
    return float(local[2]), float(local[1] / span)


def _guess_from_rate(times: Floats, rate: Floats, restoring: str) -> Guess:
    """The ``Guess`` from angular velocities (rad/s): the largest of each half-swing tell its amplitude by the energy.

    A gyroscope's zero is taken from the mean over whole periods, at whose ends the pendulum is where it was.
    """
    rate = calmed(times, rate, ends_quiet=False)
    crossings, speeds = middle_crossings(times, rate - np.mean(rate))
    if crossings.size >= 3:
        last = crossings[crossings.size - (1 if crossings.size % 2 else 2)]
        rate = rate - np.mean(rate[(times >= crossings[0]) & (times <= last)])
        crossings, speeds = middle_crossings(times, rate)
    if crossings.size < 2:
        raise InputError(
            "swing", "the angular rate passes zero fewer than twice", "at least one whole half-swing", "record longer"
        )  # fmt: skip
    used = speeds >= 0.5 * speeds[0]
    half, fastest = float(np.median(np.diff(crossings)[used])), float(np.median(speeds[used]))
    frequency = observed = np.pi / half
    for _ in range(30 if restoring == "sine" else 0):  # the faster of two that depend on each other
        frequency = observed / quickening(float(reached(fastest / frequency, restoring)))
    turned = reached(speeds / frequency, restoring)
    amplitude = float(np.median(turned[used]))
    loss = (turned[0] - turned[-1]) / max(1, turned.size - 1) if turned.size > 1 else 0.01 * amplitude
    velocity, acceleration = at_first(times, rate, half)
    release = -acceleration / frequency**2  # of a spring; a weight pulls with the sine of the angle
    if restoring == "sine":
        sine = float(np.clip(release, -1.0, 1.0))
        # beyond 90° the pull falls again: which side of it the release is on, the energy tells
        cosine = np.cos(turned[0]) + 0.5 * (velocity / frequency) ** 2
        release = float(np.arctan2(sine, cosine)) if cosine < 0.5 else float(np.arcsin(sine))
    return Guess(float(frequency), release, velocity, amplitude, float(loss))


def _median(values: list[float]) -> float:
    """The median of a few values: numpy's own takes longer to look at its arguments than all else does."""
    ordered, half = sorted(values), len(values) // 2
    return ordered[half] if len(values) % 2 else (ordered[half - 1] + ordered[half]) / 2
