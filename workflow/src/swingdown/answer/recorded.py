"""A file as a recording in Python: read once, then fitted, explained, drawn or handed on as a table."""

import difflib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypedDict, Unpack

import numpy as np
import pandas as pd
import xarray as xr

from .. import markup
from ..arrays import Floats, Shown
from ..dataset import series_of
from ..errors import InputError, told_to
from ..extras import has, needed
from ..measurement.files.columns import UNITS
from ..measurement.sheet import SCHEMA
from ..planning import own
from ..schema import near, rules
from .options import ARGUMENTS, TO_READ

if TYPE_CHECKING:
    from ..plots.style import Drawn
    from .result import Answer

Restoring = Literal["sine", "linear"]
Paths = str | PathLike[str] | Sequence[str | PathLike[str]]


class OfAFile(TypedDict, total=False):
    """What you may state of a file alone."""

    column: str
    """Name of the column of the angle."""
    time_unit: str
    """s, ms, us or ns."""
    time_column: str
    """Name of the column of the time."""
    rate: float
    """Samples a second of a file without times."""
    start: float
    """Time in s before which nothing is used."""
    stop: float
    """Time in s after which nothing is used."""
    counts_per_revolution: float
    """Of an encoder in counts."""
    scale: str
    """Degrees that one unit of the signal is worth; or two readings at known angles, as ``512=0,700=30``."""
    length: str
    """From the pivot to the middle of the bob: ``0.583±0.001`` (m), ``58cm``. It gives g, and the angle where one coordinate was recorded (``350px``)."""
    bob_diameter: str
    """Of a ball, for its inertia in g: ``30.0(1)mm``."""
    bob_density: str
    """Of the bob, for the air's part in g: ``7800`` (kg/m^3), ``7.8g/cm3``."""
    run: str
    """Which run of a file with several."""
    sheet: str
    """Which sheet of a workbook, or file in an archive."""


class Told(OfAFile, total=False):
    """What you may state of a file that does not state it itself."""

    unit: str
    """Of the angle or its rate: rad, deg, counts, V, rad/s or deg/s; of positions m, cm, mm or px."""
    kind: str
    """What the values are: swing, turning_points, half_swings, passages or periods."""
    zero_tolerance: float
    """How far the zero of an angle may be off, in rad; by default 0.1, and the swings tell it."""
    input: str
    """Name of the column of what was measured of its drive."""
    input_kind: str
    """What it is: torque, pivot_acceleration, pivot_position or pivot_angle."""
    input_unit: str
    """Of the input."""
    input_free: str
    """What of the input's sensor is to be found: gain, delay, both, or nothing."""
    input_between: str
    """What the input does between its samples: curve, line or hold."""


@dataclass(frozen=True)
class Recording:
    """What files hold of one pendulum.

    Attributes
    ----------
    swings
        Datasets of the angles (rad) over the time (s), one a recording or release.
    taken
        How each file was read, a line each.
    remarks
        What was noticed in the recordings, a line each.
    restoring
        ``sine`` for a pendulum, ``linear`` for a wheel on a spring.
    rows
        By recording, what is stated of it, as a row of the sample sheet.
    """

    swings: tuple[xr.Dataset, ...]
    taken: tuple[str, ...] = field(repr=False)
    remarks: tuple[str, ...] = field(repr=False, default=())
    restoring: Restoring = "sine"
    rows: Mapping[str, Mapping[str, Any]] = field(default_factory=dict, repr=False)

    @told_to(TO_READ)
    def fit(
        self, *, fitted: str | Sequence[str] | None = None, effects: Mapping[str, Any] | None = None
    ) -> "Answer":
        """The ``Answer`` of ``swingdown.fit`` on this recording.

        Parameters
        ----------
        fitted, effects
            As in ``swingdown.fit``, and so are the errors.

        Returns
        -------
        Answer
            With g, where a length is stated.
        """
        from . import of_swings

        return of_swings(self.swings, fitted, effects, self.restoring).with_g(self.rows)[0]

    @told_to(TO_READ)
    def explain(
        self,
        *,
        base: str | Sequence[str] | None = None,
        rounds: int = 4,
        fitted: str | Sequence[str] | None = None,
        effects: Mapping[str, Any] | None = None,
    ) -> "Answer":
        """The ``Answer`` of ``swingdown.explain`` on this recording.

        Parameters
        ----------
        base, rounds, fitted, effects
            As in ``swingdown.explain``, and so are the errors.

        Returns
        -------
        Answer
            With a verdict, and with g where a length is stated.
        """
        from . import BASE, explained

        found = explained(self.swings, base or BASE, rounds, fitted, effects, self.restoring)
        return found.with_g(self.rows)[0]

    def to_dataframe(self) -> pd.DataFrame:
        """A DataFrame with a row for each sample.

        Returns
        -------
        pandas.DataFrame
            Columns ``recording``, ``time_s``, and ``angle_rad`` or ``rate_rad_per_s``.
        """
        return table_of(self.swings)

    def to_xarray(self) -> xr.Dataset:
        """A Dataset of the samples of all swings, one after the other.

        Returns
        -------
        xarray.Dataset
            ``angle`` (rad) or ``rate`` (rad/s) over ``sample``, with the coordinates ``time`` (s) and ``recording``.
        """
        return samples_of(self.swings)

    def plot(self) -> "Drawn":
        """A matplotlib Figure of the angle over the time, which a notebook shows."""
        needed("matplotlib")
        from ..plots.answer import swings_alone

        shown = [shown_with(one, np.full(one.sizes["time"], np.nan)) for one in self.swings]
        emulated = any(one.attrs.get("emulated") == "yes" for one in self.swings)
        return swings_alone(shown, {"emulated": "yes" if emulated else "no"})

    def _repr_html_(self) -> str:
        heads = ["recording", "samples", "s", "largest"]
        rows = [[name, samples, f"{seconds:.4g}", f"{reach:.3g} {unit}"] for name, samples, seconds, reach, unit in map(_about, self.swings)]  # fmt: skip
        picture = self.plot() if has("matplotlib") and any(_shows(one) for one in self.swings) else None
        return markup.page([*self.taken, *self.remarks], markup.table(heads, rows), picture)

    def __repr__(self) -> str:
        return "\n".join([*self.taken, *(f"    {text}" for text in self.remarks), *map(_line, self.swings)])


def _about(swing: xr.Dataset) -> tuple[str, int, float, float, str]:
    """Of a swing its name, samples, seconds, the largest angle and its unit."""
    series, times = series_of(swing), swing["time"].values
    reach = float(np.nanmax(np.abs(series.values))) if _shows(swing) else np.nan
    unit = str(series.attrs.get("units", "rad"))
    return str(swing.attrs["recording"]), times.size, float(times[-1] - times[0]), reach, unit


def _shows(swing: xr.Dataset) -> bool:
    """Whether a swing has angles; passages without speeds have none."""
    return bool(np.isfinite(series_of(swing).values).any())


def _line(swing: xr.Dataset) -> str:
    name, samples, seconds, reach, unit = _about(swing)
    return f"{name:18} {samples} samples in {seconds:.4g} s, up to {reach:.3g} {unit}"


@told_to(TO_READ)
def read(path: Paths, *, restoring: Restoring = "sine", **told: Unpack[Told]) -> Recording:
    """The ``Recording`` in a file, or in several files of one pendulum.

    Parameters
    ----------
    path
        Any file that the command ``swingdown`` takes, or a list of files.
    restoring
        ``sine`` for a pendulum; ``linear`` for a wheel on a spring or a torsion pendulum.
    **told
        What the file does not state itself: ``unit="deg"``, ``column="theta"``, ``time_unit="ms"``, ``start=1.5`` (s); ``Told`` lists all.

    Raises
    ------
    InputError
        With the file, its line, what is wrong and the mend. For a file with several runs it lists them, for ``run``.
    """
    given = [path] if isinstance(path, str | PathLike) else list(path)
    paths, passed = own.files(_no_folders(given))
    if passed:
        raise passed[0].error
    rows = own.rows(paths, Path(), len(paths) > 1, _cells(told))
    found = [one for row, file in zip(rows, paths, strict=True) for one in _taken(row, file, restoring, told)]
    remarks = [str(one.recording.attrs["remarks"]) for one in found if one.recording.attrs.get("remarks")]
    taken = dict.fromkeys(
        f"{Path(one.row['file']).name}: {one.recording.attrs.get('taken', '')}" for one in found
    )
    stated = {one.row["recording"]: one.row for one in found}
    return Recording(
        tuple(one.angle for one in found), tuple(taken), tuple(dict.fromkeys(remarks)), restoring, stated
    )


def as_one(recordings: Sequence[Recording]) -> Recording:
    """The ``Recording`` of all swings of these, as of one pendulum; of those with one name the later ones are numbered.

    InputError where some are of a pendulum and others of a wheel on a spring.
    """
    if len(recordings) == 1:
        return recordings[0]
    restoring = recordings[0].restoring
    if any(one.restoring != restoring for one in recordings):
        problem, expected = (
            "some are of a pendulum, others of a wheel on a spring",
            "recordings of one pendulum",
        )
        raise InputError("the recordings", problem, expected, "read all with one ⟨restoring⟩")
    swings, rows = [], dict[str, Mapping[str, Any]]()
    for one in recordings:
        for swing in one.swings:
            given = name = str(swing.attrs["recording"])
            number = 2
            while name in rows:
                name, number = f"{given}-{number}", number + 1
            about = {"recording": name, "campaign": own.TOGETHER}
            rows[name] = {**one.rows.get(given, {}), **about}
            swings.append(swing.assign_attrs(about))
    taken = dict.fromkeys(line for one in recordings for line in one.taken)
    remarks = dict.fromkeys(line for one in recordings for line in one.remarks)
    return Recording(tuple(swings), tuple(taken), tuple(remarks), restoring, rows)


def _no_folders(given: Sequence[str | PathLike[str]]) -> list[Path]:
    paths = [Path(one) for one in given]
    if folders := [one for one in paths if one.is_dir()]:
        raise InputError(folders[0], "it is a folder", "the files of one pendulum", "name the files")
    if not paths:
        raise InputError("path", "no file is given", "at least one", "name a file")
    return paths


def _cells(told: Mapping[str, Any]) -> dict[str, Any]:
    """Cells of the sample sheet for arguments of ``read``; InputError for an unknown one, and for a value that its cell cannot have."""
    known, columns, cells = Told.__annotations__, rules(SCHEMA)["properties"], dict[str, Any]()
    for name, value in told.items():
        if name not in known:
            meant = difflib.get_close_matches(name, known, 1)
            raise InputError(f"argument {name}", "there is no such argument", ", ".join(known), f"say {meant[0]}=" if meant else "leave it out")  # fmt: skip
        cell = ARGUMENTS.get(name, name)
        if name == "unit":
            value = UNITS.get(str(value), ("", ""))[1] or value  # `degrees` is deg
        rule = columns.get(cell, {})
        values = rule.get("enum", ())
        if values and value not in ("", *values):
            raise InputError(f"argument {name}", f"it is {value!r}", " or ".join(map(str, values)), near(value, values))  # fmt: skip
        cells[cell] = _number(name, value) if rule.get("type") == "number" else value
    return cells


def _number(name: str, value: Any) -> float:
    """The value of an argument that is a number; InputError for one that is none."""
    try:
        return float(value)
    except (TypeError, ValueError):
        raise InputError(f"argument {name}", f"it is {value!r}", "a number", "write a number") from None


def _taken(row: Mapping[str, Any], path: Path, restoring: str, told: Mapping[str, Any]) -> list[own.Taken]:
    """What a file gives, with the refusals of its parts raised."""
    parts = own.take(row, path, restoring)
    if refused := [one for one in parts if isinstance(one, own.Refused)]:
        one = refused[0]
        raise InputError(one.label or path.name, one.problem, one.expected, one.mend)
    found = [one for one in parts if isinstance(one, own.Taken)]
    runs = [str(one.row["run"]) for one in found if "run" in one.row]
    if len(runs) > 1 and "run" not in told:
        problem = f"it holds {len(runs)} runs: {', '.join(runs)}"
        raise InputError(path.name, problem, "one run", f"say run={runs[0]!r}")
    return found


def shown_with(swing: xr.Dataset, fit: Floats) -> Shown:
    """A swing as pictures take it, beside its fit."""
    series = series_of(swing)
    return Shown(str(swing.attrs["recording"]), "", swing["time"].values, series.values, fit, unit=str(series.attrs["units"]))  # fmt: skip


def samples_of(swings: Sequence[xr.Dataset], **more: np.ndarray) -> xr.Dataset:
    """A Dataset of the samples of swings, one after the other, over ``sample``; ``more`` are further series of them."""
    series = [series_of(one) for one in swings]
    about = {"units": str(series[0].attrs["units"])}
    name = "angle" if about["units"] == "rad" else "rate"
    values = {name: np.concatenate([one.values for one in series]), **more}
    recording = np.concatenate([np.full(one.sizes["time"], str(one.attrs["recording"])) for one in swings])
    times = np.concatenate([one["time"].values for one in swings])
    return xr.Dataset(
        {key: ("sample", value, about) for key, value in values.items()},
        {"time": ("sample", times, {"units": "s"}), "recording": ("sample", recording)},
    )


def table_of(swings: Sequence[xr.Dataset]) -> pd.DataFrame:
    """The samples of swings as a table, with units in the names of its columns."""
    found = samples_of(swings)
    columns = {"recording": found["recording"].values, "time_s": found["time"].values}
    units = {"angle": "rad", "rate": "rad_per_s"}
    columns |= {f"{name}_{units[str(name)]}": one.values for name, one in found.data_vars.items()}
    return pd.DataFrame(columns)
