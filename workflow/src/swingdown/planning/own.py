"""A study of somebody's files: which they are, what each is called, and the folder with its sheet and config."""

import difflib
import hashlib
import os
import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr
import yaml

from ..errors import InputError, as_told
from ..language import ENGLISH
from ..measurement.angle import to_angle
from ..measurement.files.archive import SeveralFiles
from ..measurement.files.programs import CLOSED, READERS
from ..measurement.files.runs import SeveralRuns, clock_part
from ..measurement.files.source import NETCDF
from ..measurement.recording import ingest
from ..measurement.refused import NOT_LOOKED_AT, WHICH_COLUMN, place_in
from ..measurement.sharing import sharing
from ..measurement.sheet import COLUMNS
from ..measurement.slack import zero_unstated
from ..measurement.swings.release import SeveralReleases
from ..paths import printable, safe_name, write_csv, write_text
from ..pendulum.model import everyday

# What of a folder is given to the readers; they tell of each that they cannot use why.
ENDINGS = (".csv", ".tsv", ".txt", ".dat", ".xlsx", ".xls", ".ods", ".zip", ".gz", *READERS, *CLOSED, *NETCDF)
_PICTURES = (".png", ".jpg", ".jpeg", ".gif", ".svg", ".heic", ".bmp", ".tif", ".tiff", ".webp", ".pdf")
SHEET, CONFIG, LEFT_OUT = "recordings.csv", "study.yaml", "left_out.csv"
SUFFIX = "-swingdown"  # of a study's folder, after the file that it is of
TOGETHER = "pendulum"
_OPENING = """\
# The study of the recordings in {sheet}, as `swingdown` wrote it. It is yours to change (config/README.md of the project tells every
# key); then run, in the project's folder:
#   .venv/bin/snakemake -c2 --configfile {config} --directory {folder}
"""
_WRITTEN = "# as written: "


AT_REST = 0.05  # of the widest swing in a file: what moves less beside it is at rest


class Taken(NamedTuple):
    """A file that can be used: its row of the sheet, and its angle as ``measurement.angle.to_angle`` gives it."""

    row: dict[str, Any]
    recording: xr.Dataset
    angle: xr.Dataset


class Refused(NamedTuple):
    """A file, or a part of one, that cannot be used or searched, and why. ``recording`` is its name in the sheet, or would be."""

    recording: str
    file: str
    problem: str
    expected: str
    mend: str
    label: str = ""  # what to call it, where that is not its name
    code: str = ""  # what a program goes by, as of a ``Refusal``

    @property
    def error(self) -> InputError:
        """What is raised where nothing else is to be done."""
        return InputError(self.file, self.problem, self.expected, self.mend)


def files(given: Iterable[str | Path]) -> tuple[list[Path], list[Refused]]:
    """The files among these paths, and of each folder those in it that may be recordings, in the order of their names; and of all
    other files and folders in it why they are not looked at.

    InputError for a path that is not there, and for a folder without any.
    """
    found: list[Path] = []
    passed: list[Refused] = []
    for path in map(Path, given):
        if path.is_dir():
            inside = sorted((one for one in path.iterdir() if not one.name.startswith(".")), key=_in_order)
            able = [one for one in inside if one.suffix.lower() in ENDINGS and one.is_file()]
            if not able:
                raise InputError(path, "there is no recording in this folder", f"files that end in {', '.join(ENDINGS)}", "name the files themselves")  # fmt: skip
            found += able
            passed += [_passed(one) for one in inside if one not in able and not one.name.endswith(SUFFIX)]
        elif path.is_file():
            found.append(path)
        else:
            mend = f"correct the path{_near(path)}"
            raise InputError(path, "there is no such file", "a file or a folder of files", mend)
    found = list(dict.fromkeys(found))
    nameless = [path for path in found if _shown(path) != path.name]
    return [path for path in found if path not in nameless], passed + [_misnamed(path) for path in nameless]


def _near(path: Path) -> str:
    """A question after the file that a mistyped path may have meant; empty where none is near."""
    there = [one.name for one in path.parent.iterdir()] if path.parent.is_dir() else []
    near = difflib.get_close_matches(path.name, there, 1)
    return f"; did you mean {path.with_name(near[0])}?" if near else ""


def _passed(path: Path) -> Refused:
    """A file or folder in a folder that is not looked at."""
    ending = path.suffix.lower()
    what = (
        "a folder in the folder" if path.is_dir() else "a picture is no recording" if ending in _PICTURES
        else f"files that end in {ending} are none of recordings" if ending
        else "files without an ending are none of recordings"
    )  # fmt: skip
    told = f"not looked at: {what}", "", "name it by itself, if it is one"
    shown = _shown(path)
    return Refused(safe_name(shown), shown, *told, printable(shown), NOT_LOOKED_AT)


def _misnamed(path: Path) -> Refused:
    """A file whose name no sheet can hold: its bytes are no UTF-8."""
    shown = _shown(path)
    return Refused(safe_name(shown), shown, "the name of the file is in another encoding than UTF-8, perhaps Latin-1", "a name in UTF-8", "rename the file", printable(shown))  # fmt: skip


def _shown(path: Path) -> str:
    """A file's name as text; bytes that are no UTF-8 are read as Latin-1."""
    raw = os.fsencode(path.name)
    try:
        return raw.decode("utf-8")
    except UnicodeDecodeError:
        return raw.decode("latin-1")


def _in_order(path: Path) -> list[tuple[int, str | int]]:
    """Numbers in a name count as numbers: swing 2 comes before swing 10."""
    parts = re.split(r"(\d+)", path.name.lower())
    return [(0, int(part)) if part.isdecimal() else (1, part) for part in parts]


def names(paths: Sequence[Path]) -> list[str]:
    """A name for each file that can name a file on any system: letters, digits, ``.``, ``_`` and ``-``, each once."""
    found: list[str] = []
    for path in paths:
        name = safe_name(path.stem)
        count, taken = 1, {one.lower() for one in found}
        while (chosen := name if count == 1 else f"{name}-{count}").lower() in taken:
            count += 1
        found.append(chosen)
    return found


def place(given: Sequence[str | Path]) -> Path:
    """The folder for the study of these files: beside the first, named after it."""
    first = Path(given[0]).resolve()
    return first.with_name((first.name if first.is_dir() else first.stem) + SUFFIX)


def rows(
    paths: Sequence[Path], folder: Path, together: bool = False, told: Mapping[str, Any] | None = None
) -> list[dict[str, Any]]:
    """A row of the sample sheet for each file, as a dict with the cells that are not empty.

    Each is a pendulum of its own, or all are recordings of one. ``file`` is relative to ``folder``; ``told`` are cells that hold
    for every row.
    """
    known, found = {key: cell for key, cell in (told or {}).items() if cell is not None}, []
    for name, path in zip(names(paths), paths, strict=True):
        file = os.path.relpath(path.resolve(), folder.resolve())
        label = {"label": printable(path.stem)} if path.stem != name else {}
        row = {"recording": name, "campaign": TOGETHER if together else name, "file": file}
        found.append(row | label | known)
    return found


def take(row: Mapping[str, Any], path: Path, restoring: str = "sine") -> list[Taken | Refused]:
    """What a file of the sheet's ``row`` gives: its angle, or why it has none; of several runs, releases or files in an archive in a row each.

    Releases are recordings of one campaign, whose names end in their number. Runs and files are pendulums of their own,
    unless the row's campaign is another than the recording.
    """
    why: Sequence[str] = ()
    try:
        return [_taken(row, path, restoring)]
    except SeveralRuns as found:
        parts = [_run(row, name) for name in found.names]
    except SeveralFiles as found:
        parts = [_inside(row, name) for name in found.names]
        told = [_passed_inside(row, name) for name in found.others]
        return [*(one for part in parts for one in take(part, path, restoring)), *told]
    except SeveralReleases as found:
        parts = [_release(row, number, cells) for number, cells in enumerate(found.cells, 1)]
        why = found.why
    except InputError as problem:
        return [refused(row, problem, path)]
    each = zip(parts, why or [""] * len(parts), strict=True)
    taken = _asked_alike([_cut(one, cut) for part, cut in each for one in take(part, path, restoring)])
    return _without_rest(taken, path)


def _asked_alike(parts: list[Taken | Refused]) -> list[Taken | Refused]:
    """The parts of a file; where one of them does not say which column swings, none does in which another column may be the swing."""
    asked = next((one for one in parts if isinstance(one, Refused) and one.code == WHICH_COLUMN), None)
    return [
        asked._replace(recording=one.row["recording"], label=one.row.get("label", ""))
        if asked and isinstance(one, Taken) and one.recording.attrs.get("columns_alike")
        else one
        for one in parts
    ]


def _without_rest(parts: list[Taken | Refused], path: Path) -> list[Taken | Refused]:
    """The parts of a file, those refused that hardly move beside another in the same unit: as a pendulum at rest beside one that swings.

    Parts that follow each other are no such ones.
    """
    taken = {k: one for k, one in enumerate(parts) if isinstance(one, Taken) and "run" in one.row}
    runs = {k: one for k, one in taken.items() if not clock_part(str(one.row["run"]))}
    signals = {k: one.recording["signal"] for k, one in runs.items()}
    sizes = {k: float(np.ptp(signal.values)) for k, signal in signals.items()}
    found = list(parts)
    for k, size in sizes.items():
        most = max(sizes[n] for n in sizes if signals[n].attrs["units"] == signals[k].attrs["units"])
        if size < AT_REST * most:
            told = InputError(
                path.name,
                f"it moves by {100 * size / most:.2g} % of what another column of the file does: at rest beside it",
                f"a swing of at least {100 * AT_REST:.0f} % of the widest in the file",
                "if that is its swing, give it alone by its name ⟨in run⟩",
            )
            found[k] = refused(runs[k].row, told, path)
    return found


def _run(row: Mapping[str, Any], run: str) -> dict[str, Any]:
    """The row of one run of several in the file of a row."""
    name = safe_name(f"{row['recording']}-{safe_name(run)}")
    campaign = name if row["campaign"] == row["recording"] else row["campaign"]
    label = f"{row.get('label', row['recording'])}, {run}"
    return {**row, "recording": name, "campaign": campaign, "label": label, "run": run}


def _inside(row: Mapping[str, Any], file: str) -> dict[str, Any]:
    """The row of one file of several in the archive of a row."""
    return {key: cell for key, cell in {**_run(row, file), "sheet": file}.items() if key != "run"}


def _passed_inside(row: Mapping[str, Any], file: str) -> Refused:
    """A file in the archive of a row that is not looked at."""
    part, mend = _inside(row, file), "unpack it and name it by itself, if it is a recording"
    told = f"not looked at: {printable(file)} in it is no table of numbers", "", mend
    return Refused(part["recording"], row["file"], *told, printable(part["label"]), NOT_LOOKED_AT)


def _release(row: Mapping[str, Any], number: int, cells: Mapping[str, str]) -> dict[str, Any]:
    """The row of one release of several in the file of a row."""
    window = {key: float(cell) for key, cell in cells.items()}
    label = f"{row.get('label', row['recording'])}, release {number}"
    return {**row, "recording": f"{row['recording']}-{number}", "label": label, **window}


def _cut(one: Taken | Refused, why: str) -> Taken | Refused:
    """The same release, with ``why`` a part of it alone is used among its remarks; "" for none."""
    if not why or isinstance(one, Refused):
        return one
    told = "; ".join(filter(None, (as_told(why), one.recording.attrs.get("remarks"))))
    return one._replace(recording=one.recording.assign_attrs(remarks=told))


def _taken(row: Mapping[str, Any], path: Path, restoring: str) -> Taken:
    """The recording and its angle; the zero of an angle is open, as nobody states it."""
    recording = ingest({**COLUMNS, **row, "file": str(path)}, restoring=restoring, calibrated=False)
    if "signal" in recording and (known := zero_unstated(row, str(recording["signal"].attrs["units"]))):
        row, recording = {**row, **known}, recording.assign_attrs(known)
    return Taken(dict(row), recording, to_angle(recording))


def apart(taken: Sequence[Taken]) -> list[Taken]:
    """The recordings, those that share no model with the others of their pendulum as pendulums of their own."""
    found = list(taken)
    for campaign in dict.fromkeys(one.row["campaign"] for one in taken):
        members = [k for k, one in enumerate(taken) if one.row["campaign"] == campaign]
        for k in sharing([taken[k].angle for k in members])[1] if len(members) > 1 else ():
            one = taken[members[k]]
            found[members[k]] = one._replace(row=one.row | {"campaign": one.row["recording"]})
    return found


def refused(row: Mapping[str, Any], problem: InputError, path: Path | None = None) -> Refused:
    """The ``Refused`` of a row of the sheet; the line and column of the file at ``path`` stand before the problem."""
    at = place_in(str(path), problem.where, row["recording"]) if path else ""
    told = at + problem.problem, problem.expected, problem.mend
    return Refused(row["recording"], row["file"], *told, row.get("label", ""), problem.code)


def write(
    folder: Path,
    kept: Sequence[Mapping[str, Any]],
    left_out: Sequence[Refused],
    searched: Sequence[str],
    restoring: str = "sine",
    lang: str = ENGLISH,
) -> Path:
    """The path of the config written into the folder, with the sheet and the table of what is left out beside it.

    ``kept`` are the rows of the sample sheet, ``left_out`` the recordings that cannot be used, with the reason, ``searched`` the campaigns to
    search; ``restoring`` is ``sine`` or ``linear``, ``lang`` the language of the report. InputError if somebody changed the sheet or the
    config since they were written here, or the folder cannot be written.
    """
    try:
        _check_untouched(folder)
        columns = [name for name in COLUMNS if any(name in row for row in kept)]
        write_csv(pd.DataFrame(kept).reindex(columns=columns), folder / SHEET)
        settings: dict[str, Any] = {
            "recordings": SHEET,
            "simulation": {"simulated": []},
            "experiment": {"fitted": list(everyday(restoring))},
        }
        settings |= {"lang": lang} if lang != ENGLISH else {}
        settings |= {"model": {"restoring": restoring}} if restoring == "linear" else {}
        if left_out:
            write_csv(pd.DataFrame(left_out), folder / LEFT_OUT)
            settings["left_out"] = LEFT_OUT
        campaigns = dict.fromkeys(row["campaign"] for row in kept)
        if [name for name in campaigns if name not in searched]:
            settings["discovery"] = {"campaigns": list(searched)}
        body = yaml.safe_dump(settings, sort_keys=False, allow_unicode=True)
        opening = _OPENING.format(sheet=SHEET, config=folder / CONFIG, folder=folder)
        digest = _digest((folder / SHEET).read_bytes(), body)
        return write_text(folder / CONFIG, f"{opening}{_WRITTEN}{digest}\n{body}")
    except OSError as error:
        raise InputError(folder, f"it cannot be written ({error.strerror})", "a folder of your own", "name another with --into") from error  # fmt: skip


def _digest(sheet: bytes, body: str) -> str:
    return hashlib.sha256(sheet + body.encode()).hexdigest()[:16]


def _check_untouched(folder: Path) -> None:
    """Refuses a folder whose sheet or config are somebody's own work."""
    there = [name for name in (SHEET, CONFIG) if (folder / name).exists()]
    if not there:
        return
    text = (folder / CONFIG).read_text(encoding="utf-8") if CONFIG in there else ""
    _, mark, rest = text.partition(_WRITTEN)
    digest, _, body = rest.partition("\n")
    sheet = (folder / SHEET).read_bytes() if SHEET in there else b""
    if not mark or digest != _digest(sheet, body):
        raise InputError(
            folder,
            f"{' and '.join(there)} there {'were' if len(there) > 1 else 'was'} changed, or not written by this command",
            "a new folder, or one as this command left it",
            f"name another with --into, or run what is there: snakemake -c2 --configfile {folder / CONFIG} --directory {folder}",
        )
