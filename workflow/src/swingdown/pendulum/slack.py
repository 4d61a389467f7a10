"""What a measurement leaves open of its readings: nuisance effects, how large their values can be, and from which sources."""

import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from ..arrays import Floats

ZERO = "sensor_zero"
READING = {"sensor_gain": "sensor_gain", ZERO: ZERO, "sensor_curvature": "sensor_curvature"}
"""The effects that a calibration may leave open, and the parameter of each."""

_SURELY = 3.0  # standard errors
_POWER = re.compile(r"(\*|/)?\s*([A-Za-z]+)\s*(?:\^\s*(-?\d+))?")


@dataclass(frozen=True, eq=False)
class Slack:
    """What is known of the nuisance values of a campaign before any fit: means of zero and a covariance, by source.

    ``names`` are the nuisance effects, one parameter each; ``contributions`` (name, source) what a standard uncertainty of
    each of the ``sources`` does to each of their values, in the parameters' units: the covariance is contributions times
    their transpose. ``clock`` is the relative standard uncertainty of the time scale, which no fit can see, of which the share ``limited`` is of an error within
    limits and the rest of a normal one. ``noise`` (rad)
    is what all this is weighed against: the standard deviation of white noise with the spectrum that a fit's residuals have
    at the pendulum's frequencies.
    """

    names: tuple[str, ...] = ()
    sources: tuple[str, ...] = ()
    contributions: Floats = field(default_factory=lambda: np.zeros((0, 0)))
    clock: float = 0.0
    limited: float = 1.0
    noise: float | None = None

    @property
    def parameters(self) -> tuple[str, ...]:
        """The names of the nuisance parameters, one for each effect."""
        return tuple(READING[name] for name in self.names)

    @cached_property
    def covariance(self) -> Floats:
        """The covariance of the nuisance values, (name, name), in the parameters' units."""
        return self.contributions @ self.contributions.T

    @property
    def deviations(self) -> dict[str, float]:
        """The standard uncertainty of each nuisance parameter, by its name."""
        return dict(zip(self.parameters, map(float, np.sqrt(np.diag(self.covariance))), strict=True))

    @cached_property
    def precision(self) -> Floats:
        """The inverse of the covariance times the noise's variance: what joins J'J, rad^2 over the parameters' units."""
        size = np.sqrt(np.diag(self.covariance))
        correlation = self.covariance / np.outer(size, size)
        inverse = np.linalg.inv(correlation + 1e-9 * np.eye(size.size))
        return float(self.noise or 0.0) ** 2 * inverse / np.outer(size, size)

    def precision_among(self, free: Sequence[str]) -> Floats:
        """The precision over all ``free`` values of a fit, (free, free); zeros where nothing is open, or not all that is is free."""
        found = np.zeros((len(free), len(free)))
        if self.names and set(self.parameters) <= set(free):
            at = [free.index(name) for name in self.parameters]
            found[np.ix_(at, at)] = self.precision
        return found

    def weighed(self, noise: float) -> "Slack":
        """The same, weighed against residuals of this standard deviation (rad)."""
        return replace(self, noise=float(noise))

    def without(self, effects: Collection[str]) -> "Slack":
        """The same without effects that a model has under their own names: of these nothing is taken for known."""
        kept = [k for k, name in enumerate(self.names) if name not in effects]
        names = tuple(self.names[k] for k in kept)
        return replace(self, names=names, contributions=self.contributions[kept, :])


def reading_slack(values: dict[str, dict[str, float]], clock: float = 0.0) -> Slack:
    """The ``Slack`` from {effect: {source: contribution}}; effects of which nothing is open are left out."""
    names = tuple(name for name in READING if any(values.get(name, {}).values()))
    sources = tuple(dict.fromkeys(source for name in names for source in values[name]))
    table = [[values[name].get(source, 0.0) for source in sources] for name in names]
    return Slack(names, sources, np.array(table, dtype=float).reshape(len(names), len(sources)), clock)


def is_open(value: float, standard_error: float | None) -> bool:
    """True where a fitted nuisance value is surely not nothing: beyond three standard errors. Without one it is not known to be any."""
    return abs(value) > _SURELY * (standard_error or np.inf)


def time_power(unit: str) -> int:
    """The power of the second in a unit such as ``rad/s^2``: by how much a value changes where all times do."""
    power = 0
    for sign, name, exponent in _POWER.findall(unit):
        count = (-1 if sign == "/" else 1) * int(exponent or 1)
        power += count if name == "s" else -count if name == "Hz" else 0
    return power
