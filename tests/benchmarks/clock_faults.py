"""Clocks at fault, drawn again and again: what a recording tells of them, how wrong its times stay, and how often a sound one is blamed.

    .venv/bin/python tests/benchmarks/clock_faults.py [DRAWS] [SOUND]

Prints tables, of which docs/bench.md gives the sum. Boards and arrivals are those of tests/capture/arrivals.py: simulated, at 100 samples a second
(sound ones at 50, 100, 200 and 500, for 10 to 60 s, up to 0.4 % from the rate told). DRAWS for each fault, SOUND recordings for each
kind of arrivals.
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "capture"))
import arrivals

from swingdown.capture.clocks import compare

OFFSETS = {
    "99.3 steadily": {"rate": arrivals.steady(99.3)},
    "99.8 steadily": {"rate": arrivals.steady(99.8)},
    "100.55 steadily, 60 s": {"rate": arrivals.steady(100.55), "seconds": 60},
}
MADE_UP = {
    "three of 0.3 s, made up by 110": {"rate": arrivals.made_up, "stalls": [(5, 0.3), (10, 0.3), (15, 0.3)]}
}
STALLS = {f"stall of {name}": {"stalls": one} for name, one in arrivals.STALLS.items()}
FAULTS = arrivals.WANDERS | arrivals.SMALL | OFFSETS | STALLS | MADE_UP


def seen(found):
    """True if the recording tells of the fault: of a rate, a change or a stall."""
    return bool(found.stalls or found.wanders or found.wrong or (found.steady and found.apart))


def row(fault, draws, random):
    """Of each kind of arrivals: the part that was seen, and the error left in the times (ms)."""
    cells, raw = [], 0.0
    for scatter in arrivals.SCATTER.values():
        told, left, honest = 0, [], []
        for _ in range(draws):
            true = arrivals.sent(**fault)
            times = np.arange(len(true)) / arrivals.TOLD
            true = true - true[0]
            found = compare(times, scatter(true, random))
            raw = float(np.ptp(times - true))
            told += seen(found)
            left.append(float(np.std(found.corrected(times) - true)))
            honest.append(found.uncertainty)
        cells.append((told / draws, 1e3 * np.median(left), 1e3 * np.median(honest)))
    return raw, cells


def sound(scatter, count, random):
    """How many of ``count`` sound recordings are blamed, and the largest and the usual error over the stated uncertainty."""
    blamed, ratio = 0, []
    for _ in range(count):
        rate, seconds = random.choice([50, 100, 200, 500]), random.choice([10, 20, 30, 60])
        times = np.arange(rate * seconds) / rate
        true = times * (1 + random.uniform(-0.004, 0.004))
        found = compare(times, scatter(true, random))
        blamed += bool(found.stalls or found.wanders or found.wrong)
        ratio.append(float(np.std(found.corrected(times) - true)) / found.uncertainty)
    return blamed, np.quantile(ratio, 0.95)


def main(draws=40, count=400):
    """Prints the tables."""
    random = np.random.default_rng(28)
    kinds = list(arrivals.SCATTER)
    print("| fault | times wrong by, s | " + " | ".join(kinds) + " |\n|---|---|" + "---|" * len(kinds))
    for name, fault in FAULTS.items():
        raw, cells = row(fault, draws, random)
        told = [f"{part:.0%}, {left:.2g} ({said:.2g})" for part, left, said in cells]
        print(f"| {name} | {raw:.3f} | {' | '.join(told)} |", flush=True)
    steps = {f"bursts of {every} ms": (lambda t, r, every=every: arrivals.bursts(t, r, every / 1000)) for every in (1, 4, 10, 20)}  # fmt: skip
    for name, scatter in (arrivals.SCATTER | steps).items():
        blamed, ratio = sound(scatter, count, random)
        print(
            f"{name}: {blamed} of {count} sound recordings blamed; error over uncertainty {ratio:.2g} (95 %)",
            flush=True,
        )


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
