"""Which recordings of a pendulum share a model, and why each of the others stands alone: its period and decay are told all the same."""

from collections.abc import Sequence

import xarray as xr

from ..errors import InputError
from ..own_unit import own_of
from .angle import UNSCALED
from .points.points_recording import NOT_IN_IT, POINTS_ALONE, are_points


def sharing(angles: Sequence[xr.Dataset]) -> tuple[list[int], dict[int, InputError]]:
    """The places of the recordings that one model can share and a search can use, and by place why each of the others cannot.

    A model needs the angle, for on it the period depends: points of the motion and readings without a scale do not hold it.

    Parameters
    ----------
    angles
        Angle datasets (``measurement.angle.to_angle``) of one pendulum.
    """
    alone = {k: why for k, one in enumerate(angles) if (why := _alone(one, len(angles) > 1)) is not None}
    return [k for k in range(len(angles)) if k not in alone], alone


def _alone(angle: xr.Dataset, beside: bool) -> InputError | None:
    """Why a recording shares no model with others; None where it holds angles, or their rate, and of one that has none ``beside`` it
    where it has a unit of its own."""
    where = f"recording {angle.attrs.get('recording', '')}"
    if are_points(angle):
        return InputError(
            where, NOT_IN_IT, "samples of the motion itself", "record the motion itself", POINTS_ALONE
        )
    if own_of(angle.attrs) is not None:
        return InputError(
            where, "its readings have no scale, and how large its unit is beside that of another recording is not known",
            "angles, or a recording alone", "state the degrees that one unit is worth ⟨in scale⟩, or make it a campaign of its own",
        ) if beside else None  # fmt: skip
    if angle.attrs.get("mode") == UNSCALED:
        return InputError(
            where, "its readings have no scale: they allow no search, and period and decay alone are reported",
            "angles", "state the degrees that one unit is worth ⟨in scale⟩; of a wheel or a mass on a spring none is needed: write ⟨restoring=linear⟩",
        )  # fmt: skip
    return None
