"""Which effect is missing: every move refitted from several starts, inadmissible ones refused, ranked by evidence."""

from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace

import numpy as np

from ...engine.trajectory import TrajectoryError
from ...fitting.result import Begin, Fit
from ...pendulum.effect import NATURAL_FREQUENCY
from ..budget import Budget
from ..criterion import USUAL
from ..data.noise import Noise
from ..see.linear import Frame, frame
from .admissible import hopeless, inadmissible, leaves_noise
from .candidates import Start, additions, starts_to_add, starts_to_drop, starts_to_exchange, without
from .evidence import TIE, Candidate, best_first, evidence
from .mimics import mimics
from .pairs import plain, starts_of_pairs
from .refit import refit, refit_by_the_widest, with_effect

ENDLESS = Budget()
_PROMISING = 0.05  # of the best predicted gain: candidates below are not refitted, a linear step already tells them off
_FIRST = 2  # effects without a shape that others are tried beside
_FEW = 4  # effects tried in another one's place
_LED = 2  # candidates led out of a false minimum
_FAR = 2.0  # times the noise
_FELL_SHORT = 1.02  # of what a linear step leaves: a fit that leaves more may be in a false minimum
_MORE = 2.0  # times what a linear step promises: a fit may gain so much
_SHAPES = 3  # of an effect, to start from where the first ones did not do


def ranking(
    here: Frame,
    noise: Noise,
    allowed: Collection[str] | None = None,
    budget: Budget = ENDLESS,
    reach: float = np.inf,
) -> list[Candidate]:
    """The ``Candidate``s that mend a fit seen in a ``Frame``, best first: additions, and exchanges of known rivals.

    ``allowed`` limits the effects that may be added (all of the catalogue by default). A candidate is refused where a
    parameter ends at a bound at which the effect is not there; one that no start gives a trajectory for is left out.
    Those that promise too little to be probable, or leave more than ``reach`` (rad^2), are not refitted; where the ``budget`` is
    spent, the rest is left out.
    """
    moves = _reaching(_offered(here, additions(here.fit.model, allowed), best=_SHAPES), here, reach)
    if reach < np.inf and not moves:
        return []
    moves = [starts for starts in moves if not _sized(here, starts) or _may_pay(here, starts, noise)]
    moves.sort(key=lambda starts: -starts[0].predicted)
    most = moves[0][0].predicted if moves else 0.0
    # of an effect without a parameter no linear step tells what it is worth
    promising = [
        _first(starts)
        for starts in moves
        if not _sized(here, starts) or starts[0].predicted >= _PROMISING * most
    ]
    found = _moved(here, noise, promising, allowed, budget)
    if not budget.spent:
        found = _led(found, here, noise)
    return _grown(found, moves, here, noise, budget)


def _offered(
    here: Frame, names: Iterable[str], dropped: str | None = None, best: int = 2
) -> list[list[Start]]:
    """The starts of each effect that has any."""
    offered = (starts_to_add(here, name, best, dropped) for name in names)
    return [starts for starts in offered if starts]


def _sized(here: Frame, starts: list[Start]) -> bool:
    """True where the effect of these starts has a size."""
    added = starts[0].added
    return added is None or here.fit.model.catalogue[added].size is not None


def _may_pay(here: Frame, starts: Sequence[Start], noise: Noise) -> bool:
    """True where what a linear step promises, and more, would make the model with these effects possible: its evidence has a price."""
    catalogue, count = here.fit.model.catalogue, 1 + len(starts[0].also)
    price = count * (np.log(len(catalogue)) + 0.5 * np.log(noise.effective(here.fit.n)))
    gain = 0.5 * _MORE * starts[0].predicted / noise.slow_variance
    return bool(gain > price + np.log(USUAL.possible))


def _reaching(moves: list[list[Start]], here: Frame, reach: float) -> list[list[Start]]:
    """The moves of which what a linear step promises, and more, would leave no more than ``reach`` (rad^2)."""
    return [starts for starts in moves if here.fit.rss - _MORE * starts[0].predicted <= reach]


def _first(starts: list[Start]) -> list[Start]:
    """The starts to try first: the two most promising shapes, and the last, with the model as it is."""
    return [*starts[:2], starts[-1]] if len(starts) > 3 else starts


def _led(found: list[Candidate], here: Frame, noise: Noise) -> list[Candidate]:
    """The candidates, the first ones from growing parts of the swings as well: friction that stops a pendulum leaves many minima side by side."""
    first = (_led_out(one, here, noise) for one in found[:_LED])
    return best_first([*first, *found[_LED:]])


def _led_out(one: Candidate, here: Frame, noise: Noise) -> Candidate:
    try:
        fit = refit(one.fit.begin, here.swings)
    except TrajectoryError:
        return one
    return _weighed(replace(one, fit=fit), noise) if fit.rss < one.fit.rss else one


def _weighed(one: Candidate, noise: Noise) -> Candidate:
    """The candidate with the evidence of its fit, and why it is refused."""
    why = [inadmissible(one.fit, name, noise) for name in one.names]
    return replace(one, bic=evidence(one.fit, noise), refused=next(filter(None, why), ""))


def _grown(
    found: Sequence[Candidate], moves: Sequence[list[Start]], here: Frame, noise: Noise, budget: Budget
) -> list[Candidate]:
    """The candidates, those looked for again in growing parts of the swings that fell short of what a linear step promised where
    this would have brought them beside the best: dry friction has many minima, and growing parts lead around them.

    Where the best is far from the noise the model's own friction may do the work of what is missing, and a linear step from it tells
    little: what damps is looked for again whatever it promised.
    """
    known = {one.move: one for one in found}
    admissible = [one.bic for one in found if not one.refused]
    reach = min(admissible) + TIE if admissible else np.inf
    again = []
    for starts in moves:
        left = max(here.fit.rss - starts[0].predicted, here.fit.n * noise.deviation**2)
        one = known.get(starts[0].move)
        fit = here.fit if one is None else one.fit
        if fit.rss > _FELL_SHORT * left and evidence(fit, noise) + _gain(fit, left, noise) < reach:
            again.append(starts)
    if not found or found[0].fit.rms > _FAR * noise.deviation:
        damping = [starts for starts in moves if here.fit.model.catalogue.damps(starts[0].added or "")]
    else:
        damping = []
    others = [starts for starts in again if not any(starts is one for one in damping)]
    for starts in (*damping, *others[:_FEW]):
        one = None if budget.spent else _best(starts, here, noise, grown=True)
        old = known.get(starts[0].move)
        if one and (old is None or one.fit.rss < old.fit.rss):
            known[one.move] = one
    return best_first(known.values())


def _gain(fit: Fit, left: float, noise: Noise) -> float:
    """The change of the evidence where no more than ``left`` (rad^2) were left of what a fit leaves."""
    return float(noise.effective(fit.n) * np.log(left / fit.rss))


def _moved(
    here: Frame, noise: Noise, moves: Sequence[list[Start]], allowed: Collection[str] | None, budget: Budget
) -> list[Candidate]:
    """The candidates of these moves and of all exchanges, best first.

    An exchange is looked for in growing parts, unless an addition leaves the noise alone: what the model has is then right, and
    another in its place would have to be found without.
    """
    exchanges: dict[str, list[Start]] = {}
    for start in starts_to_exchange(here, allowed):
        exchanges.setdefault(start.move, []).append(start)
    found = best_first(_best(starts, here, noise) for starts in moves if not budget.spent)
    best = found[0].fit if found and not found[0].refused else here.fit
    enough = hopeless(min(best, here.fit, key=lambda fit: fit.rss), here.swings, noise)
    grown = not leaves_noise(best, noise)
    others = (_best(starts, here, noise, grown, enough) for starts in exchanges.values() if not budget.spent)
    return best_first([*found, *others])


def in_pairs(
    here: Frame, noise: Noise, allowed: Collection[str] | None = None, budget: Budget = ENDLESS
) -> list[Candidate]:
    """The ``Candidate``s that add two effects without a shape at once, best first: the few that promise most, if it is enough."""
    offered = [starts for starts in starts_of_pairs(here, allowed, few=_FEW) if _may_pay(here, starts, noise)]
    return best_first([_best(starts, here, noise) for starts in offered if not budget.spent])


def beside_the_best(
    here: Frame,
    noise: Noise,
    ranked: Sequence[Candidate],
    allowed: Collection[str] | None = None,
    budget: Budget = ENDLESS,
) -> list[Candidate]:
    """The ``Candidate``s that add one of the best of the ``ranked`` effects without a shape and another one without: the two
    that promise most once the first is fitted.

    Far from the noise a linear step from the model as it is tells little of two.
    """
    catalogue = here.fit.model.catalogue
    alone = [one for one in ranked if one.added and not one.refused and not one.dropped and not one.also
             and plain(catalogue[one.added])]  # fmt: skip
    found: list[Candidate | None] = []
    for one in alone[:_FIRST]:
        if one.added is None or budget.spent:
            break
        try:
            there = frame(one.fit, here.swings)
        except TrajectoryError:
            continue
        names = [name for name in additions(one.fit.model, allowed) if plain(catalogue[name])]
        moves = sorted(_offered(there, names), key=lambda starts: -starts[0].predicted)[:2]
        for starts in moves:
            begun = [replace(start, added=one.added, also=(start.added,)) for start in starts if start.added]
            found.append(_best(begun, there, noise))
    return best_first(found)


def in_place_of(
    here: Frame,
    noise: Noise,
    old: str,
    allowed: Collection[str] | None = None,
    beside: bool = False,
    reach: float = np.inf,
) -> list[Candidate]:
    """The ``Candidate``s that have another effect in the place of one of the model's own, best first.

    The model is fitted without it, and the few effects that then promise most are fitted in its place (``reach`` as in ``ranking``);
    ``beside`` the others as they were, too, those that are nearly its like.
    """
    begin = without(here.fit, old)
    if not begin.model.names:
        return []
    try:
        fit = refit(begin, here.swings)
        there = frame(fit, here.swings)
    except TrajectoryError:
        return []
    names = [name for name in additions(fit.model, allowed) if name != old]
    moves = _reaching(_offered(there, names, old), there, reach)
    moves.sort(key=lambda starts: -starts[0].predicted)
    found = [_best(starts, there, noise) for starts in moves[:_FEW]]
    if beside:
        good = {one.added for one in found if one and one.fit.rss < _FELL_SHORT * here.fit.rss}
        alike = {name: size for name, size in mimics(here, old, allowed).items() if name not in good}
        found = [one for one in found if one and one.added not in alike]
        found += [_beside_what_was(begin, old, name, size, here, noise) for name, size in alike.items()]
    return _led(best_first(found), here, noise)


def _beside_what_was(
    begin: Begin, old: str, name: str, size: float, here: Frame, noise: Noise
) -> Candidate | None:
    """The candidate of an effect without a shape in the place of another, looked for beside the others first held as they were.

    What would do an effect's work needs the others beside it, which without either of them have nothing to do.
    """
    (own,) = here.fit.model.catalogue[name].parameters
    apart = {own.name, *begin.model.each, NATURAL_FREQUENCY.name}
    begin = with_effect(begin, name, {own.name: size})
    others = [one for one in begin.model.parameters if one not in apart]
    try:
        fit = refit(refit(begin, here.swings, held=others).begin, here.swings)
    except TrajectoryError:
        return None
    return Candidate(name, old, fit, evidence(fit, noise), inadmissible(fit, name, noise))


def drops(here: Frame, noise: Noise) -> list[Candidate]:
    """The ``Candidate``s with one effect less, best first."""
    return best_first([_best([start], here, noise) for start in starts_to_drop(here)])


def _best(
    starts: Sequence[Start], here: Frame, noise: Noise, grown: bool = False, enough: float = np.inf
) -> Candidate | None:
    # what has no size cannot begin small: parts of the swings that grow lead to it
    grown = grown or not _sized(here, list(starts))
    # friction that does the work of what is missing is far too large: what damps is given its share of the decay, too
    seen = grown and any(
        here.fit.model.catalogue.damps(name) for name in (starts[0].added, *starts[0].also) if name
    )
    fits = []
    for start in starts:
        try:
            fit = (
                refit_by_the_widest(start.begin, here.swings, enough, seen)
                if grown
                else refit(start.begin, here.swings, grown=False)
            )
        except TrajectoryError:
            continue
        if fit is None:
            continue
        fits.append(fit)
        if start.predicted > 0 and fits[-1].rss < _FELL_SHORT * (here.fit.rss - start.predicted):
            break  # it is where the linear step said: no other start leads further
    if not fits:
        return None
    fit, start = min(fits, key=lambda fit: fit.rss), starts[0]
    return _weighed(Candidate(start.added, start.dropped, fit, 0.0, also=start.also), noise)
