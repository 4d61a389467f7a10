"""What is told of real pendulums of others of which it is known what is there, as a table.

    .venv/bin/python tests/benchmarks/labelled/labelled.py FOLDER --split learn|apart|fresh [--mirrors FOLDER] [--data FOLDER]
        [--only TEXT] [--budget SECONDS] [--again] [--out docs/labelled.csv] [--pickles FOLDER]

campaigns.csv has a row for each recording. Those of one ``campaign`` are one; ``base`` and ``restoring`` are what the search begins
with, ``label`` is what is known to be there and not in the base (``|`` between those that a person cannot tell apart), ``source`` says
whence. ``split`` is ``learn`` where the search was made beside it, and ``apart`` or ``fresh`` where it was searched once, when that was done: other
apparatuses, taken by what they are before any was searched.

FOLDER is filled as corpus/fetch.py fills its own. Recordings without a commit were prepared by others and lie in the folder that
``--data`` names. ``--pickles`` writes the campaigns, and searches nothing. ``--out`` puts the rows in the place of those that the table has of
these campaigns; with ``--again`` beside those of the half that was searched once.
"""

import argparse
import csv
import pickle
import sys
import time
import warnings
from dataclasses import replace
from pathlib import Path

from swingdown import read
from swingdown.answer import before_search, searchable, unit_doubt
from swingdown.discovery.data.campaign import campaign
from swingdown.discovery.search import discover
from swingdown.discovery.tell.files import summary
from swingdown.discovery.tell.verdict import verdict
from swingdown.errors import InputError
from swingdown.pendulum.model import Model

sys.path.insert(0, str(Path(__file__).parents[1] / "corpus"))
from fetch import fetched, place

LIST = Path(__file__).with_name("campaigns.csv")
# columns that are arguments of swingdown.read
TOLD = ("column", "run", "unit", "time_unit", "rate", "scale", "start", "stop")
COLUMNS = ("campaign", "half", "base", "known", "asserted", "status", "told", "held out, times the noise", "CPU (s)")  # fmt: skip
HALVES = {"learn": "open", "apart": "searched once", "fresh": "fresh"}
AGAIN = {"apart": "again", "fresh": "fresh again"}  # what was searched once, by another search than that was


def listed(split=None):
    """Return the rows of campaigns.csv by campaign: all, or those of one split."""
    campaigns = {}
    with LIST.open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            if split in (None, row["split"]):
                campaigns.setdefault(row["campaign"], []).append(row)
    return campaigns


def swings(number, row, folder, data):
    """Return the angle datasets of one row, as the package reads its file, and the doubt of their unit; their names begin with this number."""
    path = place(folder, row) if row["commit"] else Path(data) / row["path"]
    told = {name: row[name] for name in TOLD if row[name]}
    told |= {name: float(told[name]) for name in ("rate", "start", "stop") if name in told}
    found = read(path, restoring=row["restoring"], **told).swings
    first = before_search(found, restoring=row["restoring"])
    doubt = unit_doubt(found, first)
    found = found if doubt else first.swings
    return [one.assign_attrs(recording=f"{number} {one.attrs['recording']}") for one in found], doubt


def built(rows, folder, data):
    """Return the ``Campaign`` of its rows; those that are refused are left out, as the command does, while there are others."""
    parts, doubts, refused = {"fit": [], "holdout": []}, [], []
    for number, row in enumerate(rows, 1):
        try:
            given, doubt = swings(number, row, folder, data)
        except InputError as problem:
            refused.append(problem)
            continue
        parts[row["role"] or "fit"] += given
        doubts.append(doubt)
    if not doubts:
        raise refused[0]
    one = searchable(rows[0]["campaign"], parts["fit"] + parts["holdout"], max(doubts))
    if not parts["holdout"]:
        return one
    held = {str(swing.attrs["recording"]) for swing in parts["holdout"]}
    whole = {True: [], False: []}
    for swing in one.whole:
        whole[swing.name in held].append(swing)
    return replace(campaign(one.name, whole[False], whole[True]), slack=one.slack, reading=one.reading)


def right(label, effects):
    """Return whether what is known is among the asserted effects, alone or in a tie, and whether something else stands in its place.

    ``effects`` holds by name what each asserted effect is tied with.
    """
    known = set(label.split("|"))
    there = any({name, *ties} & known for name, ties in effects.items())
    return there, bool(effects) and not there


def asked(one, base, budget):
    """Return status, asserted effects with their ties, and the held-out residual before and after, in noise."""
    found = verdict([summary(state, one) for state in discover(one, base, budget_s=budget)], base.catalogue)
    effects = {each["name"]: each["tied_with"] for each in found["effects"]}
    return (
        found["status"],
        effects,
        (found["gap"]["holdout"][0], found["gap"]["left"]["noise"]),
        [found["sentence"]],
    )


def line(rows, one, budget, half):
    """Return a campaign's row of the table, whether it is told right and wrong, and what else is said."""
    first = rows[0]
    base = Model(first["base"], restoring=first["restoring"])
    began = time.process_time()
    status, effects, (before, after), said = asked(one, base, budget)
    spent = time.process_time() - began
    there, wrong = right(first["label"], effects)
    cells = [
        first["campaign"],
        half,
        first["base"] + (", linear" if first["restoring"] == "linear" else ""),
        first["label"].replace("|", " or "),
        " · ".join(" or ".join([name, *ties]) for name, ties in effects.items()) or "–",
        status,
        "right" if there else "wrong" if wrong else "nothing",
        f"{before:.3g} → {after:.3g}",
        f"{spent:.0f}",
    ]
    return cells, there, wrong, said


def written(rows, path):
    """Return nothing; a table has these rows in the place of those that it had of their campaigns, in the order of campaigns.csv."""
    known = {tuple(row[:2]): row for row in rows}
    if path.exists():
        with path.open(encoding="utf-8", newline="") as file:
            known = {tuple(row[:2]): row for row in list(csv.reader(file))[1:]} | known
    places = [(name, half) for name in listed() for half in (*HALVES.values(), *AGAIN.values())]
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerows([COLUMNS, *(known[place] for place in places if place in known)])


def main(argv=None):
    """The table printed, line by line, and how many of campaigns and apparatuses are told right, and wrong."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--split", choices=[*HALVES], required=True)
    parser.add_argument("--mirrors")
    parser.add_argument("--data", type=Path, help="folder of the recordings that others prepared")
    parser.add_argument(
        "--only", nargs="*", default=[""], help="campaigns whose name holds one of these texts"
    )
    parser.add_argument(
        "--budget", type=float, default=600.0, help="CPU seconds a search, as discovery.budget_s"
    )
    parser.add_argument("--out", type=Path)
    parser.add_argument("--pickles", type=Path, help="write the campaigns to this folder, and search nothing")
    parser.add_argument("--again", action="store_true", help="what was searched once; its own rows stay")
    given = parser.parse_args(argv)
    if given.again and given.split not in AGAIN:
        parser.error("the open half was searched many times: leave --again out")
    half = (AGAIN if given.again else HALVES)[given.split]
    campaigns = {
        name: rows for name, rows in listed(given.split).items() if any(text in name for text in given.only)
    }
    files = {
        (row["repository"], row["path"]): row for rows in campaigns.values() for row in rows if row["commit"]
    }
    fetched(
        [row for row in files.values() if not place(given.folder, row).exists()], given.folder, given.mirrors
    )
    lines, told = [], []
    for name, rows in campaigns.items():
        try:
            one = built(rows, given.folder, given.data or Path())
            if given.pickles:
                kept(rows, one, given.pickles)
                continue
            row, there, wrong, said = line(rows, one, given.budget, half)
            told.append((rows[0]["apparatus"], there, wrong))
        except InputError as problem:
            blank = [name, half, *"–" * 3, f"not read: {problem.problem}", "nothing", "–", "–"]
            row, said = blank, []
            told.append((rows[0]["apparatus"], False, False))
        lines.append(row)
        print(*row, sep=" | ")
        print(*(f"    {text}" for text in said), sep="\n", flush=True)
        if given.out:
            written(lines, given.out)
    right_of = {name: [there for apparatus, there, _ in told if apparatus == name] for name, _, _ in told}
    print(f"told right: {sum(there for _, there, _ in told)} of {len(told)} campaigns, wrong: {sum(wrong for _, _, wrong in told)}; "
          f"of {len(right_of)} apparatuses every campaign: {sum(map(all, right_of.values()))}, at least one: {sum(map(any, right_of.values()))}")  # fmt: skip


def kept(rows, one, folder):
    """Return nothing; the campaign is written as NAME.pkl: (name, swings, base, restoring, label, split), and whole as NAME.campaign.pkl."""
    first = rows[0]
    folder.mkdir(parents=True, exist_ok=True)
    whole = (
        first["campaign"],
        list(one.whole),
        *(first[key] for key in ("base", "restoring", "label", "split")),
    )
    (folder / f"{first['campaign']}.pkl").write_bytes(pickle.dumps(whole))
    (folder / f"{first['campaign']}.campaign.pkl").write_bytes(pickle.dumps(one))


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    main()
