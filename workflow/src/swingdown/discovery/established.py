"""What a search has established although something remains: what swings left out in turn confirm, and nothing else could do."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from ..engine.trajectory import TrajectoryError
from ..fitting.result import Fit
from ..pendulum.catalogue import Catalogue
from ..pendulum.effect import Effect
from .admissible import inadmissible
from .budget import Budget
from .campaign import Campaign
from .candidates import without
from .constancy import changes, forms
from .evidence import Candidate, evidence
from .folds import Turns, in_turn
from .linear import frame
from .ranking import in_place_of
from .refit import refit
from .sentence import NEARLY
from .state import Round

_SIZE = 4.0  # jackknife errors that a size must be from nothing
_SHAPE = 0.25  # jackknife error over value, of a shape that is determined
_NEEDED = 0.10  # of the score on swings left out, that an effect must be worth
_SHARE = 0.9  # of the excess without it, that an effect must explain: what explains less may be the like of something else
_MOST = 0.75  # of the folds, that must be better with it
_TOLD = 0.015  # of the score, by which each rival must be worse, and be worse on as many folds
_PLAINLY = (
    0.05  # of the logarithm of what fitted swings leave: a rival that is worse by as much is told off by them
)
_RICHER = 0.02  # of the score, that a rival must be better for each parameter more
_TIE_SET = 4  # effects, of which one is there
_CONSTANT = 0.1  # of its size (RMS along the motion), that an effect may change by
AT_FIRST = 0.5  # the same when it was found, much else being missing
_EXPLAINED, _CLEAR = 1 / 3, 5.0  # of what remains, and standard errors, that such a change must be to count
_FORM, _BESIDE = (
    0.5,
    0.3,
)  # of what remains, and of its size, that a torque of its kind and of another form must be to count
_STEADY = 0.3  # of its size, by which it may be another where nothing else that was found stands beside it
_BORROWED = 0.1  # of its size, below which it is another's
_LITTLE = (
    1 / 3
)  # of the noise, RMS: where something that is less remains, the effect may be a little other than its name
_IDLE = 0.005  # of the score, below which an effect is not needed


def unneeded(state: Round, campaign: Campaign) -> Candidate | None:
    """The ``Candidate`` that drops an effect which neither fitted swings nor those left out in turn miss; None where all are missed.

    Those of the base are asked, too: what was found later may do their work.
    """
    names = state.fit.model.names
    whole = in_turn(state.fit, campaign, state.holdout)
    if whole is None or len(names) < 2:
        return None
    best: tuple[float, Candidate, Turns] | None = None
    for name in names:
        size = state.fit.model.catalogue[name].size
        nothing = size is not None and size.lower == 0 and state.fit.model.values[size.name] <= 0
        if nothing and name not in state.found:
            continue  # that it would be negative is told
        lost = _lost(state, campaign, name, whole)
        if lost is None or np.log(lost[1].fit.rms / state.fit.rms) > _IDLE:
            continue  # the fitted swings miss it
        if lost[0] < _IDLE and (best is None or lost[0] < best[0]):
            best = lost
    return best and best[1]


def _lost(state: Round, campaign: Campaign, name: str, whole: Turns) -> tuple[float, Candidate, Turns] | None:
    """What the score on swings left out loses without one effect, the model without it, and what that leaves."""
    try:
        fit = refit(without(state.fit, name), campaign.fit)
    except TrajectoryError:
        return None
    turns = in_turn(fit, campaign)
    if turns is None:
        return None
    return whole.gain(turns), Candidate(None, name, fit, evidence(fit, state.noise)), turns


def changing(state: Round, campaign: Campaign, name: str, most: float = _CONSTANT) -> str:
    """In words how an effect is not of one size or not of its form, where that explains a good part of what remains; else empty.

    ``most`` is the change, of its size, that is let pass.
    """
    here = frame(state.fit, campaign.fit)
    effect = state.fit.model.catalogue[name]
    excess = state.fit.rss - state.fit.n * state.noise.deviation**2
    try:
        changed, beside = changes(here, effect, state.noise), forms(here, effect)
    except TrajectoryError:  # the motion cannot be followed on a finer grid
        return "whether it is the same everywhere could not be seen"
    for one in changed:
        if one.squares < _EXPLAINED * excess or one.change < _CLEAR * one.error:
            continue
        if one.change > most or (most == _CONSTANT and one.squares > _SHARE * excess):
            return f"its size changes with {one.of}"
    for form in beside:
        if form.squares >= _FORM * excess and form.size > max(_BESIDE, most):
            return f"a torque of another form, over {form.over}, remains beside it"
    return ""


def _leaning(state: Round, campaign: Campaign, name: str) -> str:
    """In words that an effect has another size where nothing else that was found stands beside it; empty where it has not.

    Terms that bend one another's curve into that of something else have their sizes from one another.
    """
    size, others = state.fit.model.catalogue[name].size, [one for one in state.found if one != name]
    if size is None or not others:
        return ""
    alone = state.fit
    try:
        for other in others:
            if len(alone.model.names) > 1 and other in alone.model.names:
                alone = refit(without(alone, other), campaign.fit, grown=False)
    except TrajectoryError:
        return "it is not there without what was found beside it"
    value = state.fit.model.values[size.name]
    if abs(alone.model.values[size.name] - value) > _STEADY * abs(value):
        return f"{size.name} depends on what stands beside it"
    return ""


def borrowed(state: Round, campaign: Campaign) -> bool:
    """True where of two effects that were found neither has its size without the other: large ones that nearly cancel.

    A zero of 90 mrad and an eccentricity of as much are a bent sensor, and not there.
    """
    if len(state.found) != 2:
        return False
    for name, other in (state.found, state.found[::-1]):
        size = state.fit.model.catalogue[name].size
        if size is None:
            return False
        try:
            alone = refit(without(state.fit, other), campaign.fit, grown=False)
        except TrajectoryError:
            return False
        if abs(alone.model.values[size.name]) > _BORROWED * abs(state.fit.model.values[size.name]):
            return False
    return True


def still_so(finding: "Finding", effect: Effect, told: Fit, last: Fit) -> "Finding":
    """The finding on an effect, doubted where its values are others in the ``last`` fit than in the one that established it.

    What remained was then no separate thing: what came to imitate it took over some of the effect's work.
    """
    for parameter in effect.parameters:
        if parameter.each or parameter.role not in ("size", "shape"):
            continue
        value, now = (one.model.values.get(parameter.name) for one in (told, last))
        if finding.sure and value is not None and now is not None and abs(now - value) > _STEADY * abs(value):
            return replace(finding, doubt=f"{parameter.name} depends on what stands beside it", ties=())
    return finding


@dataclass(frozen=True)
class Finding:
    """What is to be said of one effect that was found: why it is not established (or empty), the effects one of which may be there
    in its place, and by parameter the standard error that the jackknife over swings left out gives."""

    doubt: str
    ties: tuple[str, ...] = ()
    errors: Mapping[str, float] = field(default_factory=dict)

    @property
    def sure(self) -> bool:
        """True where the effect, or one of those it ties with, is established."""
        return not self.doubt

    def beside(self, names: Collection[str] | None, name: str, catalogue: Catalogue) -> "Finding":
        """The finding once these ``names`` are known to do as well as the effect (None: there was no asking).

        A tie is told of few, each of them one of which the catalogue knows the measurement that tells it from the effect.
        """
        if names is None:
            return replace(self, doubt="it was not held against swings left out")
        strange = [one for one in names if not catalogue.measurement(name, one)]
        ties = tuple(dict.fromkeys((*self.ties, *names)))
        if strange or len(ties) >= _TIE_SET:
            return replace(self, doubt=f"{(strange or list(ties))[0]} does as well in its place", ties=())
        return replace(self, ties=ties)

    @property
    def alone(self) -> "Finding":
        """The finding where a tie is a doubt."""
        return (
            replace(self, doubt=f"{self.ties[0]} does as well in its place", ties=()) if self.ties else self
        )


def established(
    state: Round,
    campaign: Campaign,
    allowed: Collection[str] | None,
    budget: Budget,
    base: Collection[str] = (),
) -> dict[str, Finding]:
    """The ``Finding`` of each effect that a round has found.

    Established is what most of the swings left out in turn miss, whose size and shape agree whichever swings they are fitted to
    (jackknife, which knows of misfits), and in whose place no other effect does as well, those of the ``base`` that were
    dropped first of all.
    """
    whole = in_turn(state.fit, campaign, state.holdout)
    found: dict[str, Finding] = {}
    for name in state.found:
        if whole is None or budget.spent:
            found[name] = Finding("it was not held against swings left out")
            continue
        effect = state.fit.model.catalogue[name]
        errors = {p.name: whole.spread(p.name) for p in effect.parameters if not p.each and p.role != "range"}
        found[name] = Finding(_doubt(state, campaign, name, whole, errors), errors=errors)
        if found[name].sure:
            near = rivals(state, campaign, allowed, name, base, whole)
            found[name] = found[name].beside(near, name, state.fit.model.catalogue)
    return found


def _doubt(state: Round, campaign: Campaign, name: str, whole: Turns, errors: Mapping[str, float]) -> str:
    """In words why an effect is not established, its rivals left aside; empty where there is no reason."""
    effect, values = state.fit.model.catalogue[name], state.fit.model.values
    if why := inadmissible(state.fit, name, state.noise):
        return why
    for parameter in effect.parameters:
        if parameter.each or parameter.role in ("phase", "range"):
            continue
        spread, value = errors[parameter.name], abs(values[parameter.name])
        if parameter.role == "size" and value < _SIZE * spread:
            return f"{parameter.name} differs from swing to swing as much as it differs from nothing"
        if parameter.role == "shape" and spread > _SHAPE * value:
            return f"{parameter.name} differs from swing to swing"
    lost = _lost(state, campaign, name, whole)
    if lost is None or lost[0] < _NEEDED or whole.better(lost[2]) < _MOST:
        return "swings left out do not miss it"
    if why := changing(state, campaign, name) or _leaning(state, campaign, name):
        return why
    with_it, without_it = (turns.excess(state.noise) for turns in (whole, lost[2]))
    if without_it - with_it < _SHARE * without_it:
        return "much remains beside what it explains"
    if state.missing and with_it < (_LITTLE * state.noise.deviation) ** 2:
        return NEARLY
    return ""


def rivals(
    state: Round,
    campaign: Campaign,
    allowed: Collection[str] | None,
    name: str,
    base: Collection[str] = (),
    whole: Turns | None = None,
) -> list[str] | None:
    """The names of the effects that do as well in the place of one of a round's; None where there are no swings to leave out.

    One with as many parameters does as well unless fitted and left-out swings together tell, and most of the latter or, by much,
    the former.
    """
    whole = whole or in_turn(state.fit, campaign, state.holdout)
    if whole is None:
        return None
    here, catalogue = frame(state.fit, campaign.fit), state.fit.model.catalogue
    # a linear step from a model without its friction promises nothing of another friction: all that damps is held against what damps,
    # and what the base had against what is there in its place
    alike = [one for one in base if one not in state.fit.model.names]
    if catalogue[name].damping:
        alike += [one.name for one in catalogue if one.damping and (allowed is None or one.name in allowed)]
    others = [*in_place_of(here, state.noise, name, set(alike), few=len(alike))] if alike else []
    others += in_place_of(here, state.noise, name, allowed)
    found = []
    for other in {one.added: one for one in reversed(others)}.values():
        if other.refused or other.added is None:
            continue
        if name in catalogue.contained_in(other.added):
            continue  # the richer one can always do its work
        turns = in_turn(other.fit, campaign)
        if turns is None:
            continue
        more = len(other.fit.model.parameters) - len(state.fit.model.parameters)
        gain, fitted = whole.gain(turns), float(np.log(other.fit.rms / state.fit.rms))
        if more > 0:  # a richer one can always do about as well
            as_well = gain + _RICHER * more < 0
        else:
            as_well = (gain + fitted) / 2 < _TOLD or (whole.better(turns) < _MOST and fitted < _PLAINLY)
        if as_well:
            found.append(other.added)
    return found
