"""How often stated 95 % intervals hold the truth: calibrations and swings by the thousand, each known to the last digit.

Every draw is a measurement from its beginning: an apparatus whose lengths were measured within their limits, towers and rest
read by an encoder with an error inside the manual's limit (a gain and a curvature), a clock within a quartz's tolerance, and
swings of the second pendulum, which shares no code with the engine, under noise of some colour. The project's own chain then
calibrates, fits and states its intervals.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from scipy.signal import lfilter
from scipy.special import stdtrit

from swingdown.arrays import Floats, Swing
from swingdown.calibration import from_means
from swingdown.calibration.geometry import arm_angle
from swingdown.calibration.layout import Read
from swingdown.engine.trajectory import checked_times, sensitivities
from swingdown.fitting.least_squares import fit_jointly
from swingdown.fitting.problem import RELEASE
from swingdown.fitting.result import Fit
from swingdown.fitting.slack import allowing
from swingdown.fitting.uncertainty import Uncertainty, uncertainty
from swingdown.measurement.angle import to_angle
from swingdown.measurement.apparatus import Apparatus, encoder_limit
from swingdown.measurement.slack import CLOCK_TOLERANCE, of_angles
from swingdown.measurement.uncertainty import Mean, mean_of_samples
from swingdown.pendulum.model import Model
from swingdown.studies.quantities import Quantity, quantities

from .second_pendulum import trajectory

STATED = 0.95
COVERAGE = 1.959963984540054  # standard uncertainties to either side
TRUTH = Model(
    ("quadratic_drag", "load_coulomb"),
    {"natural_frequency": 7.25, "quadratic_coefficient": 0.0012, "load_friction": 0.0018},
)
SLOPE, ZERO = 0.12566, 5.0  # rad/V, V
NOISE, STEP = 0.004, 0.008  # V: half a milliradian, and an encoder's steps of one
# s recorded; s that are fitted, the rest is foretold; samples a second
DURATION, FITTED, RATE = 20.0, 15.0, 50.0
AMPLITUDES = (0.3, 0.4, 0.5, 0.6)  # rad
AT = 0.3  # rad: the amplitude at which period, quality and decay time are asked for
_STILL = 300  # samples on each tower
_DRAWS = 500  # of a calibration's Monte Carlo


@dataclass(frozen=True)
class Case:
    """What is drawn: the noise's kind and correlation, and how many swings are fitted together."""

    noise: str
    correlation: float
    swings: int

    @property
    def words(self) -> str:
        """The case as a table tells it."""
        return f"{'one swing' if self.swings == 1 else f'{self.swings} swings together'}, {self.noise}"


CASES = {
    "white": Case("white noise", 0.0, 1),
    "ar5": Case("coloured noise (AR .5)", 0.5, 1),
    "ar9": Case("coloured noise (AR .9)", 0.9, 1),
    "steps": Case("noise in steps", 0.0, 1),
    "together": Case("white noise", 0.0, len(AMPLITUDES)),
}


@dataclass(frozen=True)
class Bench:
    """One draw of a calibrated bench: its calibration, and the voltage (V) that its encoder gives for angles (rad)."""

    calibration: xr.Dataset
    volts: Callable[[Any], Floats]


def bench(apparatus: Apparatus, seed: Sequence[int], smooth: bool = True) -> Bench:
    """The ``Bench`` of that seed: the sheet's lengths are taken for the true ones, and measured with errors in their limits.

    The encoder's error is a gain and a bend, as a swing meets it, or where not ``smooth`` another one at every voltage, anywhere
    within the manual's limit.
    """
    rng = np.random.default_rng([*seed, 1])
    gain, bend = rng.uniform(-0.5, 0.5, 2)
    limit = apparatus["encoder"]["limits"][0]["limit"]

    def volts(angle: Any) -> Floats:
        away = np.asarray(angle, dtype=float) / SLOPE
        if smooth:
            return ZERO + away + limit * (gain * away / ZERO + bend * (away / ZERO) ** 2)
        return ZERO + away + encoder_limit(apparatus, ZERO + away) * rng.uniform(-1, 1, away.shape)

    def off(entry: Any, key: str) -> Any:
        return entry | {key: entry[key] + rng.uniform(-entry["limit"], entry["limit"])}

    names: tuple[Any, ...] = ("over_shaft", "shaft_diameter", "bob_diameter", "arm")
    over_shaft, shaft, bob, arm = (apparatus["lengths"][name]["value"] for name in names)
    heights = np.array([point["height"] for point in apparatus["points"]])
    measured: Any = apparatus.copy()
    measured["lengths"] = {name: off(entry, "value") for name, entry in apparatus["lengths"].items()}
    measured["points"] = [off(point, "height") for point in apparatus["points"]]

    def read(volts: float) -> Mean:
        return mean_of_samples(volts + NOISE * rng.standard_normal(_STILL))

    angles = np.asarray(arm_angle(over_shaft, shaft, bob, arm, heights))
    towers = [read(float(one)) for one in volts(angles)]
    # errors are counted from there
    rest = read(ZERO + float(rng.uniform(-1, 1)) * apparatus["rest"]["limit"] / SLOPE)
    calibration, _ = from_means(measured, Read(towers, rest, NOISE), _DRAWS, seed[0])
    calibration.attrs |= {"emulated": "yes", "mode": "gum"}
    return Bench(calibration, volts)


def calibrations(apparatus: Apparatus, count: int, seed: int) -> pd.DataFrame:
    """The coverage of calibrations: a row for the line's slope and zero and for an angle in each mode; columns as ``table``."""
    held: dict[str, list[bool]] = {}
    for number in range(count):
        one = bench(apparatus, [seed, number], smooth=False)
        line, rng = one.calibration.sel(mode="gum"), np.random.default_rng([seed, number, 2])
        factor = float(line["coverage_factor"])
        slope, u_slope = line["line"].sel(coefficient="slope"), np.sqrt(line["line_covariance"][1, 1])
        for name, truth, value, error in (
            ("slope of the line", SLOPE, slope, u_slope),
            ("rest voltage", ZERO, line["rest_voltage"], line["rest_voltage_uncertainty"]),
        ):
            held.setdefault(name, []).append(bool(abs(float(value) - truth) <= factor * float(error)))
        angle = rng.uniform(-AMPLITUDES[-1], AMPLITUDES[-1])
        volts = one.volts(np.full(1, angle)) + NOISE * rng.standard_normal(1)
        for mode in map(str, one.calibration["mode"].values):
            found = to_angle(_recording(np.zeros(1), volts), one.calibration, mode)
            inside = abs(float(found["angle"][0]) - angle) <= float(found["angle_bound"][0])
            held.setdefault(f"angle of a sample, mode {mode}", []).append(inside)
    return table("calibrations", held)


def swings(apparatus: Apparatus, case: Case, count: int, seed: int) -> pd.DataFrame:
    """The coverage of fitted values in a ``Case``: parameters, period, quality, decay time, and the part of the swing that was
    not fitted; columns as ``table``."""
    truths = _truths()
    asked = {name: one.value for name, one in quantities(TRUTH, AT).items()}
    held: dict[str, list[bool]] = {}
    for number in range(count):
        one = bench(apparatus, [seed, number, 3])
        rng = np.random.default_rng([seed, number, 4])
        clock = 1 + rng.uniform(-CLOCK_TOLERANCE, CLOCK_TOLERANCE)
        chosen = range(len(AMPLITUDES)) if case.swings > 1 else [number % len(AMPLITUDES)]
        times, clean = truths[0] * clock, [truths[1][k] for k in chosen]
        read = (_recording(times, _read(one, angle, case, rng)) for angle in clean)
        angles = [to_angle(recording, one.calibration) for recording in read]
        fit, known = _fitted(angles, times)
        for name, truth, value, half in _stated(fit, known, asked):
            held.setdefault(name, []).append(bool(abs(value - truth) <= half))
        foretold, spread = predict_reading(fit, known, times)
        line = one.calibration.sel(mode="gum")
        away = one.volts(clean[0]) - float(line["rest_voltage"])
        reading = float(line["line"].sel(coefficient="slope")) * away
        at = int(rng.integers(round(FITTED * RATE), times.size))
        inside = bool(abs(foretold[at] - reading[at]) <= _factor(known) * spread[at])
        held.setdefault("held-out end", []).append(inside)
    return table(case.words, held)


def table(case: str, held: dict[str, list[bool]]) -> pd.DataFrame:
    """A row for each quantity: case, quantity, stated, n, inside, share, low, high (Wilson's 95 % limits of the share)."""
    rows = []
    for name, inside in held.items():
        n, share = len(inside), float(np.mean(inside))
        middle = (share + COVERAGE**2 / (2 * n)) / (1 + COVERAGE**2 / n)
        half = COVERAGE / (1 + COVERAGE**2 / n) * np.sqrt(share * (1 - share) / n + (COVERAGE / (2 * n)) ** 2)
        rows.append(
            {"case": case, "quantity": name, "stated": STATED, "n": n, "inside": int(np.sum(inside)), "share": share,
             "low": middle - half, "high": middle + half}
        )  # fmt: skip
    return pd.DataFrame(rows)


def _truths() -> tuple[Floats, list[Floats]]:
    """Times (s) and the angles (rad) of the second pendulum's swings."""
    times = np.arange(round(DURATION * RATE)) / RATE
    return times, [
        trajectory(TRUTH.names, TRUTH.values, times, amplitude).reading for amplitude in AMPLITUDES
    ]


def _read(one: Bench, angle: Floats, case: Case, rng: np.random.Generator) -> Floats:
    """The voltages of a swing with noise, and in steps where the case has them."""
    white = rng.standard_normal(angle.size + 200)
    noise = lfilter([np.sqrt(1 - case.correlation**2)], [1, -case.correlation], white)[200:]
    if "steps" not in case.noise:
        return one.volts(angle) + NOISE * noise
    offset = rng.uniform(0, STEP)
    return STEP * np.round((one.volts(angle) + NOISE / 2 * noise - offset) / STEP) + offset


def _recording(times: Floats, volts: Floats) -> xr.Dataset:
    attrs = dict.fromkeys(("recording", "role", "file", "sha256", "source"), "")
    attrs |= {"campaign": "bench", "emulated": "yes"}
    return xr.Dataset({"signal": ("time", volts, {"units": "V"})}, {"time": times}, attrs)


def _fitted(angles: Sequence[xr.Dataset], times: Floats) -> tuple[Fit, Uncertainty]:
    """The fit of the first part of each swing, and its uncertainty, as the experiment study makes them."""
    part = slice(0, round(FITTED * RATE))
    pairs: list[Swing] = [(times[part], angle["angle"].values[part]) for angle in angles]
    fit = allowing(fit_jointly(TRUTH, pairs, guess=TRUTH, seen=False, grown=False), pairs, of_angles(angles))
    return fit, uncertainty(fit, pairs)


def predict_reading(fit: Fit, known: Uncertainty, times: Any, swing: int = 0) -> tuple[Floats, Floats]:
    """The reading (rad) of a fitted swing and its standard uncertainty, both of the shape of ``times``, without a sample's noise.

    Parameters
    ----------
    fit, known
        The fit and the ``Uncertainty`` of its values.
    times
        In s; the first is that of the swing's release. The same clock is taken to go on.
    swing
        Which of the fitted swings.
    """
    times = checked_times(times)
    one = fit.swings[swing]
    own = [*one.own, *(RELEASE if RELEASE[0] in fit.free else ())]
    shared = len(fit.free) - len(own) * len(fit.swings)
    where = np.r_[:shared, shared + swing * len(own) : shared + (swing + 1) * len(own)]
    release = one.release_angle, one.release_velocity
    series, slopes = sensitivities(one.model, times, *release, free=[fit.free[i] for i in where])
    systematic = known.systematic[where][:, :-1]  # all but the clock
    covariance = known.random[np.ix_(where, where)] + systematic @ systematic.T
    held = ~np.isfinite(np.diag(covariance))
    slopes, covariance = slopes[~held], covariance[np.ix_(~held, ~held)]
    return series, np.sqrt(np.einsum("it,ij,jt->t", slopes, covariance, slopes))


def _factor(known: Uncertainty) -> float:
    """The k of a 95 % interval of what is derived from a fit."""
    return float(stdtrit(known.dof, 0.975))


def _stated(
    fit: Fit, known: Uncertainty, asked: dict[str, float]
) -> Iterator[tuple[str, float, float, float]]:
    """Of each quantity its name, true value, and value and half of the 95 % interval as stated."""
    halves = known.factors * np.sqrt(np.diag(known.covariance))
    for name in TRUTH.parameters:
        half = float(halves[fit.free.index(name)])
        yield name.replace("_", " "), TRUTH.values[name], fit.model.values[name], half
    at = [fit.free.index(name) for name in TRUTH.parameters]
    values = TRUTH.with_values({name: fit.model.values[name] for name in TRUTH.parameters})
    found: dict[str, Quantity] = quantities(values, AT, known.covariance[np.ix_(at, at)])
    for name in ("period", "quality", "decay_time"):
        half = _factor(known) * found[name].uncertainty
        yield name.replace("_", " "), asked[name], found[name].value, half
