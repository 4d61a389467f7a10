"""Where a pendulum swings by itself: from the release out of a hand to the next one, or to where it rests."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr
from scipy.ndimage import uniform_filter1d

from ...arrays import Floats
from ...errors import InputError
from ...pendulum.half_swings import Swings, half_swings
from ...quantisation import quantisation_step
from ..sheet import Row, rows_of_parts
from .hand import Stretch, held_still, stretches
from .lift import lifted_until
from .noise_level import noise_level

RISE = 1.15  # times as high as before it was held: a pendulum that was released anew
FEWEST = 4  # half-swings; fewer are no swing
REST = 0.01  # of the range: less is rest
LONG = 2.0  # periods of rest at the end, beyond which the rest is left out
ENOUGH = 100  # samples a half-swing
KEPT = 1.0  # period of rest that stays: it tells where friction stopped the pendulum
NOISE = 5.0  # standard deviations: what is within them is at rest
COARSE = 1.5  # steps of the reading: between two of them what rests may flicker
MEAN, BETWEEN = 0.25, 0.6  # of a period, and steps: how far such means of what rests may be apart
STAYS = 2.0  # times as long as a swing stays where it is at a turning point: what rests for longer about its middle does not swing yet


class Window(NamedTuple):
    """From when to when (s) a pendulum swings by itself."""

    released: float  # when the hand let go, about; nan where it swings from the first sample on
    begins: float  # past the middle for the first time; nan as before
    ends: float  # nan where it swings to the last sample
    rests: bool  # it ends because the pendulum came to rest; otherwise a hand stopped it
    why: str = ""  # it begins and ends there, where that is neither a hand nor rest


NAN = float("nan")
WHOLE = Window(NAN, NAN, NAN, False)  # of what swings from the first sample to the last


class SeveralReleases(InputError):
    """A recording with several releases: ``cells`` are the start_s and stop_s (s, as text) of each, those that it needs, and ``why`` what
    else than a hand cuts it, "" for nothing."""

    cells: tuple[dict[str, str], ...] = ()
    why: tuple[str, ...] = ()


def find_windows(
    times: Floats,
    signal: Floats,
    scale: float,
    rate: bool = False,
    hidden: Sequence[tuple[float, float]] = (),
) -> tuple[list[Window], list[float]]:
    """The ``Window``s of a recording in order, and when (s) something pushed the pendulum within one of them.

    Parameters
    ----------
    times
        In s, evenly spaced, of shape (sample,).
    signal
        Of the same shape.
    scale
        Rad per unit of ``signal``, 0 where that is not known.
    rate
        Whether it is an angular rate.
    hidden
        From when to when (s) the signal is not known; of hands nothing is told beside it.

    Returns
    -------
    tuple
        A window for each release, and one of nan where nobody touched the pendulum or the recording is too short. A hand parts two of
        them where it stays for a period, or where the pendulum swings higher after it.
    """
    free, pushed = [Stretch(NAN, NAN)], []
    swings = _swings_in(times, signal, free[0])
    if swings is None:
        return [WHOLE], []
    starts = swings.starts
    # more samples a period tell no more of a hand, and take their square in time
    step = max(1, int(np.median(np.diff(starts))) // ENOUGH)
    times, signal = times[::step], signal[::step]
    room = float(np.median(np.diff(times[starts // step])))
    for hand in held_still(times, signal) if rate else stretches(times, signal, scale):
        if any(hand.start < b + room and hand.stop > a - room for a, b in hidden):
            continue
        free[-1] = free[-1]._replace(stop=hand.start)
        free.append(Stretch(hand.stop, NAN))
    found: list[tuple[Stretch, Swings]] = []
    still = _still(times, signal)
    for part in free:
        swings = _swings_in(times, signal, part)
        if swings is None or np.ptp(signal[_samples(times, part)]) < 2 * still:  # it hangs there
            continue
        if found and not _anew(found[-1][0], found[-1][1], part, swings, times):
            pushed.append(part.start)
            part = Stretch(found[-1][0].start, part.stop)
            swings = _swings_in(times, signal, part) or swings
            found.pop()
        found.append((part, swings))
    windows = [_window(times, signal, part) for part, _ in found] or [WHOLE]
    if np.isnan(windows[0].begins) and not rate:
        part_of = within(windows[0], times)
        starts = half_swings(signal[part_of]).starts
        until = _stays_until(times[part_of], signal[part_of])
        if until is None and scale:
            until = lifted_until(times[part_of], scale * signal[part_of])
        if until is not None:
            windows[0] = windows[0]._replace(released=until, begins=float(times[part_of][starts[1]]))
    return windows, pushed


def _samples(times: Floats, part: Stretch) -> slice:
    first = 0 if np.isnan(part.start) else int(np.searchsorted(times, part.start))
    return slice(first, len(times) if np.isnan(part.stop) else int(np.searchsorted(times, part.stop)))


def _swings_in(times: Floats, signal: Floats, part: Stretch) -> Swings | None:
    """The half-swings between two hands; None for less than a swing."""
    own = signal[_samples(times, part)]
    if len(own) < 64:
        return None
    swings = half_swings(own)
    return swings if len(swings.starts) >= FEWEST else None


def _anew(before: Stretch, earlier: Swings, after: Stretch, later: Swings, times: Floats) -> bool:
    """True where a hand stayed for a period, or the pendulum swings higher after it."""
    period = earlier.period(times[_samples(times, before)])
    if after.start - before.stop > period:
        return True
    last, first = np.ptp(earlier.turns[-3:]), np.ptp(later.turns[:3])
    return bool(first > RISE * last)


def _window(times: Floats, signal: Floats, part: Stretch) -> Window:
    where = _samples(times, part)
    own, when = signal[where], times[where]
    swings = half_swings(own)
    rest = _rest(when, own, swings.period(when))
    begins = NAN if np.isnan(part.start) else float(when[swings.starts[1]])
    ends = NAN if np.isnan(part.stop) else float(when[-1])
    return Window(part.start, begins, ends if rest is None else rest, rest is not None)


def _rest(times: Floats, signal: Floats, period: float) -> float | None:
    """Until when (s) the samples are used of a pendulum that has come to rest; None for one that has not, or not for long.

    Where the reading comes in coarse steps means over a part of a swing tell it: what rests between two steps has one mean.
    """
    still, step, size = _still(times, signal), quantisation_step(signal), float(np.ptp(signal))
    if COARSE * step > REST * size:
        part = max(1, round(MEAN * period / float(np.median(np.diff(times)))))
        still = max(REST * size, BETWEEN * step, NOISE * noise_level(times, signal) / np.sqrt(part))
        signal = uniform_filter1d(signal, part, mode="nearest")
    tail = signal[times > times[-1] - period]
    moving = np.flatnonzero(np.abs(signal - np.median(tail)) > still)
    if not len(moving) or times[-1] - times[moving[-1]] < LONG * period:
        return None
    return float(times[moving[-1]] + KEPT * period)


def _stays_until(times: Floats, signal: Floats) -> float | None:
    """Until when (s) the pendulum rests about its middle, before a hand or a push sets it swinging; None for one that swings from the first
    sample on. At a turning point near the top it may stay as long by itself."""
    swings = half_swings(signal)
    still, size, away = _still(times, signal), float(np.ptp(signal)) / 2, signal - signal[0]
    moving = np.flatnonzero(np.abs(away) > still)
    if not len(moving) or not abs(signal[0] - swings.centre()) < size / 2:
        return None
    share = min(still / size, 1.0)
    # to a turn, and back as far again
    longest = (np.arccos(1 - share) + np.arccos(1 - 2 * share)) / (2 * np.pi)
    until = float(times[moving[0]])
    return until if until - times[0] > STAYS * longest * swings.period(times) else None


def _still(times: Floats, signal: Floats) -> float:
    """How far from where it is a pendulum is at rest, in the signal's unit."""
    return max(
        REST * float(np.ptp(signal)), NOISE * noise_level(times, signal), COARSE * quantisation_step(signal)
    )


def within(window: Window, times: Floats) -> slice:
    """The samples of a window."""
    first = 0 if np.isnan(window.begins) else int(np.searchsorted(times, window.begins))
    last = len(times) if np.isnan(window.ends) else int(np.searchsorted(times, window.ends, "right"))
    return slice(first, last)


def by_itself(recording: xr.Dataset) -> xr.Dataset:
    """The part of a recording, as ``recording.ingest`` made it, in which the pendulum swings by itself."""
    begins, ends = (float(recording.attrs.get(key, NAN)) for key in ("begins_s", "ends_s"))
    return recording.isel(time=within(Window(NAN, begins, ends, False), recording["time"].values))


def several_releases(windows: Sequence[Window], row: Row, place: str) -> SeveralReleases:
    """The refusal of a recording with several releases. Its mend holds the rows of the sheet that make each of them a recording."""
    ends = [{"start_s": window.begins, "stop_s": window.ends} for window in windows]
    parts = [{key: "" if np.isnan(at) else f"{at:.3f}" for key, at in one.items()} for one in ends]
    refusal = SeveralReleases(
        place,
        f"the pendulum is released {len(windows)} times in it",
        "one swing in a recording",
        f"put these rows in place of this one, or state ⟨start_s⟩ or ⟨stop_s⟩ to keep it whole:\n{rows_of_parts(row, parts)}",
    )
    refusal.why = tuple(one.why for one in windows)
    refusal.cells = tuple({key: cell for key, cell in part.items() if cell} for part in parts)
    return refusal
