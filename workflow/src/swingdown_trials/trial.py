"""Campaigns in which effects are hidden: drawn by number, swung by the second pendulum, written as sheet and CSV files."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from scipy.signal import lfilter

from swingdown import dataset
from swingdown.arrays import Floats
from swingdown.engine.trajectory import TrajectoryError
from swingdown.errors import InputError
from swingdown.fitting.least_squares import fit_jointly
from swingdown.manifest import checksum
from swingdown.measurement.apparatus import Apparatus
from swingdown.paths import write_csv
from swingdown.pendulum.catalogue import SHIPPED, Catalogue
from swingdown.pendulum.effect import Effect, Parameter
from swingdown.pendulum.half_swings import middle_crossings
from swingdown.pendulum.model import BASES, Model

from .coverage import SLOPE, Bench, bench
from .second_pendulum import BELOW_NOISE, Runaway, trajectory
from .torques import FOREIGN, KNOWN

BASE = BASES["sine"]
NOISES = ("white", "coloured", "steps")
_WITHIN = 0.58  # rad, that swings stay within of which a calibrated sensor reads 72 degrees in all
_CROSSINGS = 6  # of the middle, that a swing must make at least
OWN_FREQUENCY = 1e-3  # standard deviation, of swings of a pendulum that was taken down between them
CORRELATION = 0.5  # of neighbouring samples of coloured noise
MEMORY = 0.2  # s, of slow noise, which is in no schedule
STEP = 2.0  # of noise in steps, in units of its whole standard deviation (an encoder's steps and little else)
# one that takes energy away, drives or reads wrongly beside one that does not: pairs of which the data can tell both
PAIRS = (
    ("quadratic_drag", "constant_torque"), ("quadratic_drag", "base_vibration"), ("presliding", "cubic_stiffness"),
    ("constant_coulomb", "clock_drift"), ("eddy_brake", "sensor_zero"), ("stribeck", "cubic_stiffness"),
    ("quadratic_drag", "cubic_stiffness"), ("damping_drift", "detent"), ("structural_damping", "backlash"),
    ("steady_wind", "clock_drift"), ("flexible_pivot", "constant_torque"), ("power_law_drag", "sensor_lag"),
)  # fmt: skip


class Design(NamedTuple):
    """How a campaign was recorded: the number of swings, of so many seconds at so many samples a second, between which angles (rad) their
    amplitudes are spread (the largest is drawn between two), what pulls back, what the sensor reads, and whether the bearing rubs."""

    swings: int = 6
    duration: float = 20.0
    rate: float = 100.0
    smallest: float = 0.3
    largest: tuple[float, float] = (0.8, 1.05)
    restoring: str = "sine"
    reading: str = "angle"
    rubs: bool = True

    @property
    def base(self) -> tuple[str, ...]:
        """What damps every pendulum of this design: friction goes with the load where a weight pulls back."""
        if not self.rubs:
            return ("viscous",)
        return BASE if self.restoring == "sine" else ("viscous", "constant_coulomb")


USUAL = Design()


@dataclass(frozen=True)
class Trial:
    """What is hidden in one campaign: the effects beside the ``design``'s base, all values, each swing's release and own values, the noise.

    ``kind`` is ``single``, ``pair``, ``null``, ``own`` (nothing is hidden, but each swing has its own natural frequency),
    ``calibrated`` (nothing is hidden, but the recordings are in volts, and their calibration is as wrong as it says it may be), ``removed`` (the effect is then taken out of the catalogue) or ``foreign``
    (it never was in it); ``ratio`` the residual of the base model's fit that was asked for and ``reached`` the one that
    came out, in units of the noise (rad) ``sigma``. ``beside`` names what is there besides and has no name, and leaves ``misfit`` times
    the noise.
    """

    name: str
    kind: str
    hidden: tuple[str, ...]
    ratio: float
    noise: str
    sigma: float
    values: dict[str, float]
    releases: tuple[tuple[float, float], ...]
    own: tuple[dict[str, float], ...] = ()
    reached: float = 1.0
    design: Design = USUAL
    beside: tuple[str, ...] = ()
    misfit: float = 0.0


class Planned(NamedTuple):
    """One trial to draw: kind, hidden effects, ratio of the base model's residual to the noise, noise, and number."""

    kind: str
    hidden: tuple[str, ...]
    ratio: float
    noise: str
    number: int


def hideable(catalogue: Catalogue, design: Design = USUAL) -> tuple[str, ...]:
    """The names of the effects that can be hidden beside a design's base: all others that the second pendulum knows and that make
    sense with what pulls back."""
    others = (e for e in catalogue.of(design.reading) if e.name not in design.base and _known(e))
    return tuple(e.name for e in others if e.beside in ("", design.restoring))


def _known(effect: Effect) -> bool:
    return effect.name in KNOWN or effect.twin is not None


def draw(seed: int, one: Planned, catalogue: Catalogue = SHIPPED, design: Design = USUAL) -> Trial:
    """The ``Trial`` of that seed, plan and design: always the same one.

    Sizes are found with the engine's fits of the base model to the noiseless swings; the swings themselves never see it.

    Parameters
    ----------
    seed
        Of all draws.
    one
        What is planned: which effects are hidden, and how much they are to leave.
    catalogue
        The effects that may be named.
    design
        Releases, lengths, rate and noise.

    Raises
    ------
    ArithmeticError
        If no size within reason leaves such a residual.
    InputError
        For an effect that the second pendulum does not know.
    """
    kind, hidden, ratio, noise, number = one
    words = [*(ord(letter) for letter in "+".join((kind, *hidden, noise))), round(100 * ratio), number]
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=words))
    values = {
        "natural_frequency": rng.uniform(5.0, 9.0),
        "viscous_ratio": rng.uniform(0.004, 0.012),
        "load_friction": rng.uniform(0.001, 0.004),
    }
    if design.restoring == "linear":
        values["constant_friction"] = values.pop("load_friction") * values["natural_frequency"] ** 2
    sigma = rng.uniform(1e-3, 3e-3)
    largest = np.linspace(design.smallest, rng.uniform(*design.largest), design.swings)
    largest *= rng.uniform(0.95, 1.05, design.swings)
    if kind == "calibrated":
        largest *= _WITHIN / np.max(largest)
    velocities = rng.normal(0, 0.05, design.swings) * (0 if kind == "calibrated" else 1)
    releases = tuple(
        (float(a * (-1) ** k), float(v)) for k, (a, v) in enumerate(zip(largest, velocities, strict=True))
    )
    own: list[dict[str, float]] = [{} for _ in range(design.swings)]
    if kind == "own":
        shifts = OWN_FREQUENCY * rng.standard_normal(design.swings)
        own = [{"natural_frequency": values["natural_frequency"] * (1 + float(shift))} for shift in shifts]
    for name in hidden:
        _draw_shape(rng, name, catalogue, values, own)
    signs = {name: rng.choice((-1.0, 1.0)) if _signed(name, catalogue) else 1.0 for name in hidden}
    label = "+".join(hidden) or "null"
    called = f"{kind}-{label}-{ratio:g}-{noise}-{number}".replace("+", "-and-")
    trial = Trial(called, kind, hidden, ratio, noise, sigma, values, releases, tuple(own), design=design)
    for name in hidden:  # each alone to its share, as if the others were not there
        trial = _sized(trial, name, signs[name], catalogue)
    return trial


def with_misfit(trial: Trial, seed: int, misfit: float) -> Trial:
    """The trial with a little of what no catalogue has, drawn from ``FOREIGN``, that leaves ``misfit`` times the noise; each swing has a
    natural frequency of its own, which moves its end by half of that. ArithmeticError where nothing that is drawn acts on these swings."""
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=[*map(ord, trial.name), 2]))
    names = [str(one) for one in rng.permutation([one for one in FOREIGN if one not in trial.hidden])]
    own = []
    for one, (angle, _) in zip(trial.own, trial.releases, strict=True):
        frequency = one.get("natural_frequency", trial.values["natural_frequency"])
        away = misfit * trial.sigma / (abs(angle) * trial.design.duration) * rng.standard_normal()
        own.append(one | {"natural_frequency": frequency + float(away) / 2})
    for name in names:
        values, each = dict(trial.values), [dict(one) for one in own]
        _draw_shape(rng, name, SHIPPED, values, each)
        alone = replace(trial, values=values, own=tuple(each), ratio=float(np.hypot(1, misfit)))
        try:
            sized = _sized(alone, name, 1.0, SHIPPED)
        except ArithmeticError:  # a stop that these swings never reach, say
            continue
        return replace(sized, ratio=trial.ratio, reached=trial.reached, beside=(name,), misfit=misfit)
    raise ArithmeticError(f"no misfit of {misfit:g} times the noise can be drawn for {trial.name}")


def _draw_shape(
    rng: np.random.Generator, name: str, catalogue: Catalogue, values: dict[str, float], own: Sequence[dict[str, float]]
) -> None:  # fmt: skip
    """Draw all that an effect has beside its size into ``values``, or into each swing's ``own``."""
    if name in FOREIGN:
        for parameter, among in FOREIGN[name].drawn.items():
            values[parameter] = _drawn(rng, among)
        for parameter, (other, distance) in FOREIGN[name].beyond.items():
            values[parameter] = values[other] + distance
        return
    for parameter in catalogue[name].parameters:
        if parameter == catalogue[name].size or parameter.role == "start":
            continue
        if parameter.each:
            for one in own:
                one[parameter.name] = float(rng.uniform(-np.pi, np.pi))
        elif parameter.role == "phase":
            values[parameter.name] = float(rng.uniform(-np.pi, np.pi))
        else:
            values[parameter.name] = _drawn(rng, parameter.drawn or _usual(parameter))


def _usual(parameter: Parameter) -> tuple[float, float]:
    """Where a parameter is drawn that says nothing of it: between its starts, or about its typical size."""
    among = parameter.starts or (parameter.typical / 2, 2 * parameter.typical)
    return min(among), max(among)


def _drawn(rng: np.random.Generator, among: Sequence[Any]) -> float:
    if isinstance(among[0], tuple):
        return float(rng.uniform(*among[int(rng.integers(len(among)))]))
    return float(rng.choice(among)) if len(among) > 2 else float(rng.uniform(*among))


def _size(name: str, catalogue: Catalogue) -> tuple[str, float, float]:
    """The name of the parameter that sizes an effect, its usual size, and the largest that a trial may have."""
    if name in FOREIGN:
        return FOREIGN[name].parameters[0], FOREIGN[name].typical, np.inf
    size = catalogue[name].size
    if size is None:
        raise InputError(f"effect {name!r}", "it has no size, so none can be drawn", "an effect with one")
    return size.name, size.typical, size.largest


def _signed(name: str, catalogue: Catalogue) -> bool:
    if name in FOREIGN:
        return False
    size = catalogue[name].size
    return size is not None and size.lower < 0


def _sized(trial: Trial, name: str, sign: float, catalogue: Catalogue) -> Trial:
    """The trial with the effect's size such that the base model, fitted to it alone without noise, leaves what it should."""
    if name not in FOREIGN:
        check_known([name], catalogue)
    target, asked = trial.sigma * np.sqrt(trial.ratio**2 - 1), f"{trial.ratio} times the noise"
    parameter, typical, largest = _size(name, catalogue)
    low, high, size = 0.0, np.inf, typical / 3
    for _ in range(14):
        one = replace(trial, values=trial.values | {parameter: float(sign * size)})
        try:
            left = left_by_base(one, (name,), catalogue)
        except (Runaway, TrajectoryError, InputError):
            left = np.inf
        if abs(left / target - 1) < 0.08 or (high < np.inf and high - low < 1e-3 * high):
            break
        low, high = (size, high) if left < target else (low, size)
        step = np.clip(target / left if left > 0 else 8.0, 0.15, 8.0)
        size = size * step if low < size * step < high else (low + high) / 2 if high < np.inf else 2 * size
        if size > largest:
            raise ArithmeticError(f"{name} would have to be beyond {largest} to leave {asked}")
    if not 0.5 < left / target < 2:
        raise ArithmeticError(f"{name}: no size leaves {asked} (nearest {left / target:.2g} of it)")
    reached = float(np.sqrt(trial.reached**2 + (left / trial.sigma) ** 2))
    return replace(trial, values=one.values, reached=reached)


def check_known(names: Iterable[str], catalogue: Catalogue) -> None:
    """Raise InputError for an effect that the second pendulum, which trials are made with, does not know."""
    if unknown := [name for name in names if not _known(catalogue[name])]:
        raise InputError(
            f"effect {unknown[0]!r}", "the second pendulum, which trials are made with, does not know it",
            ", ".join(e.name for e in catalogue if _known(e)), "give its entry a twin (CONTRIBUTING.md), or leave it out of the trials",
        )  # fmt: skip


def left_by_base(trial: Trial, hidden: Sequence[str], catalogue: Catalogue) -> float:
    """RMS (rad) that the base model leaves of every second swing, sampled at a third of the rate, without noise."""
    design = trial.design
    times = np.arange(0, design.duration, 3 / design.rate)
    pairs = [(times, _swing(trial, hidden, k, times, catalogue)) for k in range(0, design.swings, 2)]
    if any(middle_crossings(*pair)[0].size < _CROSSINGS for pair in pairs):
        raise Runaway("it stops before it has swung, which no import takes for a swing")
    model = Model(design.base, restoring=design.restoring).of(design.reading)
    return fit_jointly(model, pairs, bounded=True).rms


def _swing(trial: Trial, hidden: Sequence[str], k: int, times: Floats, catalogue: Catalogue) -> Floats:
    values, twins = trial.values | trial.own[k], {e.name: e.twin for e in catalogue if e.twin}
    design = trial.design
    return trajectory(
        (*design.base, *hidden), values, times, *trial.releases[k], restoring=design.restoring, twins=twins,
        reading=design.reading, accuracy=BELOW_NOISE,
    ).reading  # fmt: skip


def bench_of(trial: Trial, seed: int, apparatus: Apparatus) -> Bench:
    """The sensor of a ``calibrated`` trial with its calibration."""
    return bench(apparatus, [seed, *map(ord, trial.name)])


def swings(
    trial: Trial, seed: int, catalogue: Catalogue = SHIPPED, sensor: Bench | None = None
) -> list[tuple[Floats, Floats]]:
    """The trial's swings with noise: a list of (times in s, angles in rad; of a calibrated ``sensor`` V)."""
    return [(times, clean + noise) for times, clean, noise in _apart(trial, seed, catalogue, sensor)]


def _apart(
    trial: Trial, seed: int, catalogue: Catalogue, sensor: Bench | None
) -> Iterator[tuple[Floats, Floats, Floats]]:
    """The trial's swings, each as its times (s), what the sensor would read without noise, and the noise (rad; of a sensor V)."""
    times = np.arange(round(trial.design.duration * trial.design.rate) + 1) / trial.design.rate
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=[*map(ord, trial.name), 1]))
    sigma = trial.sigma / (SLOPE if sensor else 1.0)
    for k in range(trial.design.swings):
        clean = _swing(trial, (*trial.hidden, *trial.beside), k, times, catalogue)
        clean = clean if sensor is None else sensor.volts(clean)
        white = rng.standard_normal(times.size + 100)
        if correlation := _correlation(trial):
            new = np.sqrt(1 - correlation**2)
            white, _ = lfilter([new], [1, -correlation], white, zi=[(1 - new) * white[0]])
        noise = sigma * white[100:]
        if trial.noise == "steps":  # rounding adds step / sqrt 12 to what the sensor itself has
            step = STEP * sigma
            noise = step * np.round((clean + noise * np.sqrt(1 - STEP**2 / 12)) / step) - clean
        yield times, clean, noise


def _correlation(trial: Trial) -> float:
    """That of neighbouring samples of a trial's noise."""
    slow = float(np.exp(-1 / (MEMORY * trial.design.rate)))
    return {"coloured": CORRELATION, "slow": slow}.get(trial.noise, 0.0)


def write_trial(
    trial: Trial,
    seed: int,
    name: str,
    folder: Path | str,
    catalogue: Catalogue = SHIPPED,
    apparatus: Apparatus | None = None,
) -> tuple[list[dict[str, str]], dict[str, Any]]:
    """(rows of a sample sheet, truth): the trial's CSV files written to ``folder`` under a name that tells nothing of it.

    The truth is the ``Trial`` as a dict, with the noise's RMS in each swing (rad) and the samples of each. A ``calibrated`` one needs
    the ``apparatus`` that its sensor is calibrated with, and has its calibration written beside the swings (``calibration_of``).
    """
    rows, noise, sensor = [], [], None
    if trial.kind == "calibrated":
        if apparatus is None:
            problem = "its sensor has no apparatus to be calibrated with"
            raise InputError(f"trial {trial.name}", problem, "an apparatus sheet")
        sensor = bench_of(trial, seed, apparatus)
        sensor.calibration.attrs["campaigns"] = name
        dataset.write(sensor.calibration, calibration_of(folder, name))
    column = "encoder_V" if sensor else "theta_rad"
    for k, (times, clean, away) in enumerate(_apart(trial, seed, catalogue, sensor), 1):
        path = Path(folder) / f"{name}-{k}.csv"
        write_csv(pd.DataFrame({"t_s": times, column: clean + away}), path, float_format="%.7g")
        row = {"recording": f"{name}-{k}", "campaign": name, "file": str(path.resolve())}
        rows.append(row | {"sha256": checksum(path)} | ({"signal_unit": "V"} if sensor else {}))
        noise.append(float(np.sqrt(np.mean(away**2))) * (SLOPE if sensor else 1.0))
    return rows, asdict(trial) | {"noise_rms_rad": noise, "samples": times.size}


def calibration_of(folder: Path | str, name: str) -> Path:
    """Where the calibration of a campaign in volts lies, beside its swings."""
    return Path(folder) / f"{name}-calibration.nc"
