"""A recording that cannot be used: in place of its data the reason, which reading it raises; and who is left of several."""

import re
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

import xarray as xr

from .. import dataset
from ..errors import InputError
from ..paths import is_url
from .sheet import Row

# of a row on what is left out
COLUMNS = ("campaign", "recording", "label", "file", "problem", "expected", "mend", "code")
NOT_LOOKED_AT = "not looked at"  # the code of a file in a folder that no reader is given
OTHER_BYTES = "other bytes"  # the code of a file that is not the one whose checksum the sheet states
WHICH_COLUMN = "which column"  # the code of what does not say which of its columns swings
_WHY = ("where", "problem", "expected", "mend")
_DOUBT = "doubt_"  # before each of these, where a recording can be used, and may be no free swing


def refuse(problem: InputError, about: Mapping[str, Any], output: str | Path, known: bool = False) -> str:
    """What is said of a recording that cannot be used; ``output`` is written in place of its data, and tells why.

    ``about`` holds ``recording``, ``campaign``, ``file`` and perhaps a ``label``: a row of the sample sheet, or the attributes of an earlier step, of which
    the problem may be ``known``. Whoever reads the file by ``dataset.read`` meets the problem again, so no step can take it for data.
    """
    told = _named(about)
    why = {key: getattr(problem, key) for key in _WHY}
    title = "a recording that cannot be used"
    dataset.write(xr.Dataset(attrs={"title": title, "role": dataset.REFUSED, **told, **why}), output)
    name = told["recording"] or f"campaign {told['campaign']}"
    return f"{name}: left out, as reported before" if known else f"{name}: NOT USED: {problem}"


def _named(about: Mapping[str, Any]) -> dict[str, str]:
    told = {key: str(about.get(key, "")) for key in ("recording", "campaign", "file")}
    return told | {"label": str(about.get("label") or told["recording"])}


def doubted(fits: xr.Dataset, about: Mapping[str, Any], problem: InputError | None) -> xr.Dataset:
    """The fits of a swing with the name of its recording, and with the ``problem`` where it may be no free one."""
    why = {_DOUBT + key: getattr(problem, key) for key in _WHY} if problem else {}
    return fits.assign_attrs(_named(about) | why)


def doubt_in(path: str | Path) -> dict[str, str]:
    """Why a swing, by the file of its fits, may be no free one: where, problem, expected, mend; empty for a free one."""
    about = dataset.attributes(path)
    return {key: str(about[_DOUBT + key]) for key in _WHY if _DOUBT + key in about}


def problem_in(path: str | Path) -> InputError | None:
    """Why the recording that a file stands for cannot be used; None where it can. InputError for a damaged file."""
    about = dataset.attributes(path)
    return InputError(*(about[key] for key in _WHY)) if about.get("role") == dataset.REFUSED else None


def left_out(path: str | Path) -> dict[str, str]:
    """The row (``COLUMNS``) on a recording that cannot be used, or may be no free swing, with the problem's place in its file; empty for
    any other."""
    about = dataset.attributes(path)
    why = {key: about[key] for key in _WHY} if about.get("role") == dataset.REFUSED else doubt_in(path)
    if not why:
        return {}
    return _row(about, why)


def row_on(about: Mapping[str, Any], problem: InputError) -> dict[str, str]:
    """The row (``COLUMNS``) on a recording, by the attributes of a step, that cannot be used because of a ``problem``."""
    return _row(about, {key: getattr(problem, key) for key in (*_WHY, "code")})


def _row(about: Mapping[str, Any], why: Mapping[str, str]) -> dict[str, str]:
    row = {key: str((_named(about) | {"code": ""} | dict(why))[key]) for key in COLUMNS}
    return row | {"problem": place_in(row["file"], why["where"], row["recording"]) + row["problem"]}


def taking_part(
    fits: Sequence[str | Path], explained: Collection[str] = ()
) -> tuple[list[str | Path], list[dict[str, str]]]:
    """The files of those swings that take part, and the rows (``COLUMNS``) on the others.

    A swing that may be no free one is left out beside free ones. Where a campaign has no free one, something other than damping may move
    all of them: they take part if it is one of those that are ``explained``.
    """
    rows = {path: left_out(path) for path in fits}
    free = {str(dataset.attributes(path).get("campaign")) for path, row in rows.items() if not row}
    all_ = set(explained) - free
    whole = {
        path for path, row in rows.items() if row and row["campaign"] in all_ and problem_in(path) is None
    }
    kept = [path for path, row in rows.items() if not row or path in whole]
    return kept, [row for path, row in rows.items() if path not in kept]


def used(paths: Sequence[str | Path]) -> tuple[list[xr.Dataset], list[dict[str, str]]]:
    """The datasets of those files that can be used, and the rows (``COLUMNS``) on the others."""
    rows = [left_out(path) for path in paths]
    kept = [dataset.read(path) for path, row in zip(paths, rows, strict=True) if not row]
    return kept, [row for row in rows if row]


def place_in(file: str, where: str, recording: str) -> str:
    """The place inside a file of an error that tells ``where`` it is, such as ``line 3, column angle``; empty for the whole file."""
    if not where.startswith(file):
        return ""
    sheet = rf" \([^()]*, {re.escape(recording)}[^)]*\)"
    inside = re.sub(sheet, "", where.removeprefix(file)).strip(", ")
    return f"{inside}: " if inside else ""


def none_left(lost: Sequence[Mapping[str, str]]) -> InputError:
    """What is told where all of several recordings are left out: how many, and why the first is."""
    first = lost[0]
    name = f"{first['recording']} ({first['file']})"
    where = f"none of {len(lost)} recordings can be used; the first, {name}" if len(lost) > 1 else name
    return InputError(where, first["problem"], first["expected"], first["mend"])


def may_pass(problem: InputError, row: Row) -> bool:
    """True for a problem that may be gone the next time though nobody changed the file: it was out of reach, or what came over a
    network is not what the sheet says."""
    damaged = is_url(row["file"]) and problem.code == OTHER_BYTES
    return damaged or isinstance(problem.__cause__, OSError)
