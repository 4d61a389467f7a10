"""What is told of recordings of real pendulums, as a table: recording, base, asserted, imitated, what is left, CPU seconds.

    .venv/bin/python tests/benchmarks/real_verdicts.py --data ../shared/data/real [--pohl FOLDER] [--only NAME …] [--out FILE.md]

``--data`` is the folder of recordings that tests/test_real_recordings.py reads. ``--pohl`` holds the five recordings of a Pohl
wheel with an eddy-current brake from the public repository martin8ner/P1 at 5b8f9cce, folder Resonanz, as they stand there
(1.1.csv, 1.3_100mA.csv …); it states no licence, so nothing of it is kept here. Their truth is known: a uniform viscous brake
in all but 1.1.csv, whose strength grows with the square of the current. A line is printed as soon as a verdict is there.
"""

import argparse
import sys
import time
from pathlib import Path

import pandas as pd

from swingdown.discovery.campaign import Swing, campaign
from swingdown.discovery.files import summary
from swingdown.discovery.search import discover
from swingdown.discovery.verdict import verdict
from swingdown.pendulum.model import Model

# name: files, windows' starts (s), base, restoring
SHARED = {
    "dynamicslab_large": (["dynamicslab_single/free_swing_large.csv"], [0.0], "viscous+load_coulomb", "sine"),
    "dynamicslab_small": (["dynamicslab_single/free_swing_small.csv"], [0.0], "viscous+load_coulomb", "sine"),
    "jensen": (
        [f"jensen_rotary/rel{angle}.csv" for angle in (45, 90, 135)],
        [0.35, 0.45, 0.35],
        "viscous+load_coulomb",
        "sine",
    ),
    "khasawneh": (["khasawneh_rig/fig13_digitised.csv"], [0.0], "quadratic_drag+load_coulomb", "sine"),
}
POHL = ["1.3_700mA", "1.3_400mA", "1.3_200mA", "1.3_100mA", "1.1"]
HEAD = "| recording | base | status | asserted | imitated | held-out, times the noise | left | explained | CPU |\n|---|---|---|---|---|---|---|---|---|"


def shared(folder, files, starts):
    """The swings of recordings with columns t_s and theta_rad."""
    found = []
    for file, start in zip(files, starts, strict=True):
        table = pd.read_csv(folder / file, comment="#")
        table = table[table["t_s"] >= start]
        found.append(Swing(Path(file).stem, table["t_s"].to_numpy(), table["theta_rad"].to_numpy()))
    return found


def pohl(folder, name):
    """The swing of one recording of the Pohl wheel."""
    table = pd.read_csv(folder / f"{name}.csv", sep=";", decimal=",", encoding="utf-8-sig").iloc[:, [0, 3]]
    table = table.astype(float).dropna()
    return [Swing(name, table.iloc[:, 0].to_numpy(), table.iloc[:, 1].to_numpy())]


def told(name, swings, base, budget_s):
    """(one row of the table, the verdict's sentence)."""
    started = time.process_time()
    one = campaign(name, swings)
    found = verdict([summary(state, one) for state in discover(one, base, budget_s=budget_s)], base.catalogue)
    seconds = time.process_time() - started
    gap, left = found["gap"]["holdout"], found["gap"]["left"]
    share = found["gap"]["explained"]
    cells = [
        name, base.label + ("" if base.restoring == "sine" else ", linear"), found["status"],
        " · ".join(map(value, found["effects"])) or "–", " · ".join(map(value, found["stand_ins"])) or "–",
        f"{gap[0]:.3g} → {left['noise']:.3g}", f"{1e3 * left['rad']:.3g} mrad",
        "–" if share is None else f"{100 * share:.0f} %", f"{seconds:.0f} s" + (" (stopped)" if found["stopped"] else ""),
    ]  # fmt: skip
    return "| " + " | ".join(cells) + " |", found["sentence"]


def value(one):
    """An effect with its first value."""
    entry = next(iter(one["parameters"].values()), {"value": None})
    size = "" if entry["value"] is None else f" {entry['value']:.4g}" + (f" ± {entry['standard_error']:.1g}" if entry["standard_error"] else "")  # fmt: skip
    ties = f" or {' or '.join(one['tied_with'])}" if one["tied_with"] else ""
    return one["name"] + size + ties


def main():
    """The table printed, and written where ``--out`` says."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path)
    parser.add_argument("--pohl", type=Path)
    parser.add_argument("--only", nargs="*")
    parser.add_argument(
        "--budget", type=float, default=600.0, help="CPU seconds a search, as discovery.budget_s"
    )
    parser.add_argument("--out", type=Path)
    given = parser.parse_args()
    todo = []
    if given.pohl:
        todo += [(f"pohl {n}", lambda n=n: pohl(given.pohl, n), "constant_coulomb", "linear") for n in POHL]
    if given.data:
        todo += [(name, lambda f=files, s=starts: shared(given.data, f, s), base, restoring)
                 for name, (files, starts, base, restoring) in SHARED.items()]  # fmt: skip
    if not todo:
        sys.exit(
            "NOT MEASURED: no recordings. Name a folder with --data or --pohl (python real_verdicts.py --help)."
        )
    lines = [HEAD]
    print(HEAD, flush=True)
    for name, read, base, restoring in todo:
        if given.only and not any(part in name for part in given.only):
            continue
        model = Model(base, restoring=restoring)
        line, sentence = told(name, read(), model, given.budget)
        lines.append(line)
        print(line, f"<!-- {sentence} -->", sep="\n", flush=True)
        if given.out:
            given.out.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
