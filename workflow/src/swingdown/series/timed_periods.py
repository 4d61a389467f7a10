"""Periods timed by hand, in a table: over what was varied, or trial below trial."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from scipy import special

from ..arrays import Floats
from ..errors import InputError
from ..measurement.stated import UNITS, Stated, read
from ..pendulum.half_swings import lengthening
from ..studies.gravity import ON_EARTH
from .hand_table import COUNTED, HandTable, Head, hand_table
from .values import GROUP, KNOWN, Values, cell

NEAR = 0.3  # of g: what lengths and periods of a bob on a string give, however carelessly measured
MOST = 50  # swings that somebody counts
# trials differ by no more: a share of the period, by chance as rarely, and what a hand errs by (s)
ALIKE, CHANCE, HAND = 0.05, 0.01, 0.5


class Timed(NamedTuple):
    """Periods that were timed by hand.

    Attributes
    ----------
    table
        A row for each line of the file, or for its trials: recording, label, period_s and period_s_u (its standard uncertainty); as
        ``series_of`` takes it.
    values, groups
        What was varied, by recording and column.
    others
        Columns of numbers that are neither times nor known as varied.
    told
        How the file was read, a line each.
    emulated
        ``yes`` where the file says so.
    """

    table: pd.DataFrame
    values: Values
    groups: dict[str, dict[str, str]]
    others: list[str]
    told: list[str]
    emulated: str

    def period(self) -> Stated | None:
        """The period (s) of trials of one pendulum; None where anything was varied."""
        if len(self.table) > 1:
            return None
        one = self.table.iloc[0]
        return Stated(float(one["period_s"]), float(one["period_s_u"]), "s")


def timed(path: Path, by: str = "", u: float = np.nan) -> Timed | None:
    """The ``Timed`` periods of a table, or None for a file that is no such table.

    Its heads name times of a counted number of swings (``time for 10 swings (s)``), or the period and what was varied with it
    (``length (cm)``, ``mass (g)``). Columns of one kind side by side are trials, and so are lines that differ in nothing else. The standard
    uncertainty is that of the mean of the trials, by the scatter of all; without trials that of the last digit.

    Parameters
    ----------
    path
        A text file or a workbook.
    by
        A column that was varied, if it is none of length, mass, area, current; in small letters.
    u
        The standard uncertainty of its values, in the SI's unit, where the file has none.

    Raises
    ------
    InputError
        If the heads leave open how many swings were timed, a cell is no number, two columns say one thing, columns side by side are no trials
        of one pendulum, or lengths and periods fit another count of swings.
    """
    given = hand_table(path)
    if given is None:
        return None
    times = given.seconds(path)
    kept = times.notna().any(axis=1)
    given, times = given._replace(cells=given.cells[kept]), times[kept]
    alike = {name: one for name, one in given.heads.items() if not (one.counts or one.error)}
    _check_columns(times, path)
    told = [_told(given)]
    if given.beside > 1:
        told.append(f"{given.beside} tables with the same heads stand side by side: taken for one")
    if angle := next((name for name, one in alike.items() if one.angle), None):
        longer = _longer(given.cells[angle], alike[angle].unit, f"{path.name}, column {angle}")
        times = times.div(longer, axis=0)
        told.append(f"periods are those of small swings, by the angle of release in `{angle}`")
    else:
        told.append("taken as periods of small swings, as no column has the angle of release")
    table, lines, trials, scatter = _of_trials(times, given.cells[list(alike)], given.last_digit)
    _check_lines(trials, scatter, given.usual, path)
    if len(lines) == times.notna().to_numpy().sum():
        told.append("there are no trials: how the points scatter tells the uncertainty")
    given = given._replace(cells=given.cells.loc[lines].set_axis(table["recording"]))
    values, groups = _varied(given, by, path, lines)
    told += _of_lengths(values, dict(zip(table["recording"], table["period_s"], strict=True)), given, path)
    for own in values.values():
        if by in own and not own[by].uncertainty >= 0:
            own[by] = own[by]._replace(uncertainty=u)
    unknown = [name for name, one in alike.items() if not (one.angle or one.column in (*KNOWN, GROUP, by))]
    others = [name for name in unknown if len({text for text in given.cells[name] if read(text)}) > 1]
    return Timed(table, values, groups, others, told, "yes" if given.emulated else "no")


def _check_columns(times: pd.DataFrame, path: Path) -> None:
    """None for columns of times that may be trials of one pendulum; InputError where each is longer than another in line after line.

    By an analysis of variance of columns beside lines: people who start and stop a watch differ by little. Of one line chance is not known.
    """
    whole = times.dropna().to_numpy()
    lines, columns = whole.shape
    if not lines or columns < 2:
        return
    left = whole - whole.mean(axis=1, keepdims=True)
    each, free = left.mean(axis=0), (lines - 1) * (columns - 1)
    scatter = float(((left - each) ** 2).sum()) / max(free, 1)
    between, apart = lines * float((each**2).sum()) / (columns - 1), float(np.ptp(each) / whole.mean())
    chance = special.fdtrc(columns - 1, free, between / scatter) if scatter > 0 and free else 0.0
    if apart > ALIKE and chance < CHANCE:
        raise InputError(
            path.name, f"its columns of times differ by {100 * apart:.2g} % in line after line, as those of one pendulum do not: whose are they?",
            "trials of one pendulum side by side", "make a file of each pendulum's times",
        )  # fmt: skip


def _check_lines(trials: Sequence[Floats], scatter: float, swings: float, path: Path) -> None:
    """None for periods (s) that may be of the same pendulum in each group; InputError where they scatter (s) more than a watch in a hand does."""
    mean = float(np.mean(np.concatenate(trials)))
    if scatter > ALIKE * mean and scatter * swings > HAND:
        raise InputError(
            path.name, f"times of what seems to be one pendulum scatter by {100 * scatter / mean:.2g} %, {scatter * swings:.2g} s: are they of several?",
            "trials of one pendulum, or a column of what was varied", "add a column with the length, the mass or the name of each",
        )  # fmt: skip


def _told(given: HandTable) -> str:
    names, swings = ", ".join(f"`{one.name}`" for one in given.times), given.times[0].swings
    told = f"took {names} as times of {swings} swings" if swings > 1 else f"took {names} as times of a swing"
    if given.counts:
        told = f"took {names} as times of as many swings as `{given.counts}` says"
    return told + ("; trials side by side" if len(given.times) > 1 else "")


def _longer(cells: pd.Series, unit: str, where: str) -> Floats:
    """How many times longer than of small swings the period is at the angles of a column."""
    known = np.array([abs(one.value) if (one := read(text)) else np.nan for text in cells])
    dimension, factor = UNITS.get(unit, ("", 1.0))
    if dimension != "rad" and np.nanmax(known) > np.pi:
        factor = UNITS["deg"][1]
    if not np.all(known * factor < np.pi):
        raise InputError(where, "not every line holds an angle of release", "angles below 180°", "correct it")
    return lengthening(known * factor)


def _of_trials(
    times: pd.DataFrame, alike: pd.DataFrame, digit: float
) -> tuple[pd.DataFrame, list[Any], list[Floats], float]:
    """The table of mean periods with their standard uncertainties, the first line of each, its trials, and how far (s) these scatter.

    Pooled over all trials (JCGM 100, 4.2), with half a unit of the last digit (4.3.7).
    """
    which: dict[tuple[str, ...], list[Any]] = {}
    for line, cells in alike.iterrows():
        which.setdefault(tuple(cells), []).append(line)
    trials = [times.loc[lines].stack().dropna().to_numpy() for lines in which.values()]
    free = sum(one.size - 1 for one in trials)
    pooled = sum(float(((one - one.mean()) ** 2).sum()) for one in trials) / free if free else 0.0
    rows = []
    for lines, one in zip(which.values(), trials, strict=True):
        numbers, u = list(map(str, lines)), float(np.sqrt((pooled + digit**2 / 12) / one.size))
        label = f"line{'s' * (len(lines) > 1)} {', '.join(numbers)}"
        rows.append((f"line-{'-'.join(numbers)}", label, float(one.mean()), u))
    table = pd.DataFrame(rows, columns=["recording", "label", "period_s", "period_s_u"])
    return table, [lines[0] for lines in which.values()], trials, float(np.sqrt(pooled))


def _varied(
    given: HandTable, by: str, path: Path, lines: Sequence[Any]
) -> tuple[Values, dict[str, dict[str, str]]]:
    """The values of what was varied, and the groups, by recording; InputError for a cell that is none, and two columns of one thing."""
    values: Values = {str(name): {} for name in given.cells.index}
    groups: dict[str, dict[str, str]] = {name: {} for name in values}
    errors = {one.column: (name, one) for name, one in given.heads.items() if one.error}
    seen: dict[str, str] = {}
    for name, one in given.heads.items():
        if one.error or one.column not in (*KNOWN, GROUP, by):
            continue
        first = seen.setdefault(one.column, name)
        if first != name:
            raise InputError(f"{path.name}, columns {first} and {name}", f"each is the {one.column}", "one such column", "leave one of them out")  # fmt: skip
        for recording, line in zip(values, lines, strict=True):
            text = str(given.cells.loc[recording, name])
            if not text:
                continue
            if one.column == GROUP:
                groups[recording][GROUP] = text
                continue
            found = cell(text, one.unit, one.column, f"{path.name}, line {line}, column {name}")
            beside, error = errors.get(one.column, ("", one))
            if beside and (own := str(given.cells.loc[recording, beside])):
                size = cell(own, error.unit or one.unit, one.column, f"{path.name}, line {line}, column {beside}")  # fmt: skip
                found = found._replace(uncertainty=size.value)
            values[recording][one.column] = found
    return values, groups


def _of_lengths(values: Values, periods: Mapping[str, float], given: HandTable, path: Path) -> list[str]:
    """What is said of lengths that state no unit: theirs is then the one by which weight pulls a bob on a string back.

    InputError where the periods are those of several swings.
    """
    lengths = {name: own["length"] for name, own in values.items() if "length" in own}
    if not lengths:
        return []
    g = float(np.median([4 * np.pi**2 * one.value / periods[name] ** 2 for name, one in lengths.items()]))
    if abs(g / ON_EARTH - 1) < NEAR:
        return []
    for unit in ("cm", "mm", "in") if _unitless(given.cells, given.heads) else ():
        factor = UNITS[unit][1]
        if abs(g * factor / ON_EARTH - 1) < NEAR:
            for name, one in lengths.items():
                values[name]["length"] = Stated(one.value * factor, one.uncertainty * factor, "m")
            would = f"as in m they would give g = {g:.3g} m/s²"
            return [f"no unit of the lengths is stated: TAKEN AS {unit}, {would}"]
    for swings in range(2, MOST + 1) if given.times[0].swings == 1 else ():
        if abs(g * swings**2 / ON_EARTH - 1) < NEAR / swings:
            raise InputError(
                path.name, f"its lengths and periods give g = {g:.2g} m/s²; are these the times of {swings} swings?", COUNTED, "correct the head",
            )  # fmt: skip
    return []


def _unitless(cells: pd.DataFrame, heads: Mapping[str, Head]) -> bool:
    """Whether neither the head nor a cell of the lengths states a unit."""
    name, one = next((name, one) for name, one in heads.items() if one.column == "length" and not one.error)
    return not one.unit and not any(known.unit for text in cells[name] if (known := read(text)))
