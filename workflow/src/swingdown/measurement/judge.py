"""What is asked of a swing before it is fitted, the same of a file and of arrays: unit, zero, spikes, hands, holes, an end."""

from dataclasses import dataclass, field, replace

import numpy as np

from ..arrays import Floats
from ..calmed import calmed
from ..errors import InputError
from ..pendulum.half_swings import half_swings
from ..rounding import again
from .apparent_scale import RELATIVE, apparent_scale
from .gyroscope import TO_RAD_PER_S, check_rate
from .plausibility import check_shrinks, drift, hanging
from .swings.beats import check_one_motion
from .swings.continuity import check_alive, check_continuous
from .swings.even import evenly
from .swings.gaps import check_countable, uncounted
from .swings.noise_level import too_quiet
from .swings.quality import check_signal
from .swings.release import Window, find_windows, within
from .swings.slips import longest_between, out_of_step
from .swings.spikes import Spikes, find_spikes
from .units import COUNTED, NO_SCALE, TURNS, angle_unit, check_steps, in_rad, turns_counted, unwrapped

UNSCALED = (
    "no scale is stated: PERIOD AND DECAY ALONE ARE REPORTED. For angles state the degrees that one unit is worth "
    "⟨in scale⟩"
)
TOO_QUIET = (
    "NO SENSOR IS SO QUIET: its noise is less than a millionth of the swing; was it computed, or smoothed?"
)
OWN = "no scale is known: SIZES ARE IN UNITS OF THE READING ({})"

_AT_REST = 0.02  # of what a recording goes through, in its last quarter
_FOR_A_FIT = 3  # whole half-swings


@dataclass(frozen=True)
class Reading:
    """What a signal is read as: its ``unit`` (NO_SCALE for a reading without one), whether that was ``stated``, and rad per unit of
    it (``scale``; NaN where that is not known, 0 for no angle). What was ``computed`` of two coordinates has no rail and no smallest step.
    ``own`` is the unit as written of what a spring pulls back, whose sizes need no scale; empty of all else."""

    unit: str
    stated: bool
    scale: float = 0.0
    restoring: str = "sine"
    computed: bool = False
    own: str = ""

    @property
    def told(self) -> str:
        """``yes`` where the unit is stated or the only one possible, ``no`` where it is rad for want of a word."""
        return "no" if self.unit == "rad" and not self.stated else "yes"

    @property
    def unscaled(self) -> dict[str, str | float]:
        """The attributes of a recording whose scale nobody knows, as ``own_unit.own_of`` reads them where it has a unit of its own."""
        about: dict[str, str | float] = {"scale": "unknown"}
        return about | {"own_unit": self.own, "own_step": 1 / self.scale} if self.own else about


@dataclass(frozen=True)
class Judged:
    """A swing that was looked at: ``signal`` (unwrapped), its ``reading``, its ``spikes``, the ``windows`` in which the pendulum swings by
    itself, the middle that is taken away (``zero``, rad), and ``remarks``, a line each."""

    signal: Floats
    reading: Reading
    spikes: Spikes
    windows: list[Window]
    zero: float = 0.0
    remarks: list[str] = field(default_factory=list)


def judge(times: Floats, signal: Floats, reading: Reading, place: str) -> Judged:
    """The swing in a recording, with its spikes, windows and remarks.

    Parameters
    ----------
    times, signal
        In s (rising) and in the reading's unit, both of shape (sample,).
    reading
        The unit, whether it was stated, and what pulls back.
    place
        What an error names as its place.

    Raises
    ------
    InputError
        If it is no swing of a pendulum in its unit.
    """
    unit = reading.unit if reading.stated else ""
    remarks: list[str] = []
    if reading.unit in (*TURNS, *COUNTED):
        steps = 2 * np.pi / reading.scale if reading.unit in COUNTED and reading.scale else np.nan
        signal, remarks = unwrapped(signal, unit, steps)
    check_signal(times, signal, place, computed=reading.computed)
    spikes = find_spikes(times, signal)
    if reading.unit in TURNS:
        known, told = angle_unit(spikes.healed, unit, reading.restoring, place)
        reading, remarks = replace(reading, unit=known, scale=in_rad(known) or np.nan), remarks + told
    if reading.unit in TO_RAD_PER_S:
        spikes = spikes._replace(healed=calmed(times, spikes.healed))
        remarks += check_rate(times, signal, reading.unit, place)
    unscaled = np.isnan(reading.scale)
    if unscaled:
        reading = replace(reading, scale=2 * RELATIVE / float(np.ptp(spikes.healed)))
        zero = half_swings(spikes.healed).centre() * reading.scale
        if reading.own:
            remarks.append(OWN.format(reading.own))
        elif not any("UNKNOWN SCALE" in one for one in remarks):
            remarks.append(UNSCALED)
        zero = zero if np.isfinite(zero) else 0.0
    else:
        # of readings of a converter no turn begins anew
        counted = reading.restoring == "sine" and reading.unit != NO_SCALE
        zero, told = hanging(spikes.healed, reading.scale, counted)
        remarks += told
        if reading.scale:
            angle = spikes.healed * reading.scale
            if reading.stated or reading.restoring == "sine":  # what a spring pulls back may be no angle
                check_steps(times, angle, place)
            remarks += drift(angle) + (turns_counted(angle - zero) if reading.restoring == "sine" else [])
    check_alive(times, signal, place)
    about = spikes.healed - zero / reading.scale if zero else spikes.healed
    even = evenly(times, about)
    hidden = even.deep(half_swings(about).period(times))
    windows, pushed = find_windows(
        even.times, even.signal, reading.scale, reading.unit in TO_RAD_PER_S, hidden
    )
    if pushed:
        remarks.append(f"something other than the pendulum moves it at about {pushed[0]:.2f} s")
    if even.kept and not even.missing.any() and too_quiet(even.times, even.signal):
        remarks.append(TOO_QUIET)
    for window in windows:
        part = within(window, times)
        check_one_motion(times[part], about[part], place)
    windows = [_without_holes(_in_step(one, times, about), times, about) for one in windows]
    if unscaled:
        part = within(windows[0], times)
        small, scale = reading.scale, apparent_scale(times[part], about[part], reading.restoring)
        reading, zero = replace(reading, scale=scale), zero * scale / small
    return Judged(signal, reading, spikes, windows, zero, remarks)


def _in_step(window: Window, times: Floats, signal: Floats) -> Window:
    """The longest part of a window in which each swing takes the time that those beside it do."""
    part = within(window, times)
    slips = out_of_step(times[part], signal[part])
    if not slips:
        return window
    begins, ends = longest_between(slips, times[part], signal[part])
    at = f"from {slips[0][0]:.2f} to {slips[0][1]:.2f} s" + again(len(slips) - 1)
    why = (
        f"THE SWING IS OUT OF STEP {at}, as where samples are lost, a tracker follows something else, or somebody touches the pendulum: "
        "the longest part beside that is used"
    )
    return window._replace(
        begins=begins if np.isfinite(begins) else window.begins,
        ends=ends if np.isfinite(ends) else window.ends,
        why=why,
    )


def _without_holes(window: Window, times: Floats, signal: Floats) -> Window:
    """The longest part of a window without a hole that hides swings nobody can count."""
    part = within(window, times)
    hidden = None if window.why else uncounted(times[part], signal[part])
    if hidden is None:
        return window
    begins, ends = hidden.part
    return window._replace(
        begins=begins if begins > times[part][0] else window.begins,
        ends=ends if ends < times[part][-1] else window.ends,
        why=f"{hidden.words()} (at {hidden.start:.2f} s): the longest part without such a hole is used",
    )


def check_used(times: Floats, judged: Judged, used: slice, place: str, partial: bool = False) -> list[str]:
    """Remarks on the part of a swing that is used.

    Parameters
    ----------
    times
        In s, of shape (sample,).
    judged
        As ``judge`` returns it.
    used
        Which samples.
    place
        What an error names as its place.
    partial
        Whether the sheet allows a part, which may be short.

    Raises
    ------
    InputError
        If it is too short for a fit, grows, or hides swings in a hole.
    """
    healed, why = judged.spikes.healed[used], judged.windows[0].why
    if why and not partial and healed.size < times.size:
        _check_part(healed, why, place)
    if not partial and (count := len(half_swings(healed).starts)) < 3:
        _check_swings(healed, judged.reading, max(count - 1, 0), place)
        raise InputError(
            place,
            f"the recording is too short, or holds no angle: in {healed.size} samples it passes its middle {max(count - 1, 0)} times",
            "three whole half-swings or more for a fit, nine for a search in one recording alone",
            "record longer, or widen ⟨start_s⟩ and ⟨stop_s⟩; for a sensor that sees the bob pass write the times of its passages, and passages "
            "⟨in signal_kind⟩",
        )
    check_countable(times[used], healed, place)
    remarks = check_shrinks(healed, place)
    return remarks + check_continuous(times[used], judged.signal[used], judged.spikes.within(used))


def _check_part(signal: Floats, why: str, place: str) -> None:
    """InputError where the longest part that can be used, for the reason ``why``, has too few swings for a fit."""
    crossings = int(np.count_nonzero(np.diff(np.signbit(signal - np.median(signal)))))
    passed = min(crossings, max(len(half_swings(signal).starts) - 1, 0))  # noise crosses it, too
    if passed <= _FOR_A_FIT:
        raise InputError(
            place,
            f"{why}, and in that it passes its middle {passed} times",
            f"{_FOR_A_FIT} whole half-swings or more in one piece",
            "record one pendulum that swings in one way alone and that nothing touches, without losing samples",
        )


def _check_swings(signal: Floats, reading: Reading, passed: int, place: str) -> None:
    """InputError for what is long enough, passes its middle ``passed`` times, and does not swing: it turns over, or rests at once."""
    in_turns = 0.0 if reading.unit in TO_RAD_PER_S else (reading.scale or 0.0) / (2 * np.pi)
    turns = float(np.ptp(signal)) * in_turns
    if turns > 1 and reading.restoring == "sine":
        problem = f"it turns over and over: from end to end it makes {turns:.1f} turns"
        mend = "leave out the part in which it turns over (⟨start_s⟩ and ⟨stop_s⟩)"
    elif np.ptp(signal[-(signal.size // 4) :]) < _AT_REST * np.ptp(signal):
        problem = (
            f"it is braked so much that it comes to rest without a swing: it passes its middle {passed} times"
        )
        mend = "brake it less, or name the column of the angle"
    else:
        return
    raise InputError(place, problem, "a pendulum that swings back and forth about where it hangs", mend)


def used_part(
    windows: list[Window], by_hand: tuple[bool, bool] = (False, False)
) -> tuple[Window, list[str], dict[str, float]]:
    """The window that is used, remarks on it, and the attributes that keep it. Where a start or an end is stated ``by_hand`` that stands."""
    first, last = windows[0], windows[-1]
    told = []
    if len(windows) > 1:
        told = [f"the pendulum is released {len(windows)} times in it"]
        last = last._replace(ends=np.nan)
    begins, ends = np.nan if by_hand[0] else first.begins, np.nan if by_hand[1] else last.ends
    found = Window(first.released, begins, ends, last.rests)
    about: dict[str, float] = {}
    if first.why and not any(by_hand):
        known = {"begins_s": found.begins, "ends_s": found.ends}
        about = {key: at for key, at in known.items() if np.isfinite(at)}
        words = {"begins_s": "from {:.3f} s on", "ends_s": "until {:.3f} s"}
        used = " and ".join(words[key].format(at) for key, at in about.items())
        return found, [*told, f"{first.why}, {used} (⟨start_s⟩ and ⟨stop_s⟩ say otherwise)"], about
    if np.isfinite(found.begins):
        about |= {"released_s": found.released, "begins_s": found.begins}
        told += [
            f"it begins in a hand and was released at about {found.released:.2f} s: "
            f"the swing is used from {found.begins:.3f} s on (⟨start_s⟩ says otherwise)"
        ]
    if np.isfinite(found.ends):
        about |= {"ends_s": found.ends}
        told += [
            f"{'it comes to rest and stays there' if found.rests else 'a hand stops it'}: "
            f"the swing is used until {found.ends:.3f} s (⟨stop_s⟩ says otherwise)"
        ]
    return found, told, about
