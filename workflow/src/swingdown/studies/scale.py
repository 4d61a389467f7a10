"""Whether swings are a pendulum's in the unit that they are taken for, or in another one.

A weight pulls back as the sine of the angle: the larger its swings, the slower they are, and by how much tells how large they
are, whatever their unit is called. Swings of 3 degrees that are taken for 3 rad are far too fast.
"""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from math import log, pi, sin

import numpy as np

from ..arrays import Swing
from ..engine.trajectory import TrajectoryError, TrajectoryWarning
from ..errors import InputError
from ..fitting.least_squares import fit_jointly
from ..fitting.result import Fit
from ..fitting.uncertainty import uncertainty
from ..pendulum.catalogue import ANGLE
from ..pendulum.effect import NATURAL_FREQUENCY
from ..pendulum.half_swings import LARGEST, lengthening
from ..pendulum.model import Model, as_model
from ..pendulum.slack import ZERO, reading_slack
from .comparison import WORTH

DEGREE = pi / 180
IN_DOUBT = "the unit is in doubt"
_MODEL = "viscous+quadratic_drag+load_coulomb"  # whatever damps: only the period is asked
_BESIDE = "cubic_stiffness"  # any other change of the period with the amplitude, to first order
_OPEN = reading_slack({ZERO: {"where it hangs": 1.0}}).weighed(0.0)  # of a zero nothing is known
_ALL = 0.99  # of what such a change would explain, that another unit must explain
_CLEAR = 5.0  # standard errors of the scale: evidence is their square


@dataclass(frozen=True)
class Scale:
    """What swings tell of their unit.

    ``factor``: angles so many times as large are a pendulum's, as those given are not; 1 where nothing speaks against these.
    ``told``: the swings tell that they are not in degrees, or that they are. ``left`` and ``left_given`` are what damping leaves
    (RMS, rad or rad/s) with these angles (with ``factor`` 1: as if they had been degrees) and with the given ones, in the unit given.
    """

    factor: float = 1.0
    told: bool = False
    left: float = np.nan
    left_given: float = np.nan

    def doubt(self, unit: str = "rad") -> str:
        """The doubt in words, with what is left in ``unit``; empty where there is none."""
        if self.factor == 1.0:
            return ""
        way, mistake = "larger", "rad taken for degrees?"
        if self.factor < 1:
            way, mistake = "smaller", "degrees taken for rad, or a spring's pull?"
        return (
            f"{IN_DOUBT} ({mistake}): damping leaves {1e3 * self.left_given:.3g} m{unit} RMS of these swings, and "
            f"{1e3 * self.left:.3g} m{unit} where they are {1 / DEGREE:.3g} times {way}"
        )


def scale_of(
    swings: Sequence[Swing], restoring: str = "sine", reading: str = ANGLE, *, stated: bool = False
) -> Scale:
    """The ``Scale`` of a pendulum's swings (times in s; angles in rad, or rates in rad/s).

    Models of damping are fitted to them as they are, as if they had been degrees, and as if they had been rad and were taken for degrees.
    The evidence is that of as many samples as count as independent. Another unit is the pendulum's where it leaves less, and does all that
    any change of the period with the amplitude would do. A spring's pull (``restoring`` linear) tells no unit. Where the unit is ``stated``,
    and no change of the period with the amplitude is worth it, none is tried: it is not asked whether the swings tell their unit.
    """
    with warnings.catch_warnings():  # of models that are only compared
        warnings.simplefilter("ignore", TrajectoryWarning)
        return _scale_of(swings, restoring, reading, stated)


def _scale_of(swings: Sequence[Swing], restoring: str, reading: str, stated: bool) -> Scale:
    if restoring != "sine" or (given := _fitted(swings, 1.0, reading)) is None:
        return Scale()
    if stated and not _period_changes(given, swings, reading):
        return Scale()
    told, less = False, np.nan
    for factor in (DEGREE, 1 / DEGREE):
        other = _fitted(swings, factor, reading) if factor < 1 or _swings(swings, factor, given) else None
        if other is None:
            continue
        left = other.rms / factor
        better, by = (other, factor) if left < given.rms else (given, 1.0)
        inflation = uncertainty(better, _scaled(swings, by)).inflation
        # those that count as independent
        samples = better.n / max(1.0, inflation) if np.isfinite(inflation) else 0.0
        evidence = 2 * samples * log(given.rms / left)
        told |= factor < 1 and abs(evidence) > _CLEAR**2
        less = left if factor < 1 else less
        if evidence > _CLEAR**2 and _does_all(other, swings, factor, given.rms, samples):
            return Scale(factor, True, left, given.rms)
    return Scale(told=told, left=less, left_given=given.rms)


def _period_changes(given: Fit, swings: Sequence[Swing], reading: str) -> bool:
    """Whether another change of the period with the amplitude may be worth it, if all samples counted as independent."""
    model = _model(f"{_MODEL}+{_BESIDE}", reading)
    try:
        more = fit_jointly(model, swings, guess=given, seen=False, grown=False, bounded=True)
    except (TrajectoryError, InputError):
        return True
    return 2 * given.n * log(given.rms / more.rms) >= WORTH


def _fitted(swings: Sequence[Swing], factor: float, reading: str, begin: Fit | None = None) -> Fit | None:
    """The joint fit of damping to angles so many times as large, or from the fit ``begin`` of that with a free period; None where no
    pendulum moves so."""
    scaled = _scaled(swings, factor)
    label = _MODEL if begin is None else f"{_MODEL}+{_BESIDE}"
    try:
        return fit_jointly(_model(label, reading), scaled, guess=begin, bounded=True)
    except (TrajectoryError, InputError):
        return None


def _model(label: str, reading: str) -> Model:
    return as_model(label).of(reading).with_slack(_OPEN)


def _swings(swings: Sequence[Swing], factor: float, given: Fit) -> bool:
    """Whether a pendulum that turns back, at the pace of the fit ``given``, reaches angles or rates so many times as large."""
    largest = factor * max(float(np.abs(readings).max()) for _, readings in swings)
    if given.model.reading == ANGLE:
        return largest < pi
    # a swing's largest rate is 4 k K(k) over half its period, with k the sine of half its amplitude
    pace = 2 * given.model.values[NATURAL_FREQUENCY.name] * float(lengthening(LARGEST))
    return largest < pace * sin(LARGEST / 2)


def _scaled(swings: Sequence[Swing], factor: float) -> list[Swing]:
    return [(times, factor * angle) for times, angle in swings]


def _does_all(other: Fit, swings: Sequence[Swing], factor: float, given: float, samples: float) -> bool:
    """True where a fit in another unit needs no further change of the period with the amplitude, or hardly any beside what it explains
    of what the ``given`` one leaves (RMS)."""
    more = _fitted(swings, factor, other.model.reading, other)
    if more is None or 2 * samples * log(other.rms / more.rms) < WORTH:
        return True
    whole = (given * factor) ** 2 - more.rms**2
    return other.rms**2 - more.rms**2 < (1 - _ALL) * whole
