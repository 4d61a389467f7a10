"""What `swingdown FILE --quick` makes of each recording of the corpus, as a table in Markdown.

    .venv/bin/python tests/benchmarks/corpus/fates.py FOLDER --split learn [--only TEXT] [--out ROWS.json]
    .venv/bin/python tests/benchmarks/corpus/fates.py --table ROWS.json ... --onto docs/corpus.md > page.md

FOLDER is what fetch.py filled. Of files that are in no ROWS.json, the page keeps the rows that ``--onto`` has of them. Each file is one process, called as a user would call it. A file's fate is one of

- answered: a period, and it is the pendulum's: within the tolerance of the period that a person counted in the plot;
- asked: no number, but a question that a person would have to ask too (the file's `question` in files.csv); where that has
  an answer (`options`), the command with it then gives the period;
- refused: no number, and no such question;
- wrong: a number that is not the pendulum's.
"""

import argparse
import collections
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
TITLES = {"learn": "Open while the reading was mended", "apart": "Kept apart at first", "fresh": "Read once"}


@dataclass
class Told:
    """What one call gave: periods (s) by recording, as written with their uncertainty, and everything it said."""

    periods: list
    written: list
    said: str


def right(row, told):
    """Return whether every period that was told lies among those that were counted, from the first swings to the last."""
    ends, tolerance = [float(row["period_s"]), float(row["period_end_s"])], float(row["tolerance_s"])
    return all(min(ends) - tolerance <= p <= max(ends) + tolerance for p in told.periods)


def fate(row, first, second=None):
    """Return a file's fate from its first call and, where its question has an answer, from the call with that answer."""
    if first.periods:
        return "answered" if right(row, first) else "wrong"
    if "Traceback" in first.said:
        return "refused"
    if row["demand"] != "ask" or not re.search(row["question"], first.said, re.IGNORECASE):
        return "refused"
    if not row["options"]:
        return "asked"
    if not second or not second.periods:
        return "refused"
    return "asked" if right(row, second) else "wrong"


def called(path, options, seconds):
    """Return what `swingdown PATH --quick` told with these options."""
    with tempfile.TemporaryDirectory() as folder:
        study = Path(folder) / "study"
        command = [COMMAND, path, "--quick", "--into", study, *options]
        try:
            done = subprocess.run(
                command, capture_output=True, text=True, timeout=seconds, stdin=subprocess.DEVNULL
            )
            said = done.stdout + "\n" + done.stderr
        except subprocess.TimeoutExpired:
            return Told([], [], f"problem: no answer within {seconds} s")
        answers = sorted(study.glob("**/first_answer.csv"))
        if not answers:
            return Told([], [], said)
        table = pd.read_csv(answers[0]).dropna(subset=["period_s"])
        return Told(table["period_s"].tolist(), table["period_s_text"].astype(str).tolist(), said)


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
    if not first.periods and row["demand"] == "ask" and row["options"]:
        second = called(path, shlex.split(row["options"]), seconds)
    last = first if first.periods or second is None else second
    asked = "" if first.periods else short(first.said)
    taken = re.search(r"took (.*)", last.said)
    read = taken[1] if taken and last.periods else ""
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
    }


def cell(text, width=110):
    """Return text that a table's cell can hold."""
    text = " ".join(str(text).split()).replace("|", "\\|")
    return text if len(text) <= width else text[: width - 1] + "…"


def counted(row):
    """Return the periods that a person counted, of the first swings and of the last, and how."""
    last = "" if row["period_end_s"] == row["period_s"] else f" … {row['period_end_s']}"
    return f"{row['period_s']}{last} ± {row['tolerance_s']}, {row['check']}"


def line(r):
    """Return a file's row of the table."""
    told = r["said"] + (f" → `{r['options']}`: {r['read']}" if r["read"] and r["said"] else r["read"])
    return (
        f"| {cell(r['repository'] + ' ' + r['path'], 150)} | {cell(r['what'])}, {cell(r['recorder'])} | {cell(told, 220)} "
        f"| {r['answer']} | {counted(r)} | {r['fate']} |"
    )


def kept(page):
    """Return the rows that a page has, as they would be had they just been read: of each file its line and its fate."""
    lines = {one.split(" | ")[0]: one for one in page.splitlines() if one.endswith(" |")}
    found = []
    for row in listed(None):
        if one := lines.get("| " + cell(row["repository"] + " " + row["path"], 150)):
            found.append({**row, "line": one, "fate": one.rsplit("|", 2)[1].strip()})
    return found


def summary(rows, name):
    """Return the lines that count the fates of some rows."""
    count = collections.Counter(r["fate"] for r in rows)
    good = count["answered"] + count["asked"]
    fates = " | ".join(str(count[f]) for f in FATES)
    repositories = len({r["repository"] for r in rows})
    return f"| {name} | {len(rows)} | {repositories} | {fates} | {100 * good / max(len(rows), 1):.0f} % |"


def page(rows):
    """Return the page of all rows: the counts by split and recorder, then each file."""
    head = (
        "| | files | repositories | "
        + " | ".join(FATES)
        + " | answered or rightly asked |\n|---|"
        + "---|" * (len(FATES) + 3)
    )
    lines = [Path(__file__).with_name("head.md").read_text(encoding="utf-8").rstrip(), "", head]
    parts = {split: [r for r in rows if r["split"] == split] for split in SPLITS}
    lines += [summary(part, f"**{TITLES[split].lower()}**") for split, part in parts.items() if part]
    for recorder in sorted({r["recorder"] for r in rows}):
        lines.append(summary([r for r in rows if r["recorder"] == recorder], recorder))
    for split, part in parts.items():
        if part:
            lines += [
                "",
                f"## {TITLES[split]}",
                "",
                "| file | what, recorder | read or said | answer (s) | counted (s) | fate |",
                "|---|---|---|---|---|---|",
            ]
        part = sorted(part, key=lambda r: (r["repository"].lower(), r["path"].lower()))
        lines += [r["line"] if "line" in r else line(r) for r in part]
    return "\n".join(lines) + "\n"


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", nargs="?")
    parser.add_argument("--split", choices=SPLITS)
    parser.add_argument("--only", default="", help="files whose repository or path holds this text")
    parser.add_argument("--seconds", type=float, default=180, help="at most for one call")
    parser.add_argument("--out", help="file for the rows (JSON)")
    parser.add_argument(
        "--table", nargs="+", metavar="ROWS.json", help="print the page of these rows, and run nothing"
    )
    parser.add_argument("--onto", help="a page whose rows of other files are kept")
    args = parser.parse_args(argv)
    if args.table:
        old = kept(Path(args.onto).read_text(encoding="utf-8")) if args.onto else []
        new = [r for name in args.table for r in json.loads(Path(name).read_text(encoding="utf-8"))]
        print(page(list({(r["repository"], r["path"]): r for r in old + new}.values())), end="")
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
