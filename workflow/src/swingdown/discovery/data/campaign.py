"""A campaign as discovery takes it: swings that are fitted, and swings that are held out."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from ...arrays import Floats, swing_under
from ...errors import InputError
from ...own_unit import Own
from ...pendulum.catalogue import ANGLE, READINGS
from ...pendulum.drive import Drive
from ...pendulum.half_swings import middle_crossings
from ...pendulum.slack import Slack

# A single recording is cut into parts of as many half-swings each: odd numbers of them, so that both ends are fitted.
_PARTS = {5: 20, 3: 9, 2: 5}  # parts, and the half-swings a recording must have to be cut into so many


@dataclass(frozen=True)
class Swing:
    """One recording, or a part of one: name, times (s), angles (rad), and its largest angle (rad)."""

    name: str
    times: Floats
    angle: Floats
    drive: Drive | None = None

    @property
    def amplitude(self) -> float:
        """The largest angle from the middle of the swing, rad."""
        return float(np.ptp(self.angle) / 2)

    @property
    def pair(self) -> tuple[Floats, Floats]:
        """(times, angles), as the fitter takes them."""
        return swing_under(self.drive, self.times, self.angle)


@dataclass(frozen=True)
class Campaign:
    """The swings to fit and those held out, how they were chosen, and what is known of the noise before any fit.

    ``systematic`` is the largest standard uncertainty (rad) that all samples share; ``slack`` what calibration and clock leave
    open of the readings, which every fit leaves open too. ``reading`` is what the sensor reads: where it is a rate, angles of
    swings and of fits stand for angular velocities (rad/s). ``whole`` are all swings, of a recording that is cut the whole of it. ``own`` is
    the unit of readings that are no angle, and what of it stands for 1 rad. ``unit_doubt`` says why its unit is not to be believed, or nothing.
    """

    name: str
    fit: tuple[Swing, ...]
    holdout: tuple[Swing, ...]
    how: str
    static: tuple[tuple[Floats, Floats], ...] = field(default=())
    systematic: float = 0.0
    slack: Slack = field(default_factory=Slack, compare=False)
    reading: str = ANGLE
    whole: tuple[Swing, ...] = field(default=(), compare=False)
    own: Own | None = None
    unit_doubt: str = ""

    @property
    def unit(self) -> str:
        """What its readings are told in: rad, of a rate rad/s, or their own unit."""
        return READINGS[self.reading] if self.own is None else self.own.name


def campaign(
    name: str,
    swings: Sequence[Swing],
    holdout: Sequence[Swing] = (),
    static: Sequence[tuple[Floats, Floats]] = (),
) -> Campaign:
    """The swings of one pendulum, fitted and held out.

    Parameters
    ----------
    name
        Of the campaign.
    swings
        Those to fit.
    holdout
        Those held out. Default: by amplitude. From three swings on, every third in order of amplitude is held out, the largest and smallest
        stay; of two, the smaller; a single recording is cut into five parts (of a short recording: three), every second held out.
    static
        Records at rest: (times in s, angles in rad), each of shape (sample,).

    Raises
    ------
    InputError
        If there is no swing, or a single recording is too short.
    """
    if not swings:
        raise InputError(
            f"campaign {name}", "no swing to fit", "one or more recordings that are not static or held out"
        )
    if holdout:
        how = "held out as the sample sheet says"
        return Campaign(name, tuple(swings), tuple(holdout), how, tuple(static), whole=(*swings, *holdout))
    if len(swings) == 1:
        parts = cut(swings[0])
        how = f"one recording, cut by amplitude into {len(parts)} parts: every second held out"
        return Campaign(name, tuple(parts[::2]), tuple(parts[1::2]), how, tuple(static), whole=tuple(swings))
    order = sorted(swings, key=lambda swing: swing.amplitude)
    held = order[:1] if len(order) == 2 else order[1:-1:3]
    names = ", ".join(swing.name for swing in held)
    fit = tuple(swing for swing in swings if swing not in held)
    how = f"held out by amplitude: {names}"
    return Campaign(name, fit, tuple(held), how, tuple(static), whole=tuple(swings))


def cut(swing: Swing) -> list[Swing]:
    """The parts of one recording, as many half-swings in each.

    What follows the last swing above the noise stays with the last part.

    Parameters
    ----------
    swing
        Times (s) and angles (rad).

    Raises
    ------
    InputError
        If it has too few half-swings.
    """
    crossings, _ = middle_crossings(swing.times, swing.angle - np.mean(swing.angle[-swing.times.size // 4 :]))
    count = next((parts for parts, least in _PARTS.items() if crossings.size > least), None)
    if count is None:
        raise InputError(f"recording {swing.name}", f"{max(crossings.size - 1, 0)} half-swings, and no other recording in its campaign",
                         f"at least {min(_PARTS.values())}, so that some can be held out", "record longer, or more than once")  # fmt: skip
    at = crossings[[k * (crossings.size - 1) // count for k in range(1, count)]]
    edges = [0, *np.searchsorted(swing.times, at), swing.times.size]
    return [
        Swing(f"{swing.name}, part {k + 1} of {count}", swing.times[a:b], swing.angle[a:b], swing.drive)
        for k, (a, b) in enumerate(pairwise(edges))
    ]
