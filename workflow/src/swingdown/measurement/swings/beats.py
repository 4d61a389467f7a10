"""Whether two motions of like strength take turns in a recording, as of coupled pendulums: then there is no one period."""

import numpy as np

from ...arrays import Floats
from ...errors import InputError
from ...pendulum.half_swings import half_swings

SECOND = 1 / 3  # of the first motion's size: less disturbs it, and is none of two
EXPLAINED = 0.8  # of the mean square, by both together; what a hand moves is no such sum
SLOW = 0.5  # of their mean frequency: by so much two differ that take turns over several half-swings
FEWEST = 6  # half-swings
SAMPLES = 4096  # more tell no more of two frequencies
PADDED = 8  # times as many frequencies as independent ones
ROUNDS = 5  # each line is found beside the other; they settle


def check_one_motion(times: Floats, signal: Floats, place: str) -> None:
    """None for one swing; InputError for two of like strength that beat.

    What swings by itself never grows. The sum of two motions that differ in frequency shrinks to the difference of their sizes and grows to
    the sum of them; of the other of two pendulums, which was at rest, it grows at first.

    Parameters
    ----------
    times, signal
        In s (rising) and any unit, both of shape (sample,).
    place
        What an error names as its place.
    """
    begins, sizes = _envelope(times, signal)
    if len(sizes) < FEWEST:
        return
    after = np.maximum.accumulate(np.where(sizes > SECOND * sizes.max(), sizes, 0.0)[::-1])[::-1]
    # a hand, or a second release, makes it grow at once
    steps = np.maximum.accumulate(np.append(np.diff(sizes), 0.0)[::-1])[::-1]
    slowly = steps < (after - sizes) / 2
    zeros = np.zeros_like(sizes)
    grows = np.divide(after, sizes, out=zeros, where=slowly & (sizes > 0))
    node = int(np.argmax(grows))
    if grows[node] < (1 + SECOND) / (1 - SECOND):
        return
    pair = _two_lines(times, signal)
    if pair is None:
        return
    raise InputError(
        place,
        f"two motions of like strength beat in it, of {1 / max(pair):.3g} s and {1 / min(pair):.3g} s: from {begins[node]:.4g} s on its swings "
        f"grow again, to {after[node] / sizes[node]:.2g} times as wide",
        "one motion: what swings by itself swings less and less",
        "release it so that one of them alone swings, without a motor, or use a part in which its swings shrink (⟨start_s⟩ and ⟨stop_s⟩)",
    )


def _envelope(times: Floats, signal: Floats) -> tuple[Floats, Floats]:
    """When (s) each half-swing's time begins, and the RMS about the middle in it: for a sine the same wherever it begins; none for few."""
    swings = half_swings(signal)
    half, centre = swings.period(times) / 2, swings.centre()
    if len(swings.starts) < FEWEST:
        return np.empty(0), np.empty(0)
    edges = np.unique(np.searchsorted(times, np.arange(times[0], times[-1], half)))
    square = np.add.reduceat((signal - centre) ** 2, edges) / np.diff(np.append(edges, times.size))
    return times[edges[:-1]], np.sqrt(square[:-1])


def _two_lines(times: Floats, signal: Floats) -> tuple[float, float] | None:
    """The frequencies (Hz) of two motions, each growing or shrinking evenly, that make up the signal; None where none do, or one is small."""
    even = np.linspace(times[0], times[-1], min(SAMPLES, times.size))
    values = np.interp(even, times, signal)
    values = values - values.mean()
    known = np.fft.rfftfreq(PADDED * even.size, even[1] - even[0])
    parts = [np.zeros_like(values), np.zeros_like(values)]
    found = [0.0, 0.0]
    for k in [0, 1] * ROUNDS:
        rest = values - parts[1 - k]
        found[k] = float(known[np.argmax(np.abs(np.fft.rfft(rest, PADDED * even.size)))])
        parts[k] = _line(even, rest, found[k])
    sizes = [float(np.std(one)) for one in parts]
    left = float(np.mean((values - parts[0] - parts[1]) ** 2) / np.mean(values**2))
    beat = abs(found[0] - found[1])
    # an overtone, and what the recording is too short to tell apart, are no second motion
    apart = 1 / (even[-1] - even[0]) <= beat < SLOW * np.mean(found)
    sure = left < 1 - EXPLAINED and min(sizes) > SECOND * max(sizes) and apart
    return (found[0], found[1]) if sure else None


def _line(times: Floats, values: Floats, frequency: float) -> Floats:
    """The motion of this frequency (Hz) whose size changes evenly that comes nearest."""
    phase, late = 2 * np.pi * frequency * times, times - times.mean()
    terms = np.stack([np.cos(phase), np.sin(phase), late * np.cos(phase), late * np.sin(phase)], axis=1)
    return np.asarray(terms @ np.linalg.lstsq(terms, values, rcond=None)[0])
