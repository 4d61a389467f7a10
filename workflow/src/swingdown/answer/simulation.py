"""The swing of a model with values of one's own: what a recording of it would hold, with noise on request."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from ..engine.trajectory import TrajectoryError
from ..engine.trajectory import simulate as trajectory
from ..errors import InputError
from ..pendulum.catalogue import READINGS
from ..pendulum.model import Model
from . import labelled

if TYPE_CHECKING:
    from .result import Answer

_NAMES = {"rad": "angle", "rad/s": "rate"}


def simulate(
    model: "Model | Answer | str | Sequence[str]",
    times: Any,
    angle: Any,
    *,
    velocity: float = 0.0,
    restoring: str = "sine",
    noise: float = 0.0,
    seed: int = 0,
    **values: float,
) -> xr.DataArray:
    """The swing of a pendulum let go at the first of the times, as a DataArray over ``time`` (s), in rad; ``fit`` takes it as it is.

    ``model`` is a ``Model`` or an answer with its fitted values, or a label such as ``"viscous+load_coulomb"`` with ``values`` by the
    parameters' names (``natural_frequency=7.25`` in rad/s, ``viscous_ratio=0.01``, ``load_friction=0.003``), which go before those that a model has.
    ``times`` in s, increasing; ``angle`` in rad and ``velocity`` in rad/s at the release; quantities of pint bring their units along.
    ``restoring`` (of a label) is ``sine`` or ``linear``. ``noise`` (rad) is the standard deviation of what is added, drawn by ``seed``: the same
    seed gives the same numbers. Of a model that reads angular rates (rad/s) the noise is one of these. InputError for a parameter
    that is missing or unknown, for bad times, and where no pendulum moves so.
    """
    known: Any = getattr(model, "model", model)
    if not isinstance(known, Model):
        known = Model(known, {}, {}, restoring)
    if values:
        known = known.with_values({**known.values, **values}, known.standard_errors)
    return swing_of(known, times, (None, angle, velocity), noise, seed)


def swing_of(
    model: Model, times: Any, begin: tuple[float | None, Any, float], noise: float, seed: int
) -> xr.DataArray:
    """The swing of a model from ``begin``: time (s; None: the first of the times), angle (rad) and angular velocity (rad/s)."""
    at = labelled.times(times)
    since, angle, velocity = begin
    start = float(np.ravel(labelled.angles(angle)[0])[0])
    if at.size and since is not None and at[0] < since:
        raise InputError("times", f"they begin at {at[0]:.6g} s, before the recording does", f"times from {since:.6g} s on", "give an angle to let it go from")  # fmt: skip
    if not noise >= 0:
        raise InputError("noise", f"{noise!r}", "a standard deviation, 0 or more")
    before = at.size and since is not None and since < at[0]
    try:
        read = trajectory(model, np.concatenate([[since], at]) if before else at, start, float(velocity))
    except TrajectoryError as problem:
        raise InputError(
            "model", str(problem), "values of a pendulum that swings back and forth"
        ) from problem
    if before:
        read = read[1:]
    if noise:
        read = read + noise * np.random.default_rng(seed).standard_normal(read.size)
    unit = READINGS[model.reading]
    about = {"units": unit, "emulated": "yes", "model": model.label}
    return xr.DataArray(read, {"time": ("time", at, {"units": "s"})}, ["time"], _NAMES[unit], about)
