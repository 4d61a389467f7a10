"""A first guess from the data alone: frequency from zero crossings, decay from successive peaks, release from the start."""

from dataclasses import dataclass

import numpy as np

from .errors import InputError


@dataclass(frozen=True)
class Guess:
    """What a swing shows before any fit: natural frequency (rad/s), release (rad, rad/s), amplitude and its loss a half-swing (rad)."""

    natural_frequency: float
    release_angle: float
    release_velocity: float
    amplitude: float
    loss: float

    def damping(self, model):
        """The value of each damping parameter that would alone explain the loss a half-swing, by name.

        First-order energy balance over a half-swing of harmonic motion (Nayfeh and Mook 1979, ch. 3).
        """
        a, w, loss = self.amplitude, self.natural_frequency, max(self.loss, 1e-6 * self.amplitude)
        seen = {
            "viscous_ratio": loss / (np.pi * a),
            "quadratic_coefficient": 3 * loss / (4 * a**2 * w),
            "load_friction": loss / 2,
            "constant_friction": loss * w**2 / 2,
            "structural_coefficient": loss * w**2 / a,
        }
        return {name: float(seen[name]) for name in model.parameters if name in seen}


def amplitude_factor(amplitude):
    """Frequency of undamped swings of that amplitude (rad) over that of small ones: agm(1, cos(amplitude / 2))."""
    mean, root = 1.0, max(np.cos(min(abs(amplitude), 3.1) / 2), 1e-3)
    for _ in range(6):
        mean, root = (mean + root) / 2, np.sqrt(mean * root)
    return float(mean)


def half_swings(times, angle):
    """Times of the middle crossings (s), and the extreme between each two (rad); a tenth of the spread is hysteresis against noise."""
    band = 0.1 * np.sqrt(np.mean(angle**2))
    side = np.where(angle > band, 1, np.where(angle < -band, -1, 0))
    marks = np.flatnonzero(side)
    turns = np.flatnonzero(np.diff(side[marks]))
    crossings, extremes = [], []
    for k in turns:
        i, j = marks[k], marks[k + 1]
        if j - i > 1:
            after, part = times[i : j + 1] - times[i], angle[i : j + 1]
            centred = after - after.mean()
            slope = centred @ part / (centred @ centred)  # of the straight line, and its value at the first
            middle = part.mean() - slope * after.mean()
            crossings.append(times[i] + np.clip(-middle / slope if slope else 0.0, 0.0, times[j] - times[i]))
        else:
            crossings.append(times[i] + (times[j] - times[i]) * angle[i] / (angle[i] - angle[j]))
    for first, second in zip(crossings, crossings[1:], strict=False):
        inside = np.abs(angle[(times >= first) & (times < second)])
        extremes.append(inside.max() if inside.size else 0.0)
    return np.array(crossings), np.array(extremes)


def first_guess(times, angle, restoring="sine"):
    """The ``Guess`` for a swing: times in s, angles in rad; InputError where it crosses its middle fewer than twice."""
    times, angle = np.asarray(times, dtype=float), np.asarray(angle, dtype=float)
    crossings, extremes = half_swings(times, angle)
    if crossings.size < 2:
        crossings, extremes = half_swings(times, angle - 0.5 * (angle.max() + angle.min()))
    if crossings.size < 2:
        raise InputError("swing", "the angle crosses its middle fewer than twice", "at least one whole half-swing", "record longer")
    halves = np.diff(crossings)
    used = extremes >= 0.5 * extremes[0]  # the late, small ones are mostly noise or friction
    half, amplitude = float(np.median(halves[used])), float(np.median(extremes[used]))
    frequency = np.pi / half / (amplitude_factor(amplitude) if restoring == "sine" else 1.0)
    loss = (extremes[0] - extremes[-1]) / max(1, extremes.size - 1) if extremes.size > 1 else 0.01 * amplitude
    few = max(4, min(times.size, int(np.searchsorted(times, times[0] + half / 8))))
    local = np.polynomial.Polynomial.fit(times[:few] - times[0], angle[:few], 2).convert().coef
    return Guess(float(frequency), float(local[0]), float(local[1]), amplitude, float(loss))
