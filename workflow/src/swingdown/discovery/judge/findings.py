"""What is said of an effect, by the numbers of ``criterion``.

The probability is that it is there, or one of its tie, among all structures that were looked at, an unnamed torque beside the base among
them. Of an effect that takes energy the shares are asked of what only such an effect could do (``friction``): a spring that the model lacks
as well, or a natural frequency that drifts, says nothing of friction.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...arrays import Floats
from ...engine.trajectory import TrajectoryError
from ...pendulum.effect import NATURAL_FREQUENCY, VARIABLES, Contained
from ...pendulum.formula import evaluate
from ..criterion import CLEAR, USUAL, Doubt
from ..data.noise import Noise
from ..move.laws import damping
from ..see import friction
from ..see.envelope import Seen
from .confirm import gap
from .structures import Key, Pool, Structure

_ANGLES = 101  # at which two torques are compared


@dataclass(frozen=True)
class Finding:
    """What is to be said of an effect that the most probable structure has: the ``probability`` that it or one of its ``ties`` is there,
    the ``share`` of the discrepancy that is left with it, that of the ``held_out`` swings' excess over the noise, what they leave
    ``without`` it (in units of the noise), NaN where that cannot be computed, the ``doubt`` because of which it is not told, and
    ``law_open``, True of a damping whose law may be one that the catalogue has not, ``of_amplitudes``, True where the shares are those of what
    amplitudes lose from swing to swing, and ``any_unit``, True of a damping that amplitudes show: they lose alike in any unit."""

    probability: float
    ties: tuple[str, ...] = ()
    share: float = np.nan
    held_out: float = np.nan
    without: float = np.nan
    doubt: Doubt | None = None
    law_open: bool = False
    of_amplitudes: bool = False
    any_unit: bool = False

    @property
    def sure(self) -> bool:
        """True where the effect, or one of those it ties with, is told."""
        return self.doubt is None

    @property
    def why(self) -> str:
        """Its doubt in words; empty where there is none."""
        return (
            self.doubt.format(probability=self.probability, share=min(self.share, 9.99)) if self.doubt else ""
        )

    @property
    def idle(self) -> bool:
        """True of an effect without which nothing is missing, however probable it is."""
        return bool(np.isinf(self.share))


def judged(pool: Pool, best: Structure, most: Structure | None = None) -> dict[str, Finding]:
    """The ``Finding`` of each effect that a structure has beside the base; of its frictions in one, and of its drags, where they are not
    sure each. Of the ``most`` probable structure (default: the same) it may leave effects out, beside which its own are named no more; what
    an effect is nearly is seen in that one, too."""
    alike = (best,) if most is None else (best, most)
    named = pool if most is None else pool.but(most.key - best.key, pool.added(best.key))
    found = {name: _finding(pool, named, best, name, alike) for name in pool.added(best.key)}
    for kind in (pool.frictions, pool.drags):
        names = [name for name in kind(best.key) if name in found]
        shown, like = _shown(pool, kind())
        if kind(pool.base):
            names = [name for name in names if name in like] if shown else []
        if not all(found[name].sure for name in names):
            first = max(names, key=lambda name: pool.of([name]))
            as_one = _as_one(pool, best, first, names, like, alike, shown)
            if as_one.sure:
                found = {
                    name: as_one if name == first else one
                    for name, one in found.items()
                    if name == first or name not in names
                }
        if shown:
            found |= {name: replace(found[name], any_unit=True) for name in found.keys() & set(like)}
    return found


def told_of(pool: Pool, best: Structure) -> tuple[Structure, dict[str, Finding]]:
    """(the structure that is told, the ``Finding`` of each effect that it adds): the best one, or where nothing is told of it the most
    probable one that is possible and has for one of its effects another that this one is tied with, if something is told then: of names
    that the data do not tell apart the best may leave the most."""
    first = _told_of(pool, best)
    if any(one.sure for one in first[1].values()):
        return first
    alike = {_with(best.key, name, tie) for name, one in judged(pool, best).items() for tie in one.ties}
    possible = best.evidence + np.log(pool.criterion.possible)
    others = [
        one
        for key, one in pool.known.items()
        if key in alike and one.evidence >= possible and pool.follows(one.fit)
    ]
    for one in sorted(others, key=lambda one: -one.evidence):
        told = _told_of(pool, one)
        if any(finding.sure for finding in told[1].values()):
            return told
    return first


def _told_of(pool: Pool, best: Structure) -> tuple[Structure, dict[str, Finding]]:
    """The same of one structure, without the effects that take away too little of what is missing, of fitted swings or of held-out ones,
    if some effect is told then. A friction that is sure without being named has the most probable structure that names one."""
    most, best = best, _naming(pool, best)
    whole = found = judged(pool, best)
    if most is not best:  # beside a damping that is sure without a name, nothing is surer than it was
        before = judged(pool, most)
        whole = found = {
            name: before[name] if one.sure and name in before else one for name, one in found.items()
        }
    here = best
    while little := {
        name: over
        for name, one in found.items()
        if (over := pool.criterion.over_bounds((one.share, one.held_out))) > 1 and not one.sure
    }:
        fewer = _fewer(pool, here, sorted(little, key=lambda name: -little[name]))
        if fewer is None:
            return best, whole
        here, found = fewer, judged(pool, fewer, best)
    return (here, found) if any(one.sure for one in found.values()) else (best, whole)


def stand_in(pool: Pool) -> list[Structure]:
    """The most probable structure that adds something, where something unnamed does as well or better: if each of its effects is possible, and
    takes away enough of what is missing; else none."""
    named = [one for one in pool.known.values() if pool.added(one.key) and pool.follows(one.fit)]
    best = sorted(named, key=lambda one: -one.evidence)[:1]
    found = [finding for one in best for finding in judged(pool, one).values()]
    bounds = [pool.criterion.over_bounds((one.share, one.held_out)) for one in found]
    possible = all(one.probability >= pool.criterion.possible for one in found)
    return best if possible and max(bounds, default=0.0) <= 1 else []


def _fewer(pool: Pool, here: Structure, names: Sequence[str]) -> Structure | None:
    """The most probable structure without the first of these effects that can be left out; None where none can, or nothing is added then."""
    without = (one for name in names for one in pool.lacking(here, [name])[:1])
    return next((one for one in without if pool.added(one.key)), None)


def _naming(pool: Pool, best: Structure) -> Structure:
    """The most probable structure that names each kind of damping which is sure without a name, where anything is missing."""
    if pool.nothing() > pool.criterion.possible:
        return best
    shown = {kind: _shown(pool, kind()) for kind in (pool.frictions, pool.drags)}
    wanted = [like for one, like in shown.values() if one]
    if not pool.frictions(pool.base) and pool.of_friction() >= pool.criterion.probable:
        wanted.append(pool.frictions())

    def named(one: Structure) -> bool:
        return all(one.key & set(like) for like in wanted)

    if named(best):
        return best
    others = [one for one in pool.known.values() if named(one) and pool.follows(one.fit)]
    return max(others, key=lambda one: one.evidence, default=best)


def _shown(pool: Pool, kind: Sequence[str]) -> tuple[Seen | None, list[str]]:
    """(what the envelope shows of this kind of damping, where that is sure and its everyday laws leave little of what amplitudes lose; its
    effects that the base has none like)."""
    laws, like = pool.unlike_the_base(kind)
    one = pool.envelope(laws)
    # by the swings or by the envelope, unless the latter makes it improbable, or nothing may be missing without it
    sure = one.chance >= pool.criterion.possible and max(one.chance, pool.of(like)) >= pool.criterion.probable
    sure = sure and pool.whole_without(like) <= pool.criterion.possible
    sure = sure and pool.criterion.over_bounds((one.share, one.held_out)) <= 1
    return one if sure else None, like


def _finding(pool: Pool, named: Pool, best: Structure, name: str, alike: Sequence[Structure]) -> Finding:
    """That of one effect by its name, whose probability is among the structures of ``named``."""
    simpler = _simpler(pool, best, name, alike)
    same = {name, *simpler, *_at_its_values(pool, best, name)}
    # what the structure has beside it is there with or without it: no rival
    others = (
        {one for key in named.known for one in named.added(key)}
        - same
        - frozenset().union(*(each.key for each in alike))
    )
    ties = simpler
    chance = named.of(same)
    while chance < pool.criterion.probable and len(ties) + 1 < pool.criterion.ties and others:
        nearest = max(sorted(others), key=lambda one: named.of([*same, *ties, one]))
        if named.of([*same, *ties, nearest]) - chance < pool.criterion.possible / pool.criterion.ties:
            break
        ties.append(nearest)
        others.discard(nearest)
        chance = named.of([*same, *ties])
    ties += _nearly_the_tied(pool, best, name, ties)[: pool.criterion.ties - 1 - len(ties)]
    return _asked(pool, best, name, [name], Finding(chance, tuple(ties)))


def _nearly_the_tied(pool: Pool, best: Structure, name: str, ties: Sequence[str]) -> list[str]:
    """What those that an effect is tied with are nearly, each in the place of the effect: a cubic spring that softens as a weight does."""
    there = {one: pool.known[key] for one in ties if (key := _with(best.key, name, one)) in pool.known}
    found = [simpler for one, structure in there.items() for simpler in _nearly_in(structure, one)]
    return [
        one for one in dict.fromkeys(found) if one not in (name, *ties) and one not in best.key | pool.base
    ]


def _as_one(
    pool: Pool,
    best: Structure,
    name: str,
    names: Sequence[str],
    kind: Sequence[str],
    alike: Sequence[Structure],
    shown: Seen | None,
) -> Finding:
    """That of all effects of one kind of damping that a structure has, told by the name of one: the data may not tell their law, and
    amplitudes do not tell everyday laws apart that lose alike. It may be one that the tie has no place for, and of friction, which is
    left as the speed goes to nothing, none of the catalogue's: an unnamed torque may hold that as well."""
    model = pool.first.fit.model
    lost, everyday = shown.laws if shown else frozenset(), damping(model)
    others = sorted(
        (
            one
            for one in kind
            if one in names
            or pool.of([one]) >= pool.criterion.possible
            or (one in everyday and model.catalogue.powers_lost(one) <= lost)
        ),
        key=lambda one: -pool.of([one]),
    )
    ties = tuple(one for one in dict.fromkeys([*_simpler(pool, best, name, alike), *others]) if one != name)[
        : pool.criterion.ties - 1
    ]
    rubs, open_ = model.catalogue.rubs(name), pool.of([name, *ties]) < pool.criterion.probable
    chance = max(pool.of_friction() if rubs else pool.of(kind), shown.chance if shown else 0.0)
    seen = shown is not None or (rubs and pool.sees_friction() >= pool.criterion.probable)
    one = _asked(pool, best, name, names, Finding(chance, ties, law_open=open_))
    if one.sure or not seen:
        return one
    # what is seen without a name is there, however little its named law explains
    one = replace(one, doubt=None, law_open=True)
    if shown is None:
        return one
    return replace(one, share=shown.share, held_out=shown.held_out, without=np.nan, of_amplitudes=True)


def _asked(pool: Pool, best: Structure, name: str, names: Sequence[str], one: Finding) -> Finding:
    """The finding with the shares that are left with these effects, and what speaks against it."""
    near = pool.lacking(best, names)
    if not near:
        return replace(one, doubt=Doubt.NO_MODEL)
    # what the base has may be improbable beside a discrepancy, and does more of the work than it does
    without = min(near, key=lambda other: other.left(pool.noise))
    share, held, rms = _whole(pool, best, without)
    damps = best.fit.model.catalogue.damps(name)
    if pool.criterion.over_bounds((share, held)) > 1 and damps:
        share, held = min((share, held), _of_friction(pool, best, without), key=pool.criterion.over_bounds)
    why = pool.criterion.doubt(one.probability, share, held)
    if why is Doubt.IMPROBABLE and not pool.added(pool.best.key):
        why = Doubt.AS_WELL
    law_open = one.law_open or (why is None and damps and pool.loses_more(best))
    return replace(one, share=share, held_out=held, without=rms, doubt=why, law_open=law_open)


def _at_its_values(pool: Pool, best: Structure, name: str) -> set[str]:
    """The richer effects that in its place are this one at the values that they are fitted with: a drag in the power 2.0 of the speed."""
    found = set()
    for richer in best.fit.model.catalogue:
        there = pool.known.get(_with(best.key, name, richer.name))
        simpler = next((one for one in richer.contains if one.name == name), None)
        if simpler is None or there is None:
            continue
        values, errors = there.fit.model.values, there.fit.model.standard_errors
        if _as_likely(simpler, values, errors):
            found.add(richer.name)
    return found


def _simpler(pool: Pool, best: Structure, name: str, alike: Sequence[Structure]) -> list[str]:
    """The simpler effects that this one is not told from: it is nearly that, or takes away too little of what is missing with that in its
    place, as an effect is asked that is told from none."""
    inside = [
        one.name for one in best.fit.model.catalogue[name].contains if one.name not in best.key | pool.base
    ]
    known = [
        (one, pool.known[_with(best.key, name, one)])
        for one in inside
        if _with(best.key, name, one) in pool.known
    ]
    found = [one for one, there in known if pool.criterion.over_bounds(_whole(pool, best, there)[:2]) > 1]
    return list(dict.fromkeys([*_nearly(alike, name), *found]))


def _nearly(structures: Sequence[Structure], name: str) -> list[str]:
    """The simpler effects, in none of these structures, that this one is nearly in one of them."""
    found = [one for structure in structures if name in structure.key for one in _nearly_in(structure, name)]
    return [one for one in dict.fromkeys(found) if not any(one in structure.key for structure in structures)]


def _nearly_in(best: Structure, name: str) -> list[str]:
    """The simpler effects that this one is at values that are as likely as those it is fitted with: presliding over no angle."""
    values, errors = best.fit.model.values, best.fit.model.standard_errors
    errors = {one: error * best.widened.get(one, 1.0) for one, error in errors.items()}
    effect = best.fit.model.catalogue[name]
    # a shape that ends at its bound may be anything beyond
    lowest = {
        one.name: one.lower
        for one in effect.parameters
        if values[one.name] <= one.lower + 1e-9 * abs(one.lower)
    }
    found = [
        simpler.name
        for simpler in effect.contains
        if simpler.at
        and (
            _as_likely(simpler, values, errors)
            or all(lowest.get(one, -np.inf) >= wanted for one, wanted in simpler.at.items())
        )
    ]
    return [*found, *_of_no_size(best, name, values, errors)]


def _of_no_size(
    best: Structure, name: str, values: Mapping[str, float], errors: Mapping[str, float]
) -> list[str]:
    """The effects that have no size, and whose torque over the angles of the swings is, but for a small ``share``, that of this one at a size as
    likely as its own: what a weight does under a linear restoring torque, and a cubic spring. What is there in small swings is the frequency's."""
    model, effect = best.fit.model, best.fit.model.catalogue[name]
    others = [one for one in model.catalogue if not one.parameters and one.beside in ("", model.restoring)]
    if effect.size is None or effect.states or effect.acts_on != "torque" or not others:
        return []
    angles = np.linspace(-1, 1, _ANGLES) * max(float(np.max(np.abs(one.angle))) for one in best.fit.swings)
    own = {"theta": angles, "duration": 1.0, "omega_n": values[NATURAL_FREQUENCY.name]}
    at, middle = dict.fromkeys(VARIABLES, 0.0) | own, _ANGLES // 2

    def beyond(torque: Floats) -> Floats:
        after, before = middle + 1, middle - 1
        return torque - angles * (torque[after] - torque[before]) / (angles[after] - angles[before])

    shape = {one.symbol: values[one.name] for one in effect.parameters} | {effect.size.symbol: 1.0}
    unit = beyond(evaluate(effect.term, **at, **shape) * np.ones(_ANGLES))
    found = []
    for other in others:
        torque = beyond(evaluate(other.term, **at))
        size = float(torque @ unit / (unit @ unit)) if np.any(unit) else 0.0
        alike = np.linalg.norm(torque - size * unit) <= USUAL.share * np.linalg.norm(torque)
        if alike and _as_likely(Contained(other.name, {effect.size.name: size}), values, errors):
            found.append(other.name)
    return found


def _as_likely(simpler: Contained, values: Mapping[str, float], errors: Mapping[str, float]) -> bool:
    """True where the values that make an effect a simpler one are as likely as its own; beyond all bounds by the inverse: a width of which
    no more is known than that it is not small."""
    return all(
        abs(values[p] - (0.0 if np.isinf(wanted) else wanted)) <= CLEAR * errors.get(p, 0.0)
        for p, wanted in simpler.at.items()
    )


def _with(key: Key, old: str, new: str) -> Key:
    return (key - {old}) | {new}


def _whole(pool: Pool, best: Structure, without: Structure) -> tuple[float, float, float]:
    """(share that is left with an effect of what is missing without it; the same of held-out swings, beyond what the noise allows; what
    these leave without it, in units of the noise); infinite where nothing is left, or cannot be computed."""
    before = without.left(pool.noise)
    share = best.left(pool.noise) / before if before > 0 else np.inf
    try:
        now, then = (pool.held_out(one.fit) for one in (best, without))
    except TrajectoryError:
        return float(share), np.inf, np.nan
    held = _share(pool.noise, now.n, now.rms**2, then.rms**2)
    if np.isinf(held) and without.fit.model.slack.names and now.rms <= then.rms:
        # nothing to confirm, and it may be what the calibration says that speaks against the model
        held = 0.0
    return float(share), held, gap(then, pool.noise)


def _of_friction(pool: Pool, best: Structure, without: Structure) -> tuple[float, float]:
    """The same two shares of what only friction or drag could do; infinite where that is less than the noise without it."""
    variance, swings = pool.noise.slow_variance, pool.campaign.holdout
    now, then = friction.fitted(best.frame), friction.fitted(without.frame)
    if now is None or then is None or then.mean_square < variance * (1 + then.share):
        return np.inf, np.inf
    left, lacked = (max(one.mean_square - variance * one.share, 0.0) for one in (now, then))
    share = np.sqrt(left / lacked) * (1 - best.whole)
    try:
        now, then = (friction.held_out(pool.held_out(one.fit), swings) for one in (best, without))
    except TrajectoryError:
        return float(share), np.inf
    if now is None or then is None:
        return np.inf, np.inf
    directions = now.share * sum(one.times.size for one in swings)
    known = np.hypot(np.sqrt(2 / directions), pool.noise.known)
    return float(share), _left(now.mean_square, then.mean_square, variance * now.share, known)


def _share(noise: Noise, samples: int, now: float, then: float) -> float:
    """What is left of a mean square beyond what the noise allows, as a share in size of what was left then."""
    known = np.hypot(np.sqrt(2 / noise.effective(samples)), noise.known)
    return _left(now, then, noise.deviation**2, known)


def _left(now: float, then: float, variance: float, known: float) -> float:
    """What is left of a mean square beyond a noise of this variance, which is known to such a share, as a share in size of what was
    left then beyond the noise; infinite where that was nothing."""
    allowed = variance * (1 + CLEAR * known)
    if then <= allowed:
        return np.inf
    return float(np.sqrt(max(now - allowed, 0.0) / (then - variance)))
