"""What is to be recorded, where it goes, and its entry in the sheet: all that can stand against it is told beforehand."""

import errno
import hashlib
import shutil
from dataclasses import dataclass
from pathlib import Path

from ..errors import InputError, Unwritten
from . import sheets, source, take
from .formats import parser

FOLDER = Path("resources/recordings")
_ROOM = 128  # bytes that a sample may take on disk, journal and recording together
_LONG = 600.0  # s that room is asked for where no duration is fixed


@dataclass(frozen=True)
class Job:
    """What is to be recorded and where it goes."""

    name: str
    settings: dict  # the config's capture, as it holds for this recording
    about: dict  # further attributes of the recording
    sheet: Path  # the sample sheet, or the apparatus sheet for a tower height
    height: float | None = None  # m

    @property
    def path(self):
        return FOLDER / f"{self.name}.nc"

    @property
    def journal(self):
        return FOLDER / f"{self.name}.raw"


def job(config: dict, again: bool = False) -> Job:
    """What a ``config`` (``settings.complete``) asks for of a capture, checked before anything is recorded.

    InputError if the recording could not be kept: a name that is taken, unless it is made ``again``, a sheet that cannot take the row,
    settings that contradict each other.
    """
    name, settings, height = config["recording"], dict(config["capture"]), config.get("height")
    still = height is not None or config.get("role") == "static"
    if still:
        settings |= {"trigger": None, "duration_s": settings["still_s"], "still": True}
    settings = source.completed(settings)
    format = parser(settings)
    if format.sequence_modulus and settings["timeout_s"] * settings["rate_hz"] > format.sequence_modulus / 4:
        most = format.sequence_modulus / 4 / settings["rate_hz"]
        raise InputError(
            "capture.timeout_s",
            f"in {settings['timeout_s']:g} s of silence the sequence numbers could start again unnoticed",
            f"at most {most:.3g} s at {settings['rate_hz']:g} samples a second",
            "lower capture.timeout_s",
        )
    if height is not None:
        if not config.get("apparatus"):
            problem = "no apparatus sheet is named"
            raise InputError("config, key height", problem, "one, with the lengths", "set `apparatus`")
        sheet = sheets.own(config["apparatus"], "apparatus")
        if not sheet.is_file():
            problem = "there is no such apparatus sheet"
            raise InputError(sheet, problem, "an apparatus sheet with the measured lengths", "write it first")
    else:
        sheet = sheets.own(config.get("recordings") or "recordings.csv", "recordings")
    about = {"recording": name, "campaign": settings["campaign"], "role": config.get("role", "")}
    made = Job(name, settings, about, sheet, height)
    if not config.get("recover") and not (again and made.path.exists()):
        take.check_absent(made.path)
        try:
            FOLDER.mkdir(parents=True, exist_ok=True)
            enter(made, "0" * 64, rehearse=True)
        except PermissionError as error:
            problem = "you may not write to it"
            mend = "name another with --directory"
            raise InputError(error.filename or sheet, problem, "a folder of your own", mend) from error
    return made


def enter(job, digest, rehearse=False):
    """The recording's row, or point, added to its sheet."""
    if job.height is not None:
        sheets.add_point(job.sheet, _point(job, digest), rehearse)
    else:
        sheets.add_row(job.sheet, _row(job, digest), rehearse)


def enter_whole(job):
    """The same for a recording that is on disk; InputError tells what to add by hand."""
    digest = hashlib.sha256(job.path.read_bytes()).hexdigest()
    try:
        enter(job, digest)
    except (InputError, OSError) as error:
        entry = _point(job, digest) if job.height is not None else _row(job, digest)
        by_hand = ", ".join(f"{key}: {cell}" for key, cell in entry.items() if cell not in ("", None))
        problem = f"the recording is whole ({job.path}) but could not be entered: {getattr(error, 'problem', error)}"
        mend = f"mend the sheet and add by hand: {by_hand}"
        raise InputError(job.sheet, problem, "a sheet that takes one more entry", mend) from error


def _row(job, digest):
    settings = job.settings
    return {
        "recording": job.name,
        "campaign": job.about["campaign"],
        "file": str(job.path),
        "time_column": "time",
        "time_unit": "s",
        "signal_column": take.SIGNALS[settings["signal_unit"]][0],
        "signal_unit": settings["signal_unit"],
        "counts_per_revolution": settings.get("counts_per_revolution", ""),
        "start_s": 0 if settings.get("trigger") else "",
        "role": job.about["role"],
        "sha256": digest,
    }


def _point(job, digest):
    return {
        "height": job.height,
        "limit": job.settings["height_limit"],
        "file": str(job.path),
        "time_column": "time",
        "signal_column": take.SIGNALS[job.settings["signal_unit"]][0],
        "sha256": digest,
    }


def check_room(seconds: float | None = 0.0, rate: float = 0.0, folder: str | Path = FOLDER) -> None:
    """None where the disk has room for a recording.

    Parameters
    ----------
    seconds
        How long it lasts; None: an open end.
    rate
        Samples a second.
    folder
        Where it is kept.

    Raises
    ------
    Unwritten
        If the disk has no room.
    """
    seconds = _LONG if seconds is None else seconds
    needed = seconds * rate * _ROOM + 1e6
    free = shutil.disk_usage(folder).free
    if free < needed:
        raise Unwritten(
            errno.ENOSPC,
            f"the disk is full: a recording{f' of {seconds:g} s' if seconds else ''} needs up to {needed / 1e6:.1f} MB in {folder} and {free / 1e6:.1f} MB "
            "are free. Mend: make room and run again",
        )
