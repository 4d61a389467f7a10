"""The table of others' recordings: how a file's fate is told, and that the list of files is sound."""

import csv
import re
import shlex
import sys
from pathlib import Path

import pytest

CORPUS = Path(__file__).parent / "benchmarks" / "corpus"
sys.path.insert(0, str(CORPUS))

import fates  # noqa: E402
import fetch  # noqa: E402

ROW = {
    "period_s": "1.50",
    "period_end_s": "1.45",
    "tolerance_s": "0.02",
    "demand": "answer",
    "question": "",
    "options": "",
}
WHEEL = ROW | {"demand": "ask", "question": "linear|turn", "options": "--restoring linear"}
NOTHING = fates.Told([], [], "problem: a gap of 0.2 s")
QUESTION = fates.Told([], [], "it swings by three turns: --restoring LINEAR of a wheel?")


def number(*periods):
    return fates.Told([str(p) for p in periods], list(periods), "")


@pytest.mark.parametrize(
    ("row", "first", "second", "fate"),
    [
        (ROW, number(1.51), None, "answered"),
        (ROW, number(1.44), None, "answered"),  # of the last swings: they are shorter
        (ROW, number(1.53), None, "wrong"),
        (ROW, number(1.42), None, "wrong"),
        (ROW, number(1.5, 3.0), None, "wrong"),  # one run of two is not the pendulum's
        (ROW, NOTHING, None, "refused"),
        (ROW, QUESTION, number(1.5), "refused"),  # a person would not have to ask
        (WHEEL, number(1.5), None, "answered"),
        (WHEEL, NOTHING, number(1.5), "refused"),  # it asks of something else
        (WHEEL, QUESTION, number(1.5), "asked"),
        (WHEEL, QUESTION, number(0.75), "wrong"),
        (WHEEL, QUESTION, NOTHING, "refused"),  # the answer leads to no number
        (WHEEL | {"options": ""}, QUESTION, None, "asked"),
        (WHEEL | {"options": "", "period_s": ""}, QUESTION, None, "asked"),
        (WHEEL | {"options": "", "period_s": ""}, number(1.5), None, "wrong"),  # nobody can tell one
    ],
)
def test_fate(row, first, second, fate):
    assert fates.fate(row, first, second) == fate


def test_a_traceback_is_never_a_question():
    said = 'Traceback (most recent call last):\n  File "turn.py"\nValueError: turn'
    assert fates.fate(WHEEL, fates.Told([], [], said), number(1.5)) == "refused"


def test_list():
    with fetch.LIST.open(encoding="utf-8", newline="") as f:
        rows = list(csv.DictReader(f))
    assert len({(r["repository"], r["path"]) for r in rows}) == len(rows)
    apart = {r["repository"] for r in rows if r["split"] == "apart"}
    assert not apart & {r["repository"] for r in rows if r["split"] == "learn"}
    for r in rows:
        assert r["period_s"] or r["demand"] == "ask", r[
            "path"
        ]  # no clock, or nothing that swings: none can be counted
        assert (
            not r["period_s"]
            or float(r["period_s"]) > 0
            and 0 < float(r["tolerance_s"]) < 0.15 * float(r["period_s"])
        ), r["path"]
        assert (r["demand"] == "ask") == bool(r["question"]), r["path"]
        re.compile(r["question"])
        shlex.split(r["options"])


def test_table():
    """Each row of the page's table is a file of the list, and the page counts what the table holds."""
    with fates.TABLE.open(encoding="utf-8", newline="") as f:
        rows = list(csv.DictReader(f))
    listed = {(r["repository"], r["path"]) for r in fetch.listed(None)}
    found = [(r["repository"], r["path"]) for r in rows]
    assert len(set(found)) == len(found) and set(found) <= listed
    assert {r["fate"] for r in rows} <= set(fates.FATES)
    assert fates.page(rows) == fates.TABLE.with_suffix(".md").read_text(encoding="utf-8")
