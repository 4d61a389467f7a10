"""The resonance curve that a ring-down foretells: amplitude and phase against the frequency of a drive, with the backbone in it."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import ArrayLike
from scipy.special import jv

from ..arrays import Floats
from ..dataset import variable
from ..errors import InputError

KINDS = ("torque", "pivot")
SIDES = ("below", "above")
COLUMNS = [
    "campaign", "drive_rad_per_s2", "source", "side", "amplitude_rad", "frequency_Hz", "low_Hz", "high_Hz", "phase_rad", "stable"
]  # fmt: skip
_SHARES = (0.25, 0.5, 0.9)  # of the largest amplitude: where the drives peak that nobody named
_POINTS = 101  # of each side of a curve
_ABOVE = 1.02  # of the weakest drive that is told anything of: how strong one is at least that nobody named
_FINE = 2001  # amplitudes among which a peak is looked for
_SURE = 1.96  # standard uncertainties of a band of 95 %


def resonance(curves: xr.Dataset, drive: ArrayLike | None = None, kind: str = "torque") -> xr.Dataset:
    """A Dataset of the steady swings under a drive: ``frequency`` (Hz), ``phase`` (rad) and ``stable`` over ``amplitude`` (rad).

    Harmonic balance (Nayfeh and Mook, Nonlinear Oscillations (1979), 4.1): the drive balances period and damping ratio at each
    amplitude. Harmonics are left out.

    Parameters
    ----------
    curves
        As ``curves.dataset.curves`` returns them.
    drive
        Amplitudes in rad/s². Default: up to three that peak within the ring-down.
    kind
        ``torque`` (over the inertia) or ``pivot`` (the pivot's sideways acceleration over the length).

    Returns
    -------
    xarray.Dataset
        Over ``drive``, ``source`` (``free`` of a model, ``model``), ``side`` (``below`` and ``above`` the backbone) and ``point``.
        ``frequency_low`` and ``frequency_high`` are the 95 % band. ``phase`` is the lag behind the drive, 0 to pi. What is not
        ``stable`` lies between two folds. ``peak_amplitude`` and ``peak_frequency`` are NaN where the peak is beyond the ring-down.

    Raises
    ------
    InputError
        For readings without a unit of angles or without times, and for a drive that is not above 0 or too weak.
    """
    if kind not in KINDS:
        raise InputError("argument kind", f"unknown kind {kind!r}", " or ".join(KINDS), "correct it")
    timed = np.isfinite(curves["period"].sel(source="free")).any()
    if curves["amplitude"].attrs["units"] != "rad" or not timed:
        told = "the ring-down holds no angles in rad over time", "a swing with a unit and with times"
        raise InputError("resonance", *told)
    sources = [one for one in ("free", "model") if np.isfinite(curves["period"].sel(source=one)).sum() > 3]
    each = {one: _Ring(curves.sel(source=one), kind) for one in sources}
    weakest = max(one.asked[0] for one in each.values())
    if drive is None:
        drive = np.unique(np.maximum(each[sources[0]].usual(), _ABOVE * weakest))
    drives = _amplitudes(drive)
    if weakest >= drives[0]:
        raise InputError(
            "argument drive", f"{drives[0]:.3g} rad/s^2 makes it swing less than the ring-down shows",
            f"more than {weakest:.3g} rad/s^2", "drive it harder, or record until it swings less",
        )  # fmt: skip
    found = [[each[source].driven(one) for source in sources] for one in drives]
    whole = xr.combine_nested(found, ["drive", "source"], combine_attrs="drop")
    along = variable("drive", drives, "amplitude of the drive", "rad/s^2")
    whole = whole.assign_coords(drive=along, source=sources, side=list(SIDES))
    for name, unit, words in _VARIABLES:
        whole[name].attrs = {"units": unit, "long_name": words}
    about = {key: curves.attrs[key] for key in ("campaign", "emulated", "restoring", "model")}
    whole["backbone_amplitude"] = ("backbone", curves["amplitude"].values, {"units": "rad"})
    frequency = 1 / curves["period"].sel(source=sources).values
    whole["backbone_frequency"] = (("source", "backbone"), frequency, {"units": "Hz"})
    return whole.assign_attrs(about | {"kind": kind})


def _amplitudes(given: ArrayLike) -> Floats:
    """Amplitudes of a drive in ascending order; InputError where there is none, or one that is not above 0."""
    try:
        drives = np.sort(np.atleast_1d(np.asarray(given, dtype=float)))
    except (TypeError, ValueError):
        drives = np.empty(0)
    if drives.ndim != 1 or not drives.size or not (np.isfinite(drives) & (drives > 0)).all():
        expected = "amplitudes above 0, in rad/s^2"
        raise InputError("argument drive", f"{given!r}", expected, "correct it, or leave it out")
    return drives


_VARIABLES = (
    ("amplitude", "rad", "amplitude of the steady swing"),
    ("frequency", "Hz", "frequency of the drive"),
    ("frequency_low", "Hz", "lower end of its band of 95 %"),
    ("frequency_high", "Hz", "upper end of its band of 95 %"),
    ("phase", "rad", "how far the swing lags behind the drive"),
    ("stable", "1", "whether the swing stays there"),
    ("peak_amplitude", "rad", "largest amplitude of the steady swing"),
    ("peak_frequency", "Hz", "frequency of the drive there"),
)


class _Ring:
    """Period and damping ratio of a ring-down at any of its amplitudes, with standard uncertainties, and what a drive makes of them."""

    def __init__(self, curves: xr.Dataset, kind: str) -> None:
        known = np.isfinite(curves["period"].values) & np.isfinite(curves["damping_ratio"].values)
        size = curves["amplitude"].values[known]
        period, u = (curves[f"period{end}"].values[known] for end in ("", "_u"))
        columns = [2 * np.pi / period, 2 * np.pi * u / period**2]
        columns += [curves[f"damping_ratio{end}"].values[known] for end in ("", "_u")]
        # below the smallest swings seen nothing is told; between points the curves are smooth
        self.columns = [np.where(np.isfinite(one), one, 0.0) for one in columns]
        self.size, self.kind = size, kind
        self.fine = np.linspace(size[0], size[-1], _FINE)
        frequency, _, ratio, _ = self.at(self.fine)
        # drive that holds each amplitude
        self.asked = 2 * ratio * frequency**2 * self.fine / self.grip(self.fine)[1]

    def at(self, amplitude: Floats) -> list[Floats]:
        """Angular frequency (rad/s) and damping ratio, each followed by its standard uncertainty."""
        return [np.interp(amplitude, self.size, one) for one in self.columns]

    def grip(self, amplitude: Floats) -> tuple[Floats | float, Floats | float]:
        """What a drive does at an amplitude, in step with the angle and in step with the speed, over what it does at small ones."""
        if self.kind == "torque":
            return 1.0, np.ones_like(amplitude)
        return jv(0, amplitude) - jv(2, amplitude), jv(0, amplitude) + jv(2, amplitude)

    def usual(self) -> Floats:
        """Drives that peak at some shares of the largest amplitude."""
        sizes = np.clip(self.size[-1] * np.array(_SHARES), self.size[0] * 1.05, None)
        return np.interp(sizes, self.fine, self.asked)

    def driven(self, drive: float) -> xr.Dataset:
        """The steady swings under a drive (rad/s²)."""
        beyond = np.flatnonzero(self.asked >= drive)
        peak = self.size[-1]
        if beyond.size:
            k = max(int(beyond[0]), 1)
            peak = float(np.interp(drive, self.asked[k - 1 : k + 1], self.fine[k - 1 : k + 1]))
        amplitude = peak - (peak - self.size[0]) * np.linspace(1, 0, _POINTS) ** 2
        frequency, u_frequency, ratio, u_ratio = self.at(amplitude)
        both = self.sides(amplitude, drive, frequency, ratio)
        errors = (u_frequency, 0.0), (0.0, u_ratio)
        u = np.hypot(*(self._moved(both[0], amplitude, drive, (frequency, f), (ratio, r)) for f, r in errors))
        centre, phase = both
        if beyond.size:  # both sides meet
            p, q = (float(np.broadcast_to(one, amplitude.shape)[-1]) for one in self.grip(amplitude))
            square = 1 - (2 * ratio[-1] * p / q) ** 2 / 2
            centre[:, -1] = frequency[-1] * np.sqrt(square)
            phase[:, -1] = np.arctan2(2 * ratio[-1] * np.sqrt(square) / q, (1 - square) / p)
            # up one side and down the other the frequency rises, but between folds
            path = np.gradient(np.concatenate([centre[0], centre[1][::-1]]))
            slopes = np.array([path[:_POINTS], path[_POINTS:][::-1]])
        else:
            slopes = np.array([[1.0], [-1.0]]) * np.gradient(centre, axis=1)
        stable = (slopes > 0).astype(float)
        top = [peak, float(centre[:, -1].mean())] if beyond.size else [np.nan, np.nan]
        return xr.Dataset(
            {
                "amplitude": ("point", amplitude),
                "frequency": (("side", "point"), centre / (2 * np.pi)),
                "frequency_low": (("side", "point"), (centre - _SURE * u) / (2 * np.pi)),
                "frequency_high": (("side", "point"), (centre + _SURE * u) / (2 * np.pi)),
                "phase": (("side", "point"), phase),
                "stable": (("side", "point"), stable),
                "peak_amplitude": ((), top[0]),
                "peak_frequency": ((), top[1] / (2 * np.pi)),
            }
        )

    def _moved(self, centre: Floats, amplitude: Floats, drive: float, frequency: Any, ratio: Any) -> Floats:
        """How far (rad/s) a standard uncertainty moves the curve at each amplitude; where one way leaves no swing so wide, as beside the
        peak, by the other."""
        pairs = [(frequency[0] + k * frequency[1], ratio[0] + k * ratio[1]) for k in (1, -1)]
        moved = np.abs(np.array([self.sides(amplitude, drive, *one)[0] for one in pairs]) - centre)
        return np.where(np.isfinite(moved[0]), moved[0], moved[1])

    def sides(
        self, amplitude: Floats, drive: float, frequency: Floats, ratio: Floats
    ) -> tuple[Floats, Floats]:
        """The drive's angular frequencies (rad/s) that hold each amplitude, below the backbone and above it, and the phases; nan for none.

        With W the square of the drive's frequency over that of the backbone, and d the drive over frequency² and amplitude:
        ((1 - W)/p)² + (2 ratio)² W/q² = d², where p and q are what the drive does in step with the angle and with the speed.
        """
        p, q = self.grip(amplitude)
        friction = (2 * ratio * p / q) ** 2
        strength = (drive * p / (frequency**2 * amplitude)) ** 2
        middle = 1 - friction / 2
        root = middle**2 - 1 + strength
        root = np.sqrt(np.where(root > -1e-9, np.maximum(root, 0.0), np.nan))
        squares = np.array([middle - root, middle + root])
        at = frequency * np.sqrt(np.where(squares > 0, squares, np.nan))
        phase = np.arctan2(2 * ratio * at / frequency / q, (1 - squares) / p)
        return at, phase


def table(found: xr.Dataset) -> pd.DataFrame:
    """A DataFrame with a row for each point of the curves of ``resonance`` and the columns ``COLUMNS``."""
    names = {
        "drive": "drive_rad_per_s2", "amplitude": "amplitude_rad", "frequency": "frequency_Hz",
        "frequency_low": "low_Hz", "frequency_high": "high_Hz", "phase": "phase_rad",
    }  # fmt: skip
    kept = found[["amplitude", "frequency", "frequency_low", "frequency_high", "phase", "stable"]]
    rows = kept.to_dataframe().reset_index().rename(columns=names).assign(campaign=found.attrs["campaign"])
    return rows.dropna(subset=["frequency_Hz"])[COLUMNS].reset_index(drop=True)


def words(found: xr.Dataset, source: str) -> Sequence[str]:
    """A line on each drive: how wide it swings at most (°), and at which frequency (Hz), by the ``source`` ``free`` or ``model``."""
    own, told = found.sel(source=source), []
    for k, drive in enumerate(found["drive"].values):
        one: Any = own.isel(drive=k)
        peak = float(one["peak_amplitude"])
        what = "wider than the ring-down shows"
        if np.isfinite(peak):
            what = f"{np.degrees(peak):.3g}° at {float(one['peak_frequency']):.4g} Hz"
        told.append(f"a drive of {drive:.3g} rad/s²: {what}")
    return told
