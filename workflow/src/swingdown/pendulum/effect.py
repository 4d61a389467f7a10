"""What an effect is: its equation, its parameters and their roles, and all that is known of it beside others.

A formula is written in ``theta`` (rad, 0 hanging straight down), ``thetadot`` (rad/s), ``t`` (s since the first
sample), ``duration`` (s, of the record), ``omega_n`` (rad/s), the effect's own symbols and its own states; of a pendulum whose
drive was measured also ``input`` (``drive.KINDS``), ``input_rate`` and ``input_curve``, its first two derivatives by time. What
it acts on decides what its term means:

- ``torque``: added to the angular acceleration (rad/s^2);
- ``sensor``: the reading, with ``theta`` the angle (or the reading of the sensor effect before it in the catalogue);
- ``play``: the width of a dead band between angle and reading (rad);
- ``clock``: the true time of a sample stamped ``t`` (s).

``inertia`` is a fraction added to the pendulum's own: theta'' = sum of torques / (1 + sum of inertias). A state has a
first-order equation of motion of its own, which may also use ``thetaddot``.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from math import inf
from typing import Any, Literal, NamedTuple

import numpy as np

from .formula import evaluate, parse

INPUTS = {"input": "1", "input_rate": "1/s", "input_curve": "1/s**2"}
VARIABLES = {"theta": "1", "thetadot": "1/s", "t": "s", "duration": "s", "omega_n": "1/s", **INPUTS}
TERM_UNITS = {"torque": "1/s**2", "sensor": "1", "play": "1", "clock": "s"}

_INPUT = re.compile(r"\binput(_rate|_curve)?\b")
_SLOW, _NOTHING = 1e-300, 1e-9  # a speed (rad/s) so small, and a torque so small, that they are none

Role = Literal["size", "shape", "phase", "start", "delay"]


class Parameter(NamedTuple):
    """A number an effect has: its name in files, its symbol in formulas, unit, admissible bounds, and typical size.

    ``role`` tells what it does: the effect is linear in a ``size`` and nothing is left of it at zero; a ``shape`` decides
    where or how fast it acts; a ``phase`` is an angle that turns a sine into a cosine; a
    ``start`` tells how the recordings begin; a ``delay`` is that of a measured drive.
    """

    name: str
    symbol: str
    unit: str
    lower: float = -inf
    upper: float = inf
    text: str = ""
    typical: float = 0.01
    role: Role = "size"
    starts: tuple[float, ...] = ()
    """Of a shape: the values that searches start from; in units of the natural frequency where ``relative``."""
    relative: bool = False
    at_line: bool = False
    """Of a frequency: searches start where the residual's spectrum has its line."""
    apart_from_swing: tuple[float, float] | None = None
    """Of a frequency in Hz: ratios to the pendulum's own between which it would imitate the pendulum's own error."""
    each: bool = False
    """Each recording has a value of its own, such as a phase at its first sample."""
    drawn: tuple = ()
    """Where trials draw it: (low, high), several such pairs, or more than two values; by default between its starts."""
    largest: float = inf
    """Of a size: beyond this no trial goes."""
    firm: bool = False
    """Its bounds hold in every fit, as those that a study states do; the catalogue's hold in searches, and a fit shows what lies beyond."""

    @property
    def least(self) -> float:
        """The value below which there is no such effect, or none the engine can follow: a lower bound above zero."""
        return self.lower if self.lower > 0 else -inf

    @property
    def usual(self) -> float:
        """The value where nothing is said of it: the typical size, and of a start nothing."""
        return 0.0 if self.role == "start" else self.typical

    def starting_values(self, natural_frequency: float) -> list[float]:
        """The values to start a search from, in the parameter's unit; ``natural_frequency`` in rad/s."""
        return [value * natural_frequency if self.relative else value for value in self.starts]


class State(NamedTuple):
    """A quantity with a memory: symbol, unit, its value at the release and its rate of change, as formulas."""

    symbol: str
    unit: str
    initial: str
    rate: str
    text: str = ""


class Contained(NamedTuple):
    """A simpler effect that an effect becomes where its parameters take the values ``at`` (infinite: in that limit)."""

    name: str
    at: dict[str, float]


class StandIn(NamedTuple):
    """An effect whose work this one can do, and with which values: formulas by parameter, in the other's symbols and ``omega_n``.

    Each dict of ``values`` is one place to start a fit of the exchange from.
    """

    name: str
    values: tuple[dict[str, str], ...]


class Formulas(NamedTuple):
    """An effect's formulas as sympy expressions: torque and inertia, rates and initial values of states, the reading."""

    motion: dict[str, Any]
    rates: tuple[Any, ...]
    initial: tuple[Any, ...]
    reading: Any


@dataclass(frozen=True)
class Effect:
    """One physical effect: its term, where it acts, its parameters, where it comes from, and what is known of it beside others.

    ``printed`` is the term as the paper prints it, where that differs from the dimensionally consistent form.
    """

    name: str
    term: str
    parameters: tuple[Parameter, ...]
    explanation: str
    reference: str
    acts_on: str = "torque"
    printed: str | None = None
    inertia: str | None = None
    states: tuple[State, ...] = ()
    symbol: str = ""
    spoken: str = ""
    """What a sentence calls it that says what stops a pendulum; empty where it takes no energy."""
    spoken_of_wheel: str = ""
    """The same of a wheel on a spring, where that is another thing: a magnet may brake it as well as air."""
    beside: str = ""
    """The restoring torque (``sine`` or ``linear``) that alone it makes sense beside; empty for any."""
    damping: str = ""
    """The size that alone would take the ``loss`` (rad) a half-swing from the ``amplitude`` (rad): a formula of these and
    ``omega_n``, from the energy balance of harmonic motion (Nayfeh and Mook 1979, ch. 3). Empty where it does not damp."""
    contains: tuple[Contained, ...] = field(default=(), hash=False)
    replaces: tuple[StandIn, ...] = field(default=(), hash=False)
    told_apart: dict[str, str] = field(default_factory=dict, hash=False)
    """By rival: the measurement that tells the two apart, as a sentence to an experimenter."""
    headline: tuple[str, ...] = ()
    """Names of the parameters that a sentence tells, the first first; by default the size."""
    reading_error: str = ""
    """Of a sensor effect that a calibration may leave open: its largest error (rad), a formula of its own symbols and
    ``largest_angle`` (rad)."""
    twin: Callable[..., float] | None = field(default=None, repr=False, compare=False)
    """The torque (rad/s^2) for the second pendulum, written by hand: a function of time, angle, velocity, direction of
    motion, values by name and the record's duration. The shipped effects have theirs in ``swingdown_trials``."""

    @property
    def size(self) -> Parameter | None:
        """The parameter that the effect vanishes with; None where it has none."""
        return next((parameter for parameter in self.parameters if parameter.role == "size"), None)

    @property
    def one_sided(self) -> bool:
        """True where a size below zero would be another thing than the effect: it takes energy, or pulls back."""
        return self.size is not None and self.size.lower == 0

    @property
    def rubs(self) -> bool:
        """True of a friction: a torque against the motion that is left at the middle as the speed goes to nothing."""
        if self.acts_on != "torque" or self.states or self.takes_input:
            return False
        values = {one.symbol: one.starts[0] if one.starts else 1.0 for one in self.parameters}
        at = dict.fromkeys(VARIABLES, 0.0) | {"duration": 1.0, "omega_n": 1.0} | values
        forth, back = (
            {name: np.float64(value) for name, value in (at | {"thetadot": speed}).items()}
            for speed in (_SLOW, -_SLOW)
        )
        with np.errstate(all="ignore"):  # of a formula that has no value at the middle
            return bool(abs(evaluate(self.term, **forth) - evaluate(self.term, **back)) > _NOTHING)

    def with_role(self, *roles: Role) -> tuple[Parameter, ...]:
        """The parameters that have one of these roles."""
        return tuple(parameter for parameter in self.parameters if parameter.role in roles)

    @property
    def each(self) -> tuple[str, ...]:
        """The names of the parameters that each recording has for itself."""
        return tuple(parameter.name for parameter in self.parameters if parameter.each)

    @property
    def told(self) -> tuple[str, ...]:
        """The names of the parameters that a sentence tells, in that order."""
        return self.headline or ((self.size.name,) if self.size else ())

    @property
    def numerics(self) -> tuple:
        """All that the compiled engine depends on."""
        symbols = tuple(parameter.symbol for parameter in self.parameters)
        states = tuple((state.symbol, state.initial, state.rate) for state in self.states)
        late = tuple(parameter.symbol for parameter in self.with_role("delay"))
        return self.name, self.term, self.printed, self.inertia, self.acts_on, symbols, states, late

    @property
    def takes_input(self) -> bool:
        """True where a formula of it names the measured drive."""
        formulas = (self.term, self.inertia or "", *(state.rate for state in self.states))
        return any(_INPUT.search(one) for one in formulas)

    def expressions(self, form: str = "consistent") -> Formulas:
        """The formulas of the effect as sympy expressions.

        Parameters
        ----------
        form
            ``consistent``, or ``printed`` (the paper's Table 1 to the letter).

        Raises
        ------
        InputError
            If a formula cannot be read.
        """
        names = (*VARIABLES, *(p.symbol for p in self.parameters), *(state.symbol for state in self.states))

        def read(text: str, *more: str) -> Any:
            return parse(text, (*names, *more), where=f"effect {self.name}")

        term = read(self.printed if form == "printed" and self.printed else self.term)
        motion = {"torque": term} if self.acts_on == "torque" else {}
        if self.inertia:
            motion["inertia"] = read(self.inertia)
        rates = tuple(read(state.rate, "thetaddot") for state in self.states)
        initial = tuple(read(state.initial) for state in self.states)
        return Formulas(motion, rates, initial, term if self.acts_on in ("sensor", "clock") else None)


NATURAL_FREQUENCY = Parameter(
    "natural_frequency", "omega_n", "rad/s", 0.0, inf, "of small undamped swings, sqrt(m g r / I)", 7.0
)
