"""Where model and measurement disagree: score tests by group, in trajectory space, before any effect has a name.

Torques of a general form are pushed through the equations of variation at the fit; what the fit's own parameters can do
is projected out; the share of the residual that each group explains is a chi-square. No noisy data are differentiated.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy.stats import chi2

from .. import effects
from .linear import columns_of, explained

KINDS = {
    "position": "restoring",
    "constant": "constant torque",
    "velocity": "dissipative",
    "time": "time-dependent",
    "sensor": "sensor",
    "line": "spectral line",
    "other": "of no simple kind",
}
_CONSTANT = 0.95  # of what the position explains: a torque that is the same everywhere
_POINTS = 41  # of a curve


@dataclass(frozen=True)
class Group:
    """One group's score test: explained chi-square (noise at the pendulum's frequencies), degrees of freedom, p, share."""

    name: str
    chi_square: float
    freedom: int
    p: float
    share: float


def groups(frame, noise):
    """The ``Group`` of position, its constant part, velocity, time, sensor, spectral line, and any other, in that order.

    ``share`` is the part of the residual beyond the noise that the group explains to first order. The line is the
    strongest of the joint periodogram; its p counts how many were looked at. ``other`` is any reading error that angle,
    velocity and time determine: it asks whether anything is left, not what.
    """
    beyond = max(float(np.sum(frame.residual**2)) - noise.deviation**2 * frame.residual.size, 1e-300)

    def group(name, squares, freedom, p=None):
        statistic = squares / noise.slow_variance
        p = (float(chi2.sf(statistic, freedom)) if freedom else 1.0) if p is None else p(statistic)
        return Group(name, statistic, freedom, p, min(1.0, squares / beyond))

    found = [group(name, *explained(frame, columns)) for name, columns in probes(frame).items()]
    _, squares, looked = line(frame)
    count = 2 * len(frame.swings)
    found.insert(-1, group("line", squares, count, lambda s: float(-np.expm1(looked * np.log1p(-min(chi2.sf(s, count), 1 - 1e-16))))))
    return found


def kind(found):
    """The key of ``KINDS`` for the group that explains most, or None where there are no groups."""
    shares = {group.name: group.share for group in found if group.name not in ("other", "constant")}
    if not shares:
        return None
    best = max(shares, key=shares.get)
    constant = next((group.share for group in found if group.name == "constant"), 0.0)
    return "constant" if best == "position" and constant > _CONSTANT * shares[best] else best


def ranges(frame):
    """The largest angle (rad) and velocity (rad/s) that the fit reaches: the ranges of the free forms."""
    speed = max(float(np.max(np.abs(np.gradient(s, w.times)))) for s, w in zip(frame.fit.angle, frame.swings, strict=True))
    return {"unnamed_position": max(float(np.max(np.abs(series))) for series in frame.fit.angle), "unnamed_velocity": speed}


def free_columns(frame, name):
    """The columns of a free form's coefficients, and their names."""
    effect = effects.effect(name)
    free = [parameter.name for parameter in effect.parameters if not parameter.grid]
    values = dict.fromkeys(free, 0.0) | ({f"{name}_range": ranges(frame)[name]} if name in ranges(frame) else {})
    return columns_of(frame, effect, values, free), free


def probes(frame):
    """The columns of each group's general form, by name."""
    columns = {name: free_columns(frame, f"unnamed_{name}")[0] for name in ("position", "velocity", "time")}
    angle = np.concatenate(frame.fit.angle)
    speed = np.concatenate([np.gradient(s, w.times) for s, w in zip(frame.fit.angle, frame.swings, strict=True)])
    since = np.concatenate([(w.times - w.times[0]) / (w.times[-1] - w.times[0]) for w in frame.swings])
    x, v = angle / np.max(np.abs(angle)), speed / np.max(np.abs(speed))
    sensor = np.column_stack([np.ones_like(x), angle, np.cos(angle), np.sin(angle), speed, np.sign(speed)])
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


def curves(frame, noise):
    """The missing torque over angle, velocity and time, each as if it alone were missing: a table.

    Columns ``over`` (position, velocity, time), ``part`` (torque; over time: drag, stiffness, push), ``x`` (rad, rad/s,
    share of the record), ``torque`` and ``band`` (its standard error, both in rad/s^2; for drag and stiffness the torque
    at the largest velocity and angle).
    """
    reach, tables = ranges(frame), []
    at = np.linspace(-1, 1, _POINTS)
    side, since = np.linspace(0, 1, _POINTS), np.linspace(0, 1, _POINTS)
    position = np.column_stack([at**k for k in (0, *range(2, 8))])
    velocity = np.column_stack([side**k for k in range(6)])
    time = np.column_stack([since**k for k in (1, 2, 3)])
    frequency = frame.fit.model.values["natural_frequency"]
    sizes = {"drag": reach["unnamed_velocity"] / frequency, "stiffness": reach["unnamed_position"], "push": 1.0}
    for over, x, shapes in (
        ("position", at * reach["unnamed_position"], {"torque": (position, slice(None), 1.0)}),
        ("velocity", side * reach["unnamed_velocity"], {"torque": (velocity, slice(None), 1.0)}),
        ("time", since, {part: (time, slice(3 * k, 3 * k + 3), size) for k, (part, size) in enumerate(sizes.items())}),
    ):
        coefficients, covariance = _estimate(frame, free_columns(frame, f"unnamed_{over}")[0], noise)
        for part, (shape, of, size) in shapes.items():
            spread = np.sqrt(np.einsum("ij,jk,ik->i", shape, covariance[of, of], shape))
            table = {"over": over, "part": part, "x": x, "torque": size * (shape @ coefficients[of]), "band": size * spread}
            tables.append(pd.DataFrame(table))
    return pd.concat(tables, ignore_index=True)


def _estimate(frame, columns, noise):
    """Coefficients of the columns beyond the fit, and their covariance under the noise."""
    outside = frame.outside(columns)
    size = np.linalg.norm(outside, axis=0)
    free = size > 1e-3 * np.linalg.norm(columns, axis=0)  # the rest the fit's own terms can do
    coefficients, covariance = np.zeros(size.size), np.zeros((size.size, size.size))
    if free.any():
        left, singular, right = np.linalg.svd(outside[:, free] / size[free], full_matrices=False)
        kept = singular > 1e-3 * singular[0]  # what the data do not determine stays at nothing
        inverse = (right[kept].T / singular[kept]) / size[free, None]
        coefficients[free] = inverse @ (left[:, kept].T @ frame.residual)
        covariance[np.ix_(free, free)] = inverse @ inverse.T * noise.slow_variance
    return coefficients, covariance
