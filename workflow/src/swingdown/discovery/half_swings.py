"""Energy loss, period and mid-point of each half-swing: what a recording shows without any fit, to hold a model against."""

import numpy as np
import pandas as pd

_NEAR = 0.12  # of a half-swing on each side of a turning point, where the angle is a parabola to the noise


def turning_points(times, angle):
    """Times (s) and angles (rad) of the turning points, each from a parabola through the samples around it."""
    middle = angle - np.median(angle)
    side = np.where(middle > 0.15 * np.std(angle), 1, np.where(middle < -0.15 * np.std(angle), -1, 0))
    marks = np.flatnonzero(side)
    changes = marks[np.flatnonzero(np.diff(side[marks]))]
    found = []
    for a, b in zip(changes, changes[1:], strict=False):
        k = a + int(np.argmax(np.abs(middle[a:b])))
        reach = max(3, int(_NEAR * (b - a)))
        rows = slice(max(0, k - reach), min(times.size, k + reach + 1))
        if rows.stop - rows.start < 5:
            continue
        local = times[rows] - times[k]
        c2, c1, c0 = np.polyfit(local, angle[rows], 2)
        if c2 == 0 or abs(c1 / (2 * c2)) > np.ptp(local):
            continue
        found.append((times[k] - c1 / (2 * c2), c0 - c1**2 / (4 * c2)))
    return np.array(found).reshape(-1, 2).T


def half_swings(times, angle, natural_frequency):
    """A table, one row a half-swing: amplitude (rad), loss (share of the potential energy), half-period against that of
    an undamped pendulum of that amplitude (ratio), and mid-point (rad).
    """
    when, where = turning_points(times, angle)
    if when.size < 4:
        return pd.DataFrame(columns=["time_s", "amplitude_rad", "energy_loss", "period_ratio", "midpoint_rad"])
    height = 1 - np.cos(where)
    amplitude = np.abs(np.diff(where)) / 2
    mean, root = np.ones_like(amplitude), np.cos(amplitude / 2)
    for _ in range(6):
        mean, root = (mean + root) / 2, np.sqrt(mean * root)
    return pd.DataFrame(
        {
            "time_s": (when[1:] + when[:-1]) / 2,
            "amplitude_rad": amplitude,
            "energy_loss": -np.diff(height) / height[:-1],
            "period_ratio": np.diff(when) * natural_frequency * mean / np.pi,
            "midpoint_rad": (where[1:] + where[:-1]) / 2,
        }
    )
