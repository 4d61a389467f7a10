"""The free variables of a fit: which they are, their bounds, where each sits in every swing's values, where searches start."""

from collections.abc import Iterable, Mapping, Sequence
from copy import copy
from functools import lru_cache
from itertools import product
from math import isfinite, prod
from typing import Any

import numpy as np

from ..arrays import Floats
from ..engine import interface
from ..engine.trajectory import Compiled, checked_times
from ..errors import InputError
from ..pendulum.catalogue import RATE, Catalogue
from ..pendulum.drive import Drive
from ..pendulum.effect import NATURAL_FREQUENCY, Parameter
from ..pendulum.model import Model
from ..pendulum.slack import Slack
from .driven import driven_guesses, driven_release
from .guess import first_guess
from .result import Begin, Fit

STARTS = ("free", "rest")
RELEASE = ("release_angle", "release_velocity")
# samples a half-swing, and in all, that are as good as any number to tell where to search
_DENSE, _ENOUGH = 32, 1000
_SHAPES = 12  # starts from shapes, each with each
_SMALLEST_FREQUENCY = 1e-3  # rad/s; a pendulum slower than an hour is none
_FEWEST_A_SWING = 1.0  # samples; of a faster pendulum nothing is seen, and to follow it takes for ever

_Names = tuple[str, ...]
Swings = Sequence[tuple[Any, Any]]
"""(times in s, angles in rad) of each swing; of a model that reads rates (times in s, angular velocities in rad/s)."""


def _checked_swing(times: Any, angle: Any) -> tuple[Floats, Floats]:
    """Times (s) and angles (rad) as contiguous arrays; InputError if they do not match, are not finite, or the times do not increase."""
    times, angle = checked_times(times), np.ascontiguousarray(angle, dtype=float)
    if angle.shape != times.shape:
        raise InputError("swing", f"{angle.size} angles for {times.size} times", "one angle for each time")
    # the sum of squares is finite only where every angle is, and takes a quarter of the time
    if not (isfinite(angle.dot(angle)) or np.isfinite(angle).all()):
        raise InputError("swing", "an angle is not finite", "numbers only")
    return times, angle


def limits(definition: Parameter, bounded: bool) -> tuple[float, float]:
    """Lower and upper bound of a parameter in a fit; where that is not bounded, only firm ones, and those beyond which there is no such effect.

    What a recording's samples say of the natural frequency comes on top.
    """
    if definition.name == NATURAL_FREQUENCY.name:
        return _SMALLEST_FREQUENCY, np.inf
    return (definition.lower, definition.upper) if bounded or definition.firm else (definition.least, np.inf)


def _rate(times: Floats) -> float:
    """Samples a second."""
    return float((times.size - 1) / (times[-1] - times[0])) if times.size > 1 else np.inf


def _mean(values: list[float]) -> float:
    return values[0] if len(values) == 1 else float(np.mean(values))


# Kept, as is a compiled model: of a small fit, to make them anew would take as long as the search.
@lru_cache(maxsize=500)
def _layout(
    entries: Catalogue,
    parameters: _Names,
    own: _Names,
    fixed: _Names,
    releases: bool,
    bounded: bool,
    count: int,
) -> tuple[list[str], list[str], list[str], Floats, Floats, np.ndarray]:
    """Which values of a fit are variables: names shared and of each swing, all free ones; their bounds, and where each sits
    in the swings' values (swing, slot)."""
    shared = [name for name in parameters if name not in own and name not in fixed]
    each = [*(name for name in parameters if name in own), *(RELEASE if releases else [])]
    free = shared + each * count
    slots = [*parameters, *RELEASE]
    where = np.full((count, len(slots)), -1, dtype=np.int32)
    for k in range(count):
        place = {name: i for i, name in enumerate(shared)}
        place |= {name: len(shared) + k * len(each) + i for i, name in enumerate(each)}
        where[k] = [place.get(name, -1) for name in slots]
    bounds = {name: limits(entries.parameters[name], bounded) for name in parameters}
    lower, upper = np.array([bounds.get(name, (-np.inf, np.inf)) for name in free]).reshape(-1, 2).T.copy()
    for array in (lower, upper, where):
        array.flags.writeable = False
    return shared, [name for name in parameters if name in own], free, lower, upper, where


# a model without its values: catalogue, names of its effects and of its slack's, restoring torque, form, drive
_Key = tuple[Catalogue, _Names, _Names, str, str, Drive | None]


@lru_cache(maxsize=500)
def _compiled(key: _Key, duration: float, start: float) -> Compiled:
    catalogue, names, open_, restoring, form, drive = key
    slack = Slack(open_, contributions=np.zeros((len(open_), 0)))
    return Compiled(Model(names, {}, {}, restoring, form, catalogue, slack, drive=drive), duration, start)


def compiled(model: Model, times: Floats, drive: Drive | None = None) -> Compiled:
    """The model as the engine takes it, for a record of these ``times`` (s), under a measured drive where one acts in it."""
    duration = model.record or float(times[-1] - times[0])
    start, drive = (float(times[0]), drive) if model.takes_input else (0.0, None)
    key = model.catalogue, model.names, model.slack.names, model.restoring, model.form, drive
    return _compiled(key, duration, start)


class Problem:
    """The free variables of a fit and where each sits in every swing's values.

    The variables are the shared parameters, then for each swing in turn its own ones and its release where that is free.
    """

    def __init__(
        self,
        model: Model,
        swings: Swings,
        start: str,
        bounded: bool,
        own: Iterable[str] = (),
        fixed: Mapping[str, float] | None = None,
    ) -> None:
        if start not in STARTS:
            raise InputError("fit, start", f"unknown start {start!r}", " or ".join(STARTS))
        if model.reading == RATE and start != "free":
            raise InputError(
                f"fit of {model.label}, start", f"{start!r} takes the release from the first sample, and the recording is of an "
                "angular rate, which does not hold it", "free", "fit the release too (experiment.start: free)",
            )  # fmt: skip
        self.fixed = dict(fixed or {})
        if unknown := [name for name in (*own, *self.fixed) if name not in model.parameters]:
            problem = f"no parameter {unknown[0]!r} in {model.label}"
            raise InputError("fit, own or fixed", problem, ", ".join(model.parameters))
        self.model, self.swings, self.start = model, [_checked_swing(*swing) for swing in swings], start
        count, sizes = len(self.swings), [times.size for times, _ in self.swings]
        layout = _layout(
            model.catalogue, model.parameters, tuple(own), tuple(self.fixed), start == "free", bounded, count
        )
        self.shared, self.own, self.free, self.lower, self.upper, self.where = layout
        if (natural := self.where[:, 0])[0] >= 0:
            self.upper = self.upper.copy()
            self.upper[natural] = 2 * np.pi / _FEWEST_A_SWING * max(_rate(times) for times, _ in self.swings)
        values = [self.fixed.get(name, 0.0) for name in model.parameters]
        rate = model.reading == RATE
        firsts = [0.0 if rate else angle[0] for _, angle in self.swings]
        self.given = np.array([[*values, first, 0.0] for first in firsts], dtype=float)
        self.n = sum(sizes)
        if self.n <= len(self.free):
            problem = f"{self.n} samples for {len(self.free)} free values"
            raise InputError("fit", problem, "more samples than free values")
        self.known = self._known() if model.slack.names else None
        self.drives: list[Any] = [getattr(swing, "drive", model.drive) for swing in swings]
        self.compiled = [
            compiled(model, times, drive) for (times, _), drive in zip(self.swings, self.drives, strict=True)
        ]
        self._point_at_swings()

    def _known(self) -> interface.Knowledge | None:
        """What the model's slack says of the variables beforehand; None where it says nothing, or they are not free."""
        slack = self.model.slack
        if not (slack.names and set(slack.parameters) <= set(self.shared)):
            return None
        if slack.noise is None:
            raise InputError(
                f"fit of {self.model.label}",
                "what the measurement leaves open is not weighed against any noise",
                "a slack with its noise (Slack.weighed), or fitting.slack.allowing",
            )
        return interface.Knowledge(np.zeros(len(self.free)), slack.precision_among(self.free))

    def _point_at_swings(self) -> None:
        models = [compiled.c for compiled in self.compiled]
        bounds = interface.Bounds(self.lower, self.upper)
        self.c = interface.FitProblem(models, self.swings, self.where, self.given, bounds, self.known)

    def half_swings(self, starts: Floats) -> float:
        """How many half-swings all swings are together, about, at the natural frequency of the first start."""
        frequency = float(starts[0, 0] if self.where[0, 0] == 0 else self.given[0, 0])
        seconds = sum(times[-1] - times[0] for times, _ in self.swings)
        return float(max(abs(frequency), _SMALLEST_FREQUENCY) * seconds / np.pi)

    def thinned(self, starts: Floats) -> "Problem":
        """The problem with every so many samples only, as many as tell a pendulum of the starts' frequency; or itself."""
        shortest = min(times.size for times, _ in self.swings)
        dense = self.n / (_DENSE * self.half_swings(starts))
        every = int(min(dense, self.n / _ENOUGH, shortest / _DENSE))
        if every < 2:
            return self
        thin = copy(self)
        thin.swings = [(times[::every].copy(), angle[::every].copy()) for times, angle in self.swings]
        if self.known is not None:  # what is known weighs as much beside fewer samples
            thin.known = self.known._replace(precision=self.known.precision / every)
        thin._point_at_swings()
        return thin

    def variables(
        self, values: Mapping[str, float] | Sequence[Mapping[str, float]], releases: Iterable[Sequence[float]]
    ) -> Floats:
        """The vector of free variables for parameter values (by name, 0 where absent) and the swings' releases.

        ``values`` is one mapping, or one for each swing.
        """
        each = [values] * len(self.swings) if isinstance(values, Mapping) else values
        last, x = each[-1], []
        for one, release in zip(each, releases, strict=True):
            x += [one.get(name, 0.0) for name in self.own]
            x += release if self.start == "free" else ()
        x = [last.get(name, 0.0) for name in self.shared] + x
        return np.minimum(np.maximum(np.array(x, dtype=float), self.lower), self.upper)

    def slots(self, x: Floats) -> list[list[float]]:
        """Each swing's values at the free variables: parameters, release angle, release velocity."""
        found, rows = np.asarray(x).tolist(), zip(self.where.tolist(), self.given.tolist(), strict=True)
        return [
            [found[at] if at >= 0 else fixed for at, fixed in zip(places, given, strict=True)]
            for places, given in rows
        ]

    def starts(self, guess: Any, seen: bool = True) -> tuple[Floats, int]:
        """Starting points (start, variable), and how many of them, at the end, are seen in the data.

        The guesses if there are any; the seen decay laid on all damping effects, and on each in turn, with each of the values that shapes start
        from. ``seen=False`` leaves those out where there is a fit to go on from.
        """
        known = guess if isinstance(guess, (list, tuple)) else [] if guess is None else [guess]
        if not seen and known and not any(isinstance(one, Model) for one in known):
            return np.array([self._from_guess(one, ()) for one in known]), 0
        if self.model.takes_input:
            return self._driven_starts(known, seen)
        reading = self.model.reading
        found = [first_guess(times, angle, self.model.restoring, reading) for times, angle in self.swings]
        releases = [(g.release_angle, g.release_velocity) for g in found]
        shares = [g.damping(self.model) for g in found]
        loss = {name: _mean([share[name] for share in shares]) for name in shares[0]}
        frequency = {NATURAL_FREQUENCY.name: _mean([g.natural_frequency for g in found])}
        split = frequency | {name: value / max(1, len(loss)) for name, value in loss.items()}
        alone = [frequency | dict.fromkeys(loss, 0.0) | {only: value} for only, value in loss.items()]
        starts = [split, *(alone if len(loss) > 1 else [])]
        shapes = self._shapes(frequency[NATURAL_FREQUENCY.name], known)
        from_data = [self.variables(values | shape, releases) for values in starts for shape in shapes]
        return np.array([*(self._from_guess(one, releases) for one in known), *from_data]), len(from_data)

    def _shapes(self, frequency: float, known: Sequence[Any]) -> list[dict[str, float]]:
        """The values that shapes start from: those of a guess, or each with each; where these are many, one shape after the other."""
        each = {one.name: one.starting_values(frequency) for one in self.model.definitions if one.starts}
        if known:
            begin = known[0].begin if isinstance(known[0], Fit) else known[0]
            values = begin.values if isinstance(begin, Model) else begin.swings[0].values
            return [{name: values.get(name, starts[0]) for name, starts in each.items()}]
        if prod(map(len, each.values())) <= _SHAPES:
            return [dict(zip(each, values, strict=True)) for values in product(*each.values())]
        first = {name: values[0] for name, values in each.items()}
        return [first | {name: value} for name, values in each.items() for value in values]

    def _driven_starts(self, known: Sequence[Any], seen: bool) -> tuple[Floats, int]:
        """The same of swings under a measured drive, from what each width of bumps shows of them (``driven``)."""
        releases = [driven_release(*swing) for swing in self.swings]
        given = [self._from_guess(one, releases) for one in known]
        each: list[list[dict[str, float]]] = []
        if seen or not given:
            driven = zip(self.swings, self.drives, strict=True)
            each = [driven_guesses(self.model, *swing, drive) for swing, drive in driven]
        from_data = [
            self.variables({name: _mean([one[name] for one in values]) for name in values[0]}, releases)
            for values in zip(*each, strict=False)
        ]
        return np.array([*given, *from_data]), len(from_data)

    def _from_guess(self, guess: Model | Begin | Fit, releases: Iterable[Sequence[float]]) -> Floats:
        """The free variables of a model, with the releases seen in the data, or of a fit, with its own."""
        if isinstance(guess, Model):
            return self.variables(guess.values, releases)
        begin = guess.begin if isinstance(guess, Fit) else guess
        return self.variables(
            [swing.values for swing in begin.swings],
            [(swing.release_angle, swing.release_velocity) for swing in begin.swings],
        )
