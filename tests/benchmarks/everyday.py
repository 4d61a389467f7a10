"""How often the stated uncertainties of period, quality and decay time hold the truth where nobody knows the law of damping.

    .venv/bin/python tests/benchmarks/everyday.py [COUNT] [--seed SEED] [--truth NAME …] [--verdict]

Prints a table in Markdown. Each recording is one swing of its own pendulum: sizes of damping, frequency, release, length of the record
(10 to 60 s), rate (30 to 100 a second), noise and clock are drawn; ``--verdict`` asks ``explain``, not the first answer. A value is inside where
the truth is within 1.96 stated standard uncertainties; ``wide`` is the median of the stated uncertainty over the value, and ``pull`` the
RMS of what is off, in stated uncertainties.
"""

import argparse
import warnings

import numpy as np

import swingdown
from swingdown.engine.trajectory import TrajectoryError, TrajectoryWarning, simulate
from swingdown.errors import InputError
from swingdown.pendulum.model import Model
from swingdown.studies.quantities import quantities, steady

ASKED = ("natural_frequency", "period", "quality", "decay_time")
TRIO = ("viscous", "quadratic_drag", "load_coulomb")
# beside the trio, sizes drawn between these, uniform in the logarithm
SIZES = {
    "viscous_ratio": (5e-4, 1e-2),
    "quadratic_coefficient": (5e-4, 2e-2),
    "load_friction": (2e-5, 1e-3),
    "power_law_coefficient": (1e-2, 1e-1),
    "power_law_exponent": (1.2, 1.9),
    "structural_coefficient": (3e-2, 5e-1),
    "presliding_friction": (5e-3, 5e-2),
    "presliding_angle": (5e-3, 5e-2),
}
TRUTHS = {
    "one to three of the trio": TRIO,
    "a power law": ("power_law_drag",),
    "structural damping": ("structural_damping",),
    "viscous drag, and friction before sliding": ("viscous", "presliding"),
}
CLOCK = 5e-5  # share by which a recorder's seconds may be wrong


def drawn(draws, effects):
    """Return a model of the effects (of the trio one to three) with values, its times, release (rad) and noise (rad)."""
    if effects is TRIO:
        effects = draws.permutation(TRIO)[: draws.integers(1, 4)]
    names = Model(tuple(effects)).parameters
    values = {"natural_frequency": draws.uniform(3, 8)}
    for name in names[1:]:
        low, high = np.log(SIZES[name])
        values[name] = float(np.exp(draws.uniform(low, high)))
    times = np.arange(0, draws.uniform(10, 60), 1 / draws.uniform(30, 100))
    return Model(tuple(effects), values), times, draws.uniform(0.15, 0.9), 10 ** draws.uniform(-3.3, -2.3)


def told(times, angle, verdict):
    """Return the quantities that are stated, by name, and the amplitude (rad) that they hold at."""
    if not verdict:
        answer = swingdown.fit(times, angle, unit="rad")
        return answer.quantities, float(answer.table["amplitude_rad"].iloc[0])
    answer = swingdown.explain(times, angle, unit="rad")
    found = answer.verdict["conclusion"]
    if found is None:
        raise TrajectoryError("no model follows the whole")
    return {
        name: swingdown.Quantity(one["value"], one["standard_uncertainty"], one["unit"])
        for name, one in found["quantities"].items()
    }, found["amplitude_rad"]


def pulls(truth, count, draws, verdict):
    """Return the pulls and the relative stated uncertainties of each quantity, (count, asked), and how many recordings gave no answer."""
    rows, silent = [], 0
    while len(rows) + silent < count:
        model, times, release, noise = drawn(draws, TRUTHS[truth])
        angle = simulate(model, times, release) + noise * draws.standard_normal(times.size)
        try:
            found, amplitude = told(times * (1 + draws.uniform(-CLOCK, CLOCK)), angle, verdict)
        except (InputError, TrajectoryError):
            silent += 1
            continue
        right = quantities(steady(model), amplitude, None)
        row = []
        for name in ASKED:
            one = found.get(name)
            value, u = (np.nan, np.nan) if one is None else (one.value, one.uncertainty)
            row.append(
                ((np.nan if value is None else value) - right[name].value, u or np.nan, right[name].value)
            )
        rows.append(row)
    off, u, value = np.moveaxis(np.array(rows, dtype=float), -1, 0)
    return off / u, u / value, silent


def main(argv=None):
    """The table printed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("count", nargs="?", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--truth", nargs="*", default=list(TRUTHS), choices=list(TRUTHS))
    parser.add_argument("--verdict", action="store_true")
    given = parser.parse_args(argv)
    print(
        "| damping | answered | "
        + " | ".join(f"{name.replace('_', ' ')}: inside, wide, pull" for name in ASKED)
        + " |"
    )
    print("|---" * (2 + len(ASKED)) + "|")
    for truth in given.truth:
        pull, wide, silent = pulls(truth, given.count, np.random.default_rng(given.seed), given.verdict)
        cells = []
        for k in range(len(ASKED)):
            there = np.isfinite(pull[:, k])
            inside = 100 * np.mean(np.abs(pull[there, k]) <= 1.96)
            cells.append(
                f"{inside:.1f} %, {np.median(wide[there, k]):.1e}, {np.sqrt(np.mean(pull[there, k] ** 2)):.2g} ({there.sum()})"
            )
        print(f"| {truth} | {len(pull)} of {len(pull) + silent} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    warnings.simplefilter("ignore", TrajectoryWarning)
    main()
