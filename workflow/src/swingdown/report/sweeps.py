"""What the report says of sweeps: their maps, and beside them the paper's claim."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from ..pendulum.model import in_words
from ..sealed import read_csv
from .page import Cell, Column, Figure, Findings, Item, Section, Table, Text
from .wording import groups

CLAIM = 68  # per cent
_LABELS = {"true_by_norm": "by norm", "true_by_bic": "by BIC", "true_by_ten": "by ten runs"}
_MAPS = {
    "by_norm": "by norm",
    "by_bic": "by BIC",
    "by_ten": "by ten runs",
    "detection": "what discovery said",
}


@dataclass(frozen=True)
class Made:
    """A sweep whose results are there: its summary table, and for each map its name, picture and caption."""

    table: pd.DataFrame
    maps: list[tuple[str, str, str]]


def made(
    names: Iterable[str], captions: Iterable[str], results: str | Path = "results/sweeps"
) -> dict[str, Made]:
    """The sweeps of those names whose table and maps lie in the results folder, by name (``Made``).

    ``captions`` are the paths of the maps' captions, ``sweep_by_norm.rst`` and so on.
    """
    texts = {Path(path).stem.removeprefix("sweep_"): path for path in captions}
    found = {}
    for name in names:
        folder = Path(results) / name
        pictures = [folder / "figures" / f"{map}.svg" for map in _MAPS]
        pictures = [path for path in pictures if path.exists()]
        if (folder / "summary.csv").exists() and pictures:
            told = [
                (path.stem, str(path), Path(texts[path.stem]).read_text(encoding="utf-8"))
                for path in pictures
            ]
            found[name] = Made(read_csv(folder / "summary.csv"), told)
    return found


def section(sweeps: Mapping[str, Made]) -> Section:
    """The section of all sweeps that were computed."""
    items: list[Item] = []
    for name, one in sweeps.items():
        title, kind = name.replace("_", " "), _identified if "true_by_norm" in one.table else _detected
        items.append(kind(title, one.table))
        items += [Figure(f"Sweep {title}, {_MAPS[map]}", path, caption) for map, path, caption in one.maps]
    if items:
        items.insert(0, Findings([line for name, one in sweeps.items() for line in _said(name, one.table)]))
        text = "Every draw is in results/sweeps/…/sweep.nc, every probability with its interval in summary.csv beside it."
        items.append(Text(text))
    return Section("Sweeps", items)


def _said(name: str, table: pd.DataFrame) -> Iterator[str]:
    """A few sentences on a sweep."""
    if lost := int((table["made"] == 0).sum()):
        why = "; ".join(sorted(set(table.loc[table["made"] == 0, "reason"].astype(str))))
        yield f"{name}: {lost} of {len(table)} cells could not be made ({why})."
    if "reached" in table and (short := int((table["reached"] == 0).sum())):
        yield f"{name}: in {short} of {len(table)} cells no size of the hidden effect leaves what was asked for; the table has what it leaves."
    if "true_by_norm" in table:
        several = "start" in table and table["start"].nunique() > 1
        for start, rows in table.groupby("start", sort=False) if several else [("", table)]:
            how = ten = ""
            if start:
                how = f", fits {'that start at rest at the first sample' if start == 'rest' else 'with the release fitted'}"
            if rows["true_by_ten"].notna().any():
                ten = f", and in the paper's own comparison (mean norm of ten runs, four models) in {_reached(rows['true_by_ten'])}"
            yield (
                f"{name}{how}: averaged over all cells the true model has the lowest norm in {_percent(rows['true_by_norm'])} of the swings and "
                f"the lowest BIC in {_percent(rows['true_by_bic'])}. The paper's 68 % is reached in {_reached(rows['true_by_norm'])} cells by "
                f"norm, in {_reached(rows['true_by_bic'])} by BIC{ten}."
            )
    else:
        if "size" in table:
            null = table[table["size"] == 0]
            if len(null):
                n = int(null["made"].sum())
                yield f"{name}: where nothing was hidden, the search reports something in {round((null['found'] * null['made']).sum())} of {n} campaigns."
            largest = table[table["size"] == table["size"].max()]
            yield (
                f"{name}: of effects that leave {table['size'].max():g} times the noise, {_percent(largest['found'])} are reported, "
                f"{_percent(largest['named'])} named alone, and {_percent(largest['said_wrong'])} named wrongly."
            )


def _identified(title: str, table: pd.DataFrame) -> Table:
    by = [name for name in ("simulated", "start", "noise") if name in table and table[name].nunique() > 1]
    by = by or [table.columns[0]]
    names = [name for name in _LABELS if table[name].notna().any()]
    columns = [Column(name.replace("_", " ")) for name in by] + [Column("cells", style="n")]
    columns += [Column(_LABELS[name], "mean % · cells ≥ 68 %", "n") for name in names]
    rows: list[list[Cell]] = []
    for keys, part in table.groupby(by, sort=False):
        shares = [part[name] for name in names]
        values = [f"{100 * one.mean():.0f} · {int((one >= CLAIM / 100).sum())}" for one in shares]
        rows.append([*map(in_words, keys), len(part), *values])
    caption = "How often the model that was simulated is the one that is told, and in how many cells at least as often as the paper's 68 %."
    notes = (
        f"{_counts(table['independent'])} draws a cell. By norm and by BIC: one swing, all models fitted.",
        "By ten runs: the paper's comparison, the mean norm of ten swings for the three single terms and the pair without the true one.",
    )
    return Table(f"Sweep {title}", caption, columns, rows, notes[: 2 if "true_by_ten" in names else 1])


def _detected(title: str, table: pd.DataFrame) -> Table:
    by = [name for name in ("effect", "size") if name in table]
    more = [c for c in table.columns[: list(table.columns).index("draws")] if c not in by]
    columns = [Column(name.replace("_", " ")) for name in (*by[:1], *more)]
    columns += [Column("left by the base model", "σ", "n"), Column("found", "%", "n"), Column("named alone", "%", "n"),
                Column("among others", "%", "n"), Column("without a name", "%", "n"), Column("wrong", "%", "n")]  # fmt: skip
    rows = [
        [*(in_words(row[name]) for name in (*by[:1], *more)), _number(row["left_by_base"], ".2g"),
         *(_number(100 * row[name], ".0f") for name in ("found", "named", "said_among_others", "said_unknown", "said_wrong"))]
        for _, row in table.iterrows()
    ]  # fmt: skip
    opened, notes = groups(table[by[0]]) if by else (), (f"{_counts(table['made'])} campaigns a row.",)
    caption = "What discovery said of campaigns with one effect more than its base model."
    return Table(f"Sweep {title}", caption, columns, rows, notes, opened)


def _counts(column: pd.Series) -> str:
    low, high = int(column.min()), int(column.max())
    return f"{low}" if low == high else f"{low} to {high}"


def _number(value: float, form: str) -> str:
    return format(value, form) if np.isfinite(value) else "–"


def _percent(values: pd.Series) -> str:
    return f"{100 * np.nanmean(values):.0f} %"


def _reached(values: pd.Series) -> str:
    return f"{int((values >= CLAIM / 100).sum())} of {int(values.notna().sum())}"
