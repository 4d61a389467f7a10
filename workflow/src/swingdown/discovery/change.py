"""What follows a change: recordings between which one thing was changed on purpose, and the effect whose size goes with it.

1. Fit all recordings with one model, whose values they share but for the natural frequency: a pendulum that was touched has another.
2. Give one effect of the model at a time a size for each recording; where none of these explains the change, one of the catalogue: those
   that promise most to first order are fitted.
3. Give each recording all values for itself. What that leaves is what every recording lacks alike: it counts as noise, and cancels.
4. An effect follows the change where it is the only probable one, beside a discrepancy that all share, and sizes of its own take away
   nearly all that common ones leave beyond that noise.
5. A power law through the sizes over what was changed, with errors of the sizes.
"""

from collections.abc import Collection, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ..arrays import Floats
from ..engine.trajectory import TrajectoryError
from ..errors import InputError
from ..fitting.colour import uncertainty
from ..fitting.least_squares import fit_jointly
from ..fitting.result import Begin, Fit
from ..measurement.stated import name_and_unit
from ..pendulum.effect import NATURAL_FREQUENCY, Effect
from ..pendulum.model import Model
from ..studies.power_laws import PowerLaw, power_law
from .campaign import Campaign, Noise, Swing
from .candidates import additions, starts_to_add
from .discrepancy import discrepancy
from .judge import PROBABLE, SHARE, TIES
from .linear import Frame, columns_of, explained, frame
from .refit import FAILURES, as_candidate
from .rounds import noise_of
from .structures import POSSIBLE

_FITTED = 8  # effects that are fitted, of those that promise most
_FEWEST = 2  # values of what was changed

Value = float | str
"""Of what was changed: a number, or a name, as of a side."""


@dataclass(frozen=True)
class Sizes:
    """A quantity of each recording: its values and their standard errors, in the recordings' order."""

    name: str
    unit: str
    values: Floats
    errors: Floats


@dataclass(frozen=True)
class Difference:
    """Which ``effect``'s size goes with what was changed, or ``natural_frequency``, or None where nothing is told; those that the recordings
    do not tell from it; the ``probability`` that it or one of these does; the ``share`` of what common sizes leave that is left; its
    ``sizes``, the natural ``frequency`` of each recording, and the ``law`` of the sizes where there is one."""

    changed: tuple[Value, ...]
    effect: str | None
    tied_with: tuple[str, ...] = ()
    probability: float = 0.0
    share: float = np.nan
    sizes: Sizes | None = None
    frequency: Sizes | None = None
    law: PowerLaw | None = field(default=None, repr=False)

    def beside(self, base: Model) -> Model:
        """The base model in which each recording has a natural frequency, and a size of the effect that follows the change, for itself."""
        base = replace(base, own_frequency=True)
        if self.sizes is None or self.effect is None or self.effect == NATURAL_FREQUENCY.name:
            return base
        names = base.names if self.effect in base.names else (*base.names, self.effect)
        return replace(base.with_effects(names), own=(self.sizes.name,))

    def to_dict(self, quantity: str, recordings: Sequence[str]) -> dict[str, Any]:
        """Plain values, ``quantity`` being what was changed; None for what there is not."""
        law = None if self.law is None else self.law.to_dict()
        name, unit = name_and_unit(quantity)
        return {
            "quantity": quantity,
            "quantity_name": name,
            "quantity_unit": unit,
            "effect": self.effect,
            "tied_with": list(self.tied_with),
            "probability": self.probability,
            "share_left": self.share if np.isfinite(self.share) else None,
            "parameter": None if self.sizes is None else self.sizes.name,
            "unit": None if self.sizes is None else self.sizes.unit,
            "sizes": [] if self.sizes is None else self._rows(self.sizes, recordings),
            "exponent": law and law["exponent"],
            "exponent_standard_error": law and law["u_exponent"],
            "law": law,
            "natural_frequency": [] if self.frequency is None else self._rows(self.frequency, recordings),
        }

    def _rows(self, sizes: Sizes, recordings: Sequence[str]) -> list[dict[str, Any]]:
        told = zip(recordings, self.changed, sizes.values, sizes.errors, strict=True)
        return [
            {
                "recording": name,
                "value": value,
                "size": float(size),
                "standard_error": float(error) if np.isfinite(error) else None,
            }
            for name, value, size, error in told
        ]


@dataclass(frozen=True)
class _Rival:
    """An explanation: the effect whose size is each recording's own (None: none), its fit, the sum of squares that common sizes leave and that
    all values each recording's own leave (rad^2), and how many effects it adds."""

    effect: str | None
    fit: Fit
    common: float
    whole: float
    added: int

    @property
    def share(self) -> float:
        """Of what common sizes leave beyond what every recording lacks alike, the RMS that is left."""
        beyond = self.common - self.whole
        return float(np.sqrt(max(self.fit.rss - self.whole, 0.0) / beyond)) if beyond > 0 else np.inf


def difference(
    swings: Sequence[Swing],
    changed: Sequence[Value],
    base: Model,
    allowed: Collection[str] | None = None,
) -> Difference:
    """The ``Difference`` of recordings between which ``changed`` was changed, a value for each, all else the same.

    ``base`` names the effects that are there in any case; ``allowed`` limits those of the catalogue that are looked at besides. InputError where
    fewer than two values were recorded; TrajectoryError where the base model cannot be fitted.
    """
    if np.unique(changed).size < _FEWEST:
        raise InputError(
            "what was changed",
            f"{np.unique(changed).size} value",
            f"at least {_FEWEST}",
            "add recordings at another value",
        )
    pairs, own = [swing.pair for swing in swings], (NATURAL_FREQUENCY.name,)
    same = fit_jointly(base, pairs, bounded=True, own=())
    alone = _alone(same.begin, swings)
    touched = fit_jointly(base, pairs, guess=[same.begin, _together(alone, own)], bounded=True, own=own)
    here, whole = frame(touched, swings), sum(one.rss for one in alone)
    rivals = [_Rival(None, same, same.rss, whole, 0), _Rival(own[0], touched, same.rss, whole, 0)]
    # what is there anyway explains a change before anything else does, unless it is alone: then nothing else could have changed
    more = additions(base, allowed)
    for names in (base.names, more) if len(base.names) > 1 else ((*base.names, *more),):
        for name in _promising(here, names):
            with suppress(*FAILURES):
                rivals.append(_rival(here, name, touched))
        found = _told(rivals, swings, changed)
        if found.effect:
            break
    return found


def _promising(here: Frame, names: Collection[str]) -> list[str]:
    """The effects of these names whose sizes, each recording's own, take away most to first order."""
    model, gains = here.fit.model, {}
    for name in names:
        effect = model.catalogue[name]
        if effect.size is None or effect.each or effect.acts_on != "torque":
            continue  # it was the pendulum that was changed, not what reads it
        with suppress(*FAILURES):
            gains[name] = explained(here, _apart(here, _column(here, effect)))[0]
    return sorted(gains, key=lambda name: -gains[name])[:_FITTED]


def _column(here: Frame, effect: Effect) -> Floats:
    """What the size of an effect does to all samples, of one that the model has not at the shape that does most."""
    size = _size(effect)
    if size in here.names:
        return here.slopes[: here.samples, here.names.index(size)]
    starts = starts_to_add(here, effect.name, best=1)
    if not starts:
        raise TrajectoryError(f"{effect.name}: the engine cannot follow it")
    values = {p.name: starts[0].begin.swings[0].values[p.name] for p in effect.parameters}
    return columns_of(here, effect, values, [size], rough=True)[:, 0]


def _size(effect: Effect) -> str:
    """The name of an effect's size."""
    assert effect.size is not None  # others do not take part
    return effect.size.name


def _apart(here: Frame, column: Floats) -> Floats:
    """A column for each recording, nothing outside it."""
    found = np.zeros((column.size, len(here.slices)))
    for k, rows in enumerate(here.slices):
        found[rows, k] = column[rows]
    return found


def _rival(here: Frame, name: str, touched: Fit) -> _Rival:
    """The ``_Rival`` whose sizes of this effect are each recording's own."""
    base, own = touched.model, (NATURAL_FREQUENCY.name,)
    model = base if name in base.names else base.with_effects((*base.names, name))
    size = _size(model.catalogue[name])
    pairs = [swing.pair for swing in here.swings]
    near = touched.begin if name in base.names else starts_to_add(here, name, best=1)[0].begin
    apart = _together(_alone(Begin(model, near.swings), here.swings), (*own, size))
    with as_candidate():
        common = fit_jointly(model, pairs, guess=[near, apart], bounded=True, own=own, seen=False)
        fit = fit_jointly(
            model, pairs, guess=[common.begin, apart], bounded=True, own=(*own, size), seen=False
        )
        ended = _alone(fit.begin, here.swings, seen=False)
    least = [min(a.rss, b.rss) for a, b in zip(ended, _alone(apart, here.swings, seen=False), strict=True)]
    return _Rival(name, fit, common.rss, sum(least), int(name not in base.names))


def _alone(begin: Begin, swings: Sequence[Swing], seen: bool = True) -> list[Fit]:
    """The fit of each recording by itself, from where a joint one begins; ``seen``, from its decay, too."""
    return [
        fit_jointly(begin.model, [swing.pair], guess=[Begin(begin.model, (one,))], bounded=True, seen=seen)
        for swing, one in zip(swings, begin.swings, strict=True)
    ]


def _together(alone: Sequence[Fit], own: Sequence[str]) -> Begin:
    """Where a joint fit begins after each recording's own: at the medians of what they share."""
    model, starts = alone[0].model, [one.begin.swings[0] for one in alone]
    shared = {
        p: float(np.median([one.values[p] for one in starts])) for p in model.parameters if p not in own
    }
    return Begin(model, tuple(one._replace(values={**one.values, **shared}) for one in starts))


def _told(rivals: Sequence[_Rival], swings: Sequence[Swing], changed: Sequence[Value]) -> Difference:
    """The ``Difference`` that these explanations leave."""
    pairs, best = [swing.pair for swing in swings], min(rivals, key=lambda one: one.fit.rss)
    noise = noise_of(Campaign("", tuple(swings), (), ""), best.fit)
    period = 2 * np.pi / best.fit.model.values[NATURAL_FREQUENCY.name]
    plain, unnamed = np.array([_evidence(one, swings, noise, period) for one in rivals]).T
    logs = np.logaddexp(plain, unnamed)
    shares = np.exp(logs - np.logaddexp.reduce(logs))
    order = np.argsort(-shares)
    first = rivals[order[0]]
    ties, chance = [], float(shares[order[0]])
    for k in order[1:TIES]:
        if (
            chance >= PROBABLE
            or shares[k] < POSSIBLE / TIES
            or rivals[k].effect in (None, NATURAL_FREQUENCY.name)
        ):
            break
        ties.append(rivals[k].effect)
        chance += float(shares[k])
    frequency = None if first.effect is None else _sizes(first.fit, pairs, NATURAL_FREQUENCY.name)
    if first.effect is None or chance < PROBABLE or first.share > SHARE:
        return Difference(tuple(changed), None, tuple(ties), chance, first.share, frequency=frequency)
    name = (
        first.effect
        if first.effect == NATURAL_FREQUENCY.name
        else _size(first.fit.model.catalogue[first.effect])
    )
    sizes = _sizes(first.fit, pairs, name)
    return Difference(
        tuple(changed),
        first.effect,
        tuple(ties),
        chance,
        first.share,
        sizes,
        frequency,
        _law(changed, sizes, bool(unnamed[order[0]] > plain[order[0]])),
    )


def _evidence(one: _Rival, swings: Sequence[Swing], noise: Noise, period: float) -> tuple[float, float]:
    """The evidence (natural logarithm) of an explanation as if nothing else were missing, and beside a discrepancy that all recordings
    share."""
    lacks, each = discrepancy(frame(one.fit, swings), noise, period), np.log(len(one.fit.model.catalogue))
    known = -0.5 * len(one.fit.free) * np.log(noise.effective(one.fit.n)) - each * one.added
    return lacks.log_plain + known, lacks.log_evidence - each + known


def _sizes(fit: Fit, pairs: Sequence[tuple[Floats, Floats]], name: str) -> Sizes:
    """The ``Sizes`` of a value that each recording has for itself; their errors know the colour of the residuals."""
    found = uncertainty(fit, pairs)
    at = [k for k, free in enumerate(fit.free) if free == name]
    unit = next(p.unit for p in fit.model.definitions if p.name == name)
    return Sizes(name, unit, fit.values[at], np.sqrt(np.diag(found.covariance))[at])


def _law(changed: Sequence[Value], sizes: Sizes, lacking: bool) -> PowerLaw | None:
    """The power law through the sizes; with an offset where none without it goes through them, and where all recordings are ``lacking``
    something, which shifts all sizes alike."""
    if any(isinstance(one, str) for one in changed):
        return None
    try:
        law = power_law(changed, sizes.values, 0.0, sizes.errors)
        if not (lacking or law.scatter.refuted):
            return law
        beside = power_law(changed, sizes.values, 0.0, sizes.errors, offset=True)
    except (InputError, *FAILURES):
        return None
    return law if beside.scatter.refuted else beside
