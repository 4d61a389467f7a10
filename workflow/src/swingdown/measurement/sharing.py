"""Which recordings of a pendulum share a model, and why each of the others stands alone: its period and decay are told all the same."""

from collections.abc import Sequence

import xarray as xr

from ..errors import InputError
from ..own_unit import own_of
from .angle import UNSCALED
from .points.points_recording import NOT_IN_IT, POINTS_ALONE, are_points
from .positions import METRES

_OF_ONE_SIZE = {*METRES, "v"}  # units that are as large in every recording


def sharing(angles: Sequence[xr.Dataset]) -> tuple[list[int], dict[int, InputError]]:
    """The places of the recordings that one model can share and a search can use, and by place why each of the others cannot.

    A model needs the angle, for on it the period depends: points of the motion and readings without a scale do not hold it. Readings in
    a unit of their own share one where that is the same unit of length for all, or volts, which one sensor gives.

    Parameters
    ----------
    angles
        Angle datasets (``measurement.angle.to_angle``) of one pendulum.
    """
    alone = {k: why for k, one in enumerate(angles) if (why := _alone(one)) is not None}
    rest = [k for k in range(len(angles)) if k not in alone]
    owned = {k: own.name.lower() for k in rest if (own := own_of(angles[k].attrs)) is not None}
    alike = len(owned) == len(rest) and len(set(owned.values())) == 1 and set(owned.values()) <= _OF_ONE_SIZE
    if len(rest) > 1 and not alike:
        alone |= {k: InputError(
            _where(angles[k]), "its readings have no scale, and how large its unit is beside that of another recording is not known",
            "angles, or a recording alone", "state the degrees that one unit is worth ⟨in scale⟩, or make it a campaign of its own",
        ) for k in owned}  # fmt: skip
    return [k for k in rest if k not in alone], alone


def in_one_step(angles: Sequence[xr.Dataset]) -> list[xr.Dataset]:
    """The angle datasets of one pendulum, of readings in one unit of their own with what stands for 1 rad in the largest of them."""
    steps = [own.step for one in angles if (own := own_of(one.attrs)) is not None]
    if len(set(steps)) < 2:
        return list(angles)
    return [_with_step(one, max(steps)) if own_of(one.attrs) else one for one in angles]


def _with_step(angle: xr.Dataset, step: float) -> xr.Dataset:
    """The angle dataset with so much of its reading for 1 rad."""
    times = float(angle.attrs["own_step"]) / step
    names = [str(name) for name in angle.data_vars if str(name).startswith("angle")]
    parts = {name: angle[name].copy(data=times * angle[name].values) for name in names}
    return angle.assign(parts).assign_attrs(own_step=step)


def _where(angle: xr.Dataset) -> str:
    return f"recording {angle.attrs.get('recording', '')}"


def _alone(angle: xr.Dataset) -> InputError | None:
    """Why a recording shares no model with any other; None where it holds angles, their rate, or readings in a unit of their own."""
    if are_points(angle):
        mend = "record the motion itself"
        return InputError(_where(angle), NOT_IN_IT, "samples of the motion itself", mend, POINTS_ALONE)
    if own_of(angle.attrs) is None and angle.attrs.get("mode") == UNSCALED:
        return InputError(
            _where(angle), "its readings have no scale: they allow no search, and period and decay alone are reported",
            "angles", "state the degrees that one unit is worth ⟨in scale⟩; of a wheel, or of the place or acceleration of a mass on a spring, none is needed: write ⟨restoring=linear⟩",
        )  # fmt: skip
    return None
