"""When the bob was let go: waiting until it is still, noticing that it leaves, and going back to where it left."""

from collections import deque

import numpy as np
import numpy.typing as npt

CONFIRM = 3  # samples beyond the threshold before it is a release and no spike
LOOKS = 20  # at the stillness of the bob, in the time that it must be still
_MOMENTS = 200  # tried for the release
SPREAD = 4.5  # standard deviations that noise spreads over, from its lowest to its highest of some 50 samples


class Watch:
    """Takes the rows before a release; ``armed`` when the signal was still for the trigger's ``pre_s``.

    ``settings`` is the config's ``trigger``; ``rate`` in samples a second, ``scale`` the signal for one unit of what is sent.
    """

    def __init__(self, settings, rate, scale):
        self.threshold, self._scale = settings["threshold"], scale
        self._size = max(round(settings["pre_s"] * rate), 2 * CONFIRM)
        self._every = max(self._size // LOOKS, 1)
        self._quiet, self._sum, self._seen, self._beyond = deque(), 0.0, 0, []
        self.armed = False

    @property
    def needed(self):
        """How many rows before the last a release rests on."""
        return 2 * self._size

    @property
    def spread(self):
        """By how much the signal has moved of late, while the bob should be still."""
        return max(self._quiet) - min(self._quiet) if self._quiet else 0.0

    def take(self, row):
        """The row that began a release, once it is certain; else None."""
        value = row.value * self._scale
        if self.armed:
            if abs(value - self._sum / len(self._quiet)) > self.threshold:
                self._beyond.append(row)
                return self._beyond[0] if len(self._beyond) >= CONFIRM else None
            self._beyond = []
        self._quiet.append(value)
        self._sum += value
        self._seen += 1
        if len(self._quiet) > self._size:
            self._sum -= self._quiet.popleft()
        if not self.armed and self._seen % self._every == 0 and len(self._quiet) == self._size:
            self.armed = self.spread <= self.threshold
        return None


def release(times: npt.ArrayLike, values: npt.ArrayLike, at: int, threshold: float, power: int = 2) -> float:
    """The time (s) of the first sample at which the bob was free, or the last before.

    From rest a pendulum leaves its level with the square of the time, and its angular rate with the time. The moment is that from which
    such a curve follows the values best.

    Parameters
    ----------
    times, values
        Of the rows around the release, in s and the signal's unit, both of shape (row,). Those in the first half of the time before ``at``
        were taken while the bob was held.
    at
        Index at which the release was noticed.
    threshold
        How far from its level the signal was then, in its unit.
    power
        2 of an angle, 1 of an angular rate.
    """
    times, values = np.asarray(times, float), np.asarray(values, float)
    held = values[: max(at // 2, 1)]
    level, floor = float(np.mean(held)), max(4 * float(np.std(held)), threshold / 8)
    away = values - level
    first = at
    while first > 0 and abs(away[first - 1]) > floor:
        first -= 1
    begun = np.linspace(times[at // 2], times[first], _MOMENTS)
    t, away = times[at // 2 :], away[at // 2 :]
    shapes = np.maximum(t - begun[:, None], 0.0) ** power
    sizes = shapes @ away / np.maximum(np.sum(shapes**2, axis=1), 1e-300)
    left = np.sum((away - sizes[:, None] * shapes) ** 2, axis=1)
    return float(times[np.searchsorted(times, begun[np.argmin(left)] - 1e-9)])


def noise(values: npt.ArrayLike) -> float:
    """The standard deviation of the noise, in the unit of the values, by their second differences: slow motion beneath it drops out."""
    values = np.asarray(values, float)
    if len(values) < 8:
        return 0.0
    return float(np.sqrt(np.mean(np.diff(values, 2) ** 2) / 6))
