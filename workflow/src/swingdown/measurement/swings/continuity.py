"""Whether a recording runs on: spikes, jumps as of lost samples, a clock that stumbles, a sensor that died."""

import numpy as np

from ...arrays import Bools, Floats, runs
from ...errors import InputError
from ...pendulum.half_swings import half_swings, passages
from ...quantisation import quantisation_step
from ...rounding import again, moment
from ..plausibility import ENOUGH, in_a_row
from .clock import UNEVEN
from .even import evenly
from .gaps import missing_samples
from .renumbered import lost_evenly
from .spikes import MOST, SIDE, Spikes, beside_holes, kernel, standing_out

SPIKE = "a spike"
PHASE = "the pendulum is out of step with the clock, as where samples are lost,"
JUMP = "the signal jumps, as where samples are lost or the apparatus is knocked,"
OUT_OF_STEP = 0.03  # of a half-swing's time; a smaller jump of the phase is not told
JITTER = 8.0  # standard deviations of what noise does to the time of a half-swing
SERIES = range(2, 5)  # that may take turns in one column
APART = 0.25  # of the swing's standard deviation: a step from a row to the next of series that take turns
SMOOTHER = 0.25  # of such a step: one from a row to the next of its own series
TOGETHER = 0.05  # of the variance: less is in the mean of rows that follow one another where a swing is read about as often as it swings


def check_continuous(times: Floats, signal: Floats, spikes: Spikes) -> list[str]:
    """Remarks, each one line, on what is missing, on spikes, jumps and uneven times."""
    even = evenly(times, spikes.healed)
    remarks = missing_samples(even, times)
    if not even.kept:
        return remarks
    period, interval = half_swings(signal).period(times), even.interval
    steps = np.diff(times) / interval
    uneven = np.flatnonzero(np.abs(steps - np.round(steps)) > UNEVEN)
    remarks += [_told("the clock stumbles", times[uneven + 1])] if len(uneven) else []
    left_out = np.flatnonzero(spikes.where)
    unknown = beside_holes(even, period)
    remarks += lost_evenly(even, period / interval)
    # spikes that were left where they are, for they are too many or too near an end
    kept = _places(even.signal, kernel(True), period / interval, unknown)
    healed = even.signal.copy() if kept else even.signal
    for k in kept:
        healed[k] = (healed[k - 1] + healed[k + 1]) / 2
    jumps = _places(healed, kernel(False), period / interval, unknown)
    kept = [k for k in kept if all(abs(k - n) > SIDE for n in jumps)]  # a jump looks a little like one
    if len(left_out):
        words = _told(SPIKE, times[[first for first, _ in runs(spikes.where)]])
        remarks.append(f"{words}, left out as missing: {len(left_out)} of {times.size} samples")
    if kept:
        many = not len(left_out) and len(kept) > MOST * times.size
        remarks.append(f"{_told(SPIKE, even.times[kept])}, {'too many to be' if many else 'not'} left out")
    if jumps:
        remarks.append(_told(JUMP, even.times[jumps]))
    odd = np.concatenate([times[left_out], even.times[[*kept, *jumps]], even.times[unknown]])
    late = [one for one in _out_of_step(times, spikes.healed) if not (np.abs(odd - one) < 3 * period).any()]
    if late:
        remarks.append(_told(PHASE, np.array(late)))
    return remarks


def check_one_series(times: Floats, signal: Floats, place: str) -> None:
    """InputError where several swings take turns in one column, row by row: each is smooth, and the rows are not."""
    for count in SERIES:
        rows = signal[: signal.size // count * count].reshape(-1, count)
        if rows.shape[0] < 2 * ENOUGH:
            return
        step, own = (np.nanmedian(np.abs(signal[k:] - signal[:-k])) for k in (1, count))
        if not (step > APART * np.nanstd(signal) and own < SMOOTHER * step):
            continue
        if np.nanvar(rows.mean(axis=1)) > TOGETHER * np.nanvar(rows) and any(
            in_a_row(times[k::count][: rows.shape[0]], rows[:, k]) >= ENOUGH for k in range(count)
        ):
            mend = "write in a column of its own which sensor each row is of, or give each sensor a column or a file"
            raise InputError(place, f"{count} series take turns in it, row by row", "one series", mend)


def _out_of_step(times: Floats, signal: Floats) -> Floats:
    """When (s) a half-swing lasts longer or shorter than those beside it: samples lost at a turning point leave no jump.

    Each is compared with the second and fourth before and after it, for a zero beside the middle makes neighbours unequal. Noise
    moves a passage of the middle the more, the smaller the swing, and so does a reading that comes in steps, by up to half a step at either end.
    """
    swings = half_swings(signal)
    passed = passages(times, signal, swings.centre())
    if len(passed) != len(swings.starts) - 1 or len(passed) < 13:
        return np.empty(0)
    lasts = np.diff(passed)
    sizes = np.abs(np.diff(swings.turns))[1 : len(lasts) + 1]
    beside = np.median([lasts[:-8], lasts[2:-6], lasts[6:-2], lasts[8:]], axis=0)
    off = lasts[4:-4] - beside
    sure = sizes[4:-4] / sizes.max()
    usual = float(np.median(np.abs(off) * sure)) / 0.6745
    rounded = quantisation_step(signal) / (np.pi / beside * sizes[4:-4] / 2)  # s, at the speed in the middle
    least = np.maximum(OUT_OF_STEP * beside, 2 * rounded)
    odd = (np.abs(off) * sure > JITTER * usual) & (np.abs(off) > least) & (sure > 0.05)
    return (passed[4:-5] + lasts[4:-4] / 2)[odd]


def _told(what: str, times: Floats) -> str:
    return f"{what} at {moment(times[0])} s{again(len(times) - 1)}"


def _places(signal: Floats, weights: Floats, period: float, unknown: Bools) -> list[int]:
    """Where the height that the kernel tells stands out of those nearby: the largest of each cluster. ``period`` in samples; of
    places that are ``unknown`` nothing is told."""
    clusters = standing_out(signal, weights, period, unknown)
    if not clusters:
        return []
    height = np.abs(np.correlate(signal, weights, mode="valid"))
    return [int(one.samples[np.argmax(height[one.samples - SIDE])]) for one in clusters]


def check_alive(times: Floats, signal: Floats, place: str) -> None:
    """None if the signal moves, or came to rest: then it lost its swing before. InputError for a sensor that died while it swung."""
    moving = np.flatnonzero(signal != signal[-1])
    last = int(moving[-1]) + 1
    if last < 4 or len(signal) - last < 10:
        return
    period = half_swings(signal[:last]).period(times) / float(np.median(np.diff(times)))  # in samples
    if not period > 4 or len(signal) - last < period / 2:
        return
    n = round(period)
    late, still = np.ptp(signal[max(0, last - n) : last]), False
    if last >= 2 * n:
        still = bool(late <= 0.8 * np.ptp(signal[last - 2 * n : last - n]))
    else:  # friction takes its time to stop it
        still = bool(abs(signal[last] - signal[last - 3]) < 3 * 0.2 * np.pi * late / n)
    if not still and late > 8 * quantisation_step(signal):
        raise InputError(
            f"{place}, {moment(times[last])} s",
            f"the sensor is dead from there on: it stays at {signal[-1]:g} while the pendulum still swings",
            "a swing that decays before it ends",
            f"leave the end out with ⟨stop_s={moment(times[last - 1])}⟩, and check the sensor",
        )
