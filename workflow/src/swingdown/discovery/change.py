"""What follows a change: recordings between which one thing was changed on purpose, and the effect whose size goes with it.

1. Fit all recordings with one model, whose values they share but for the natural frequency: a pendulum that was touched has another.
2. Give one effect of the model at a time a size for each recording; where none of these explains the change, or that leaves something, one
   of the catalogue: those that promise most to first order are fitted. What leaves nothing then is told.
3. Give each recording all values for itself. What that leaves is what every recording lacks alike: it counts as noise, and cancels.
4. An effect follows the change where it is the only probable one, beside a discrepancy that all share, and sizes of its own take away
   nearly all that common ones leave beyond that noise.
5. A power law through the sizes over what was changed, with errors of the sizes.
"""

from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from ..arrays import Floats
from ..engine.trajectory import TrajectoryError
from ..errors import InputError
from ..fitting.result import Begin, Fit
from ..fitting.uncertainty import uncertainty
from ..measurement.stated import name_and_unit
from ..pendulum.effect import NATURAL_FREQUENCY, Effect
from ..pendulum.model import Model
from ..studies.power_laws import PowerLaw, power_law
from .budget import Budget
from .criterion import USUAL
from .data.campaign import Campaign, Swing
from .data.noise import Noise
from .move.candidates import additions, starts_to_add
from .move.refit import FAILURES, opened, refit
from .rounds import first_fit, noise_of
from .see.discrepancy import Unnamed
from .see.linear import Frame, columns_of, explained, frame

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
    """Which ``effect``'s size goes with what was ``changed`` (a value for each recording, by name), or ``natural_frequency``, or None where
    nothing is told; those that the recordings do not tell from it; the ``probability`` that it or one of these does; the ``share`` of what
    common sizes leave that is left; its ``sizes``, the natural ``frequency`` of each recording where anything differs, and the ``law`` of
    the sizes where there is one. ``stopped`` says why not all effects were asked, or is empty."""

    changed: Mapping[str, Value]
    effect: str | None = None
    tied_with: tuple[str, ...] = ()
    probability: float = 0.0
    share: float = np.nan
    sizes: Sizes | None = None
    frequency: Sizes | None = None
    law: PowerLaw | None = field(default=None, repr=False)
    stopped: str = ""

    def beside(self, base: Model) -> Model:
        """The base model in which each recording has a natural frequency, and a size of the effect that follows the change, for itself,
        where these differ."""
        if self.frequency is None:
            return base
        base = replace(base, own_frequency=True)
        if self.sizes is None or self.effect is None or self.effect == NATURAL_FREQUENCY.name:
            return base
        names = base.names if self.effect in base.names else (*base.names, self.effect)
        return replace(base.with_effects(names), own=(self.sizes.name,))

    def to_dict(self, quantity: str) -> dict[str, Any]:
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
            "sizes": self._rows(self.sizes),
            "exponent": law and law["exponent"],
            "exponent_standard_error": law and law["u_exponent"],
            "law": law,
            "natural_frequency": self._rows(self.frequency),
            "stopped": self.stopped,
        }

    def _rows(self, sizes: Sizes | None) -> list[dict[str, Any]]:
        if sizes is None:
            return []
        return [
            {
                "recording": name,
                "value": value,
                "size": float(size),
                "standard_error": float(error) if np.isfinite(error) else None,
            }
            for (name, value), size, error in zip(
                self.changed.items(), sizes.values, sizes.errors, strict=True
            )
        ]


@dataclass(frozen=True)
class _Rival:
    """An explanation: the effect whose size is each recording's own (None: none), its fit, the sum of squares that common sizes leave and that
    all values each recording's own leave (rad^2), and how many effects it adds."""

    effect: str | None
    fit: Fit
    common: float
    whole: float
    added: int = 0

    @property
    def share(self) -> float:
        """Of what common sizes leave beyond what every recording lacks alike, the RMS that is left."""
        beyond = self.common - self.whole
        return float(np.sqrt(max(self.fit.rss - self.whole, 0.0) / beyond)) if beyond > 0 else np.inf


def difference(
    campaign: Campaign,
    changed: Mapping[str, Value],
    base: Model,
    allowed: Collection[str] | None = None,
    budget_s: float | None = None,
) -> Difference | None:
    """The ``Difference`` of those recordings of a campaign, held-out ones too, between which one thing was changed, all else the same.

    Parameters
    ----------
    campaign
        Its swings.
    changed
        The value of what was changed for each recording, by name.
    base
        The model whose effects are there in any case.
    allowed
        The effects of the catalogue that may be candidates besides; None for all.
    budget_s
        Seconds (``Budget``) after which no other effect is asked; None: no end.

    Returns
    -------
    Difference or None
        None for fewer than two values. ``stopped`` says what was not asked, or where the comparison broke off.

    Raises
    ------
    TrajectoryError or InputError
        If the base model cannot be fitted.
    """
    swings = tuple(one for one in campaign.whole if one.name in changed)
    values = {one.name: changed[one.name] for one in swings}
    if len(set(values.values())) < _FEWEST:
        return None
    every, budget = replace(campaign, fit=swings, holdout=()), Budget(budget_s)
    plain = first_fit(every, replace(base, own_frequency=False, own=()))
    try:
        with threadpool_limits(1, "blas"):  # as in the search
            same = opened(plain, swings, every.slack, noise_of(every, plain))
            return _asked(every, values, same, allowed, budget)
    except FAILURES as problem:
        return Difference(values, stopped=f"the comparison broke off ({problem})")


def _asked(
    every: Campaign, changed: Mapping[str, Value], same: Fit, allowed: Collection[str] | None, budget: Budget
) -> Difference:
    """The ``Difference`` beside the fit of one model to all recordings."""
    alone = _alone(same.begin, every.fit, seen=True)
    touched = _jointly(replace(same.model, own_frequency=True), same.begin, alone, every.fit, seen=True)
    here, least = frame(touched, every.fit), sum(one.rss for one in alone)
    rivals = [_Rival(None, same, same.rss, least), _Rival(NATURAL_FREQUENCY.name, touched, same.rss, least)]
    # what is there anyway explains a change before anything else does, unless something else leaves nothing to be explained; alone it could be
    # nothing else that was changed
    base, more = touched.model.names, additions(touched.model, allowed)
    told: Difference | None = None
    gains: dict[str | None, float] = {}  # to first order (rad^2)
    for names in (base, more) if len(base) > 1 else ((*base, *more),):
        for gain, name, begin in _promising(here, names, budget):
            # what promises less than what is told already would leave something, too
            if budget.spent or (told and gain < gains.get(told.effect, 0.0)):
                break
            gains[name] = gain
            with suppress(*FAILURES):
                rivals.append(_rival(here, name, begin))
        found, lacking = _told(rivals, every, changed)
        whole = bool(found.effect) and not lacking
        told = found if told is None or not told.effect or whole else told
        if whole or budget.spent:
            break
    assert told is not None
    return replace(told, stopped="the time for it is spent") if budget.spent else told


def _promising(here: Frame, names: Collection[str], budget: Budget) -> list[tuple[float, str, Begin]]:
    """The effects of these names whose sizes, each recording's own, take away most to first order, each with that (rad^2), and with where its
    fit begins."""
    model, gains = here.fit.model, []
    for name in names:
        effect = model.catalogue[name]
        if effect.size is None or effect.each or effect.acts_on != "torque" or budget.spent:
            continue  # it was the pendulum that was changed, not what reads it
        with suppress(*FAILURES):
            begin, column = _offered(here, effect)
            gains.append((explained(here, here.apart(column))[0], name, begin))
    gains.sort(key=lambda one: -one[0])
    return gains[:_FITTED]


def _offered(here: Frame, effect: Effect) -> tuple[Begin, Floats]:
    """Where a fit with this effect begins, and what its size does to all samples: of one that the model has not, at the shape that does
    most."""
    size = _size(effect)
    if size in here.names:
        return here.fit.begin, here.slopes[: here.samples, here.names.index(size)]
    starts = starts_to_add(here, effect.name, best=1)
    if not starts:
        raise TrajectoryError(f"{effect.name}: the engine cannot follow it")
    begin = starts[0].begin
    values = {p.name: begin.swings[0].values[p.name] for p in effect.parameters}
    return begin, columns_of(here, effect, values, [size], rough=True)[:, 0]


def _size(effect: Effect) -> str:
    """The name of an effect's size."""
    assert effect.size is not None  # others do not take part
    return effect.size.name


def _rival(here: Frame, name: str, begin: Begin) -> _Rival:
    """The ``_Rival`` whose sizes of this effect are each recording's own."""
    own = replace(begin.model, own=(_size(begin.model.catalogue[name]),))
    alone = _alone(begin, here.swings)
    common = _jointly(begin.model, begin, alone, here.swings)
    fit = _jointly(own, common.begin, alone, here.swings)
    least = [min(a.rss, b.rss) for a, b in zip(alone, _alone(fit.begin, here.swings), strict=True)]
    return _Rival(name, fit, common.rss, sum(least), int(name not in here.fit.model.names))


def _alone(begin: Begin, swings: Sequence[Swing], seen: bool = False) -> list[Fit]:
    """The fit of each recording by itself, from where a joint one begins; ``seen``, from its decay, too."""
    model = replace(begin.model, own_frequency=False, own=())
    return [
        refit(Begin(model, (one,)), [swing], seen=seen, ended=True)
        for swing, one in zip(swings, begin.swings, strict=True)
    ]


def _jointly(
    model: Model, begin: Begin, alone: Sequence[Fit], swings: Sequence[Swing], seen: bool = False
) -> Fit:
    """The joint fit of a model from a beginning, and from each recording's own fit at the medians of what all share."""
    starts = [one.begin.swings[0] for one in alone]
    shared = {
        name: float(np.median([one.values[name] for one in starts]))
        for name in model.parameters
        if name not in model.each
    }
    middle = tuple(one._replace(values={**one.values, **shared}) for one in starts)
    return refit([Begin(model, begin.swings), Begin(model, middle)], swings, seen=seen, ended=True)


def _told(rivals: Sequence[_Rival], every: Campaign, changed: Mapping[str, Value]) -> tuple[Difference, bool]:
    """The ``Difference`` that these explanations leave, and whether all recordings lack something beside it."""
    swings, best = every.fit, min(rivals, key=lambda one: one.fit.rss)
    noise = noise_of(every, best.fit)
    period = 2 * np.pi / best.fit.model.values[NATURAL_FREQUENCY.name]
    torques = Unnamed(best.fit, swings, period, noise, alike=True)
    seen = []
    for one in rivals:
        with suppress(*FAILURES):  # of one that cannot be seen to first order
            seen.append((one, *_evidence(one, swings, noise, torques)))
    rivals, plain, unnamed = [one for one, *_ in seen], *np.array([logs for _, *logs in seen]).T
    logs = np.logaddexp(plain, unnamed)
    shares = np.exp(logs - np.logaddexp.reduce(logs))
    order = np.argsort(-shares)
    first, lacking = rivals[order[0]], bool(unnamed[order[0]] > plain[order[0]])
    ties, chance = [], float(shares[order[0]])
    for k in order[1 : USUAL.ties]:
        if (
            chance >= USUAL.probable
            or shares[k] < USUAL.possible / USUAL.ties
            or rivals[k].effect in (None, NATURAL_FREQUENCY.name)
        ):
            break
        ties.append(rivals[k].effect)
        chance += float(shares[k])
    if first.effect is None:
        return Difference(changed, None, tuple(ties), chance, first.share), lacking
    frequency = _sizes(first.fit, swings, NATURAL_FREQUENCY.name)
    if chance < USUAL.probable or first.share > USUAL.share:
        return Difference(changed, None, tuple(ties), chance, first.share, frequency=frequency), lacking
    own = first.fit.model.own
    sizes = _sizes(first.fit, swings, own[0]) if own else frequency
    law = _law(tuple(changed.values()), sizes, lacking)
    return Difference(changed, first.effect, tuple(ties), chance, first.share, sizes, frequency, law), lacking


def _evidence(one: _Rival, swings: Sequence[Swing], noise: Noise, torques: Unnamed) -> tuple[float, float]:
    """The evidence (natural logarithm) of an explanation as if nothing else were missing, and beside a discrepancy that all recordings
    share."""
    lacks, each = torques.beside(frame(one.fit, swings)), np.log(len(one.fit.model.catalogue))
    known = -0.5 * len(one.fit.free) * np.log(noise.effective(one.fit.n)) - each * one.added
    return lacks.log_plain + known, lacks.log_evidence - each + known


def _sizes(fit: Fit, swings: Sequence[Swing], name: str) -> Sizes:
    """The ``Sizes`` of a value that each recording has for itself; their errors know the colour of the residuals."""
    found = uncertainty(fit, [swing.pair for swing in swings])
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
