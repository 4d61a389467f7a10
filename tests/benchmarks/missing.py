"""How often stated 95 % intervals hold period and damping where samples are missing or stamped wrongly, in simulated swings.

    .venv/bin/python tests/benchmarks/missing.py [--swings 300] [--seed NUMBER] [ROW …]

Prints a table in Markdown (docs/files.md holds it): by what is wrong with the times, the share of swings in which the interval
value ± k u of the natural frequency and of each damping holds the truth, and the pulls' standard deviation. Each swing is a file's
way: times put in order, the swing judged, the law given, fitted. Beside the shares of the damping stand those of the same draws
where noise and times are known and the error is that of linear least squares: how lucky the draws are.
"""

import argparse
import sys

import numpy as np
from scipy.signal import lfilter

from swingdown.answer import of_swings
from swingdown.answer.given import swings
from swingdown.engine.trajectory import sensitivities, simulate
from swingdown.pendulum.model import Model

LAW = "viscous+quadratic_drag"


def drawn(draws):
    """The truth, times (s) and angles (rad) of one swing, sampled evenly."""
    rate, length = draws.choice([25.0, 30.0, 60.0, 100.0]), draws.uniform(15, 45)
    truth = {
        "natural_frequency": draws.uniform(3, 8),
        "viscous_ratio": draws.uniform(0.002, 0.01),
        "quadratic_coefficient": draws.uniform(0.001, 0.01),
    }
    return Model(LAW, truth), np.arange(int(rate * length)) / rate, draws.uniform(0.2, 1.0)


def without(share, burst=1):
    """What a recorder does that loses this share of its samples, in bursts of so many."""

    def lose(draws, times):
        kept = np.ones(times.size, dtype=bool)
        while (~kept).sum() < share * times.size:
            at = draws.integers(1, times.size - burst)
            kept[at : at + burst] = False
        return times[kept], times[kept]

    return lose


def stamped(scatter, late=False):
    """What a computer does that stamps even samples with this scatter, in steps; ``late`` alone, as it is when it is busy."""

    def stamp(draws, times):
        step = times[1]
        off = draws.exponential(scatter, times.size) if late else scatter * draws.standard_normal(times.size)
        return times, times + step * np.clip(off, -0.45, 0.45 if not late else 3)

    return stamp


def jittered(draws, times):
    """A recorder that keeps no rate and stamps rightly."""
    true = times + times[1] * draws.uniform(-0.3, 0.3, times.size)
    return true, true


def wrong_both(draws, times):
    """Samples that keep no rate, and stamps that are wrong as well: nothing tells the even times."""
    true = times + times[1] * draws.uniform(-0.3, 0.3, times.size)
    return true, true + times[1] * 0.3 * draws.uniform(-1, 1, times.size)


def rounded(digits):
    def stamp(draws, times):
        return times, np.round(times, digits)

    return stamp


KINDS = {
    "nothing": lambda draws, times: (times, times),
    "1 % missing at random": without(0.01),
    "5 % missing at random": without(0.05),
    "20 % missing at random": without(0.2),
    "1 % missing in bursts of 10": without(0.01, 10),
    "5 % missing in bursts of 20": without(0.05, 20),
    "20 % missing in bursts of 40": without(0.2, 40),
    "uneven, stamped rightly": jittered,
    "even, stamps off by 30 % of a step": stamped(0.3),
    "even, stamped late by 30 % of a step": stamped(0.3, late=True),
    "uneven, and stamps off by up to 30 % of a step": wrong_both,
    "stamps rounded to 10 ms": rounded(2),
    "slow noise, 20 % missing at random": without(0.2),
    "slow noise, 20 % missing in bursts of 40": without(0.2, 40),
}  # fmt: skip


def noise(kind, draws, even, true):
    """Noise with a standard deviation of 1: white, or of an error that lasts a tenth of a second."""
    if not kind.startswith("slow"):
        return draws.standard_normal(true.size)
    memory = np.exp(-even[1] / 0.1)
    series = lfilter([np.sqrt(1 - memory**2)], [1, -memory], draws.standard_normal(even.size + 1000))[1000:]
    return series[np.isin(even, true)]


def with_noise_known(model, release, true, white):
    """The pull of each damping in linear least squares that know the motion, the times and how large the noise is."""
    values, size = list(model.values), [release, 0.0]
    slopes = sensitivities(model, true, *size, free=[*values, "release_angle", "release_velocity"])[1]
    covariance = np.linalg.inv(slopes @ slopes.T)
    return (covariance @ (slopes @ white) / np.sqrt(np.diag(covariance)))[1 : len(values)]


def pulls(kind, count, seed):
    """(error, u, k) of each value in each swing, the pull of each damping with the noise known, and how many could not be fitted."""
    draws, found, known, lost = np.random.default_rng(seed), [], [], 0
    for _ in range(count):
        model, even, release = drawn(draws)
        true, told = KINDS[kind](draws, even)
        white = noise(kind, draws, even, true)
        angle = simulate(model, true, release) + 0.004 * release * white
        told = told * (1 + draws.uniform(-5e-5, 5e-5))  # a quartz, as the usual tolerance of a clock has it
        order = np.argsort(told, kind="stable")
        known.append(with_noise_known(model, release, true, white))
        try:
            answer = of_swings(swings(told[order], angle[order], unit="rad"), fitted=[LAW], checked=False)
        except Exception as problem:
            lost += 1
            print(f"{kind}: {problem}", file=sys.stderr)
            continue
        fit = answer.fits.isel(recording=0, fitted=0)
        at = {"parameter": list(model.values)}
        value, error, factor = (
            fit[key].sel(at).values for key in ("value", "standard_error", "coverage_factor")
        )
        found.append((value - np.array(list(model.values.values())), error, factor))
    return np.array(found), np.array(known), lost


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("rows", nargs="*", default=list(KINDS))
    parser.add_argument("--swings", type=int, default=300)
    parser.add_argument("--seed", type=int, default=20261123)
    args = parser.parse_args()
    print("| what is wrong with the times | frequency inside | damping inside | … with the noise known | pulls (standard deviation) | not fitted |")  # fmt: skip
    print("|---|---|---|---|---|---|")
    for kind in args.rows:
        found, known, lost = pulls(kind, args.swings, args.seed)
        error, u, factor = found.transpose(1, 0, 2)
        inside = 100 * np.mean(np.abs(error) <= factor * u, axis=0)
        lucky = 100 * np.mean(np.abs(known) <= 1.96, axis=0)
        luck = "" if kind.startswith("slow") else f"{lucky[0]:.1f}, {lucky[1]:.1f} %"
        spread = ", ".join(f"{one:.2f}" for one in np.std(error / u, axis=0))
        print(f"| {kind} | {inside[0]:.1f} % | {inside[1]:.1f}, {inside[2]:.1f} % | {luck} | {spread} | {lost} |", flush=True)  # fmt: skip


if __name__ == "__main__":
    main()
