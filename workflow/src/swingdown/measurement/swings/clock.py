"""The times of a recording as they are: rows put in order, an even clock behind rounded or late stamps, samples that are missing."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Bools, Floats
from ...errors import InputError
from ...pendulum.half_swings import half_swings
from ...rounding import moment
from .noise_level import scatter

UNEVEN = 0.2  # of the usual interval: a step that differs by less is an even one
DIGITS = range(7)  # decimal places of a second to which a clock may round
FIGURES = range(2, 7)  # significant figures to which a program may write its times
MISSING = 1.5  # of the usual interval: a longer step may be one over samples that are missing
RISES = 0.95  # of the changes of a clock: so often it goes on, though it stumbles
RESTART = 10  # samples that a clock must repeat before a step back is its restart, and not a row out of place
ROUNDED = 0.55  # of a digit: how far a rounded stamp lies from the line through all of them, which is not quite the clock's
EXACT = 1e-6  # of the interval: a clock that is more even is even
SEEN = 0.01  # of the interval: a rounding that is worth a word
WINDOW, ORDER = 9, 4  # samples and order of the polynomials by which two clocks are compared
LATE = 0.1  # of a period
SURE = 10.0  # natural logarithm of how much more likely one clock must be


class Ordered(NamedTuple):
    """Which samples are kept, in order of time, their times (s), remarks on what was put right, and the standard uncertainty of the
    clock's rate, as a share, that scattered stamps leave."""

    kept: NDArray[np.integer] | slice
    times: Floats
    remarks: list[str]
    rate: float = 0.0


def in_order(times: Floats, signal: Floats, place: str) -> Ordered:
    """The samples of a recording in the order of their times.

    Rows out of place are sorted, rows that stand twice are left out. Stamps that are those of an even clock, rounded, give way to
    that clock; so do stamps that scatter about one, where the signal is a smoother function of the even times. The clock counts
    once (``parts``).

    Parameters
    ----------
    times, signal
        In s and any unit, as they stand in the file, both of shape (row,).
    place
        What an error names as its place.

    Raises
    ------
    InputError
        If no time passes, or the times run back and forth, as those of no clock do.
    """
    going, stopped = _going(times)
    cut = _cut(times[:going])
    whole = np.flatnonzero(~cut)
    _check_goes_on(times[whole], place)
    kept, told = _sorted(times[whole], signal[whole])
    kept = slice(going) if isinstance(kept, slice) and not cut.any() else whole[kept]
    if cut.any():
        told = [f"in {int(cut.sum())} of {going} rows the time alone jumps back, as where a line lost its start: left out as missing", *told]  # fmt: skip
    times, signal, told = times[kept], signal[kept], stopped + told
    if not times[-1] > times[0]:
        raise InputError(place, "all samples have one time", "a time for each sample", "export the time too")
    even, why = _even_clock(times, signal)
    if even is None:
        return Ordered(kept, times, told + why)
    # of the line through the stamps
    rate = float(np.std(times - even) / (np.std(even) * np.sqrt(times.size)))
    return Ordered(kept, even, told + why, rate)


def _going(times: Floats) -> tuple[int, list[str]]:
    """How many rows the clock goes on for, and a word on those after it, which all have its last time."""
    edges = np.flatnonzero(np.concatenate(([True], np.diff(times) != 0, [True])))
    sizes = np.diff(edges)
    if sizes.size < 2 or sizes[-1] < RESTART * sizes[:-1].max():
        return times.size, []
    remark = f"THE CLOCK STOPS at {moment(times[-1])} s: the last {sizes[-1] - 1} rows, which have no other time, were left out"
    return int(edges[-2]) + 1, [remark]


def goes_on(times: Floats) -> bool:
    """True for readings of a clock: from row to row they stay, or rise, but for a few rows; and they rise more often than a few times."""
    changes = _changes(times)
    return changes.size >= min(RESTART, times.size - 1) > 0 and bool(np.mean(changes > 0) > RISES)


def counts_rows(values: Floats) -> bool:
    """True for whole numbers that go up, or down, mostly by one from row to row, as those of frames or samples do: a row may be lost."""
    known = values[np.isfinite(values)]
    steps = np.diff(known)
    one_way = bool(steps.size) and (np.all(steps > 0) or np.all(steps < 0))
    return bool(one_way and abs(np.median(steps)) == 1 and np.array_equal(known, np.round(known)))


def counts_ticks(times: Floats) -> bool:
    """True for whole numbers as a processor's clock shows them: a step differs from another by two or more, and all have no common measure.

    Who reads a slow swing does so at even times, each so many whole seconds after the one before.
    """
    steps = _changes(times)
    if steps.size < RESTART or not (steps > 0).any() or not (times == np.round(times)).all():
        return False
    return bool(np.ptp(steps[steps > 0]) >= 2 and np.gcd.reduce(steps.astype(np.int64)) == 1)


def _changes(times: Floats) -> Floats:
    """The steps from one finite reading to the next that are not 0."""
    steps = np.diff(times[np.isfinite(times)])
    return steps[steps != 0]


def _check_goes_on(times: Floats, place: str) -> None:
    """None for times that rise from row to row, or fall, but for a few rows; InputError for others."""
    back = np.mean(_changes(times) < 0) if np.ptp(times) else 0.0
    if 1 - RISES < back < RISES:
        raise InputError(
            place,
            f"it is no time: it falls at {round(100 * back)} % of its changes from row to row",
            "times that rise from row to row, or times since the row before under a name that says so, as `dt (ms)`",
            "name the column of the time ⟨in time_column⟩, write the samples a second ⟨in rate_hz⟩, or sort the rows by their time",
        )


def parts(times: Floats) -> list[slice]:
    """The pieces between which a clock jumps back and counts anew; one where it never does."""
    back = np.flatnonzero(np.diff(times) < 0)
    if not len(back) or len(back) > len(times) / (2 * RESTART):
        return [slice(0, len(times))]
    back = back[~_cut(times)[back + 1]]
    edges = [0]
    for k in back:
        earlier = times[edges[-1] : k + 1]
        if np.count_nonzero(earlier >= times[k + 1]) >= RESTART and len(times) - k > RESTART:
            edges.append(int(k) + 1)
    return [slice(a, b) for a, b in zip(edges, [*edges[1:], len(times)], strict=True)]


def _cut(times: Floats) -> Bools:
    """True for a row whose time alone jumps back far, to where there is a sample: the row after it goes on from the one before."""
    back = np.flatnonzero(np.diff(times) < 0)
    back = back[back + 2 < times.size]
    alone = back[times[back + 2] > times[back]] + 1
    others = np.sort(np.delete(times, alone))
    cut = np.zeros(times.size, dtype=bool)
    if len(alone) and len(others) > 1:
        at = np.searchsorted(others, times[alone]).clip(1, len(others) - 1)
        near = np.minimum(np.abs(times[alone] - others[at - 1]), np.abs(times[alone] - others[at]))
        far = alone - np.arange(len(alone)) - np.searchsorted(others, times[alone]) >= RESTART
        cut[alone[far & (near < np.median(np.diff(others)) / 2)]] = True
    return cut


def _sorted(times: Floats, signal: Floats) -> tuple[NDArray[np.integer] | slice, list[str]]:
    steps = np.diff(times)
    if (steps > 0).all():
        return slice(None), []
    told, order = [], np.arange(times.size)
    if wrong := int(np.count_nonzero(steps < 0)):
        order = np.argsort(times, kind="stable")
        told = [f"the time runs back at {wrong} of {times.size} rows, which were put in order of time"]
        if wrong == len(steps):
            told = ["the rows run backwards in time and were turned round"]
    again = np.diff(times[order]) == 0
    same = again & (np.diff(signal[order]) == 0)
    if again.any() and np.count_nonzero(again) <= UNEVEN**2 * times.size:
        order = order[np.concatenate(([True], ~again))]
        differ = int(np.count_nonzero(again & ~same))
        told.append(
            f"{np.count_nonzero(again)} of {times.size} rows repeat the time of another and were left out"
            + (f" ({differ} with another reading)" if differ else "")
        )
    return order, told


def _even_clock(times: Floats, signal: Floats) -> tuple[Floats | None, list[str]]:
    """The times of an even clock where the stamps are those, rounded or late, and a word on it; None where the stamps stand."""
    steps = np.diff(times)
    usual = float(np.median(steps))
    repeated = not (steps > 0).all()
    if not repeated and np.abs(steps / usual - 1).max() < EXACT:
        return None, []
    clocks = [_line(times, slots) for slots in _countings(times, usual)]
    digit = _digit(times)
    coarse = digit > SEEN * usual
    for even in sorted(clocks, key=lambda one: float(np.std(times - one))):  # rounding scatters the least
        away = np.abs(times - even).max()
        if away < EXACT * digit:
            return None, []
        if away <= ROUNDED * digit:
            return even, [
                f"the times are those of an even clock, rounded to {1e3 * digit:g} ms"
            ] if coarse else []
    stamps = _spread(times) if repeated else times
    if (found := _by_figures(times)) is not None:
        return found
    # a computer is late by less than a swing: a clock that is further off counts something else
    clocks = [even for even in clocks if np.std(times - even) < LATE * half_swings(signal).period(even)]
    if clocks and times.size >= 2 * WINDOW and not _at_changes(signal):
        left = [scatter(one, signal, WINDOW, ORDER) for one in (stamps, *clocks)]
        rough = [float(one.sum()) for one in left]
        best = int(np.argmin(rough))
        freedom = left[0].size * (WINDOW - ORDER - 1)
        if best and 0.5 * freedom * np.log(rough[0] / max(rough[best], 1e-300)) > SURE:
            late = 1e3 * float(np.std(times - clocks[best - 1]))
            return clocks[best - 1], [
                f"the stamps scatter by {late:.2g} ms about an even clock, as of a computer that was late, and the swing is "
                "smooth over the even times: these are taken"
            ]
    if repeated:
        remark = "samples that share a time, for the clock has too few digits, were spread evenly over it"
        return stamps, [remark]
    return None, []


def _at_changes(signal: Floats) -> bool:
    """Whether readings in steps were written when they changed, as an encoder's are: mostly by one step, and never by none as at a turning
    point. Over even times they would be straight lines."""
    changes = np.abs(np.diff(signal))
    step = changes.min()
    return bool(step > 0 and np.isclose(np.median(changes), step))


def _by_figures(times: Floats) -> tuple[Floats, list[str]] | None:
    """The times of an even clock that a program wrote with a few significant figures, and a word on it; None where they are none.

    The later a stamp, the coarser it is: 9.97, then 10.0, then 100. What is fine tells the interval. A sample is missing where a
    stamp lies later than the clock would show.
    """
    figures = next((n for n in FIGURES if _written_with(times, n)), 0)
    if not figures:
        return None
    own = _last_figure(times, figures)
    steps = np.diff(times)
    sure = steps > 1.5 * own[1:]  # more than one of the last figure
    interval = float(np.median(steps[sure])) if sure.any() else 0.0
    fine = int(np.argmax(own > interval / 2))  # so many stamps at the beginning tell each sample's place
    if fine < RESTART:
        return None
    known = np.concatenate([[0], np.cumsum(np.maximum(np.round(steps[: fine - 1] / interval), 1))])
    interval, first = map(float, np.polyfit(known, times[:fine], 1))
    place, own = np.arange(times.size), np.maximum(own, SEEN * interval)
    best, even = np.inf, times
    for _ in range(6):  # the line through all stamps, each with the weight of its last figure
        earliest = np.ceil((times - ROUNDED * own - first) / interval).astype(np.int64)
        slots = place + np.maximum.accumulate(np.maximum(earliest - place, 0))
        interval, first = map(float, np.polyfit(slots, times, 1, w=1 / own))
        away = float((np.abs(first + interval * slots - times) / own).max())
        if away < best:
            best, even = away, first + interval * slots
        first += interval * slots[0]  # the first sample's own time
    if best > 1:
        return None
    return even, [f"the times are those of an even clock, written with {figures} figures"]


def _written_with(times: Floats, figures: int) -> bool:
    """True for times of which none has more significant figures."""
    own = _last_figure(times, figures)
    return bool((np.abs(times / own - np.round(times / own)) < 1e-6).all())


def _last_figure(times: Floats, figures: int) -> Floats:
    """What the last of so many significant figures is worth in each time."""
    size = np.maximum(np.abs(times), np.abs(times)[times != 0].min(initial=1.0))
    return np.asarray(10.0 ** (np.floor(np.log10(size) + 1e-9) + 1 - figures))


def _countings(times: Floats, usual: float) -> list[NDArray[np.integer]]:
    """Places of the samples on an even clock: with what is missing left free, where the stamps tell it, and one after the other."""
    alike = np.arange(times.size)
    mean = (times[-1] - times[0]) / (times.size - 1)
    steps = np.diff(times)
    # of those over which none is missing
    beside = float(steps[steps < MISSING * usual].mean()) if usual else 0.0
    found = []
    for interval in {usual, beside, mean} - {0.0}:
        slots = np.round((times - times[0]) / interval).astype(np.int64)
        for _ in range(2):  # the interval, as the whole recording tells it
            if (np.diff(slots) < 1).any():
                break
            even = _line(times, slots)
            passed = (times - even[0]) * (slots[-1] - slots[0]) / (even[-1] - even[0])
            slots = np.round(passed).astype(np.int64)
        else:
            if (np.diff(slots) > 0).all():
                found.append(slots)
    return [*found, *([alike] if not any((one - one[0] == alike).all() for one in found) else [])]


def _line(times: Floats, slots: NDArray[np.integer]) -> Floats:
    """The times that an even clock shows at these places: the line through the stamps."""
    place = slots - slots.mean()
    slope = float(place @ (times - times.mean())) / float(place @ place)
    return times.mean() + slope * place


def _digit(times: Floats) -> float:
    """The decimal place (s) to which all the stamps are rounded; 0.0 for none down to a microsecond."""
    for places in DIGITS:
        scaled = times * 10.0**places
        if np.abs(scaled - np.round(scaled)).max() < 1e-5 * 10.0 ** max(0, places - 3):
            return 10.0**-places
    return 0.0


def _spread(times: Floats) -> Floats:
    """Times that rise: samples of one stamp share the time until the next one."""
    first = np.flatnonzero(np.concatenate(([True], np.diff(times) > 0)))
    sizes = np.diff(np.append(first, times.size))
    last = times[first[-1]] + (np.median(np.diff(times[first])) if len(first) > 1 else 1.0)
    spans = np.diff(np.append(times[first], last))
    within = np.arange(times.size) - first.repeat(sizes)
    return times[first].repeat(sizes) + within * (spans / sizes).repeat(sizes)
