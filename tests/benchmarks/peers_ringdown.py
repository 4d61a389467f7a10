"""The same recordings through what a person would otherwise take: period, quality and law of each beside the truth (docs/peers.md).

    python tests/benchmarks/peers_ringdown.py [FOLDER of real recordings]

It prints one table for swings whose truth is known, computed by the second pendulum, and one for real recordings. What is not installed is left out
and said: ``pip install lmfit pysindy ringdownanalysis rolldecay-estimators`` (the last with ``--no-deps``, and ``sympy scikit-learn``).
Period and quality are those of the first swing from rest at the stated amplitude; of an equation that a method found, they are computed from it.
"""

import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd
from scipy.integrate import solve_ivp
from scipy.signal import savgol_filter

import swingdown
from swingdown_trials.second_pendulum import trajectory

SEED = 26
DENSE = 4000  # samples of a swing that its turning points are told from
REAL = Path(__file__).parents[3] / "shared/data/real"


@dataclass(frozen=True)
class Case:
    """A swing let go from rest: effects and values, and how it is recorded; ``unit`` deg writes the readings in degrees."""

    name: str
    effects: tuple[str, ...]
    values: dict[str, float]
    amplitude: float = 0.4  # rad
    seconds: float = 30.0
    rate: float = 100.0
    noise: float = 6e-4  # rad
    unit: str = "rad"

    def recorded(self, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
        """Times (s) and readings in the case's unit."""
        times = np.arange(0, self.seconds, 1 / self.rate)
        angle = trajectory(self.effects, self.values, times, self.amplitude).reading
        readings = angle + rng.normal(0, self.noise, times.size)
        return times, np.degrees(readings) if self.unit == "deg" else readings

    def truth(self) -> "Told":
        """Period (s) and quality of its first swing, and its law."""
        period = 2 * np.pi / self.values["natural_frequency"]
        times = np.arange(0, 1.6 * period, period / DENSE)
        angle = trajectory(self.effects, self.values, times, self.amplitude).reading
        return Told(*first_swing(times, angle), law="+".join(self.effects))


BASE = {"natural_frequency": 6.0, "viscous_ratio": 0.003}
CASES = (
    Case("viscous", ("viscous",), BASE),
    Case("viscous and quadratic", ("viscous", "quadratic_drag"), BASE | {"quadratic_coefficient": 0.06}),
    Case("dry friction", ("load_coulomb",), {"natural_frequency": 6.0, "load_friction": 2e-3}),
    Case("a hidden presliding", ("viscous", "load_coulomb", "presliding"), BASE | {"load_friction": 1e-3, "presliding_friction": 0.1, "presliding_angle": 0.006}),
    Case("video of 30/s, noisy", ("viscous", "quadratic_drag"), BASE | {"quadratic_coefficient": 0.06}, rate=30.0, noise=1e-2),
    Case("in degrees", ("viscous",), BASE, unit="deg"),
)  # fmt: skip
RECORDED = (
    ("arm, 3.8°", "dynamicslab_single/free_swing_small.csv"),
    ("rotary link, 64°", "jensen_rotary/rel45.csv"),
    ("rotary link, 136°", "jensen_rotary/rel90.csv"),
)


class Told(NamedTuple):
    """What a method tells: period (s) and quality of the first swing, their standard uncertainties (nan: none), and the law."""

    period: float
    quality: float
    u_period: float = np.nan
    u_quality: float = np.nan
    law: str = ""


def first_swing(times: np.ndarray, angle: np.ndarray) -> tuple[float, float]:
    """Period (s) and quality of the first swing of a motion from rest: pi over its logarithmic decrement; nan where it does not come back."""
    turns = np.flatnonzero(np.diff(np.sign(np.diff(angle[1:]))) != 0) + 2
    if turns.size < 2:
        return np.nan, np.nan
    (_, low), (period, high) = (vertex(times, angle, k) for k in turns[:2])
    decrement = 2 * np.log((angle[0] - low) / (high - low))
    return period, float(np.pi / decrement)


def vertex(times: np.ndarray, values: np.ndarray, k: int) -> tuple[float, float]:
    """Where the parabola through three neighbouring samples turns: time and value."""
    before, here, after = values[k - 1 : k + 2]
    shift = 0.5 * (before - after) / (before - 2 * here + after)
    return float(times[k] + shift * (times[1] - times[0])), float(here - 0.25 * (before - after) * shift)


def of_equation(
    acceleration: Callable[[float, float], float], amplitude: float, period: float
) -> tuple[float, float]:
    """Period (s) and quality of the first swing of an equation of motion from rest at an amplitude; nan where it runs away."""
    times = np.linspace(0, 1.6 * period, int(1.6 * DENSE))
    found = solve_ivp(
        lambda _, y: (y[1], acceleration(y[0], y[1])),
        (0, times[-1]),
        (amplitude, 0.0),
        t_eval=times,
        rtol=1e-9,
        atol=1e-12,
    )
    return first_swing(found.t, found.y[0]) if found.success else (np.nan, np.nan)


def beginning(times: np.ndarray, series: np.ndarray) -> tuple[float, float]:
    """Frequency (Hz) of the spectrum's highest line, by a parabola through it, and the first reach of the series."""
    away = series - series.mean()
    power = np.abs(np.fft.rfft(away * np.hanning(away.size)))
    k = int(np.argmax(power[1:])) + 1
    a, b, c = np.log(power[k - 1 : k + 2])
    return float((k + 0.5 * (a - c) / (a - 2 * b + c)) / (times[-1] - times[0])), float(np.abs(away).max())


def ours(path: Path, times: np.ndarray, series: np.ndarray) -> Told:
    """This package: `swingdown.read(path).explain()`; its law is what the verdict asserts."""
    answer = swingdown.read(path).explain()
    period, quality = answer["period"], answer["quality"]
    verdict = answer.verdict or {}
    added = [" or ".join([one["name"], *one["tied_with"]]) for one in verdict.get("effects", ())]
    kept = [name for name in ("viscous", "load_coulomb") if name not in verdict.get("removed", ())]
    law = "+".join([*kept, *added]) if added else answer.label
    return Told(period.value, quality.value, period.u, quality.u, f"{law} ({verdict.get('status')})")


def by_lmfit(path: Path, times: np.ndarray, series: np.ndarray) -> Told:
    """lmfit by hand: a cosine that dies away exponentially about a constant, from the spectrum's highest line."""
    import lmfit

    def swing(t, reach, gamma, frequency, phase, middle):
        return middle + reach * np.exp(-gamma * t) * np.cos(2 * np.pi * frequency * t + phase)

    frequency, reach = beginning(times, series)
    model, best = lmfit.Model(swing), None
    for gamma in (0.003, 0.03, 0.3):
        for phase in (0.0, np.pi / 2, np.pi, -np.pi / 2):
            found = model.fit(
                series,
                t=times,
                reach=reach,
                gamma=gamma,
                frequency=frequency,
                phase=phase,
                middle=series.mean(),
            )
            best = found if best is None or found.chisqr < best.chisqr else best
    f, g = best.params["frequency"], best.params["gamma"]
    quality = np.pi * f.value / g.value
    u = quality * np.hypot((f.stderr or np.nan) / f.value, (g.stderr or np.nan) / g.value)
    return Told(1 / f.value, quality, (f.stderr or np.nan) / f.value**2, u, "viscous (assumed)")


def by_ringdownanalysis(path: Path, times: np.ndarray, series: np.ndarray) -> Told:
    """ringdownanalysis: the Q that it selects and, where that is none, what its amplitude law says at the first swing."""
    from ringdownanalysis import RingDownAnalyzer, SegmentedDemodEstimator, fit_nonlinear_damping

    rate, reach = 1 / float(np.median(np.diff(times))), float(np.abs(series - series.mean()).max())
    result = RingDownAnalyzer().analyze_array(t=times, data=series, detrend="constant")
    frequency, u = result["f_nls"], result.get("uncertainty_std_f") or np.nan
    law, quality, u_quality = "viscous (assumed)", result["Q_selected"] or np.nan, np.nan
    ends = result.get(f"Q_{result['Q_selected_source']}_ci95") if result["Q_selected_valid"] else None
    if ends is not None and np.all(np.isfinite(np.asarray(ends, dtype=float))):
        u_quality = float(ends[1] - ends[0]) / 3.92
    if not result["Q_selected_valid"]:
        law = f"no Q selected: {', '.join(result['Q_selected_reasons'])}"
        drawn = fit_nonlinear_damping(SegmentedDemodEstimator().estimate(times, series - series.mean(), rate))
        if drawn.valid:
            quality, frequency = float(drawn.q_at(reach)), drawn.f_zero + drawn.f_pull * reach
            law, u = f"1/tau = 1/tau0 + beta A ({law})", np.nan
    return Told(1 / frequency, quality, u / frequency**2, u_quality, law)


def by_pysindy(path: Path, times: np.ndarray, series: np.ndarray) -> Told:
    """pysindy: STLSQ on smoothed differences over sine, viscous, quadratic and constant friction; the threshold by BIC."""
    import pysindy

    frequency, reach = beginning(times, series)
    window = max(7, 2 * int(0.33 / frequency / (times[1] - times[0]) / 2) + 1)
    difference = pysindy.SmoothedFiniteDifference(smoother_kws={"window_length": window, "polyorder": 5})
    velocity = np.asarray(difference._differentiate(series[:, None], times))[:, 0]
    angle = np.asarray(difference.smoothed_x_)[:, 0]
    acceleration = np.asarray(difference._differentiate(velocity[:, None], times))[:, 0]
    names = ["sin", "viscous", "quadratic_drag", "constant_coulomb"]
    library = [lambda x, v: np.sin(x), lambda x, v: v, lambda x, v: v * np.abs(v), lambda x, v: np.sign(v)]
    inner = slice(window, -window)
    columns = np.column_stack([one(angle, velocity) for one in library])[inner]
    best = None
    for threshold in np.geomspace(1e-4, 0.3, 20):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of thresholds that leave nothing
            optimiser = pysindy.STLSQ(
                threshold=threshold * np.linalg.norm(acceleration[inner]), alpha=1e-6, normalize_columns=True
            )
            optimiser.fit(columns, acceleration[inner, None])
        coefficients = np.ravel(optimiser.coef_)
        left = acceleration[inner] - columns @ coefficients
        bic = left.size * np.log(np.mean(left**2)) + np.count_nonzero(coefficients) * np.log(left.size)
        best = (bic, coefficients) if best is None or bic < best[0] else best
    found = best[1]
    law = "+".join(name for name, one in zip(names[1:], found[1:], strict=True) if one) or "no damping"
    period, quality = of_equation(
        lambda x, v: float(sum(c * one(x, v) for c, one in zip(found, library, strict=True))),
        reach,
        1 / frequency,
    )
    return Told(period, quality, law=law)


def by_rolldecay(path: Path, times: np.ndarray, series: np.ndarray) -> Told:
    """rolldecay-estimators: cubic damping and a restoring torque to the fifth power, by derivatives and then by integration from there."""
    from rolldecayestimators.direct_estimator_cubic import EstimatorCubic

    frequency, reach = beginning(times, series)
    window = max(7, 2 * int(0.33 / frequency / (times[1] - times[0]) / 2) + 1)
    step, away = times[1] - times[0], series - series.mean()
    frame = pd.DataFrame(
        {
            name: savgol_filter(away, window, 5, deriv=k, delta=step)
            for k, name in enumerate(("phi", "phi1d", "phi2d"))
        },
        index=times - times[0],
    ).iloc[window:-window]
    frame.index -= frame.index[0]
    rough = EstimatorCubic(fit_method="derivation", maxfev=4000)
    rough.fit(frame)
    law, parameters = "cubic polynomial (derivatives alone)", rough.parameters
    try:
        whole = EstimatorCubic(fit_method="integration", maxfev=60, ftol=1e-9, p0=rough.parameters)
        whole.assert_success = False
        whole.fit(frame)
        law, parameters = "cubic polynomial", whole.parameters
    except (ValueError, RuntimeError):
        pass
    swing = EstimatorCubic.functions["acceleration"]
    period, quality = of_equation(
        lambda x, v: float(swing(phi=x, phi1d=v, **parameters)), reach, 1 / frequency
    )
    return Told(period, quality, law=law)


METHODS = {
    "this package": ours,
    "lmfit, damped cosine": by_lmfit,
    "ringdownanalysis": by_ringdownanalysis,
    "pysindy": by_pysindy,
    "rolldecay-estimators": by_rolldecay,
}


def row(name: str, method: str, told: Told, truth: Told | None, seconds: float) -> dict[str, object]:
    """A line of the table; errors in stated uncertainties, or in percent where none is stated."""

    def error(key: str) -> str:
        value, u = getattr(told, key), getattr(told, f"u_{key}")
        if truth is None or not np.isfinite(value):
            return "–"
        away = value - getattr(truth, key)
        return f"{away / u:+.1f} u" if u > 0 else f"{100 * away / getattr(truth, key):+.2g} %"

    def number(key: str) -> str:
        value, u = getattr(told, key), getattr(told, f"u_{key}")
        return f"{value:.5g}" + (f" ± {u:.2g}" if u > 0 else "")

    return {
        "recording": name, "method": method, "T (s)": number("period"), "error of T": error("period"), "Q": number("quality"),
        "error of Q": error("quality"), "law": told.law, "CPU (s)": f"{seconds:.1f}",
    }  # fmt: skip


def measured(
    name: str, path: Path, times: np.ndarray, series: np.ndarray, truth: Told | None
) -> list[dict[str, object]]:
    """The lines of all methods on one recording."""
    rows = [row(name, "truth", truth, None, 0.0)] if truth else []
    for method, tell in METHODS.items():
        begun = time.process_time()
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                told = tell(path, times, series)
        except ImportError as problem:
            print(f"NOT SHOWN: {method} ({problem})", file=sys.stderr)
            continue
        except Exception as problem:
            told = Told(np.nan, np.nan, law=f"failed: {type(problem).__name__}: {str(problem)[:80]}")
        rows.append(row(name, method, told, truth, time.process_time() - begun))
        print(rows[-1], file=sys.stderr, flush=True)
    return rows


def main(real: Path) -> None:
    """Prints both tables, in Markdown."""
    rows, rng = [], np.random.default_rng(SEED)
    with tempfile.TemporaryDirectory() as folder:
        for case in CASES:
            times, series = case.recorded(rng)
            path = Path(folder) / "swing.csv"
            pd.DataFrame({"t (s)": times, f"angle ({case.unit})": series}).to_csv(path, index=False)
            rows += measured(case.name, path, times, series, case.truth())
    for name, file in RECORDED:
        path = real / file
        if not path.is_file():
            print(f"NOT SHOWN: {path} is not there", file=sys.stderr)
            continue
        table = pd.read_csv(path)
        times, series = table.iloc[:, 0].to_numpy(float), table.iloc[:, 1].to_numpy(float)
        first = int(np.abs(series).argmax())  # before it a hand lifts
        rows += measured(name, path, times[first:][::10], series[first:][::10], None)
    print(markdown(rows))


def markdown(rows: list[dict[str, object]]) -> str:
    """The rows as a table in Markdown."""
    head = list(rows[0])
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join([*lines, *("| " + " | ".join(str(one[key]) for key in head) + " |" for one in rows)])


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else REAL)
