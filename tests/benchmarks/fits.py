"""Times every fitter on the same swings, interleaved, and writes results/benchmarks/fit.csv: run by ``make benchmark``.

All start at the same place and must reach the same optimum. CPU time of this process for one fit, the median over the
rounds; a fitter that takes long runs in fewer rounds, and one of a batch fits many series at once. ``relative_excess`` is how
far its sum of squares, computed again by the engine, is above the best one found; ``ratio`` its time over that of this engine's
batch, ``ratio_to_users_call`` over that of this engine as a user calls it.
"""

import argparse
import csv
import time
from pathlib import Path
from statistics import median

import compiled_peers
import numpy as np
import peers
from figures import figures
from swings import CASES, SNR, TIMES

from swingdown.engine.trajectory import TrajectoryError, simulate
from swingdown.fitting.batch import fit_batch
from swingdown.fitting.least_squares import fit_trajectory

OURS, USERS = "this engine, batch", "this engine, as a user calls it"
WANTED = {  # at least, goal, over which of ours
    "numba RK4 + sensitivities + LM, batch, warm": (4, 8, "ratio"),
    "odeint + lmfit leastsq": (400, 1_000, "ratio_to_users_call"),
}
TIMED = ("five", "seven")
QUICK = ("numba", "heyoka", "odeint + lmfit")  # the methods of --quick begin with these
TYPICAL = {
    "natural_frequency": 1.0,
    "viscous_ratio": 0.01,
    "quadratic_coefficient": 0.01,
    "load_friction": 0.005,
    "sensor_zero": 0.01,
}


OFF = {
    "five": (0.995, 0.6, 0.95),
    "seven": (0.998, 0.8, 0.97),
}  # of the truth: frequency, coefficients, release angle


def task(name):
    """The ``peers.Task`` of a case: the start is off the truth as far as its peers still find the optimum from, and at rest."""
    case, (frequency, coefficient, release) = CASES[name], OFF[name]
    clean = case.clean()
    noise = np.random.default_rng(1).standard_normal((compiled_peers.BATCH, TIMES.size))
    series = clean + noise * (np.sqrt(np.mean(clean**2)) / SNR)
    factor = {"natural_frequency": frequency, "sensor_zero": 0.0}
    start = [case.model.values[key] * factor.get(key, coefficient) for key in case.model.parameters]
    scale = [TYPICAL[key] for key in case.model.parameters]
    return peers.Task(
        name,
        TIMES,
        series,
        np.array([*start, release * case.release_angle, 0.0]),
        np.array([*scale, 0.1, 0.5]),
    )


def ours(work, count=1):
    """This engine from the task's start, ``count`` series at once."""
    model = CASES[work.name].model
    guess = model.with_values(dict(zip(model.parameters, work.start, strict=False)))
    fit = fit_batch(guess, work.times, work.series[:count], work.start[-2:])
    return peers.Found(fit.values[0], round(float(fit.evaluations.mean())))


def ours_at_once(work):
    """This engine from the task's start, a batch of series."""
    return ours(work, compiled_peers.BATCH)


ours_at_once.fits = compiled_peers.BATCH


def ours_alone(work):
    """This engine as a user calls it: from the data alone."""
    fit = fit_trajectory(CASES[work.name].model.label, work.times, work.angle)
    return peers.Found(fit.values, fit.evaluations)


def squares(work, values):
    """The sum of squares at some values, by the engine whatever found them."""
    model = CASES[work.name].model
    try:
        fitted = simulate(
            model.with_values(dict(zip(model.parameters, values, strict=False))),
            work.times,
            values[-2],
            values[-1],
        )
    except TrajectoryError:
        return np.inf
    return float(np.sum((fitted - work.angle) ** 2))


def measure(fitters, cases, rounds, budget):
    """Rows (method, case, cpu_s, evaluations, rss, runs): rounds in which each fitter runs once, until its budget (s) is spent."""
    tasks = {name: task(name) for name in cases}
    spent, times, found = {}, {}, {}
    for number in range(rounds):
        for name, work in tasks.items():
            for method, fitter in fitters.items():
                key = method, name
                if name not in getattr(fitter, "only", cases):
                    continue
                if number and spent[key] * (number + 1) / number > budget:
                    continue
                if number == 0 and "warm" in method:
                    fitter(work)
                fits = getattr(fitter, "fits", 1)
                repeats = 20 if fits == 1 and method.startswith(("this", "numba")) else 1
                begun = time.process_time()
                for _ in range(repeats):
                    found[key] = fitter(work)
                cpu = (time.process_time() - begun) / repeats
                times.setdefault(key, []).append(cpu / fits)
                spent[key] = spent.get(key, 0.0) + cpu
                if number == 0:
                    print(f"  {name:6s} {method:44s} {cpu / fits:10.6f} s CPU", flush=True)
    return [
        {"method": method, "case": name, "cpu_s": median(times[method, name]), "evaluations": found[method, name].evaluations,
         "rss": squares(tasks[name], found[method, name].values), "runs": len(times[method, name])}
        for name in tasks for method in fitters if (method, name) in times
    ]  # fmt: skip


def complete(rows):
    """The rows with ``relative_excess`` and their ratios."""
    for name in {row["case"] for row in rows}:
        here = [row for row in rows if row["case"] == name]
        best = min(row["rss"] for row in here)
        own, users = (next(row["cpu_s"] for row in here if row["method"] == name) for name in (OURS, USERS))
        for row in here:
            row["relative_excess"] = row.pop("rss") / best - 1
            row["ratio"], row["ratio_to_users_call"] = row["cpu_s"] / own, row["cpu_s"] / users
    return rows


def tell(rows):
    """The table on the terminal, each ratio beside what is wanted of it."""
    print(
        f"\n{'case':6s} {'method':44s} {'ms':>10s} {'evaluations':>12s} {'excess':>9s} {'batch':>9s} {'user':>9s}  wanted (goal)"
    )
    for row in rows:
        least, goal, of = WANTED.get(row["method"], (None, None, None))
        wanted = f"{least:,} ({goal:,}) {of}" if least and row["case"] == "five" else ""
        missed = "" if row["relative_excess"] <= 1e-6 else "  optimum missed"
        print(
            f"{row['case']:6s} {row['method']:44s} {1e3 * row['cpu_s']:10.4f} {row['evaluations']:12d} "
            f"{row['relative_excess']:9.1e} {row['ratio']:9,.1f} {row['ratio_to_users_call']:9,.2f}  {wanted}{missed}"
        )


def main():
    reader = argparse.ArgumentParser(description=__doc__)
    reader.add_argument("--rounds", type=int, default=7)
    reader.add_argument(
        "--budget", type=float, default=40.0, help="CPU seconds a fitter may take on one case in all"
    )
    reader.add_argument("--results", type=Path, default=Path("results/benchmarks"))
    reader.add_argument("--only", choices=("fits", "figures"))
    reader.add_argument(
        "--case", choices=TIMED, action="append", help="by default all; odeint takes minutes for seven"
    )
    reader.add_argument(
        "--quick",
        action="store_true",
        help="a minute: numba, heyoka and lmfit beside this engine, the case five, 3 rounds",
    )
    given = reader.parse_args()
    if given.quick:
        given.only, given.case, given.rounds = "fits", ["five"], 3
    given.results.mkdir(parents=True, exist_ok=True)
    if given.only != "figures":
        fitters, missing = peers.available(QUICK if given.quick else "")
        for name in missing:
            print(f"NOT TIMED: {name} is not installed (see requirements-benchmark.lock)")
        print(f"Fits of {TIMES.size} samples, {given.rounds} rounds, first round:")
        rows = complete(
            measure(
                {OURS: ours_at_once, "this engine, same start": ours, USERS: ours_alone} | fitters,
                given.case or TIMED,
                given.rounds,
                given.budget,
            )
        )
        write(
            given.results / "fit.csv",
            rows,
            (
                "method",
                "case",
                "cpu_s",
                "evaluations",
                "relative_excess",
                "ratio",
                "ratio_to_users_call",
                "runs",
            ),
        )
        tell(rows)
    if given.only != "fits":
        write(
            given.results / "engine.csv", figures(), ("figure", "value", "unit", "at_least", "goal", "note")
        )


def write(path, rows, columns):
    """A CSV of the rows, in those columns."""
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, columns)
        writer.writeheader()
        writer.writerows(rows)
    print(f"written: {path}")


if __name__ == "__main__":
    main()
