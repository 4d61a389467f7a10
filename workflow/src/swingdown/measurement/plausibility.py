"""Whether a recording can be a pendulum in the units it is taken for: its turns, its period, where it hangs."""

from math import pi

import numpy as np

from ..arrays import Floats
from ..errors import InputError
from ..pendulum.half_swings import half_swings, passages
from .files.columns import OF_ACCELERATIONS

CENTRED = 0.1  # rad; friction does not hold a pendulum that far from the vertical
DRIFTED = 0.05  # rad; what the amplitude does to the middle of an eccentric sensor is less
GROWS = 1.15  # times: from its first third to its last
NARROWS = 0.95  # times: the spread of the signal, as above; a motor's is nearer to 1
SHRINKS = 0.002  # of the swing: less says nothing of what stops it
STEADY = 0.15  # of a period: half-swings in step have theirs so near to the usual one
ENOUGH = 8  # half-swings in step of which there is something to tell
EVEN = 0.05  # of a period: by so much at most does one differ from the next, where they tell it
DYING = 0.98  # times: from its first third to its last, of what surely shrinks
SURELY = 3.0  # standard errors of how fast they shrink
KEPT = 0.9  # of the first swings' size: the last ones of what does not shrink
DIED = 0.05  # of the widest swing, by which one side shrinks from its first third to its last, where that tells something
GRAVITY = {"m/s²": 9.81, "g": 1.0, "mg": 1000.0}  # what an accelerometer at rest reads
NEAR = 0.06  # the share by which a cheap sensor at rest is off: 50 mg and 3 % (MPU-6050, PS-MPU-6000A, 6.2)
EVEN_SIDES = 0.25  # the share by which the turning points of one side shrink of how much the others do: less is a height's
_EACH = 3  # turning points on a side
ALL = 0.95  # of the half-swings: with so many in step there is nothing to tell
TO_RAD = {"rad": 1.0, "deg": pi / 180}


def free_part(times: Floats, signal: Floats) -> tuple[float, float] | None:
    """From when until when (s) the most half-swings in a row are in step, none wider than GROWS times one before it; None where those are
    fewer than ENOUGH, or nearly all."""
    begins = times[half_swings(signal).starts]
    first, last = _longest(times, signal)
    if ENOUGH <= last - first < ALL * (len(begins) - 2):
        return (float(begins[first]), float(begins[last]))
    return None


def in_a_row(times: Floats, signal: Floats) -> int:
    """The most half-swings in a row that are in step, none wider than GROWS times one before it."""
    first, last = _longest(times, signal)
    return last - first


def _longest(times: Floats, signal: Floats) -> tuple[int, int]:
    """The first and the last of the half-swings of ``in_a_row``."""
    swings = half_swings(signal)
    sizes, begins = np.abs(np.diff(swings.turns)), times[swings.starts]
    periods = begins[2:] - begins[:-2]
    best, first = (0, 0), 0
    for last in range(1, len(periods) + 1):
        here = slice(first, last)
        usual, least = float(np.median(periods[here])), float(sizes[here].min())
        if abs(periods[last - 1] - usual) > STEADY * usual or sizes[last - 1] > GROWS * least:
            first = last
        elif last - first > best[1] - best[0]:
            best = first, last
    return best


def narrowing(signal: Floats) -> float:
    """How wide the last third of the swings is over the first third; nan of too few. Below ``KEPT`` it dies away, whatever its model."""
    return _narrowing(np.abs(np.diff(half_swings(signal).turns[1:-1])))


def _narrowing(sizes: Floats) -> float:
    part = len(sizes) // 3
    return float(np.median(sizes[-part:]) / np.median(sizes[:part])) if part else float("nan")


def in_step_and_dying(times: Floats, signal: Floats) -> bool:
    """True for a swing of ENOUGH half-swings or more whose passages of the middle are even and whose size falls: whatever its model, they
    tell its period. That may change from swing to swing, as a ball's in a bowl that is no circle."""
    sizes = _sizes_in_step(times, signal, step=2)
    if not sizes.size:
        return False
    fall = _narrowing(sizes)
    (slope, _), covariance = np.polyfit(np.arange(len(sizes)), sizes, 1, cov=True)
    # what a motor drives unsteadily may end with smaller swings by chance
    surely = -slope > SURELY * float(np.sqrt(covariance[0, 0]))
    return fall < KEPT or bool(fall < DYING and surely)


def in_step_and_steady(times: Floats, signal: Floats) -> bool:
    """True for a swing of ENOUGH half-swings or more whose passages of the middle are even and whose sizes are all alike: they tell its period,
    and nothing of what stops it."""
    sizes = _sizes_in_step(times, signal)
    return bool(_narrowing(sizes) >= DYING and np.quantile(sizes, 0.95) < GROWS * np.quantile(sizes, 0.05))


def late_stamps(times: Floats, signal: Floats) -> float:
    """By which share of it the periods of a swing scatter whose sizes fall evenly: not the pendulum is uneven then, but its times; 0.0 of another.

    Noise or a hand that moved the passages so far would move the turning points more. From each to the next but one, drift and decay drop out.
    """
    swings = half_swings(signal)
    passed, sizes = passages(times, signal, swings.centre()), np.abs(np.diff(swings.turns[1:-1]))
    if len(sizes) < 2 * ENOUGH or not narrowing(signal) < KEPT:
        return 0.0
    periods = passed[2:] - passed[:-2]
    uneven, rough = (float(np.median(np.abs(np.diff(one, 2))) / np.median(one)) for one in (periods, sizes))
    return uneven if uneven > EVEN > rough else 0.0


def _sizes_in_step(times: Floats, signal: Floats, step: int = 0) -> Floats:
    """From turning point to turning point, of a swing whose passages of the middle are even; none of another, or of fewer than ENOUGH.

    Its periods are near to the usual one; or with a ``step`` each to that so many half-swings before, and then it is one that swings by
    itself about where it rests, which takes as long on one side as on the other.
    """
    swings = half_swings(signal)
    passed = passages(times, signal, swings.centre() if len(swings.starts) > 4 else 0.0)
    periods, sizes = passed[2:] - passed[:-2], np.abs(np.diff(swings.turns[1:-1]))
    if len(passed) < ENOUGH or len(sizes) < 6:
        return np.empty(0)
    usual = float(np.median(periods))
    halves = np.diff(passed)
    sides = abs(float(np.median(halves[::2])) - float(np.median(halves[1::2]))) if step else 0.0
    even = max(sides, float(np.median(np.abs(np.diff(periods))))) < EVEN * usual
    near, other = (periods[step:], periods[:-step]) if step else (periods, usual)
    in_step = float(np.mean(np.abs(near - other) < STEADY * other)) >= ALL
    return sizes if even and in_step else np.empty(0)


def evenness(signal: Floats) -> float:
    """How much the side on which swings shrink less does so, over the other: 1 of a bob on a spring, and 0 of a pendulum's height, whose
    lowest points stay where they are; nan where they do not shrink, or are too few to tell."""
    turns = half_swings(signal).turns[1:-1]
    sides = [side for side in (turns[::2], turns[1::2]) if len(side) >= 2 * _EACH]
    if len(sides) < 2:
        return float("nan")
    part = max(_EACH, len(sides[1]) // 3)
    moved = sorted(abs(float(np.median(side[:part]) - np.median(side[-part:]))) for side in sides)
    inwards = np.ptp(turns[-2:]) < np.ptp(turns[:2])
    return moved[0] / moved[1] if inwards and moved[1] > DIED * np.ptp(turns) else float("nan")


def check_once(signal: Floats, place: str) -> None:
    """None for readings that nobody says to be an angle and that go back and forth once a period; InputError for what a bob does twice.

    An accelerometer along the string reads the fall of weight at rest; a height and a distance to the side have one side of turning points
    that stays where it is.
    """
    swings, what = half_swings(signal), ""
    centre, turns = swings.centre(), swings.turns * np.sign(swings.centre())
    sizes = np.abs(np.diff(swings.turns[1:-1]))
    # a bob on a circle pulls with cos a to 3 - 2 cos a times its weight: about more than that by a sixth of the way between them
    rest = np.nan
    if len(sizes) > 1:
        rest = float(np.median(np.abs(swings.centres()) - (sizes[1:] + sizes[:-1]) / 12))
    known = [unit for unit, weight in GRAVITY.items() if abs(rest / weight - 1) < NEAR]  # not nan
    if known and turns.min() > 0:  # weight pulls the string, and never pushes it
        what = f"it swings about {centre:.3g}, as what an accelerometer along the string reads in {known[0]}"
    elif evenness(signal) < EVEN_SIDES:
        what = "its turning points of one side stay where they are, as of the height of a bob or its distance from the middle"
    if what:
        raise InputError(
            place,
            f"no unit is stated, and {what}: that goes up and down twice a period",
            "an angle or an angular rate",
            f"if it is an angle write its unit ⟨in signal_unit⟩, and of another reading that goes back and forth once a period write relative "
            f"⟨in scale⟩; of an acceleration {OF_ACCELERATIONS}",
        )


def check_shrinks(signal: Floats, place: str) -> list[str]:
    """A remark on a swing that does not shrink, or none; InputError for one that grows. Of fewer than 12 half-swings nothing is told.

    Whatever the friction, what swings by itself swings less and less; a motor at its resonance, or an unstable computation, makes it grow.
    Noise makes small half-swings of its own, so the spread of the signal has the last word.
    """
    swings = half_swings(signal)
    sizes = np.abs(np.diff(swings.turns[1:-1]))  # the first and the last may be cut
    part = len(sizes) // 3
    if part < 3:
        return []
    first, last = float(np.median(sizes[:part])), float(np.median(sizes[-part:]))
    early, late = swings.starts[[1, 1 + part]], swings.starts[[-1 - part, -1]]
    spread = float(np.std(signal[slice(*late)]) / np.std(signal[slice(*early)]))
    if spread < NARROWS:
        return []
    if last > GROWS * first and spread > GROWS:
        problem = f"its swings grow: in the last third of the recording they are {last / first:.2f} times as wide as in the first"
        expected = "a pendulum that nothing drives: it swings less and less"
        raise InputError(place, problem, expected, "leave the driven part out with ⟨start_s⟩ and ⟨stop_s⟩")
    if last < (1 - SHRINKS) * first:
        return []
    return [
        f"its swings do not shrink (the last third to {100 * last / first:.1f} % of the first): if a motor drives it, this is the "
        "motor's period; what stops it is not known"
    ]


def hanging(signal: Floats, scale: float, turns: bool = True) -> tuple[float, list[str]]:
    """The angle (rad) that a pendulum swings about where that is no zero, and a remark on it; else 0.0 and none.

    ``scale`` is rad per unit of ``signal``. An encoder's zero is where it was switched on, and some programs count from the
    horizontal or from the top: no friction holds a pendulum so far from the vertical. Where whole ``turns`` are counted a middle at one of
    them is where it hangs; a spring has its middle anywhere.
    """
    centre = half_swings(signal).centre() * scale
    rest = (centre + pi) % (2 * pi) - pi if turns and abs(centre) > 1.5 * pi else centre
    if not abs(rest) > CENTRED:  # nan too
        return 0.0, []
    # turns from a zero that is nowhere in particular say nothing
    remark = f"it swings about {centre:.3g} rad ({np.degrees(centre):.3g}°), and 0 should be where it hangs: this is taken away"
    return centre, [remark]


def drift(angle: Floats) -> list[str]:
    """A remark where the middle of the swings (rad) wanders. What swings less and less has it at one place, whatever the friction."""
    centres = half_swings(angle).centres()
    part = max(3, len(centres) // 4)
    if len(centres) < 2 * part:
        return []
    moved = float(np.median(centres[-part:]) - np.median(centres[:part]))
    if abs(moved) < DRIFTED:
        return []
    remark = f"its middle drifts by {moved:.2g} rad ({np.degrees(moved):.2g}°) from its first swings to its last, and 0 should stay where it hangs"
    return [remark]
