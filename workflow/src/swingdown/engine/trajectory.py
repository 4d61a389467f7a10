"""Trajectories of a model: the angle over time, exact at velocity reversals and with sticking, and its sensitivities."""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import isfinite
from typing import Any

import numpy as np

from ..arrays import Floats
from ..errors import InputError
from ..pendulum.catalogue import RATE, READINGS, SHIPPED, Catalogue
from ..pendulum.model import Model
from . import build, interface
from .interface import InitialValueProblem
from .rows import entries

_STATUS = {
    "LOST_ACCURACY": "the accuracy could not be kept (the motion is not that of a pendulum at these parameters)",
    "RAN_AWAY": "the motion ran away",
    "CLOCK_RUNS_BACK": "the clock runs backwards at these parameters",
    "TOO_LARGE": "the model has more parameters than the engine takes",
    "NO_MEMORY": "out of memory",
    "NOT_UNIQUE": "the motion from rest is not unique: friction would push the pendulum either way, as friction in proportion "
    "to the load does beyond 90°, where the rod is pushed and not pulled",
}
_DRIVEN = (
    "at a turning point friction pushes the pendulum on instead of holding it back, as friction in proportion to the load does "
    "beyond 90°, where the rod is pushed and not pulled: it gains energy there, which no bearing gives"
)


_FAR_UP = 5 * np.pi / 6  # rad
_PROMISED = 1e-6  # rad or rad/s
_FINER = 0.01  # of panels' errors, over the usual limits: what two trajectories differ by is then the usual one's error


class TrajectoryError(ArithmeticError):
    """A trajectory that cannot be computed to the engine's accuracy; the message says why."""


class ImpossibleValue(InputError, TrajectoryError):
    """A model with a value that it cannot have: an input to mend, and to a search one more model without a trajectory."""


class TrajectoryWarning(UserWarning):
    """A trajectory that follows the model to the letter, where the model is none of a pendulum; the message says why."""


@dataclass(frozen=True)
class Effort:
    """What a trajectory took and how good it is: panels, right-hand sides, reversals, estimated error (rad), sticking (s).

    ``largest_angle`` (rad) is that of the motion. ``driven``: at some turning point friction pushed the pendulum on instead of holding it back.
    """

    panels: int
    rejected: int
    evaluations: int
    reversals: int
    error: float
    stuck_after: float | None
    driven: bool
    largest_angle: float


@lru_cache(maxsize=20)
def _loaded(catalogue: Catalogue) -> tuple[Any, dict[tuple[str, str], int]]:
    """The compiled engine for a catalogue, and the row of each effect and form in its table."""
    effects, gravity = catalogue.known, tuple(catalogue.gravity.values())
    rows = {(e.name, form): k for k, (e, form) in enumerate(entries(effects, gravity))}
    return build.load(effects, gravity), rows


def engine(catalogue: Catalogue = SHIPPED) -> Any:
    """The compiled engine for a catalogue, compiled at the first use on a machine.

    Parameters
    ----------
    catalogue
        The effects whose formulas are compiled.

    Raises
    ------
    EngineError
        If there is no compiler, and neither cache nor wheel has the engine.
    """
    return _loaded(catalogue.whole)[0]


class Compiled:
    """A model as the engine takes it: which effects act where, and where each one's parameters and states begin.

    ``library`` is the engine that knows these effects. ``duration`` in s; ``start``: the time (s) of the first sample, in the clock of
    the model's drive. InputError for a model that takes a drive and has none.
    """

    def __init__(self, model: Model, duration: float, start: float = 0.0) -> None:
        self.duration = duration = model.record or duration
        self.library, rows = _loaded(model.catalogue.whole)
        motions = [(rows[model.gravity.name, "consistent"], 1, 0)]
        sensors: list[tuple[int, int, int]] = []
        clocks: list[tuple[int, int, int]] = []
        play, delay, parameter, state = -1, -1, 1, 0
        for effect in model.acting:
            part = (rows[effect.name, model.form if effect.printed else "consistent"], parameter, state)
            if effect.acts_on == "torque" or effect.states:
                motions.append(part)
            if effect.acts_on in ("sensor", "clock"):
                (sensors if effect.acts_on == "sensor" else clocks).append(part)
            if effect.acts_on == "play":
                play = parameter
            delay = next(
                (parameter + k for k, one in enumerate(effect.parameters) if one.role == "delay"), delay
            )
            parameter, state = parameter + len(effect.parameters), state + len(effect.states)
        self.model, self.n_parameters = model, parameter
        layout = interface.Layout(motions, sensors, clocks, parameter, state, play, delay)
        self.c = interface.model(layout, duration, model.catalogue.reading == RATE, self._drive(start))

    def _drive(self, start: float) -> tuple[Floats, Floats] | None:
        """The knots (s since the first sample) and coefficients of the drive that acts in the model; None of one that is free."""
        model = self.model
        if not model.takes_input:
            return None
        if model.drive is None:
            raise InputError(
                f"model {model.label}", "it has a measured drive, and no drive is given", "the drive, over the times of the trajectory",
                "say input= and input_kind=, or leave the effect out",
            )  # fmt: skip
        return model.drive.knots - start, model.drive.coefficients


def checked_times(times: Any) -> Floats:
    """The times (s) as a contiguous float64 array.

    Parameters
    ----------
    times
        In s, of shape (sample,).

    Raises
    ------
    InputError
        If they are not finite and increasing, or have another shape.
    """
    times = np.ascontiguousarray(times, dtype=float)
    if times.ndim != 1 or times.size < 1:
        raise InputError("times", f"an array of shape {times.shape}", "one dimension, at least one time")
    # of increasing times all are finite where the first and the last one are
    later = np.count_nonzero(times[1:] > times[:-1])
    if not (later == times.size - 1 and isfinite(times[0]) and isfinite(times[-1])):
        problem = "not finite and increasing"
        raise InputError("times", problem, "sample times in seconds, each later than the time before")
    return times


def _run(
    model: Model,
    times: Any,
    release_angle: float,
    release_velocity: float,
    free: Sequence[str],
    rough: bool = False,
) -> tuple[Floats, Floats, Effort]:
    times = checked_times(times)
    compiled = Compiled(model, float(times[-1] - times[0]), float(times[0]))
    values = np.array(model.vector())
    if not (np.all(np.isfinite(values)) and np.isfinite(release_angle) and np.isfinite(release_velocity)):
        raise ImpossibleValue(
            f"model {model.label}", "a value is not finite", "finite parameters and release"
        )
    for definition, value in zip(model.definitions, values, strict=True):
        if value < definition.least:
            where, least = f"model {model.label}, {definition.name}", f"{definition.least:g} or more"
            raise ImpossibleValue(where, f"{value:g} {definition.unit}", least)
    library = compiled.library
    codes = {"release_angle": library.RELEASE_ANGLE, "release_velocity": library.RELEASE_VELOCITY} | {
        name: k for k, name in enumerate(model.parameters)
    }
    if unknown := [name for name in free if name not in codes]:
        raise InputError(f"model {model.label}", f"no value {unknown[0]!r} to vary", ", ".join(codes))
    release = release_angle, release_velocity
    chosen = [codes[name] for name in free]
    if rough and chosen and library.RELEASE_ANGLE not in chosen:  # how errors grow is told by its slope
        chosen.append(library.RELEASE_ANGLE)
    angles, slopes = np.empty(times.size), np.empty((len(chosen), times.size))
    coarseness = float(library.COARSE) if rough else 1.0
    problem = InitialValueProblem(values, release, times, chosen, coarseness)
    report = _follow(compiled, problem, angles, slopes if free else None)
    effort = Effort(
        report.panels, report.rejected, report.evaluations, report.reversals, report.error,
        report.stuck_after if report.stuck_after >= 0 else None, bool(report.driven),
        report.largest_angle,
    )  # fmt: skip
    warn_of_drive(compiled, report.driven, angles)
    return angles, slopes[: len(free)], effort


def _follow(
    compiled: Compiled, problem: InitialValueProblem, angles: Floats, slopes: Floats | None = None
) -> Any:
    model = compiled.model
    code, report = interface.swing_trajectory(compiled.library, compiled.c, problem, angles, slopes)
    status = interface.status_name(code)
    if status != "DONE":
        stated = ", ".join(
            f"{name} {value:.6g}" for name, value in zip(model.parameters, problem.values, strict=True)
        )
        raise TrajectoryError(f"model {model.label} with {stated}: {_STATUS[status]}")
    return report


def warn_of_drive(compiled: Compiled, driven: bool, angles: Floats) -> None:
    """Warn of ``angles`` (rad) in which friction has ``driven`` the pendulum, where that is wrong."""
    if not driven:
        return
    # a friction below 0 is told elsewhere
    model = compiled.model
    beyond = model.reading != RATE and float(np.max(np.abs(angles), initial=0.0)) > np.pi / 2
    if beyond:
        warnings.warn(f"model {model.label}: {_DRIVEN}", TrajectoryWarning, stacklevel=4)


def simulate_compiled(compiled: Compiled, times: Floats, values: Floats, release: Sequence[float]) -> Floats:
    """The angles (rad) of ``simulate`` for a compiled model, of which nothing is checked again.

    ``times`` (s) as ``checked_times`` gives them, ``values`` in the order of the model's parameters, ``release`` angle and
    velocity (rad, rad/s). Raises TrajectoryError and warns as ``simulate`` does.
    """
    angles = np.empty(times.size)
    report = _follow(compiled, InitialValueProblem(np.ascontiguousarray(values), release, times), angles)
    warn_of_drive(compiled, report.driven, angles)
    return angles


def simulate(model: Model, times: Any, release_angle: float, release_velocity: float = 0.0) -> Floats:
    """The reading at each time, in rad (of a model that reads rates rad/s), of the shape of ``times``.

    Parameters
    ----------
    model
        The model with its values.
    times
        Increasing times in s; the release is at the first.
    release_angle, release_velocity
        In rad and rad/s.

    Raises
    ------
    InputError
        For bad times, or a model without values.
    TrajectoryError
        If the accuracy cannot be kept, or the motion from rest is not unique.

    Warns
    -----
    TrajectoryWarning
        If friction drives the pendulum, or a motion beyond 150° is off by more than 1e-6 of the unit, with the size of the error.
    """
    angles, _, effort = _run(model, times, release_angle, release_velocity, ())
    if effort.largest_angle > _FAR_UP:
        _warn_of_growth(model, checked_times(times), (release_angle, release_velocity), angles)
    return angles


def _warn_of_growth(model: Model, times: Floats, release: Sequence[float], angles: Floats) -> None:
    """Warn of ``angles`` on whose way small errors become large ones, by a finer trajectory of the same motion."""
    compiled, finer = Compiled(model, float(times[-1] - times[0]), float(times[0])), np.empty(times.size)
    try:
        problem = InitialValueProblem(np.array(model.vector()), release, times, coarseness=_FINER)
        _follow(compiled, problem, finer)
    except TrajectoryError:
        off = "an amount that is not known"
    else:
        difference = float(np.abs(finer - angles).max())
        if difference <= _PROMISED:
            return
        off = f"{difference:.0e} {READINGS[model.reading]}"
    told = f"beyond 150° small errors grow; what is read is off by some {off}, as a finer computation shows"
    warnings.warn(f"model {model.label}: {told}", TrajectoryWarning, stacklevel=3)


def simulate_each(model: Model, times: Any, values: Any) -> Floats:
    """The readings of one model with other values in each row, in rad (or rad/s), of shape (rows, n).

    Parameters
    ----------
    model
        The model; its own values are not used.
    times
        Increasing times in s, of shape (n,).
    values
        In each row the model's parameters, the release angle (rad) and velocity (rad/s). A row that is impossible, or has no trajectory, gives NaN.
    """
    times, values = checked_times(times), np.ascontiguousarray(values, dtype=float)
    if values.ndim != 2 or values.shape[1] != len(model.parameters) + 2:
        problem = f"values of shape {values.shape}"
        raise InputError(f"model {model.label}", problem, f"(any, {len(model.parameters) + 2})")
    compiled = Compiled(model, float(times[-1] - times[0]), float(times[0]))
    angles = np.full((len(values), times.size), np.nan)
    least = [definition.least for definition in model.definitions] + [-np.inf, -np.inf]
    possible = np.flatnonzero((np.isfinite(values) & (values >= least)).all(axis=1))
    rows, found = values[possible], np.empty((possible.size, times.size))
    interface.swing_trajectories(compiled.library, compiled.c, rows, times, found)
    angles[possible] = found
    return angles


def sensitivities(
    model: Model,
    times: Any,
    release_angle: float,
    release_velocity: float = 0.0,
    free: Sequence[str] | None = None,
    rough: bool = False,
) -> tuple[Floats, Floats]:
    """The reading (rad) and its derivatives by each free value, of shapes (n,) and (len(free), n).

    The derivatives are exact (variational equations), the jump at reversals included. At rest the derivative by
    ``release_velocity`` is that of a push the way the pendulum leaves; it is 0 where friction holds the pendulum.

    Parameters
    ----------
    model, times, release_angle, release_velocity
        As in ``simulate``.
    free
        Names of parameters, ``release_angle`` or ``release_velocity``. Default: all. A row is in rad over the value's unit.
    rough
        Whether models of many panels may be off by up to 1e-6 rad, to save time.

    Raises
    ------
    InputError, TrajectoryError
        As in ``simulate``.
    """
    free = (*model.parameters, "release_angle", "release_velocity") if free is None else tuple(free)
    return _run(model, times, release_angle, release_velocity, free, rough)[:2]


def effort(model: Model, times: Any, release_angle: float, release_velocity: float = 0.0) -> Effort:
    """The ``Effort`` of a trajectory; arguments and errors as of ``simulate``."""
    return _run(model, times, release_angle, release_velocity, ())[2]
