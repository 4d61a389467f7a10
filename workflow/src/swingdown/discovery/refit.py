"""Joint fits that begin from another fit: its values moved, widened by an effect, or nudged out of a false minimum."""

from dataclasses import dataclass

from ..engine.trajectory import TrajectoryError
from ..fitting.fit import fit_jointly
from ..pendulum import catalogue as effects
from .linear import each_model

_NUDGES = (0.97, 1.03, 0.9, 1.1)
_BETTER = 1e-4  # of the sum of squares; a smaller gain is the same minimum


@dataclass(frozen=True)
class Begin:
    """Where a joint fit begins, in the form of a fit: model, each swing's values (by name), release angles and velocities."""

    model: object
    own: tuple
    release_angle: tuple
    release_velocity: tuple


def refit(names, values, like, swings, releases=(), grown=True, most=30):
    """The ``Fit`` of the model with these effects, within the catalogue's bounds, from the values of each swing.

    ``like`` is the fit that it comes from: the options of its model, and its releases where ``releases`` (pairs of rad and
    rad/s) are not given; ``grown`` as in ``fit_jointly``. The range of a free form is not fitted. TrajectoryError where the
    values give no trajectory.
    """
    fixed = {key: value for key, value in values[0].items() if key.endswith("_range")}
    own = [p.name for name in names for p in effects.effect(name).parameters if p.own]
    releases = releases or tuple(zip(like.release_angle, like.release_velocity, strict=True))
    begin = Begin(like.model, tuple(values), *zip(*releases, strict=True))
    return fit_jointly(names, [swing.pair for swing in swings], guess=begin, seen=False, bounded=True, own=own, fixed=fixed,
                       grown=grown, most=most, restoring=like.model.restoring, form=like.model.form)  # fmt: skip


def nudged(fit, swings, rounds=3):
    """The fit, or a better one found from its neighbourhood.

    Friction that stops the pendulum within the record leaves many minima side by side: each lossy effect's size is moved
    by a few percent in turn, and the search begins anew from there.
    """
    for _ in range(rounds):
        best = fit
        lossy = [
            name
            for name in fit.model.effects
            if effects.effect(name).parameters[:1] and effects.effect(name).parameters[0].lower == 0
        ]
        for name in lossy:
            size = effects.effect(name).parameters[0].name
            for factor in _NUDGES:
                values = tuple(
                    model.values | {size: model.values[size] * factor} for model in each_model(fit)
                )
                try:
                    one = refit(fit.model.effects, values, fit, swings, grown=False)
                except TrajectoryError:
                    continue
                best = min(best, one, key=lambda fit: fit.rss)
        if best.rss > (1 - _BETTER) * fit.rss:
            return best
        fit = best
    return fit
