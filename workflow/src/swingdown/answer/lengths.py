"""g from the lengths that are stated with the recordings: told with the first answer, and written with its budget."""

from collections.abc import Mapping, MutableMapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from ..errors import InputError
from ..measurement.stated import quantity
from ..paths import write_csv, write_json
from ..planning.own import Taken
from ..studies.gravity import PIVOT, PIXELS, STATED, TWO, Gravity, budgets, of_two_pivots
from . import Answer
from .options import CELLS

BUDGET, RECORD = "g_budget.csv", "g.json"
PIVOTS = f"{PIVOT}s"  # of the command: a cell for each file


def with_lengths(
    rows: Sequence[MutableMapping[str, Any]], told: Mapping[str, Any], distances: Sequence[str] | None
) -> None:
    """Writes the distance of each pivot into the row of its recording. InputError for what is told and is no length, and where there
    are not two recordings for two distances."""
    for cell, dimension in STATED.items():
        text = told.get(cell)
        if text and not text.endswith(PIXELS):
            quantity(text, dimension, CELLS[cell], cell.replace("_", " "), "correct it")
    if not distances:
        return
    if len(rows) != len(distances):
        raise InputError(
            "--kater", f"{len(rows)} files", "two recordings of one body, each about a pivot of its own",
            "name two files, in the order of the distances",
        )  # fmt: skip
    for row, distance in zip(rows, distances, strict=True):
        row[PIVOT] = distance
        quantity(distance, "m", "--kater", "distance of a pivot", "correct it")


def with_g(
    answers: Mapping[str, Answer], kept: Sequence[Taken]
) -> tuple[dict[str, Answer], dict[str, Gravity]]:
    """The answers with g where a length is stated, and the ``Gravity`` of each recording, and of two pivots, by name."""
    stated = {one.row["recording"]: one.row for one in kept}
    each = {campaign: answer.with_g(stated) for campaign, answer in answers.items()}
    table = pd.concat([one.table for one in answers.values()], ignore_index=True)
    found = {name: own for _, of_one in each.values() for name, own in of_one.items()}
    return {campaign: one for campaign, (one, _) in each.items()}, found | of_two_pivots(table, stated)


def written(found: Mapping[str, Gravity], folder: Path) -> list[str]:
    """What is said of g, a line each; the budgets are written into the folder."""
    if not found:
        return []
    write_csv(budgets(found), folder / BUDGET)
    write_json(folder / RECORD, {name: one.to_dict() for name, one in found.items()})
    told = [found[TWO].sentence] if TWO in found else []
    return [*told, f"the budget of g: {folder / BUDGET}"]
