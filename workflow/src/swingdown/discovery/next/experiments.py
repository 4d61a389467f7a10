"""What an experimenter can do next, as a menu: the words for it, what a fitted model predicts of it, and how well it can be read."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import pi, sin, sqrt
from typing import NamedTuple

import numpy as np

from ...arrays import Floats
from ...engine.trajectory import sensitivities
from ...fitting.problem import RELEASE
from ...own_unit import Own
from ...pendulum.catalogue import RATE
from ...pendulum.effect import NATURAL_FREQUENCY
from ...pendulum.half_swings import reached
from ...pendulum.model import Model
from ...quantisation import quantisation_step
from ..data.campaign import Campaign
from ..data.noise import Noise

_REACHES = (1.0, 0.5, 0.25, 0.1, 1.5, 2.0, 3.0, 4.5)  # of the largest angle so far
_LASTING = (1.0, 3.0)  # of the longest swing so far
_PERIODS = 100  # that a swing lasts at most: to follow longer ones for every experiment would take seconds
_FARTHEST = np.radians(85.0)  # of a pendulum: beyond, a rod is pushed and not pulled
_MOST = 3000  # samples that are computed of a swing; its noise is weighed as if all were
_READ = 10.0  # s, that a reading at rest is the mean of
_TIMES = 9  # as often is a swing asked for at most
PROTRACTOR = ("a digital level or a protractor", np.radians(0.1))
TOWER = ("a tower or a gauge block under the bob, measured to 0.04 mm at an arm of 0.2 m", 4e-4)
"""What a held pendulum's angle is told by, and its limit of error (rad). The tower is the one that a calibration rests on
(``config/apparatus.yaml``): two lengths of 0.04 mm over the arm; the vertical, which friction keeps it from by as little."""


class Predicted(NamedTuple):
    """What a model says of an experiment: its readings (rad, of a rate rad/s), and their slopes by each value that its fit shares and
    by each that the experiment has for itself, such as a release; (reading, value)."""

    readings: Floats
    shared: Floats
    own: Floats


@dataclass(frozen=True)
class LetGo:
    """A swing from ``angle`` (rad, with its side) and ``velocity`` (rad/s) that is sampled every ``interval`` s for ``duration`` s; ``unit``
    is what its angle is told in, where it is none."""

    angle: float
    velocity: float
    duration: float
    interval: float
    most: int = _TIMES
    unit: Own | None = None

    @property
    def kind(self) -> str:
        """``release`` from rest, or ``push`` from where it hangs."""
        return "push" if self.velocity else "release"

    @property
    def every(self) -> int:
        """The number of samples of which one is computed."""
        return -(-max(int(self.duration / self.interval), 2) // _MOST)

    def own(self, model: Model) -> dict[str, float]:
        """What a model has for this swing alone, and where it is looked for: its own values and the release."""
        return {
            **{name: model.values[name] for name in model.each},
            **dict(zip(RELEASE, (self.angle, self.velocity), strict=True)),
        }

    def predicted(self, model: Model, shared: Sequence[str], own: Mapping[str, float]) -> Predicted:
        """What a model says of it; TrajectoryError or InputError where it can say nothing."""
        times = np.arange(0, max(int(self.duration / self.interval), 2), self.every) * self.interval
        each = {name: value for name, value in own.items() if name not in RELEASE}
        angle, velocity = (own[name] for name in RELEASE)
        one = model.with_values({**model.values, **each})
        readings, slopes = sensitivities(one, times, angle, velocity, free=[*shared, *own])
        return Predicted(readings, slopes[: len(shared)].T, slopes[len(shared) :].T)

    def weighed(self, columns: Floats, noise: Noise) -> Floats:
        """Columns over the readings in units of the noise."""
        return columns / sqrt(noise.slow_variance / self.every)

    def words(self, times: int, model: Model) -> str:
        """What the experimenter does, so many ``times``."""
        often = "" if times == 1 else f", {times} times"
        if not self.velocity:
            side = "positive" if self.angle > 0 else "negative"
            return f"Release from {_told(self.angle, self.unit)} on the {side} side and record {self.duration:.3g} s{often}"
        side = "positive" if self.velocity > 0 else "negative"
        out = float(reached(abs(self.velocity) / model.values[NATURAL_FREQUENCY.name], model.restoring))
        return (
            f"Push it from where it hangs, so that it swings out to about {_told(out, self.unit)} on the {side} side, "
            f"and record {self.duration:.3g} s{often}"
        )


@dataclass(frozen=True)
class Held:
    """Readings of the pendulum held still at known ``angles`` (rad), each told by ``means`` to a ``limit`` of error (rad), the vertical
    that they are counted from as well; the mean of ``samples`` samples every ``interval`` s, which come in steps of ``step`` (rad), by a sensor with a
    ``play`` of that width (rad), in which it may stand anywhere."""

    angles: tuple[float, ...]
    means: str
    limit: float
    samples: int
    interval: float
    step: float = 0.0
    play: float = 0.0
    most: int = 1  # what tells the angles errs the same way again
    kind: str = "held"

    @property
    def angle(self) -> float:
        """The largest of the angles, rad."""
        return max(self.angles)

    @property
    def velocity(self) -> float:
        """None, in rad/s."""
        return 0.0

    @property
    def duration(self) -> float:
        """Of one reading, s."""
        return self.samples * self.interval

    def own(self, model: Model) -> dict[str, float]:
        """Nothing: the errors of what tells the angles are in the covariance."""
        return {}

    def predicted(self, model: Model, shared: Sequence[str], own: Mapping[str, float]) -> Predicted:
        """What a model says of it; TrajectoryError or InputError where it can say nothing."""
        times, readings, slopes = np.array([0.0, self.interval]), [], []
        for angle in self.angles:  # the first sample is that of the pendulum as it is held
            seen, by = sensitivities(model, times, angle, free=[*shared, RELEASE[0]])
            readings.append(seen[0])
            slopes.append(by[: len(shared), 0])
        return Predicted(np.array(readings), np.array(slopes), np.zeros((len(readings), 0)))

    def covariance(self, noise: Noise) -> Floats:
        """That of the readings' errors, (reading, reading), rad^2: noise, steps, play, what tells each angle, and the vertical of all."""
        known = self.limit**2 / 3
        each = noise.slow_variance / self.samples + (self.step**2 + self.play**2) / 12 + known
        return each * np.eye(len(self.angles)) + known

    def weighed(self, columns: Floats, noise: Noise) -> Floats:
        """Columns over the readings, as independent ones of unit variance."""
        return np.asarray(np.linalg.solve(np.linalg.cholesky(self.covariance(noise)), columns))

    def words(self, times: int, model: Model) -> str:
        """What the experimenter does."""
        seconds = f"read the sensor for {self.duration:.3g} s"
        if len(self.angles) == 1:
            return f"Let it hang at rest and {seconds}"
        sides = [f"±{_told(angle)}" for angle in self.angles if angle > 0]
        return f"Hold it still at 0°, {' and '.join(sides)}, each to {_told(self.limit)} ({self.means}), and {seconds} at each"


Experiment = LetGo | Held


def menu(campaign: Campaign, model: Model, other: Model | None = None) -> Iterator[Experiment]:
    """Every ``Experiment`` that is thought of, the least trouble first: swings from a tenth to 4.5 times the largest angle so far
    (of a pendulum at most 85°, of another twice), from both sides, as long as the longest so far or three times that, and at most a hundred periods; readings at known angles; pushes.

    ``model`` tells the kind of pendulum and of sensor, and with the ``other`` that it is told from how much play there may be.
    """
    swings = (*campaign.fit, *campaign.holdout)
    longest = max(float(swing.times[-1] - swing.times[0]) for swing in swings)
    interval = min(float(np.median(np.diff(swing.times))) for swing in swings)
    frequency = model.values[NATURAL_FREQUENCY.name]
    rate = model.reading == RATE
    largest = max(float(np.max(np.abs(swing.angle))) for swing in swings)
    if rate:  # of the swing that such a rate belongs to
        largest = float(reached(largest / frequency, model.restoring))
    farthest = max(largest, float(_FARTHEST)) if model.restoring == "sine" else 2 * largest
    angles = list(dict.fromkeys(min(reach * largest, farthest) for reach in _REACHES))
    most = _PERIODS * 2 * pi / frequency
    durations = list(dict.fromkeys(min(lasting * longest, most) for lasting in _LASTING))
    for duration in durations:
        for angle in angles:
            for side in (1.0, -1.0):
                yield LetGo(angle * side, 0.0, duration, interval, unit=campaign.own)
    samples, step = max(round(_READ / interval), 2), max(quantisation_step(swing.angle) for swing in swings)
    play = max(_play(model), _play(other or model))
    held = (0.0,) if rate else (0.0, largest / 2, -largest / 2, largest, -largest)
    # where nobody knows the scale no reading is one of an angle that is
    for means, limit in () if campaign.own else (("", 0.0),) if rate else (PROTRACTOR, TOWER):
        yield Held(held, means, float(limit), samples, interval, step, play)
    for side in (1.0, -1.0):
        yield LetGo(0.0, _push(angles[-1], model) * side, durations[0], interval, unit=campaign.own)


def _play(model: Model) -> float:
    """The width (rad) of the sensor's dead band."""
    sizes = [effect.size for effect in model.acting if effect.acts_on == "play"]
    return max((model.values[size.name] for size in sizes if size), default=0.0)


def _push(angle: float, model: Model) -> float:
    """The velocity (rad/s) at the bottom of a swing out to an angle (rad)."""
    frequency = model.values[NATURAL_FREQUENCY.name]
    return frequency * (2 * sin(min(angle, pi) / 2) if model.restoring == "sine" else angle)


def _told(angle: float, own: Own | None = None) -> str:
    return f"{own.step * abs(angle):.2g} {own.name}" if own else f"{np.degrees(abs(angle)):.2g}°"
