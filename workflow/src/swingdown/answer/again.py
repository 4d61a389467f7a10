"""A swing that no model follows to its end, read once more: its longest free stretch, or its period and decay alone."""

from collections.abc import Iterator
from pathlib import Path

from ..dataset import series_of
from ..errors import InputError
from ..measurement.angle import UNSCALED
from ..measurement.interpret import RELATIVE
from ..measurement.plausibility import free_part, in_step_and_dying
from ..measurement.points_recording import are_points
from ..study import own
from . import Answer, of_swings

_ANGLES = ("rad", "deg", "counts")


def once_more(one: own.Taken, restoring: str) -> tuple[own.Taken, Answer, str] | None:
    """The recording as it can be used, its answer and what is to be said of it; None where it is no free swing.

    First the longest stretch is tried whose half-swings are in step and do not grow. Where no model follows that either, its passages of the
    middle tell period and decay, which need no scale, if they are even and it dies. Nothing is tried of a column that was guessed, and
    nothing that the user stated is overruled: a window, a scale, a unit.
    """
    about = one.recording.attrs
    stated = any(one.row.get(key) not in (None, "") for key in ("start_s", "stop_s", "scale", "signal_unit"))
    if (
        are_points(one.angle)
        or stated
        or about.get("column_told") == "no"
        or "rate" in one.angle
        or one.row.get("input_column")
    ):
        return None
    for row, told in _ways(one):
        try:
            found = own.take(row, Path(str(one.recording.attrs["file"])), restoring)
            if len(found) == 1 and isinstance(found[0], own.Taken):
                # passages that are even and swings that die are judged without a model, which need not follow them
                checked = row.get("scale") != RELATIVE
                return found[0], of_swings([found[0].angle], restoring=restoring, checked=checked), told
        except InputError:
            continue
    return None


def _ways(one: own.Taken) -> Iterator[tuple[dict[str, object], str]]:
    """The rows with which a recording is read once more, each with what is to be said of it."""
    times, signal = one.angle["time"].values, series_of(one.angle).values
    row, told = dict(one.row), ""
    if part := free_part(times, signal):
        row |= {"start_s": round(part[0], 6), "stop_s": round(part[1], 6)}
        told = f"USED FROM {part[0]:.3f} TO {part[1]:.3f} s ALONE: beside that its swings are out of step or grow"
        yield row, told
        kept = (times >= part[0]) & (times <= part[1])
        times, signal = times[kept], signal[kept]
    known = one.recording["signal"].attrs["units"] in _ANGLES and one.angle.attrs["mode"] != UNSCALED
    if known and in_step_and_dying(times, signal):
        alone = (
            "PERIOD AND DECAY ALONE ARE TOLD, by its passages of the middle, which need no model and no unit"
        )
        yield {**row, "scale": RELATIVE}, "; ".join(filter(None, (told, alone)))
