"""Whether a recording runs on: spikes, jumps as of lost samples, a clock that stumbles, a sensor that died."""

import numpy as np

from ..arrays import Floats
from ..errors import InputError
from ..quantisation import quantisation_step
from .plausibility import half_swings

SIDE = 6  # samples on each side of a place that is looked at
ODD = 12.0  # local standard deviations, beyond which a jump or spike is told; measured on recordings that have none
SEEN = 0.004  # of the range; smaller ones are not told
PHASE = "the pendulum is out of step with the clock, as where samples are lost,"
JUMP = "the signal jumps, as where samples are lost or the apparatus is knocked,"
OUT_OF_STEP = 0.03  # of a half-swing's time; a smaller jump of the phase is not told
JITTER = 8.0  # standard deviations of what noise does to the time of a half-swing
STUMBLE = 0.2  # of the usual interval


def check_continuous(times: Floats, signal: Floats, place: str) -> list[str]:
    """Remarks, each one line, on spikes, jumps and uneven times."""
    period = half_swings(signal).period(times)
    interval = float(np.median(np.diff(times)))
    steps = np.diff(times) / interval
    uneven = np.flatnonzero(np.abs(steps - 1) > STUMBLE)
    if len(uneven) > 0.01 * len(steps):  # a clock that jitters throughout
        return [
            f"the time between samples varies by {np.std(steps):.2g} of {interval:.4g} s (standard deviation)"
        ]
    remarks = [_told("the clock stumbles", times[uneven + 1])] if len(uneven) else []
    del steps
    spikes = _places(signal, _kernel(True), period / interval)
    healed = signal.copy() if spikes else signal
    for k in spikes:
        healed[k] = (signal[k - 1] + signal[k + 1]) / 2
    jumps = _places(healed, _kernel(False), period / interval)
    spikes = [k for k in spikes if all(abs(k - n) > SIDE for n in jumps)]  # a jump looks a little like one
    remarks += [_told(what, times[places]) for what, places in (("a spike", spikes), (JUMP, jumps)) if places]
    told = times[[*spikes, *jumps]]
    late = [
        one for one in _out_of_step(times, signal) if all(abs(one - other) > 3 * period for other in told)
    ]
    if late:
        remarks.append(_told(PHASE, np.array(late)))
    return remarks


def _out_of_step(times: Floats, signal: Floats) -> Floats:
    """When (s) a half-swing lasts longer or shorter than those beside it: samples lost at a turning point leave no jump.

    Each is compared with the second and fourth before and after it, for a zero beside the middle makes neighbours unequal. Noise
    moves a passage of the middle the more, the smaller the swing.
    """
    swings = half_swings(signal)
    middle = float(np.median(signal[len(signal) // 2 :])) if len(swings.starts) < 5 else swings.centre()
    now = swings.starts[1:]
    away = signal - middle
    side = np.sign(away[now])
    last = np.array(
        [
            before + np.flatnonzero(away[before : n + 1] * s < 0)[-1]
            for before, n, s in zip(swings.starts, now, side, strict=False)
            if (away[before : n + 1] * s < 0).any()
        ],
        dtype=int,
    )
    if len(last) != len(now) or len(now) < 12:
        return np.empty(0)
    passed = times[last] + (times[now] - times[last]) * away[last] / (away[last] - away[now])
    lasts = np.diff(passed)
    sizes = np.abs(np.diff(swings.turns))[1 : len(lasts) + 1]
    beside = np.median([lasts[:-8], lasts[2:-6], lasts[6:-2], lasts[8:]], axis=0)
    off = lasts[4:-4] - beside
    sure = sizes[4:-4] / sizes.max()
    usual = float(np.median(np.abs(off) * sure)) / 0.6745
    odd = (np.abs(off) * sure > JITTER * usual) & (np.abs(off) > OUT_OF_STEP * beside) & (sure > 0.05)
    return (passed[4:-5] + lasts[4:-4] / 2)[odd]


def _told(what: str, times: Floats) -> str:
    more = f" and {len(times) - 1} times more" if len(times) > 1 else ""
    return f"{what} at {times[0]:.6g} s{more}"


def _kernel(spike: bool) -> Floats:
    """Weights of the samples in a window that give the height of a spike, or of a jump, on a cubic swing."""
    n = 2 * SIDE + 1 if spike else 2 * SIDE
    x = (np.arange(n) - (n - 1) / 2) / SIDE
    # a kink, as samples lost at a turning point leave it, is no spike
    odd = [np.abs(x), np.arange(n) == SIDE] if spike else [x > 0]
    return np.linalg.pinv(np.column_stack([x**0, x, x**2, x**3, *odd]).astype(float))[-1]


def _places(signal: Floats, kernel: Floats, period: float) -> list[int]:
    """Where the height that the kernel tells stands out of those nearby: the largest of each cluster.

    What swing and noise do to it is told by its median over two periods, before, around and after. ``period`` in samples.
    """
    if len(signal) < 8 * SIDE or not period > 4 * SIDE:  # too few samples a swing for a cubic
        return []
    height = np.correlate(signal, kernel, mode="valid")
    np.abs(height, out=height)
    size = int(max(8 * SIDE, 2 * period))
    edges = np.linspace(0, len(height), max(1, len(height) // size) + 1).astype(int)
    own = np.array([np.median(height[a:b]) for a, b in zip(edges, edges[1:], strict=False)]) / 0.6745
    around = np.maximum(own, np.maximum(np.append(own[1:], 0), np.append(0, own[:-1])))
    seen = max(SEEN * np.ptp(signal), 2 * quantisation_step(signal))
    odd = np.concatenate(
        [
            a + np.flatnonzero(height[a:b] > max(ODD * scale, seen))
            for a, b, scale in zip(edges, edges[1:], around, strict=False)
        ]
    )
    if not len(odd):
        return []
    clusters = np.split(odd, np.flatnonzero(np.diff(odd) > SIDE) + 1)
    return [int(one[np.argmax(height[one])]) + SIDE for one in clusters]


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
            f"{place}, {times[last]:.6g} s",
            f"the sensor is dead from there on: it stays at {signal[-1]:g} while the pendulum still swings",
            "a swing that decays before it ends",
            f"leave the end out with stop_s = {times[last - 1]:.6g}, and check the sensor",
        )
