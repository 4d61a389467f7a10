"""Whether recordings of others could tell what is known to be there: their twins, which have that and nothing else, searched alike.

    .venv/bin/python tests/benchmarks/labelled/twins.py FOLDER --split learn|apart|fresh [--data FOLDER] [--only TEXT] [--draws 5]
        [--budget SECONDS] [--told nothing] [--table docs/labelled.csv]

FOLDER is as labelled.py filled it, ``--data`` and ``--only`` are as there. A twin is the best fit of what is known to the whole campaign, at the same times, under noise
that is as strong and as slow as what this fit leaves where a pendulum has nothing to say. What a search does not tell of the twins
either, the recording is too short, too noisy or too even to tell. ``--told`` keeps the campaigns of which the table says so.
"""

import argparse
import csv
import warnings
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import labelled
import numpy as np
from scipy.signal import lfilter

from swingdown.discovery.data.campaign import campaign
from swingdown.discovery.rounds import first_fit, noise_of
from swingdown.engine.trajectory import TrajectoryError
from swingdown.errors import InputError
from swingdown.pendulum.model import Model

FORGOTTEN = 1000  # samples before the first, after which coloured noise is as it goes on


def known(one, base, label):
    """Return (fit, noise) of the known effect that leaves least of a whole campaign; None where none can be fitted."""
    whole, fits = replace(one, fit=one.whole, holdout=()), []
    for name in label.split("|"):
        with suppress(TrajectoryError):
            fits.append(first_fit(whole, base.with_effects([*base.names, name])))
    best = min(fits, key=lambda fit: fit.rss, default=None)
    return best and (best, noise_of(whole, best))


def twin(one, fit, noise, rng):
    """Return a campaign with what a fit says in the place of what was read, under new noise; fitted and held out as before."""
    made = []
    for swing, part in zip(one.whole, fit.swings, strict=True):
        white = rng.standard_normal(swing.times.size + FORGOTTEN)
        coloured = lfilter([np.sqrt(1 - noise.correlation**2)], [1, -noise.correlation], white)[FORGOTTEN:]
        made.append(replace(swing, angle=part.angle + noise.deviation * coloured))
    held = {swing.name for swing in one.holdout}
    fitted, left = ([swing for swing in made if (swing.name in held) == out] for out in (False, True))
    again = campaign(one.name, fitted, left)
    return replace(again, slack=one.slack, reading=one.reading, own=one.own, systematic=one.systematic)


def main(argv=None):
    """A line for each campaign: of how many twins what is known is told, nothing, another; and of how many campaigns it is told of most."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--split", choices=[*labelled.HALVES], required=True)
    parser.add_argument("--data", type=Path, default=Path())
    parser.add_argument("--only", nargs="*", default=[""])
    parser.add_argument("--draws", type=int, default=5)
    parser.add_argument("--budget", type=float, default=60.0)
    parser.add_argument("--told", nargs="*", default=["nothing"])
    parser.add_argument("--table", type=Path, default=Path("docs/labelled.csv"))
    given = parser.parse_args(argv)
    with given.table.open(encoding="utf-8", newline="") as file:
        last = {row["campaign"]: row["told"] for row in csv.DictReader(file)}
    most = []
    for name, rows in labelled.listed(given.split).items():
        if last.get(name) not in given.told or not any(text in name for text in given.only):
            continue
        try:
            one = labelled.built(rows, given.folder, given.data)
        except InputError as problem:
            print(f"{name}: not read: {problem.problem}")
            continue
        base, label = Model(rows[0]["base"], restoring=rows[0]["restoring"]), rows[0]["label"]
        found = known(one, base, label)
        if found is None:
            print(f"{name}: what is known cannot be fitted")
            continue
        counts = dict.fromkeys(("right", "nothing", "wrong"), 0)
        for draw in range(given.draws):
            effects = labelled.asked(twin(one, *found, np.random.default_rng([draw, len(most)])), base, given.budget)[1]  # fmt: skip
            there, wrong = labelled.right(label, effects)
            counts["right" if there else "wrong" if wrong else "nothing"] += 1
        most.append(2 * counts["right"] > given.draws)
        print(name, *(f"{told} {count}" for told, count in counts.items()), sep=" | ", flush=True)
    print(f"what is known is told of most twins: {sum(most)} of {len(most)} campaigns")


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    main()
