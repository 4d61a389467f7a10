"""Which columns of a table hold the time, the swing and what was measured of its drive."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import pandas as pd

from ..arrays import Floats
from ..errors import InputError
from ..pendulum.half_swings import half_swings
from .files.columns import (
    ANGLE,
    COUNTS,
    RATE,
    TIME,
    UNNAMED,
    UNTOLD,
    VOLTAGE,
    Meaning,
    choose,
    drives,
    from_row_to_row,
    known_unit,
    numbers_rows,
    place_of,
    ticks_alone,
)
from .files.table import Table, first_rows
from .gyroscope import ASKEW, TO_RAD_PER_S
from .plausibility import ENOUGH, in_a_row
from .sheet import Row
from .swings.clock import RISES, counts_rows, goes_on

SHORTEST = 10  # samples; fewer tell nothing about a swing
LOOKED_FOR_NOISE = 20_000  # rows of which each column is looked at before it is called noise
# of the period of what swings beside it: so much later noise knows nothing of itself, a pendulum nearly all
FORGETS = 1 / 8
SURELY = 3.0  # standard errors of a correlation
KEEPS = 0.5  # of itself an eighth of a period later: a swing 0.7, less what noise it has
LOOKED_AT = 200_000  # rows of which each column is looked at before the swing is chosen


class Uncalibrated(InputError):
    """A recording in volts of which nobody says how many degrees a volt is."""


class SeveralSwings(InputError):
    """Several columns that swing, none of which says that it is the pendulum's."""


class Chosen(NamedTuple):
    """The columns of the time and of the swing (of a position two), and their units."""

    clock: Meaning
    found: list[Meaning]
    time_unit: str
    unit: str  # as stated anywhere, or ""


def input_of(table: Table, row: Row, place: str) -> list[str]:
    """The column of what was measured of the drive, as the row names it; none of a pendulum that swings by itself."""
    wanted = row.get("input_column", "")
    if not wanted:
        return []
    if wanted not in table.names:
        raise InputError(
            f"{row['file']} ({place}, column input_column)", f"the file has no column {wanted!r}", f"one of {', '.join(table.names)}",
            "correct ⟨input_column⟩, or the file's header",
        )  # fmt: skip
    return [wanted]


def says_nothing(table: Table) -> bool:
    """True of three columns or more of which none says that it holds the swing."""
    told = table.meanings
    return len(told) > 2 and all(one.kind in (TIME, UNTOLD) and not one.axis for one in told)


def guessed_in(table: Table) -> bool:
    """True where neither names nor the number of the columns say which one holds the swing."""
    return says_nothing(table) or ("no header" in table.layout and len(table.names) > 2)


def _by_words(table: Table, row: Row) -> list[Meaning]:
    """The columns of the swing by names and units alone, where the sheet's ``row`` names none; none where these allow no choice."""
    try:
        return choose(table.names, row["time_column"], "", "", ("", row["signal_unit"]), table.units)[1]
    except InputError:
        return []


def may_be_it(table: Table, row: Row) -> list[str]:
    """The columns of which each may be the swing, as far as names and units say, where the sheet's ``row`` names none; of one alone, none."""
    if row["signal_column"] or row["time_column"] not in ("", *table.names):
        return []
    if says_nothing(table):
        return [name for name in table.names if not name.startswith(UNNAMED)] or list(table.names)
    if not (found := _by_words(table, row)):
        return []
    others = table.meanings
    alike = [
        one.name
        for one in others
        if one.kind == found[0].kind
        and (one.kind == VOLTAGE or one.written == found[0].written)
        and not (one.axis or drives(one.name) or one.name.startswith(UNNAMED))
    ]
    return alike if len(found) == 1 and found[0].name in alike and len(alike) > 1 else []


def without_still(table: Table, row: Row) -> tuple[Table, list[str]]:
    """The table without the columns that hold one value throughout, next to no numbers, beside a time the number of the row, or noise
    alone where a column that is called alike swings, and remarks on them, where others move: they are no swing.

    A long file is taken as it is, and so is a column that the sheet names, and one that is alone beside the time.
    """
    kept, held = first_rows(table, LOOKED_AT)
    if row["role"] == "static" or not SHORTEST <= sum(map(len, held)) <= LOOKED_AT:
        return kept, []
    named = {row["signal_column"], row["time_column"], row.get("input_column", "")}
    values = {name: np.concatenate([table.numbers(piece, name) for piece in held]) for name in table.names}
    still = [
        name
        for name, one in values.items()
        if name not in named
        and not table.meaning(name).axis
        and np.isfinite(one).sum() >= SHORTEST
        and np.nanmax(one) == np.nanmin(one)
    ]
    times = {name for name in table.names if table.meaning(name).kind == TIME}
    counting = [
        name for name, one in values.items() if times and name not in named | times and counts_rows(one)
    ]
    bare = [name for name, one in values.items() if name not in named and np.isfinite(one).sum() < SHORTEST]
    moving = {name: values[name] for name in table.names if name not in still + counting + bare}
    noisy = _noise(kept._replace(names=tuple(moving)), row, moving)
    moving = {name: one for name, one in moving.items() if name not in noisy}
    if not still + counting + bare + noisy or len(moving) < 2:
        return kept, []
    plain = {name for name in still + counting + bare + noisy if not name.startswith(UNNAMED)}
    told = [
        f"{', '.join(f'`{name}`' for name in left if name in plain)} {verb}{'s' if len(left) == 1 else ''} {what}: left out"
        for left, verb, what in (
            (still, "hold", "one value throughout"),
            (counting, "count", "the rows"),
            (bare, "hold", "next to no numbers"),
            (noisy, "hold", "noise alone"),
        )
        if plain.intersection(left)
    ]
    return kept._replace(names=tuple(moving), pieces=[piece[list(moving)] for piece in held]), told


def _noise(table: Table, row: Row, values: Mapping[str, Floats]) -> list[str]:
    """Those of several columns that the header tells alike, as the channels of an oscilloscope, which forget themselves,
    where a single other one swings and one of them would be taken for the swing."""
    if "no header" in table.layout or row["signal_column"] or len(values) < 3:  # a time and two more
        return []
    found = _by_words(table, row)
    if len(found) != 1 or (first := found[0]).kind not in (UNTOLD, VOLTAGE, ANGLE) or first.axis:
        return []
    known = [table.meaning(name) for name in values]
    alike = [one.name for one in known if one.kind == first.kind and not one.axis]
    looked = {name: values[name][:LOOKED_FOR_NOISE] for name in alike}
    times = {name: np.arange(one.size, dtype=float) for name, one in looked.items()}
    swinging = _swinging(times, {name: one for name, one in looked.items() if not goes_on(one)})
    lags = {name: _lag(looked[name]) for name in swinging}
    swinging = [name for name, lag in lags.items() if _kept(looked[name], lag) > KEEPS]
    if len(swinging) != 1:
        return []
    (swing,) = swinging
    noisy = [name for name, one in looked.items() if name != swing and _forgets(one, lags[swing])]
    return noisy if first.name in noisy else []


def _lag(swing: Floats) -> int:
    """After so many samples noise beside a swing has forgotten itself."""
    known_at = np.flatnonzero(np.isfinite(swing))
    return max(1, round(FORGETS * half_swings(swing[known_at]).period(known_at.astype(float))))


def _forgets(signal: Floats, lag: int) -> bool:
    """True for a column whose values say nothing of those ``lag`` samples later, nor half as many."""
    known = np.count_nonzero(np.isfinite(signal))
    if known < SHORTEST * lag:
        return False
    most = max(abs(_kept(signal, k)) for k in (lag, max(1, lag // 2)))
    return most < SURELY * float(
        np.sqrt(lag / known)
    )  # noise that lasts as long has so many values of its own


def _kept(signal: Floats, lag: int) -> float:
    """How much values correlate with those ``lag`` samples later; what is not there is their mean."""
    known = np.isfinite(signal)
    about = np.where(known, signal - signal[known].mean(), 0.0)
    return float(about[lag:] @ about[:-lag] / (about @ about))


def with_running_time(table: Table, row: Row) -> tuple[Table, Row, list[str]]:
    """The table and the row with a clock, and a remark, where a column holds how much time passed since the row before.

    Such a column rises and falls from row to row. Where another one is a time it is left out, and else its running sum is the time.
    """
    known = table.meanings
    named = [one.name for one in known if from_row_to_row(one)]
    if not named or len(known) < 2:
        return table, row, []
    table, held = first_rows(table, 0)
    if not held or len(held[-1]) < 2:
        return table, row, []
    first = held[-1]
    steps = [name for name in named if not goes_on(table.numbers(first, name))]
    if not steps:
        return table, row, []
    others = [one.name for one in known if one.kind == TIME and one.name not in steps]
    clock = row["time_column"] or (others[0] if others else steps[0])
    kept = {clock, row["signal_column"], *set(table.names).difference(steps)}
    names = tuple(name for name in table.names if name in kept)
    if clock not in steps:
        return table._replace(names=names), row, []
    passed = 0.0

    def summed(rows: pd.DataFrame) -> pd.DataFrame:
        nonlocal passed
        own = table.numbers(rows, clock)
        if rows.index[0] == first.index[0]:
            own = np.concatenate([[0.0], own[1:]])  # before the first row there is none
        times = passed + np.cumsum(own)
        passed = float(times[-1])
        return rows.assign(**{clock: times})

    told = f"`{clock}` tells what passed since the row before: its running sum is the time"
    summed_up = table._replace(names=names, pieces=map(summed, table.pieces))
    return summed_up, {**row, "time_column": clock}, [told]


def with_rising_time(table: Table, row: Row) -> tuple[Table, Row, list[str]]:
    """The table and the row with the column of the time, and a remark, where none says that it is one and another than the first rises."""
    kinds = [table.meaning(name).kind for name in table.names]
    if row["time_column"] or TIME in kinds or kinds[0] != UNTOLD:
        return table, row, []
    if numbers_rows(table.names[0]) and not row["time_unit"]:
        raise InputError(
            f"{row['file']}, {place_of(table.names[0])}",
            "it counts frames or samples, and no column is a time",
            "a column of time, or the samples a second",
            "write the frames or samples a second ⟨in rate_hz⟩",
        )
    if ticks_alone(table.names[0]) and not row["time_unit"]:
        raise InputError(
            f"{row['file']}, {place_of(table.names[0])}",
            "it counts ticks of a clock, nothing says how many a second, and no column is a time",
            "times, or how long a tick is",
            "write ms or us ⟨in time_unit⟩ if that is a tick, or divide the column by the ticks a second",
        )
    table, held = first_rows(table, 0)
    if not held or len(held[-1]) < 2:  # of one row nothing rises
        return table, row, []
    first = held[-1]
    values = {key: table.numbers(first, key) for key in table.names}
    one = values[table.names[0]]
    backwards = goes_on(one[::-1])  # the last row is the first
    rising = [key for key, own in values.items() if goes_on(own[::-1] if backwards else own)]
    falls = np.mean(np.diff(one) <= 0) > RISES  # in groups, as lengths in a table of times by hand
    if not rising and not falls and len(table.names) > 1 and len(first) >= SHORTEST:
        raise InputError(
            f"{row['file']}, {place_of(table.names[0])}",
            "no column says that it is the time, and none rises from row to row",
            "a column of time, or the samples a second",
            "write the samples a second ⟨in rate_hz⟩, or name the column of the time ⟨in time_column⟩",
        )
    clocks = [key for key in rising if not counts_rows(values[key])] or rising
    if table.names[0] in clocks or len(clocks) != 1:
        return table, row, []
    told = f"no column says that it is the time, and `{clocks[0]}` alone rises from row to row: taken for it"
    numbering = set(rising).difference(clocks)  # no swing
    names = tuple(key for key in table.names if key not in numbering)
    return table._replace(names=names), {**row, "time_column": clocks[0]}, [told]


def columns_of(table: Table, row: Row, place: str, restoring: str = "sine") -> Chosen:
    """The columns of time and swing, by the ``row`` of the sheet and their headers; InputError where these are none, or their units do not fit.

    What a spring pulls back has force and acceleration in step with its way: whatever the column that the sheet names then holds swings as it does.
    """
    name = row["file"]
    for position, key in enumerate(("time_column", "signal_column")):
        _check_column(table.names, row[key], position, name, place, key)
    as_it_does = "any" if restoring == "linear" and row["signal_column"] else ""
    stated = row["time_unit"], row["signal_unit"] or as_it_does
    clock, found = choose(
        table.names, row["time_column"], row["signal_column"], f"{name} ({place})", stated, table.units
    )
    _check_own_unit(clock, row, "time", name, place)
    _check_own_unit(found[0], row, "signal", name, place)
    unit = known_unit(found[0], row["signal_unit"], (ANGLE, VOLTAGE, COUNTS, RATE))
    if len(found) == 1:
        _check_unit(row, found[0].name, unit, name, place)
    return Chosen(clock, found, known_unit(clock, row["time_unit"], (TIME,)), unit)


def unnamed(table: Table, names: list[str]) -> list[str]:
    """The columns after the swing's in a file without a header: what they hold nobody says, nor that the swing is not there."""
    if "no header" not in table.layout:
        return []
    return list(table.names[table.names.index(names[-1]) + 1 :])


def alike_in(table: Table, chosen: Chosen) -> list[str]:
    """The columns beside the one ``chosen`` of which each may be the swing as well, for no name says so.

    The order of a table speaks for the first column beside the time alone: one that was passed over may be it, too.
    """
    others = table.meanings
    swing = chosen.found[0]
    if swing.kind != UNTOLD or len(chosen.found) > 1:
        return []
    if table.ordered:
        others = others[: table.names.index(swing.name)]
    return [
        one.name
        for one in others
        if one.kind == UNTOLD
        and one.name not in (swing.name, chosen.clock.name)
        and not (drives(one.name) or numbers_rows(one.name) or one.name.startswith(UNNAMED))
    ]


def widest(times: Floats, angles: Mapping[str, Floats], place: str) -> tuple[int, list[str]]:
    """Which of a body's angles about its axes swings, by its place, and a remark on that; SeveralSwings where another does nearly as far.

    An angle that wanders, or holds noise alone, swings nowhere.
    """
    sizes = {name: float(np.std(angles[name])) for name in _swinging(dict.fromkeys(angles, times), angles)}
    most = max(sizes, key=lambda name: sizes[name], default=next(iter(angles)))
    wide = {name: angles[name] for name, size in sizes.items() if size > ASKEW * sizes[most]}
    ask_which(times, wide, place)
    told = f"of {len(angles)} angles `{most}` swings and was taken (⟨signal_column⟩ says otherwise)"
    return list(angles).index(most), [told]


def _swinging(times: Mapping[str, Floats], swings: Mapping[str, Floats]) -> list[str]:
    """Those that swing, by their names; ``times`` are of each its own."""
    known = {name: np.isfinite(own) for name, own in swings.items()}
    return [name for name, at in known.items() if in_a_row(times[name][at], swings[name][at]) >= ENOUGH]


def ask_which(times: Floats, swings: Mapping[str, Floats], place: str) -> None:
    """None where at most one of several columns swings; SeveralSwings for more, none of which says what it holds."""
    swinging = _swinging(dict.fromkeys(swings, times), swings)
    if len(swinging) > 1:
        problem = f"{len(swinging)} of its columns swing, and none says that it is the pendulum's: {', '.join(swinging)}"
        raise SeveralSwings(place, problem, "one swing", "name the column of the swing ⟨in signal_column⟩")


def _check_own_unit(column: Meaning, row: Row, key: str, name: str, place: str) -> None:
    """Refuses a unit in the sheet that is another than the one the file's attribute ``units`` tells."""
    said = row[f"{key}_unit"]
    if said and column.attribute and column.kind != UNTOLD and column.unit != said:
        problem = f"the sheet says {said!r} and the file says {column.written!r} of {column.name!r}"
        mend = f"correct ⟨{key}_unit⟩, or the file's own attribute `units`"
        raise InputError(f"{name} ({place}, column {key}_unit)", problem, "one unit", mend)


def _check_column(
    columns: tuple[str, ...], wanted: str, position: int, name: str, place: str, key: str
) -> None:
    if (not wanted and len(columns) > position) or wanted in columns:
        return
    raise InputError(
        f"{name} ({place}, column {key})",
        f"the file has no column {wanted!r}" if wanted else f"the file has {len(columns)} column(s)",
        f"one of {', '.join(columns)}" if wanted else "a column of time and one of the signal",
        f"correct ⟨{key}⟩, or the file's header"
        if wanted or len(columns) > 1
        else "write the samples a second ⟨in rate_hz⟩, if the file holds the signal alone",
    )


def _check_unit(row: Row, column: str, unit: str, name: str, place: str) -> None:
    """Refuses units that need more than the file tells: they are stated in the sheet, where the workflow sees them."""
    if not row["signal_unit"] and unit == "V" and not row.get("scale"):
        raise Uncalibrated(
            f"{name} ({place}, column signal_unit)",
            f"the column {column!r} seems to be in V and the sheet does not say so",
            "an angle, or a calibration: recordings in volts need one",
            "calibrate it in a study with an apparatus sheet (docs/calibrate.md), state the degrees of a volt ⟨in scale⟩ "
            "(relative: period and decay alone), or convert it to rad or deg",
        )
    turns = unit in TO_RAD_PER_S
    own, other = ("rad_per_s", "rad") if turns else ("rad", "rad_per_s")
    if np.nan_to_num(row.get(f"zero_tolerance_{other}", 0.0)) > 0:
        raise InputError(
            f"{name} ({place}, column zero_tolerance_{other})",
            f"the signal is in {unit}",
            f"the limit of its zero in {'rad/s' if turns else 'rad'}",
            f"write it in the column zero_tolerance_{own}",
        )
