"""Energy loss, period and mid-point of each half-swing: what a recording shows without any fit, to hold a model against."""

from collections.abc import Sequence

import numpy as np
import pandas as pd
from scipy.interpolate import CubicSpline

from ...arrays import Floats, Swing
from ...calmed import calmed
from ...errors import InputError
from ...own_unit import Own
from ...pendulum.catalogue import ANGLE, RATE
from ...pendulum.half_swings import lengthening, middles, reached
from ...studies.amplitudes import of_samples

COLUMNS = ["time_s", "amplitude_rad", "energy_loss", "period_ratio", "midpoint_rad"]
_FEW = 3.0  # samples of a half-swing, of which no turn is told
_ENOUGH = 10.0  # from so many on it is told of the samples themselves
_FINER = 4  # times
_HOLE = 1.5  # usual steps: over more nothing is between
_QUANTITIES = ("energy_loss", "period_ratio", "midpoint_rad")


def half_swings(
    times: Floats,
    angle: Floats,
    natural_frequency: float,
    restoring: str = "sine",
    reading: str = ANGLE,
    sine: bool = False,
) -> pd.DataFrame:
    """A table, one row a half-swing: amplitude, loss, half-period and mid-point.

    Parameters
    ----------
    times, angle
        The swing (s; rad, of a rate rad/s), of shape (sample,).
    natural_frequency
        In rad/s: what the half-periods are compared with.
    restoring
        ``sine``, beside which half-swings that begin or end beyond the top are left out, or ``linear``.
    reading
        ``angle`` or ``rate``. Of a rate the turning points are where it is fastest: each stands for the angle that it reaches by the
        energy it has there, and the mid-point is not known.
    sine
        Whether amplitudes are told from whole half-swings, where these tell them surer than the turns.

    Returns
    -------
    pandas.DataFrame
        The amplitude (rad), the loss as a share of the potential energy, the half-period against that of an undamped pendulum of that
        amplitude (ratio), and the mid-point (rad, from three turning points, so that decay leaves it alone). Half-swings that the noise
        could have made are left out.
    """
    if _coarse(times, np.pi / natural_frequency):
        times, angle = _between(times, angle)
    quiet = calmed(times, angle, ends_quiet=False) if reading == RATE else None
    try:
        found = of_samples("", times, angle, quiet=quiet, sine=sine)
    except InputError:  # too few half-swings, or too few samples in each
        return pd.DataFrame(columns=COLUMNS, dtype=float)
    when, where, number = found.times, found.angle + found.centre, found.number
    if restoring == "sine" and reading == ANGLE:  # what falls down is at rest beyond the top no more
        first = int(np.max(np.flatnonzero(np.abs(where) >= np.pi), initial=-1)) + 1
        when, where, number = when[first:], where[first:], number[first:]
    if when.size < 3:
        return pd.DataFrame(columns=COLUMNS, dtype=float)
    if reading == RATE:
        where = where - np.median(middles(where))  # a gyroscope's zero
        where = reached(where / natural_frequency, restoring)
    amplitude = np.abs(np.diff(where)) / 2
    if restoring == "sine":
        height, mean = 1 - np.cos(where), 1 / lengthening(amplitude)
    else:
        height, mean = where**2 / 2, np.ones_like(amplitude)
    in_a_row = np.diff(number, 2) == 0
    middle = np.where(in_a_row, middles(where), np.nan) * (np.nan if reading == RATE else 1.0)
    table = pd.DataFrame(
        {
            "time_s": (when[1:] + when[:-1]) / 2,
            "amplitude_rad": amplitude,
            "energy_loss": -np.diff(height) / height[:-1],
            "period_ratio": np.diff(when) * natural_frequency * mean / np.pi,
            "midpoint_rad": [*middle, middle[-1]],
        }
    )
    return table[np.diff(number) == 1]


def _coarse(times: Floats, half: float) -> bool:
    """True of a swing without holes that has too few samples in a half-swing (s) to read its turns from, and enough to tell what is between."""
    steps = np.diff(times)
    if not steps.size:
        return False
    usual = float(np.median(steps))
    return _FEW <= half / usual < _ENOUGH and float(steps.max()) < _HOLE * usual


def _between(times: Floats, angle: Floats) -> tuple[Floats, Floats]:
    """Times and angles with values between the samples: of ten a period a cubic spline is right to a few ten-thousandths of the amplitude."""
    finer = np.interp(np.arange(_FINER * (times.size - 1) + 1) / _FINER, np.arange(times.size), times)
    return finer, CubicSpline(times, angle)(finer)


def beside(
    names: Sequence[str],
    swings: Sequence[Swing],
    modelled: Sequence[Swing],
    natural_frequency: float,
    restoring: str = "sine",
    reading: str = ANGLE,
) -> pd.DataFrame:
    """One table of all half-swings of several swings, measured beside modelled: columns ``swing``, ``of`` and those of
    ``half_swings``. ``swings`` and ``modelled`` hold (times in s, angles in rad).
    """
    tables = []
    for name, measured, fitted in zip(names, swings, modelled, strict=True):
        for of, (times, angle) in (("measured", measured), ("modelled", fitted)):
            table = half_swings(times, angle, natural_frequency, restoring, reading)
            tables.append(table.assign(swing=name, of=of))
    return pd.concat(tables, ignore_index=True)


def differences(table: pd.DataFrame) -> pd.DataFrame:
    """What differs between measured and modelled half-swings, by amplitude: a table with the columns ``quantity``,
    ``low_rad`` and ``high_rad`` (of the amplitude), ``difference`` (measured less modelled) and ``error`` (its standard error).

    Half-swings are matched by their time; each third of the amplitudes makes a row for loss, period and mid-point.
    """
    pairs = []
    for _, one in table.groupby("swing", sort=False):
        measured, modelled = (one[one["of"] == of].sort_values("time_s") for of in ("measured", "modelled"))
        if len(measured) < 2 or len(modelled) < 2:
            continue
        reach = 0.4 * float(np.median(np.diff(measured["time_s"])))
        pairs.append(
            pd.merge_asof(
                measured, modelled, on="time_s", direction="nearest", tolerance=reach, suffixes=("", "_model")
            ).dropna(subset=["energy_loss_model"])
        )
    if not pairs or not sum(map(len, pairs)):
        return pd.DataFrame(columns=["quantity", "low_rad", "high_rad", "difference", "error"])
    joined = pd.concat(pairs, ignore_index=True)
    edges = np.quantile(joined["amplitude_rad"], [0, 1 / 3, 2 / 3, 1])
    rows = []
    for low, high in zip(edges, edges[1:], strict=False):
        inside = joined[(joined["amplitude_rad"] >= low) & (joined["amplitude_rad"] <= high)]
        for quantity in _QUANTITIES:
            difference = (inside[quantity] - inside[f"{quantity}_model"]).dropna().to_numpy()
            if not difference.size:
                continue
            middle = np.median(difference)
            spread = 1.4826 * np.median(np.abs(difference - middle)) / np.sqrt(max(1, difference.size - 1))
            rows.append(
                {
                    "quantity": quantity,
                    "low_rad": low,
                    "high_rad": high,
                    "difference": middle,
                    "error": spread,
                }
            )
    return pd.DataFrame(rows)


_OF_KIND = {"velocity": "energy_loss", "position": "period_ratio", "constant": "midpoint_rad"}
_SAID = {
    "energy_loss": (
        "the swing loses more energy than the model",
        "the swing loses less energy than the model",
    ),
    "period_ratio": ("the swing runs late", "the swing runs early"),
    "midpoint_rad": (
        "the middle of the swing lies to the positive side",
        "the middle of the swing lies to the negative side",
    ),
}


def said(table: pd.DataFrame, kind: str | None, own: Own | None = None) -> str:
    """A clause that tells the disagreement of a kind (a key of ``locate.KINDS``) by amplitude; empty where none is plain.

    ``own`` is the unit of amplitudes that are no angles.
    """
    found = differences(table)
    found = found[found["quantity"] == _OF_KIND.get(kind or "")]
    if found.empty:
        return ""
    sizes = found["difference"].abs() / found["error"].clip(lower=1e-12)
    row = found.loc[sizes.idxmax()]
    if sizes.max() < 4:
        return ""
    words = _SAID[row["quantity"]][0 if row["difference"] > 0 else 1]
    low, high = (_amplitude(row[key], own) for key in ("low_rad", "high_rad"))
    if (found["difference"] > 0).nunique() == 1 and sizes.min() > 4:
        return words
    if row["low_rad"] == found["low_rad"].min():
        return f"at amplitudes below {high} {words}"
    if row["high_rad"] == found["high_rad"].max():
        return f"at amplitudes above {low} {words}"
    return f"at amplitudes from {low} to {high} {words}"


def _amplitude(angle: float, own: Own | None) -> str:
    """An amplitude (rad) with two figures: 7.3°, 57°, 140°, or 0.52 V."""
    if own:
        return f"{float(f'{own.step * angle:.2g}'):g} {own.name}"
    return f"{float(f'{np.degrees(angle):.2g}'):g}°"
