"""From a port to a recording on disk and its row in a sheet; and the same from the journal of a capture that was killed."""

import hashlib
import queue
import shutil
import threading
import time
from dataclasses import dataclass
from pathlib import Path

from ..errors import InputError
from . import port as ports
from . import sheets, take
from .formats import parser
from .journal import Journal, read_journal
from .recorder import DISCONNECTED, STOPPED, Recorder

FOLDER = Path("resources/recordings")
_LOOK = 0.05  # s between looks at the clock while nothing comes
_SHOW = 0.2  # s between pictures
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


def job(config):
    """The Job that complete settings (``settings.complete``) ask for.

    InputError, before anything is recorded, for whatever would stop the recording from being kept: a name that is taken, a
    sheet that cannot take the row, settings that contradict one another.
    """
    name, settings, height = config["recording"], dict(config["capture"]), config.get("height")
    still = height is not None or config.get("role") == "static"
    if still:
        settings["trigger"], settings["duration_s"] = None, settings["still_s"]
    format = parser(settings)
    if format.sequence_modulus and settings["timeout_s"] * settings["rate_hz"] > format.sequence_modulus / 4:
        most = format.sequence_modulus / 4 / settings["rate_hz"]
        raise InputError(
            "capture.timeout_s",
            f"in {settings['timeout_s']:g} s of silence the sequence numbers could come round unseen",
            f"at most {most:.3g} s at {settings['rate_hz']:g} samples a second",
            "lower capture.timeout_s",
        )
    if height is not None:
        if not config.get("apparatus"):
            raise InputError(
                "config, key height",
                "no apparatus sheet is named",
                "one, with the lengths",
                "set `apparatus`",
            )
        sheet = sheets.own(config["apparatus"], "apparatus")
        if not sheet.is_file():
            raise InputError(
                sheet, "there is no such apparatus sheet", "one with the lengths measured", "write it first"
            )
    else:
        sheet = sheets.own(config.get("recordings") or "recordings.csv", "recordings")
    made = Job(
        name,
        settings,
        {
            "recording": name,
            "campaign": settings["campaign"],
            "role": config.get("role", ""),
            "source": _source(settings),
        },
        sheet,
        height,
    )
    if not config.get("recover"):
        take.check_absent(made.path)
        try:
            FOLDER.mkdir(parents=True, exist_ok=True)
            _enter(made, "0" * 64, rehearse=True)
        except PermissionError as error:
            raise InputError(
                error.filename or sheet,
                "it may not be written by you",
                "a folder of your own",
                "name another with --directory",
            ) from error
    return made


def capture(job, views=(), stop=None):
    """A sentence on the recording that was made: at ``job.path``, with its row in the sheet.

    ``views`` have ``show(recorder)`` and ``close()``; the event ``stop`` ends the recording. InputError where the port cannot be
    used or no recording came of it, and where it is partial for another reason than ``stop`` (it is then kept all the same).
    """
    take.check_absent(job.path)
    _check_room(job)
    stop = stop or threading.Event()
    connection = ports.connect(job.settings.get("port"), job.settings["baud"])
    try:
        opened = time.time()
        journal = Journal(job.journal, {"settings": job.settings, "about": job.about, "opened": opened})
        recorder = Recorder(job.settings, opened)
        try:
            _run(recorder, connection, journal, views, stop)
        finally:
            journal.close()
            for view in views:
                view.close()
    finally:
        connection.close()
    return _close(job, recorder, journal.remove)


def recover(job):
    """A sentence on the recording made from the journal of a capture that was killed."""
    settings, pieces = read_journal(job.journal)
    if job.path.exists():  # it was killed after the recording was whole
        if not sheets.mentions(job.sheet, str(job.path)):
            _enter_whole(job)
        job.journal.unlink()
        return f"{job.name}: {job.path} was whole already; it is entered in {job.sheet}"
    kept, about, problems = settings["settings"], settings["about"], []
    recorder = _replay(kept, settings["opened"], pieces)
    if not recorder.rows and kept.get("trigger"):  # a swing that no release was seen in
        kept = kept | {"trigger": None, "duration_s": None}
        recorder = _replay(kept, settings["opened"], pieces)
        problems.append("no release was seen in it, so it is not known where the swing begins")
    recorder.end(STOPPED, "recovered from the raw stream of a capture that did not finish")
    if recorder.duration is None:
        problems.append("recovered from the raw stream of a capture that did not finish")
    found = Job(job.name, kept, {**about, "problems": problems}, job.sheet, job.height)
    return _close(found, recorder, job.journal.unlink)


def _replay(settings, opened, pieces):
    """A Recorder fed with what a journal kept."""
    recorder = Recorder(settings, opened)
    for arrival, data in pieces:
        recorder.feed(data, arrival)
    return recorder


def _run(recorder, connection, journal, views, stop):
    """Feed the recorder from the port until it ends. A thread reads, so that neither disk nor picture makes it late."""
    start = time.time() - time.monotonic()  # a clock that is set meanwhile must not make times jump
    pieces, done = queue.SimpleQueue(), threading.Event()

    def read():
        try:
            while not done.is_set():
                data = connection.read()
                pieces.put((start + time.monotonic(), data))
        except ports.GONE as error:
            pieces.put((start + time.monotonic(), error))

    reader = threading.Thread(target=read, daemon=True)
    reader.start()
    shown = 0.0
    try:
        while recorder.state != "ended":
            try:
                arrival, data = pieces.get(timeout=_LOOK)
            except queue.Empty:
                data = None  # the reader is late: no word on what came
            if isinstance(data, Exception):
                recorder.end(DISCONNECTED, f"the port went away ({data or type(data).__name__})")
            elif data:
                problem = _keep(journal, data, arrival)
                recorder.feed(data, arrival)
                if problem:
                    recorder.end(STOPPED, f"the raw stream cannot be kept on disk ({problem.strerror})")
            elif data is not None:
                recorder.tick(arrival)
            if stop.is_set():
                recorder.end(STOPPED)
            if time.monotonic() - shown > _SHOW and pieces.qsize() < 100:
                for view in views:
                    view.show(recorder)
                shown = time.monotonic()
    finally:
        done.set()
        reader.join(1)
        for view in views:
            view.show(recorder)


def _keep(journal, data, arrival):
    """None, or why the bytes could not be kept."""
    try:
        journal.add(data, arrival)
    except OSError as problem:
        return problem


def _close(job, recorder, remove_journal):
    """Write what was recorded and enter it in the sheet; the journal goes only when both are done."""
    if not recorder.rows:
        raise _nothing(job, recorder, remove_journal)
    data = take.to_dataset(recorder, dict(job.about))
    try:
        take.write_new(data, job.path)
    except OSError as error:
        raise OSError(
            error.errno,
            f"{error.strerror or error}. What arrived is kept in {job.journal}; make room, then run the same command with "
            "`recover=true`",
        ) from error
    _enter_whole(job)
    remove_journal()
    sentence = told(job, data)
    if recorder.status != STOPPED and data.attrs["partial"] == "yes":
        raise InputError(
            job.path,
            f"the recording is kept and marked partial: {data.attrs['problems']}",
            f"{data.attrs['expected']} samples without a gap; {data.attrs['received']} came",
            "record it again under another name, or write `allow` in the column partial of its row to use what there is",
        )
    return sentence


def told(job, data):
    """What the experimenter reads when the recording has ended."""
    attrs, time = data.attrs, data["time"].values
    lines = [
        f"{job.name}: {attrs['status']}{', PARTIAL' if attrs['partial'] == 'yes' else ''}: {attrs['received']} of "
        f"{attrs['expected']} samples, {time[0]:.2f} s to {time[-1]:.2f} s; {attrs['lost']} lost, {attrs['damaged']} damaged"
    ]
    if attrs["problems"]:
        lines.append(attrs["problems"])
    lines.append(
        f"{job.path}, entered in {job.sheet}" + (" (emulated)" if attrs["emulated"] == "yes" else "")
    )
    return "\n".join(lines)


def _nothing(job, recorder, remove_journal):
    if recorder.status == STOPPED:
        remove_journal()
        return InputError(
            "capture", "stopped before anything was recorded", "a release", "run the same command again"
        )
    rows = recorder.order.rows
    if rows:
        values = [row.value * recorder.scale for row in rows]
        unit = job.settings["signal_unit"]
        seen = f"; the signal was between {min(values):.5g} and {max(values):.5g} {unit} of late"
        expected = f"still for {recorder.trigger['pre_s']:g} s, then {recorder.trigger['threshold']:g} {unit} away from there"
        mend = "hold the bob still, let go when it says so; or change capture.trigger"
    elif recorder.bytes:
        seen = f"; {recorder.bytes} bytes arrived and no whole {job.settings['format']} sample among them"
        expected = f"samples in the format {job.settings['format']} at {job.settings['baud']} baud"
        mend = "correct capture.format, capture.columns or capture.baud"
    else:
        seen, expected = "", "samples"
        mend = "check the cable, the port and that the sampler is on the board (resources/firmware/README.md)"
    if rows:
        mend += (
            f". What arrived is in {job.journal}: add `recover=true` to make a recording of it, or delete it"
        )
    else:
        remove_journal()
    return InputError(
        f"capture.port, {job.settings['port']}",
        f"nothing was recorded: {recorder.status}: {recorder.reason}{seen}",
        expected,
        mend,
    )


def _enter(job, digest, rehearse=False):
    """The recording's row, or point, added to its sheet."""
    if job.height is not None:
        sheets.add_point(job.sheet, _point(job, digest), rehearse)
    else:
        sheets.add_row(job.sheet, _row(job, digest), rehearse)


def _enter_whole(job):
    """The same for a recording that is on disk; InputError tells what to add by hand."""
    digest = hashlib.sha256(job.path.read_bytes()).hexdigest()
    try:
        _enter(job, digest)
    except (InputError, OSError) as error:
        entry = _point(job, digest) if job.height is not None else _row(job, digest)
        by_hand = ", ".join(f"{key}: {cell}" for key, cell in entry.items() if cell not in ("", None))
        raise InputError(
            job.sheet,
            f"the recording is whole ({job.path}) but could not be entered: {getattr(error, 'problem', error)}",
            "a sheet that takes one more entry",
            f"mend the sheet and add by hand: {by_hand}",
        ) from error


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


def _source(settings):
    what = (
        "an emulated board; no real apparatus was recorded" if settings["emulated"] else "its owner's board"
    )
    return f"captured from {settings.get('port')}: {what}"


def _check_room(job):
    seconds = job.settings["duration_s"] or _LONG
    needed = seconds * job.settings["rate_hz"] * _ROOM + 1e6
    free = shutil.disk_usage(FOLDER).free
    if free < needed:
        raise OSError(
            28,
            f"the disk is full: a recording of {seconds:g} s needs up to {needed / 1e6:.1f} MB in {FOLDER} and {free / 1e6:.1f} MB "
            "are free. Mend: make room and run again",
        )
