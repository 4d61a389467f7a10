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
from . import array_units
from .given import Driven, asked, drive_over

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
    **values: Any,
) -> xr.DataArray:
    """The swing of a pendulum as a DataArray over ``time`` (s), in rad; ``fit`` accepts it.

    Parameters
    ----------
    model
        A ``Model``, an answer with its fitted values, or a label such as ``"viscous+load_coulomb"``.
    times
        Increasing times in s, of shape (time,).
    angle
        Angle at the first time, in rad.
    velocity
        Angular velocity at the first time, in rad/s.
    restoring
        Of a label: ``sine`` or ``linear``.
    noise
        Standard deviation of the noise to add, in rad (in rad/s for a model that reads angular rates).
    seed
        Seed of the noise: the same seed gives the same numbers.
    **values
        Values by parameter name, in the parameters' units: ``natural_frequency=7.25`` (rad/s), ``viscous_ratio=0.01``. They replace
        those of the model. ``input``, ``input_kind`` and more (``given.Driven``) are those of a measured drive: a label gets the
        effect by which it acts, whose gain is a value like others where it is free. Quantities of pint, here and above, bring their units along.

    Returns
    -------
    xarray.DataArray
        ``angle`` (rad) or ``rate`` (rad/s), of shape (time,).

    Raises
    ------
    InputError
        If a parameter is missing or unknown, a frequency not above 0, if times are not increasing, or if no pendulum moves so.
    """
    known: Any = getattr(model, "model", model)
    said = asked({name: values.pop(name) for name in Driven.__annotations__ if name in values})
    drive = drive_over(array_units.times(times), said) if said else None
    if not isinstance(known, Model):
        names = known.split("+") if isinstance(known, str) else list(known)
        known = Model((*names, *([drive.effect] if drive else [])), {}, {}, restoring)
    if drive:
        known = known.driven_by(drive)
    if values:
        units = known.units
        told = {name: array_units.value(values[name], units[name], name) for name in values if name in units}
        known = known.with_values({**known.values, **values, **told}, known.standard_errors)
    for one in known.definitions:
        value = known.values.get(one.name, one.typical)
        if one.name.endswith("frequency") and one.lower >= 0 and not value > 0:
            raise InputError(one.name, f"it is {value:g}", f"a number of {one.unit} above 0", "correct it")
    return swing_of(known, times, (None, angle, velocity), noise, seed)


def swing_of(
    model: Model, times: Any, begin: tuple[float | None, Any, float], noise: float, seed: int
) -> xr.DataArray:
    """The swing of a model with its values as a DataArray over ``time`` (s), at ``times`` (s).

    ``begin``: time (s; None: the first of ``times``), angle (rad) and angular velocity (rad/s) of the start; ``noise`` and ``seed`` as in
    ``simulate``. InputError if times precede the start, or no pendulum moves so.
    """
    at = array_units.times(times)
    since, angle, velocity = begin
    given, stated = array_units.angles(angle)
    start = float(np.ravel(np.radians(given) if stated == "deg" else given)[0])
    if model.restoring == "sine" and abs(start) >= np.pi:
        raise InputError("angle", f"{start:.4g} rad is more than half a turn", "an angle in rad, less than pi", f"for degrees write np.radians({start:g})")  # fmt: skip
    noise = array_units.value(noise, READINGS[model.reading], "noise")
    if at.size and since is not None and at[0] < since:
        raise InputError("times", f"they begin at {at[0]:.6g} s, before the recording does", f"times from {since:.6g} s on", "give an angle to let it go from")  # fmt: skip
    if not noise >= 0:
        raise InputError("noise", f"{noise!r}", "a standard deviation, 0 or more")
    before = at.size and since is not None and since < at[0]
    clock = np.concatenate([[since], at]) if before else at
    speed = array_units.value(velocity, "rad/s", "velocity")
    try:
        read = trajectory(model, clock, start, speed)[clock.size - at.size :]
    except TrajectoryError as problem:
        expected = "values of a pendulum that swings back and forth"
        raise InputError("model", str(problem), expected) from problem
    if noise:
        read = read + noise * np.random.default_rng(seed).standard_normal(read.size)
    unit = READINGS[model.reading]
    about = {"units": unit, "emulated": "yes", "model": model.label}
    return xr.DataArray(read, {"time": ("time", at, {"units": "s"})}, ["time"], _NAMES[unit], about)
