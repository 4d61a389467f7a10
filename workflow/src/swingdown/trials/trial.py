"""Campaigns in which effects are hidden: drawn by number, swung by the second pendulum, written as sheet and CSV files."""

from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.signal import lfilter

from ..engine.trajectory import TrajectoryError
from ..errors import InputError
from ..fitting.fit import fit_jointly
from ..pendulum.catalogue import effect
from .second_pendulum import FOREIGN, Runaway, trajectory

BASE = ("viscous", "load_coulomb")
NOISES = ("white", "coloured", "steps")
SWINGS, DURATION, RATE = 6, 20.0, 100.0  # each campaign's; s, samples a second
CORRELATION = 0.5  # of neighbouring samples of coloured noise
STEP = 2.0  # of noise in steps, in units of its whole standard deviation (an encoder's steps and little else)
# where the effects' other parameters are drawn (their first one sets the size); a phase is drawn from the whole turn
SHAPES = {
    "stribeck_velocity": (0.05, 0.5),
    "presliding_angle": (0.002, 0.02),
    "power_law_exponent": ((1.3, 1.7), (2.4, 3.2)),
    "eddy_width": (0.06, 0.3),
    "detent_order": (4, 5, 6, 8, 12, 16),
    "pivot_frequency": (14.0, 45.0),
    "pivot_damping_ratio": (0.02, 0.2),
    "vibration_frequency": ((0.3, 0.55), (1.8, 6.0)),  # not the pendulum's own
    "wind_speed": ((-1.5, -0.2), (0.2, 1.5)),
    "patch_from": (-0.1, 0.1),
    "stop_from": (0.15, 0.35),
}
SINGLES = (
    "quadratic_drag", "constant_coulomb", "stribeck", "presliding", "power_law_drag", "structural_damping", "added_mass",
    "eddy_brake", "constant_torque", "torsion_spring", "cubic_stiffness", "detent", "flexible_pivot", "base_vibration",
    "damping_drift", "steady_wind", "backlash", "sensor_lag", "eccentricity", "sensor_gain", "sensor_zero", "clock_drift",
)  # fmt: skip
# one that takes energy away, drives or reads wrongly beside one that does not: pairs of which the data can tell both
PAIRS = (
    ("quadratic_drag", "constant_torque"), ("quadratic_drag", "base_vibration"), ("presliding", "cubic_stiffness"),
    ("constant_coulomb", "clock_drift"), ("eddy_brake", "sensor_zero"), ("stribeck", "cubic_stiffness"),
    ("quadratic_drag", "cubic_stiffness"), ("damping_drift", "detent"), ("structural_damping", "backlash"),
    ("steady_wind", "clock_drift"), ("flexible_pivot", "constant_torque"), ("power_law_drag", "sensor_lag"),
)  # fmt: skip
_LARGEST = {
    "sensor_gain": 0.3,
    "pivot_mass_ratio": 0.4,
    "eccentricity": 0.3,
    "clock_drift": 0.05,
    "backlash_width": 0.2,
}


@dataclass(frozen=True)
class Trial:
    """What is hidden in one campaign: the effects beside ``BASE``, all values, each swing's release and own values, the noise.

    ``kind`` is ``single``, ``pair``, ``null``, ``removed`` (the effect is then taken out of the catalogue) or ``foreign``
    (it never was in it); ``ratio`` the residual of the base model's fit that was asked for and ``reached`` the one that
    came out, in units of the noise (rad) ``sigma``.
    """

    name: str
    kind: str
    hidden: tuple
    ratio: float
    noise: str
    sigma: float
    values: dict
    releases: tuple
    own: tuple = ()
    reached: float = field(default=1.0)


def draw(seed, kind, hidden=(), ratio=1.0, noise="white", number=0):
    """The ``Trial`` of that seed, kind, hidden effects, size, noise and number: always the same one.

    Sizes are found with the engine's fits of the base model to the noiseless swings; the swings themselves never see it.
    ArithmeticError where no size within reason leaves such a residual.
    """
    hidden = (hidden,) if isinstance(hidden, str) else tuple(hidden)
    words = [*(ord(letter) for letter in "+".join((kind, *hidden, noise))), round(100 * ratio), number]
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=words))
    values = {
        "natural_frequency": rng.uniform(5.0, 9.0),
        "viscous_ratio": rng.uniform(0.004, 0.012),
        "load_friction": rng.uniform(0.001, 0.004),
    }
    sigma = rng.uniform(1e-3, 3e-3)
    largest = np.linspace(0.3, rng.uniform(0.8, 1.05), SWINGS) * rng.uniform(0.95, 1.05, SWINGS)
    releases = tuple(
        (float(a * (-1) ** k), float(v))
        for k, (a, v) in enumerate(zip(largest, rng.normal(0, 0.05, SWINGS), strict=True))
    )
    own = [{} for _ in range(SWINGS)]
    for name in hidden:
        for parameter, phase in _shape(name):
            if phase == "own":
                for one in own:
                    one[parameter] = float(rng.uniform(-np.pi, np.pi))
            else:
                values[parameter] = (
                    float(rng.uniform(-np.pi, np.pi)) if phase else _drawn(rng, SHAPES[parameter])
                )
    if "friction_patch" in hidden:
        values["patch_to"] = values["patch_from"] + 0.15
    signs = {name: rng.choice((-1.0, 1.0)) if _signed(name) else 1.0 for name in hidden}
    label = "+".join(hidden) or "null"
    trial = Trial(
        f"{kind}-{label}-{ratio:g}-{noise}-{number}".replace("+", "-and-"),
        kind,
        hidden,
        ratio,
        noise,
        sigma,
        values,
        releases,
        tuple(own),
    )
    for name in hidden:  # each alone to its share, as if the others were not there
        trial = _sized(trial, name, signs[name])
    return trial


def _shape(name):
    if name in FOREIGN:
        return [(parameter, None) for parameter in FOREIGN[name][1:] if parameter in SHAPES]
    return [(p.name, "own" if p.own else "phase" if p.phase else None) for p in effect(name).parameters[1:]]


def _drawn(rng, among):
    if isinstance(among[0], tuple):
        return float(rng.uniform(*among[rng.integers(len(among))]))
    return float(rng.choice(among)) if len(among) > 2 else float(rng.uniform(*among))


def _size_name(name):
    return FOREIGN[name][0] if name in FOREIGN else effect(name).parameters[0].name


def _signed(name):
    return name not in FOREIGN and effect(name).parameters[0].lower < 0


def _sized(trial, name, sign):
    """The trial with the effect's size such that the base model, fitted to it alone without noise, leaves what it should."""
    target = trial.sigma * np.sqrt(trial.ratio**2 - 1)
    parameter = _size_name(name)
    typical = 0.1 if name in FOREIGN else effect(name).parameters[0].typical
    if name == "soft_stop":
        typical = 5.0
    low, high, size = 0.0, np.inf, typical / 3
    for _ in range(14):
        one = Trial(**asdict(trial) | {"values": trial.values | {parameter: float(sign * size)}})
        try:
            left = _left_by_base(one, (name,))
        except (Runaway, TrajectoryError, InputError):
            left = np.inf
        if abs(left / target - 1) < 0.08 or (high < np.inf and high - low < 1e-3 * high):
            break
        low, high = (size, high) if left < target else (low, size)
        step = np.clip(target / left if left > 0 else 8.0, 0.15, 8.0)
        size = size * step if low < size * step < high else (low + high) / 2 if high < np.inf else 2 * size
        if size > _LARGEST.get(parameter, np.inf):
            raise ArithmeticError(
                f"{name} would have to be beyond {_LARGEST[parameter]} to leave {trial.ratio} times the noise"
            )
    if not 0.5 < left / target < 2:
        raise ArithmeticError(
            f"{name}: no size leaves {trial.ratio} times the noise (nearest {left / target:.2g} of it)"
        )
    reached = float(np.sqrt(trial.reached**2 + (left / trial.sigma) ** 2))
    return Trial(**asdict(trial) | {"values": one.values, "reached": reached})


def _left_by_base(trial, hidden):
    """RMS (rad) that the base model leaves of every second swing, sampled at a third of the rate, without noise."""
    times = np.arange(0, DURATION, 3 / RATE)
    pairs = [(times, _swing(trial, hidden, k, times)) for k in range(0, SWINGS, 2)]
    return fit_jointly(BASE, pairs, bounded=True).rms


def _swing(trial, hidden, k, times):
    angle, velocity = trial.releases[k]
    values = trial.values | trial.own[k]
    return trajectory((*BASE, *hidden), values, times, angle, velocity).reading


def swings(trial, seed):
    """The trial's swings with noise: a list of (times in s, angles in rad)."""
    times = np.arange(round(DURATION * RATE) + 1) / RATE
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=[*map(ord, trial.name), 1]))
    found = []
    for k in range(SWINGS):
        clean = _swing(trial, trial.hidden, k, times)
        white = rng.standard_normal(times.size + 100)
        if trial.noise == "coloured":
            white = lfilter([np.sqrt(1 - CORRELATION**2)], [1, -CORRELATION], white)
        noise = trial.sigma * white[100:]
        if trial.noise == "steps":  # rounding adds step / sqrt 12 to what the sensor itself has
            step = STEP * trial.sigma
            read = clean + noise * np.sqrt(1 - STEP**2 / 12)
            found.append((times, step * np.round(read / step)))
        else:
            found.append((times, clean + noise))
    return found


def write_trial(trial, seed, name, folder):
    """(rows of a sample sheet, truth): the trial's CSV files written to ``folder`` under a name that tells nothing of it.

    The truth is the ``Trial`` as a dict, with the noise's RMS in each swing (rad) and the samples of each.
    """
    rows, noise = [], []
    for k, (times, angle) in enumerate(swings(trial, seed), 1):
        path = Path(folder) / f"{name}-{k}.csv"
        pd.DataFrame({"t_s": times, "theta_rad": angle}).to_csv(path, index=False, float_format="%.7g")
        rows.append({"recording": f"{name}-{k}", "campaign": name, "file": str(path.resolve())})
        noise.append(float(np.sqrt(np.mean((angle - _swing(trial, trial.hidden, k - 1, times)) ** 2))))
    return rows, asdict(trial) | {"noise_rms_rad": noise, "samples": times.size}
