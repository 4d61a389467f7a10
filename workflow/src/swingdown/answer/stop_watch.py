"""What a stop-watch shows of each recording of an answer, for JSON."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd

from ..arrays import Shown, finite_or_none
from ..studies.timed import Timed, timed
from ..studies.unscaled import course_seen, of_first_swings


def by_stop_watch(shown: Sequence[Shown], table: pd.DataFrame) -> list[dict[str, Any]]:
    """By recording the mean period of its first and of its last ten swings, with the amplitude in their middle; and the period of the first whole
    swing by its passages of the middle alone.

    Parameters
    ----------
    shown
        The swings with the fit.
    table
        The rows of ``studies.pendulums``; the last is that of a recording without one of its own.
    """
    rows = {one["recording"]: one for one in table.to_dict("records")}
    told = []
    for name in dict.fromkeys(one.recording for one in shown):
        parts, row = [one for one in shown if one.recording == name], rows.get(name, table.iloc[-1].to_dict())
        times, series, fit = (
            np.concatenate([getattr(one, key) for one in parts]) for key in ("times", "angle", "fit")
        )
        found = timed(times, series, None if course_seen(row) else fit)
        if found:
            scaled = parts[0].unit == "rad" and np.isfinite(row["amplitude_rad"])
            first, last = (_as_timed(one, scaled) for one in found)
            alone = of_first_swings(times, series)
            told.append(
                {
                    "recording": name,
                    "first_swing": {
                        "period_s": finite_or_none(alone["period_first"]),
                        "standard_uncertainty": finite_or_none(alone["period_first_u"]),
                    },
                    "swings": found[0].swings,
                    "first": first,
                    "last": last,
                }
            )
    return told


def _as_timed(one: Timed, scaled: bool) -> dict[str, Any]:
    """The mean period (s) of some swings, and their amplitude (rad) where it is known."""
    return {"period_s": finite_or_none(one.period), "amplitude_rad": one.amplitude if scaled else None}
