"""A class, a series at the command line: what was varied is found, told, fitted, drawn and written beside the first answer."""

import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import pandas as pd

from ..errors import InputError
from ..extras import has
from ..language import IN_ENGLISH, Language
from ..measurement.stated import Stated, read
from ..measurement.straight_line import FEWEST
from ..paths import write_csv, write_json
from ..planning.own import Taken
from ..series import Series, as_table, from_names, from_rows, from_table, merged, series_of
from ..series.values import GROUP, KNOWN, table_beside
from . import Answer

TABLE, RECORD, FIGURE, GROUPS = "series.csv", "series.json", "series.png", "groups.png"


def without_table(paths: Sequence[Path], given: str) -> tuple[list[Path], Path | None]:
    """The recordings among the paths, and the table of values: the file ``given``, or a CSV file among them that lists the others."""
    if given and not Path(given).is_file():
        raise InputError(f"--values {given}", "there is no such file", "a CSV file with a column `file`", "correct the path")  # fmt: skip
    beside = Path(given) if given else table_beside(paths) if len(paths) > FEWEST else None
    return [one for one in paths if not beside or one.resolve() != beside.resolve()], beside


class Varied(NamedTuple):
    """What was varied, by recording: values and groups by column, how they were found, and the column that is asked for."""

    values: Mapping[str, Mapping[str, Stated]]
    groups: Mapping[str, Mapping[str, str]]
    told: Sequence[str]
    by: str


def varied(kept: Sequence[Taken], beside: Path | None, by: str) -> Varied:
    """What was varied between these recordings.

    Values in the sheet count before those in the table beside the files, and these before names. ``by`` is a column, with a standard
    uncertainty for values without one where it is ``length±1mm``.
    """
    column, u = asked(by)
    sheet, groups = from_rows(one.row for one in kept)
    stems = {one.row["recording"]: Path(one.row["file"]).stem for one in kept}
    runs = {one.row["recording"]: str(one.row.get("run", "")) for one in kept}
    named, sides, told = from_names({name: f"{stem} {runs[name]}".strip() for name, stem in stems.items()})
    values, words = from_table(beside, stems) if beside else ({}, {})
    everything, sides = merged(sheet, values, named), merged(groups, words, sides)
    if u:
        for own in everything.values():
            if column in own and not own[column].uncertainty >= 0:
                own[column] = own[column]._replace(uncertainty=u.value)
    told = [line for line in told if not _in(line, sheet, values)]
    told = [f"values from {beside.name}", *told] if beside else told
    return Varied(everything, sides, told, column)


def series(answers: Mapping[str, Answer], found: Varied) -> tuple[list[Series], list[str]]:
    """The ``Series`` that these answers are, and how their values were found; none where nothing was varied."""
    table = pd.concat([one.table for one in answers.values()], ignore_index=True)
    try:
        made = series_of(table, found.values, found.groups, found.by)
    except InputError as problem:
        if found.by:
            raise
        return [], [f"no series is made: {problem.problem}"]
    idle = {*KNOWN, GROUP} - {one.by for one in made}
    return made, [line for line in found.told if made and line.split(" ", 1)[0] not in idle]


def as_cells(kept: Sequence[Taken], made: Sequence[Series]) -> None:
    """Writes what a series goes by into the cells of its recordings that the sheet has for it, so that the report has it too.

    Not a length where the angle rests on one coordinate: there the cell would change how the file is read.
    """
    rows = {one.row["recording"]: one for one in kept}
    for one in made:
        if one.by not in (*KNOWN, GROUP):
            continue
        for point in one.table.to_dict("records"):
            taken = rows[point["recording"]]
            of_angle = one.by == "length" and "one coordinate" in taken.recording.attrs.get("remarks", "")
            if taken.row.get(one.by) or of_angle:
                continue
            error = point.get("u_x", 0.0)
            taken.row[one.by] = (
                str(point["group"]) if one.by == GROUP
                else f"({point['x']:.10g}±{error:.4g}) {one.unit}" if error else f"{point['x']:.10g} {one.unit}"
            )  # fmt: skip


def as_changed(kept: Sequence[Taken], found: Varied) -> None:
    """Writes what was changed between the recordings of one pendulum into their cells, where each has a value of what is asked for.

    Then the search tells which effect follows it.
    """
    names = [one.row["recording"] for one in kept]
    for source in (found.values, found.groups):
        known: list[Stated | str | None] = [source.get(name, {}).get(found.by) for name in names]
        if all(known):
            for one, value in zip(kept, known, strict=True):
                one.row.update(_changed(found.by, value))
            return


def _changed(by: str, value: Stated | str | None) -> dict[str, str]:
    """The cells of a value, or of a group, of what was changed."""
    if not isinstance(value, Stated):
        return {"changed": by, "changed_value": str(value)}
    unit = value.unit.replace("^", "")
    return {"changed": f"{by}_{unit}" if unit else by, "changed_value": f"{value.value:.10g}"}


def _in(line: str, *sources: Mapping[str, Mapping[str, Stated]]) -> bool:
    """True where a column that a line tells of is in one of these sources."""
    column = line.split(" ", 1)[0]
    return any(column in own for source in sources for own in source.values())


def asked(by: str) -> tuple[str, Stated | None]:
    """The column that ``--by`` names, and the standard uncertainty of its values where it says one; InputError for what is none."""
    column, _, rest = re.sub(r"\+/?-", "±", by).partition("±")
    if not rest:
        return column.strip(), None
    column = column.strip()
    found = read(rest)
    known = found.of(KNOWN.get(column, found.unit)) if found else None
    if known is None or not known.value > 0:
        problem = f"{rest!r} is no uncertainty of {column}"
        raise InputError(f"--by {by}", problem, "as length±1mm", "correct it")
    return column, known


def written(found: Sequence[Series], folder: Path, emulated: str, spoken: Language = IN_ENGLISH) -> list[str]:
    """The sentence of each series; its table, its numbers and, in the language ``spoken``, its figures are written into the folder."""
    if not found:
        return []
    write_csv(as_table(found), folder / TABLE)
    write_json(folder / RECORD, [one.to_dict() for one in found])
    made = [TABLE, *(_draw(found, folder, emulated, spoken) if has("matplotlib") else ())]
    return [*(one.sentence for one in found), f"the series: {', '.join(made)} in {folder}"]


def _draw(found: Sequence[Series], folder: Path, emulated: str, spoken: Language) -> Iterator[str]:
    """The names of the figures, each when it is written into the folder."""
    from ..plots import save  # matplotlib takes a second, and a single file has no series
    from ..plots.series import groups_side_by_side, over_what_was_varied
    from ..plots.style import in_language

    varied = [one for one in found if one.law]
    between = [one for one in found if one.comparison]
    several = len({one.by for one in varied}) > 1
    for by in dict.fromkeys(one.by for one in varied):
        name = FIGURE.replace(".", f"-{by}.") if several else FIGURE
        figure = over_what_was_varied([one for one in varied if one.by == by], emulated)
        save(in_language(figure, spoken), folder / name)
        yield name
    if between:
        first = [one for one in between if one.by == between[0].by]
        save(in_language(groups_side_by_side(first, emulated), spoken), folder / GROUPS)
        yield GROUPS
