"""What `swingdown FILE --quick` makes of each recording of the corpus, as a table in Markdown.

    .venv/bin/python tests/benchmarks/corpus/fates.py FOLDER --split learn [--only TEXT] [--out ROWS.json]
    .venv/bin/python tests/benchmarks/corpus/fates.py --table ROWS.json ...

FOLDER is what fetch.py filled. The second call puts the rows of each ROWS.json in place of those that docs/corpus.csv has of these files,
and writes the counts into docs/corpus.md. Each file is one process, called as a user would call it. A file's fate is one of

- answered: a period, and it is the pendulum's: the mean periods of the first and of the last ten swings that follow from it (``timed`` of
  the JSON) are within the tolerance of those that a person counted in the plot;
- asked: no number, but a question that a person would have to ask too (the file's `question` in files.csv); where that has
  an answer (`options`), the command with it then gives the period;
- refused: no number, and no such question;
- wrong: a number that is not the pendulum's.
"""

import argparse
import collections
import csv
import json
import re
import shlex
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

sys.path.insert(0, str(Path(__file__).parent))
from fetch import SPLITS, listed, place

COMMAND = Path(sys.executable).with_name("swingdown")
FATES = ["answered", "asked", "refused", "wrong"]
TABLE = Path(__file__).resolve().parents[3] / "docs" / "corpus.csv"
OFTEN = 10  # files of a recorder that has a row of its own in the summary
COLUMNS = (
    "repository",
    "path",
    "set",
    "what",
    "recorder",
    "read or said",
    "answer (s)",
    "counted (s)",
    "fate",
)
TITLES = {"learn": "Open while the reading was mended", "apart": "Kept apart at first", "fresh": "Read once"}


@dataclass
class Told:
    """What one call gave: periods (s) as written with their uncertainty, those that a person would count, and everything it said."""

    written: list
    timed: list  # mean periods (s) of the first and of the last ten swings of each recording; the period itself where it has no course
    said: str
    apart: float = 0.0  # how far (s) the period is from that of the first swing by passages alone, beyond two standard uncertainties


def right(row, told):
    """Return whether every mean period that the answer gives of the first and of the last ten swings lies among those that were counted, from
    the first ten swings to the last, and its period is that of the first swing; of a file without a period that can be counted, False."""
    if not row["period_s"]:
        return False
    ends, tolerance = [float(row["period_s"]), float(row["period_end_s"])], float(row["tolerance_s"])
    among = all(min(ends) - tolerance <= p <= max(ends) + tolerance for p in told.timed)
    return among and told.apart <= tolerance


def fate(row, first, second=None):
    """Return a file's fate from its first call and, where its question has an answer, from the call with that answer."""
    if first.written:
        return "answered" if right(row, first) else "wrong"
    if "Traceback" in first.said:
        return "refused"
    if row["demand"] != "ask" or not re.search(row["question"], first.said, re.IGNORECASE):
        return "refused"
    if not row["options"]:
        return "asked"
    if not second or not second.written:
        return "refused"
    return "asked" if right(row, second) else "wrong"


def called(path, options, seconds):
    """Return what `swingdown PATH --quick` told with these options."""
    with tempfile.TemporaryDirectory() as folder:
        study = Path(folder) / "study"
        command = [COMMAND, path, "--quick", "--json", "--into", study, *options]
        try:
            done = subprocess.run(
                command, capture_output=True, text=True, timeout=seconds, stdin=subprocess.DEVNULL
            )
        except subprocess.TimeoutExpired:
            return Told([], [], f"problem: no answer within {seconds} s")
        answers = sorted(study.glob("**/first_answer.csv"))
        found = json.loads(done.stdout) if done.stdout.strip() else {"periods_by_hand": []}
        if len(by_hand := found["periods_by_hand"]) == 1:
            return Told(
                [f"{one['period_s']:.5g}" for one in by_hand],
                [one["period_s"] for one in by_hand],
                done.stderr,
            )
        if not answers or not done.stdout.strip():
            return Told([], [], done.stderr)
        table = pd.read_csv(answers[0]).dropna(subset=["period_s"])
        return Told(
            table["period_s_text"].astype(str).tolist(),
            [p for one in found["pendulums"] for p in means(one)],
            done.stderr,
            max(map(apart, found["pendulums"]), default=0.0),
        )


def apart(pendulum):
    """Return how far the period of a pendulum of one recording is from that of its first swing by passages of the middle alone, beyond two
    standard uncertainties; 0 where either is not told, and of what does not die away, whose first swing need not be the widest."""
    dies = "quality" in pendulum["quantities"]
    period, timed = pendulum["quantities"].get("period") if dies else None, pendulum["timed"]
    first = timed[0]["first_swing"] if len(timed) == 1 else {"period_s": None}
    if period is None or first["period_s"] is None:
        return 0.0
    u = [one or 0.0 for one in (period["standard_uncertainty"], first["standard_uncertainty"])]
    return abs(period["value"] - first["period_s"]) - 2 * (u[0] ** 2 + u[1] ** 2) ** 0.5


def means(pendulum):
    """Return the mean periods (s) of the first and of the last ten swings of each recording in the JSON of a pendulum; of points alone, and
    of too few swings, the period."""
    found = [one[part]["period_s"] for one in pendulum["timed"] for part in ("first", "last")]
    period = pendulum["quantities"].get("period")
    return found or ([period["value"]] if period else [])


def short(said):
    """Return the line that tells what was read, or what was wrong, of all that was said."""
    if "Traceback" in said:
        return "TRACEBACK " + said.strip().splitlines()[-1]
    told = (
        re.search(r"problem: +(.*)", said)
        or re.search(r"NOT USED: (.*)", said)
        or re.search(r"took (.*)", said)
    )
    return told[1] if told else " ".join(said.split())[-160:]


def tried(row, folder, seconds):
    """Return one file's fate with what was told, as a dict of the table's cells."""
    path = place(folder, row)
    first = called(path, [], seconds)
    second = None
    if not first.written and row["demand"] == "ask" and row["options"]:
        second = called(path, shlex.split(row["options"]), seconds)
    last = first if first.written or second is None else second
    asked = "" if first.written else short(first.said)
    taken = re.search(r"took (.*)", last.said)
    read = taken[1] if taken and last.written else ""
    answer = ", ".join(last.written[:2]) + (
        f" and {len(last.written) - 2} more" if len(last.written) > 2 else ""
    )
    return {
        **row,
        "fate": fate(row, first, second),
        "read": read,
        "said": asked,
        "answer": answer,
        "all": [first.said, second.said if second else ""],
        "timed": last.timed,
        "apart": last.apart,
    }


def cell(text, width=110):
    """Return text that a table's cell can hold."""
    text = " ".join(str(text).split()).replace("|", "\\|")
    return text if len(text) <= width else text[: width - 1] + "…"


def counted(row):
    """Return the periods that a person counted, of the first swings and of the last, and how."""
    if not row["period_s"]:
        return "none"
    last = "" if row["period_end_s"] == row["period_s"] else f" … {row['period_end_s']}"
    return f"{row['period_s']}{last} ± {row['tolerance_s']}, {row['check']}"


def row_of(r):
    """Return a file's row of docs/corpus.csv."""
    told = r["said"] + (f" → `{r['options']}`: {r['read']}" if r["read"] and r["said"] else r["read"])
    cells = (
        r["repository"], r["path"], TITLES[r["split"]].lower(), r["what"], r["recorder"], cell(told, 220), r["answer"], counted(r), r["fate"],
    )  # fmt: skip
    return dict(zip(COLUMNS, cells, strict=True))


def kept():
    """Return the rows that docs/corpus.csv has of the files of the list, with what the list now says of them."""
    with TABLE.open(encoding="utf-8", newline="") as f:
        old = {(one["repository"], one["path"]): one for one in csv.DictReader(f)}
    found = {}
    for row in listed(None):
        key = row["repository"], row["path"]
        if key in old:
            found[key] = {**old[key], "set": TITLES[row["split"]].lower(), "counted (s)": counted(row)}
    return found


def summary(rows, name):
    """Return the lines that count the fates of some rows."""
    count = collections.Counter(r["fate"] for r in rows)
    good = count["answered"] + count["asked"]
    fates = " | ".join(str(count[f]) for f in FATES)
    repositories = len({r["repository"] for r in rows})
    return f"| {name} | {len(rows)} | {repositories} | {fates} | {100 * good / max(len(rows), 1):.0f} % |"


def page(rows):
    """Return the page of all rows: what it is about, the counts by set and by frequent recorder, and the table."""
    head = (
        "| | files | repositories | "
        + " | ".join(FATES)
        + " | answered or rightly asked |\n|---|"
        + "---|" * (len(FATES) + 3)
    )
    lines = [Path(__file__).with_name("head.md").read_text(encoding="utf-8").rstrip(), "", head]
    for title in TITLES.values():
        if part := [r for r in rows if r["set"] == title.lower()]:
            lines.append(summary(part, f"**{title.lower()}**"))
    known = sorted({r["recorder"] for r in rows})
    parts = {recorder: [r for r in rows if r["recorder"] == recorder] for recorder in known}
    often = {recorder: part for recorder, part in parts.items() if len(part) >= OFTEN}
    lines += [summary(part, recorder) for recorder, part in often.items()]
    if rest := [r for r in rows if r["recorder"] not in often]:
        lines.append(summary(rest, f"{len(parts) - len(often)} others"))
    lines += ["", "```{csv-table}", ":file: corpus.csv", ":header-rows: 1", "```"]
    return "\n".join(lines) + "\n"


def write(new):
    """None; docs/corpus.csv and docs/corpus.md hold these rows, and of all other files those that they had."""
    rows = {**kept(), **{(r["repository"], r["path"]): row_of(r) for r in new}}
    order = list(map(str.lower, TITLES.values()))
    ordered = sorted(
        rows.values(), key=lambda r: (order.index(r["set"]), r["repository"].lower(), r["path"].lower())
    )
    with TABLE.open("w", encoding="utf-8", newline="") as f:
        table = csv.DictWriter(f, COLUMNS, lineterminator="\n")
        table.writeheader()
        table.writerows(ordered)
    TABLE.with_suffix(".md").write_text(page(ordered), encoding="utf-8")


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", nargs="?")
    parser.add_argument("--split", choices=SPLITS)
    parser.add_argument("--only", default="", help="files whose repository or path holds this text")
    parser.add_argument("--seconds", type=float, default=180, help="at most for one call")
    parser.add_argument("--out", help="file for the rows (JSON)")
    parser.add_argument(
        "--table", nargs="+", metavar="ROWS.json", help="put these rows into docs/corpus.csv, and run nothing"
    )
    args = parser.parse_args(argv)
    if args.table:
        write([r for name in args.table for r in json.loads(Path(name).read_text(encoding="utf-8"))])
        return
    rows = []
    for row in listed(args.split):
        if args.only in f"{row['repository']}/{row['path']}":
            rows.append(tried(row, args.folder, args.seconds))
            r = rows[-1]
            print(
                f"{r['fate']:8} {r['repository']}/{r['path']}  {r['answer']}  {cell(r['said'] or r['read'])}",
                flush=True,
            )
    if args.out:
        Path(args.out).write_text(json.dumps(rows, indent=1, ensure_ascii=False), encoding="utf-8")
    print(summary(rows, args.split or "all"))


if __name__ == "__main__":
    main()
