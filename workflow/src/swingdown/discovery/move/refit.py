"""Joint fits that begin from another fit: its values moved, widened by an effect, or nudged out of a false minimum."""

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager

import numpy as np

from ...engine.trajectory import TrajectoryError
from ...fitting.least_squares import fit_jointly
from ...fitting.result import Begin, Fit
from ...pendulum.slack import Slack
from ..data.campaign import Swing
from ..data.noise import Noise

_NUDGES, _ROUNDS = (0.97, 1.03, 0.9, 1.1), 3
_BETTER = 1e-4  # of the sum of squares; a smaller gain is the same minimum
# evaluations, and of the sum of squares what a step promises at the end: to a few hundredths of a standard error, and to the end
_RANKED, _ENDED = (30, 1e-7), (200, 1e-10)

FAILURES = (ArithmeticError, ValueError)
"""How arithmetic ends that goes wrong: trajectories, divisions, singular matrices, values that a model cannot have."""


@contextmanager
def as_candidate() -> Iterator[None]:
    """A block on one model of many, whatever goes wrong in which is a TrajectoryError: the search passes that model over."""
    try:
        yield
    except TrajectoryError:
        raise
    except FAILURES as problem:
        raise TrajectoryError(str(problem)) from problem


def refit(
    begin: Begin | Sequence[Begin],
    swings: Sequence[Swing],
    grown: bool = True,
    seen: bool = False,
    ended: bool = False,
    held: Collection[str] = (),
) -> Fit:
    """The ``Fit`` of the model that ``begin`` has, within the catalogue's bounds, from its values and releases.

    Of several beginnings of one model it is the best; those that come to the minimum of an earlier one are not followed to its bottom.
    ``grown`` as in ``fit_jointly``; ``seen`` begins from the decay that the swings show, too. Unless it is ``ended`` the search is rough, and stops where candidates can be ranked. Parameters that are
    ``held`` stay at where they begin. TrajectoryError where the values give no trajectory, or are none that the model can have.
    """
    begins = [begin] if isinstance(begin, Begin) else list(begin)
    model, values = begins[0].model, begins[0].swings[0].values
    fixed = {name: values[name] for name in held}
    most, tolerance = _ENDED if ended else _RANKED
    with as_candidate():
        return fit_jointly(model, [swing.pair for swing in swings], guess=begins, seen=seen, bounded=True, own=model.each,
                           fixed=fixed, grown=grown, most=most, tolerance=tolerance,
                           rough=not ended)  # fmt: skip


def widest(swings: Sequence[Swing]) -> int:
    """Which of the swings is the widest."""
    return max(range(len(swings)), key=lambda k: swings[k].amplitude)


def refit_by_the_widest(
    begin: Begin, swings: Sequence[Swing], enough: float = np.inf, seen: bool = False, grown: bool = True
) -> Fit | None:
    """The ``Fit`` to which the widest swing leads, in growing parts if it is ``grown``; None where it leaves more than ``enough`` (rad) of it.

    What does not follow one swing alone follows no more of it beside others. Errors as of ``refit``.
    """
    k = widest(swings)
    alone = refit(Begin(begin.model, (begin.swings[k],)), [swings[k]], grown, seen)
    if alone.rms > enough:
        return None
    if len(swings) == 1:
        return alone
    shared = {
        name: alone.model.values[name]
        for name in alone.free
        if name in begin.model.parameters and name not in begin.model.each
    }
    followed = list(moved(begin, **shared).swings)
    followed[k] = alone.begin.swings[0]
    return refit([Begin(begin.model, tuple(followed)), begin], swings, grown=False)


def opened(fit: Fit, swings: Sequence[Swing], slack: Slack, noise: Noise) -> Fit:
    """The fit with what the measurement leaves open weighed against the noise, as a candidate that leaves nothing else would be.

    Weighed against the residuals of a model that misses much, what is known of the sensor would stand against every
    candidate that is right.
    """
    if not slack.names:
        return fit
    model = fit.model.with_slack(slack.weighed(float(np.sqrt(noise.slow_variance))))
    nothing = dict.fromkeys(model.slack.parameters, 0.0)
    begin = Begin(model, tuple(one._replace(values=nothing | dict(one.values)) for one in fit.begin.swings))
    try:
        return refit(begin, swings, grown=False, ended=True)
    except TrajectoryError:
        return fit


def moved(begin: Begin, **values: float) -> Begin:
    """The same beginning with some values, by name, others in every swing."""
    swings = tuple(one._replace(values={**one.values, **values}) for one in begin.swings)
    return Begin(begin.model, swings)


def widened(begin: Begin, name: str, each: Iterable[Mapping[str, float]]) -> Begin:
    """The same beginning with one effect more, and its values in each swing."""
    model = begin.model.with_effects((*begin.model.names, name))
    swings = zip(begin.swings, each, strict=True)
    return Begin(model, tuple(one._replace(values={**one.values, **more}) for one, more in swings))


def with_effect(begin: Begin, name: str, values: Mapping[str, float]) -> Begin:
    """The same beginning with one effect more, and its values, the same in every swing."""
    return widened(begin, name, [values] * len(begin.swings))


def nudged(fit: Fit, swings: Sequence[Swing]) -> Fit:
    """The fit, or a better one found from its neighbourhood.

    Friction that stops the pendulum within the record leaves many minima side by side: each one-sided effect's size is
    moved by a few percent in turn, and the search begins anew from there.
    """
    for _ in range(_ROUNDS):
        sizes = [effect.size.name for effect in fit.model.effects if effect.size and effect.one_sided]
        values = {size: fit.model.values[size] for size in sizes}
        around = [
            moved(fit.begin, **{size: value * factor})
            for size, value in values.items()
            if value
            for factor in _NUDGES
        ]
        if not around:
            return fit
        try:
            best = refit([fit.begin, *around], swings, grown=False)
            if best.rss > (1 - _BETTER) * fit.rss:
                return fit
            fit = refit(best.begin, swings, grown=False, ended=True)
        except TrajectoryError:
            return fit
    return fit
