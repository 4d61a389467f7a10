"""A table of periods that were timed by hand, at the command line: its series, or its mean period, and g."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..language import IN_ENGLISH, Language
from ..measurement.stated import Stated, quantity
from ..paths import write_csv
from ..rounding import plus_minus
from ..series import Series, series_of
from ..series.timed_periods import Timed, timed
from ..studies.gravity import STATED, Gravity, gravity
from .lengths import written as write_g
from .options import CELLS
from .series import asked
from .series import written as write_series

PERIODS = "periods.csv"


class ByHand(NamedTuple):
    """What a table of periods gave: the periods, the series, g, and what is said, a line each."""

    periods: list[dict[str, Any]]
    series: list[Series]
    g: dict[str, Gravity]
    told: list[str]


def by_hand(
    path: Path, folder: Path, by: str, stated: Mapping[str, Any], spoken: Language = IN_ENGLISH
) -> ByHand | None:
    """What a table of periods that were timed by hand gives; its files are written into the folder. None for any other file.

    ``stated`` are cells of the sample sheet: the length gives g where the table has no lengths. Its pictures are in the language ``spoken``. InputError as of ``series.timed``.
    """
    column, u = asked(by)
    column = column.lower().replace(" ", "_")
    found = timed(path, column, u.value if u else np.nan)
    if found is None:
        return None
    folder.mkdir(parents=True, exist_ok=True)
    told = [f"{path.name}: {'; '.join(found.told)}"]
    write_csv(found.table, folder / PERIODS)
    rows = found.table.to_dict("records")
    made = series_of(found.table, found.values, found.groups, column)
    if made:
        return ByHand(rows, made, {}, [*told, *write_series(made, folder, found.emulated, spoken)])
    of_g, more = _alone(found, folder, path.stem, stated)
    return ByHand(rows, [], of_g, [*told, *more])


def _alone(
    found: Timed, folder: Path, name: str, stated: Mapping[str, Any]
) -> tuple[dict[str, Gravity], list[str]]:
    """g where the trials are of one pendulum whose length is stated, and what is said of the trials."""
    period = found.period()
    if period is None:
        more = f"; --by {found.others[0]} makes one over it" if found.others else ""
        return {}, [f"three values or two groups make a series{more}: {folder / PERIODS} has the periods"]
    told = f"T = {plus_minus(period.value, period.uncertainty)} s"
    if not stated.get("length"):
        return {}, [told, "--length gives g"]
    given: dict[str, Any] = {
        cell: quantity(stated[cell], dimension, CELLS[cell], cell.replace("_", " "), "correct it")
        for cell, dimension in STATED.items()
        if stated.get(cell)
    }
    frequency = 2 * np.pi / period.value
    own = gravity(Stated(frequency, frequency * period.uncertainty / period.value, "rad/s"), **given)
    return {name: own}, [told, own.sentence, *write_g({name: own}, folder)]
