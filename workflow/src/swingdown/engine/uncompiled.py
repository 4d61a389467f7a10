"""Trajectories where there is no C compiler: the catalogue's formulas in Python, followed by scipy's DOP853 from event to event.

Some thousand times slower than the engine and good to 1e-7 rad: enough to simulate a swing and to fit one.
"""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Floats
from ..errors import EngineError
from ..pendulum.catalogue import RATE
from ..pendulum.model import Model
from . import compiler
from .equations import Part, Pendulum

_RTOL, _ATOL = 1e-11, 1e-13
_STEP = 0.08  # of an undamped period: no step is longer, so that nothing is stepped over
_FAR = 1e4  # rad; beyond, the motion has run away
_MOST_STEPS = 100_000
_DIFFERENCE = 1e-4  # of a value's size: far above the steps' own errors
_STENCIL = (
    (1, 8),
    (-1, -8),
    (2, -1),
    (-2, 1),
)  # steps, and twelfths: differences good to the fourth power of the step
_DRIVES = 1e-4  # of the acceleration, as in c/trajectory.c

SLOWLY = (
    "there is no C compiler: trajectories and fits of single swings take some thousand times as long, and nothing else is computed. "
    f"Mend: {compiler.MEND}"
)


def refusal() -> EngineError:
    """What is raised where more is asked for than is done without a compiler."""
    only = "there is no C compiler, and without it single swings are simulated and fitted, no more"
    return EngineError("engine", only, mend=compiler.MEND)


class Uncompiled:
    """What stands for the compiled engine where there is none: whatever of that is asked for raises EngineError."""

    RELEASE_ANGLE, RELEASE_VELOCITY = -1, -2

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        raise refusal()


Values = Sequence[float] | Floats


class Report(NamedTuple):
    """As ``TrajectoryReport`` in c/interface.h."""

    panels: int
    rejected: int
    evaluations: int
    reversals: int
    error: float
    stuck_after: float
    driven: bool
    largest_angle: float = 0.0  # not looked for


class Failure(ArithmeticError):
    """A trajectory that cannot be computed; its argument is the name of a Status in c/interface.h."""


class _Course:
    """A pendulum's way from event to event, with the angles, velocities and states at the times (s) asked for."""

    def __init__(self, pendulum: Pendulum, times: Floats, angle: float, velocity: float) -> None:
        self.pendulum, self.times, self.next = pendulum, times, 0
        self.t, self.y = 0.0, pendulum.release(angle, velocity)
        self.found = np.empty((2 + pendulum.n_states, times.size))
        self.turns: list[
            tuple[int, float]
        ] = []  # the next sample at each turning point, and the angle there (rad)
        self.steps = self.reversals = 0
        self.stuck_after, self.driven, self.stuck = -1.0, False, False
        pendulum.direction = float(np.sign(velocity))
        pendulum.freeze(0.0, self.y)
        period = 2 * math.pi / max(abs(pendulum.omega), 1e-3)
        self.longest = _STEP * period

    def follow(self) -> None:
        while self.next < self.times.size:
            if self.y[1] == 0.0:
                self._leave_or_stick()
            if self.stuck and not self.pendulum.timed and not self.pendulum.n_states:
                self.found[:, self.next :] = np.array(self.y)[:, None]
                return
            self._advance()

    def _leave_or_stick(self) -> None:
        up, down = self.pendulum.freed(self.t, self.y)
        if up > 0 > down:
            raise Failure("NOT_UNIQUE")
        self.driven |= up - down > _DRIVES * (abs(up) + abs(down))
        came = 0.0 if self.stuck else self.pendulum.direction
        first = -came if came else (1.0 if up + down >= 0 else -1.0)
        free = {1.0: up > 0, -1.0: down < 0}
        way = first if free[first] else -first if free[-first] else 0.0
        if not way and not self.stuck:
            self.stuck_after = self.t
        self.stuck = not way
        self.pendulum.direction = way or self.pendulum.direction or 1.0

    def _watched(self, t: float, y: Sequence[float]) -> list[float]:
        """Quantities that are positive until an event: the velocity's, then the switches', or what holds the pendulum."""
        if self.stuck:
            up, down = self.pendulum.freed(t, y)
            return [-up, down]
        values = zip(self.pendulum.signs, self.pendulum.switch_values(t, y), strict=True)
        return [self.pendulum.direction * y[1], *(sign * value for sign, value in values)]

    def _advance(self) -> None:
        """From here to the next event, or to the last of the times."""
        from scipy.integrate import DOP853

        end = float(self.times[-1])
        solver = DOP853(
            lambda t, y: self.pendulum.rates(t, y, self.stuck), self.t, np.array(self.y), max(end, self.t + 1e-12),
            max_step=self.longest, rtol=_RTOL, atol=_ATOL,
        )  # fmt: skip
        while solver.status == "running":
            self.steps += 1
            if solver.step() is not None or self.steps > _MOST_STEPS or not np.isfinite(solver.y).all():
                raise Failure("LOST_ACCURACY")
            if not abs(solver.y[0]) < _FAR:
                raise Failure("RAN_AWAY")
            dense = solver.dense_output()
            event, t = self._first_event(dense, solver.t_old, solver.t)
            self._read(dense, t)
            if event is not None:
                self._pass(event, t, dense(t).tolist())
                return
        self.t, self.y = solver.t, solver.y.tolist()

    def _first_event(self, dense: Any, low: float, high: float) -> tuple[int | None, float]:
        """Which watched quantity turns negative first in a step, and a time (s) just after; or None and the step's end."""
        from scipy.optimize import brentq

        first: int | None = None
        at = high
        for t in np.linspace(low, high, 5)[1:]:
            negative = [k for k, value in enumerate(self._watched(t, dense(t).tolist())) if value < 0]
            for k in negative:

                def watched(time: float, k: int = k) -> float:
                    return self._watched(time, dense(time).tolist())[k]

                # the quantity is as good as zero where an event has just been passed
                root = brentq(watched, low, t, xtol=1e-15, rtol=1e-15) if watched(low) > 0 else low
                while watched(root) >= 0 and root < t:
                    root = min(t, np.nextafter(root, np.inf) + 1e-15)
                if first is None or root < at:
                    first, at = k, float(root)
            if first is not None:
                return first, at
            low = t
        return None, high

    def _pass(self, event: int, t: float, y: list[float]) -> None:
        self.t, self.y = t, y
        if self.stuck:
            self.y[1] = 0.0
        elif event == 0:
            self.y[1] = 0.0
            self.reversals += 1
            self.turns.append((self.next, y[0]))
        else:
            self.pendulum.signs[event - 1] *= -1.0

    def _read(self, dense: Any, end: float) -> None:
        last = int(np.searchsorted(self.times, end, side="right"))
        if last > self.next:
            self.found[:, self.next : last] = dense(self.times[self.next : last])
            self.next = last


def trajectory(
    model: Model, duration: float, values: Values, release: Values, times: Floats
) -> tuple[Floats, Report]:
    """What is read at the times (rad, or rad/s), and how it was reached; ``Failure`` where that cannot be computed."""
    pendulum = Pendulum(model, values, duration)
    stamped = times - times[0]
    true = stamped.copy()
    for part in pendulum.parts:
        if part.effect.acts_on == "clock":
            true = _reading(pendulum, part, np.zeros(true.size), true, None)
    if not (true[1:] > true[:-1]).all():
        raise Failure("CLOCK_RUNS_BACK")
    course = _Course(pendulum, true - true[0], float(release[0]), float(release[1]))
    with np.errstate(all="ignore"):
        try:
            course.follow()
        except (OverflowError, ValueError, ZeroDivisionError):
            raise Failure("RAN_AWAY") from None
    read = course.found[1 if model.reading == RATE else 0].copy()
    for part in pendulum.parts:
        if part.effect.acts_on == "play":
            read = _played(read, course.turns, float(release[0]), part.values[0])
        if part.effect.acts_on == "sensor":
            read = _reading(pendulum, part, read, stamped, course.found[2:])
    return read, Report(
        course.steps, 0, course.steps, course.reversals, 0.0, course.stuck_after, course.driven
    )


def _reading(pendulum: Pendulum, part: Part, theta: Floats, t: Floats, states: Floats | None) -> Floats:
    assert part.terms.reading is not None
    own = [] if states is None else list(states[part.states])
    zero = np.zeros(t.size)
    found = part.terms.reading(
        theta, zero, zero, t, pendulum.duration, pendulum.omega, 1.0, *part.values, *own, *pendulum.signs[part.signs]
    )  # fmt: skip
    return np.array(np.broadcast_to(found, t.shape), dtype=float)


def _played(read: Floats, turns: Sequence[tuple[int, float]], first: float, width: float) -> Floats:
    """The angles (rad) through a coupling with play of that width (rad): it follows at the band's edges, turning points included."""
    found, at, half, turn = np.empty(read.size), first, 0.5 * width, 0
    for i, angle in enumerate(read.tolist()):
        while turn < len(turns) and turns[turn][0] <= i:
            at = min(max(at, turns[turn][1] - half), turns[turn][1] + half)
            turn += 1
        at = found[i] = min(max(at, angle - half), angle + half)
    return found


def swing_trajectory(
    model: Model,
    duration: float,
    values: Values,
    release: Values,
    times: Floats,
    free: Sequence[int],
    angles: Floats,
    by: Floats | None = None,
) -> tuple[str, Report | None]:
    """The name of the status and the report of a trajectory; ``angles`` (n,) and ``by`` (len(free), n) are filled."""
    try:
        angles[:], report = trajectory(model, duration, values, release, times)
        if by is not None:
            by[:] = slopes(model, duration, values, release, times, free)
    except Failure as failure:
        return str(failure), None
    return "DONE", report


def slopes(
    model: Model,
    duration: float,
    values: Values,
    release: Values,
    times: Floats,
    free: Sequence[int],
) -> Floats:
    """The derivatives of what is read by the free values (their codes as in c/interface.h), by differences: (free, n)."""
    whole = np.array([*values, *release], dtype=float)
    found = np.empty((len(free), times.size))
    typical = [*(definition.typical for definition in model.definitions), 0.1, 0.5]
    for row, code in zip(found, free, strict=True):
        at = code if code >= 0 else whole.size - 2 + (code == Uncompiled.RELEASE_VELOCITY)
        step = _DIFFERENCE * max(abs(whole[at]), typical[at])
        row[:] = 0.0
        for side, weight in _STENCIL:
            moved = whole.copy()
            moved[at] += side * step
            row += weight / (12 * step) * trajectory(model, duration, moved[:-2], moved[-2:], times)[0]
    return found
