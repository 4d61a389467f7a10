"""From a source to a recording on disk and its row in a sheet; and the same from the journal of a capture that was killed."""

import threading
import time
from dataclasses import replace

from ..errors import InputError
from . import sheets, source, take
from .job import Job, check_room, enter_whole
from .journal import Journal, read_journal, recovery
from .listener import LOOK, Listener
from .recorder import DISCONNECTED, STOPPED, TIMED_OUT, Recorder

_SHOW = 0.2  # s between pictures
_MANY = 100  # pieces that wait; with more there is no time for pictures


def capture(job: Job, views=(), stop: threading.Event | None = None) -> str:
    """A sentence on the recording that was made: at ``job.path``, with its row in the sheet.

    Parameters
    ----------
    job
        What is asked for, as ``job.job`` returns it.
    views
        Have ``show(recorder)`` and ``close()``.
    stop
        The event that ends the recording.

    Raises
    ------
    InputError
        If the port cannot be used, or no recording came of it. Also if it is partial for another reason than ``stop``: it is then kept all
        the same.
    """
    take.check_absent(job.path)
    check_room(job.settings["duration_s"], job.settings["rate_hz"])
    opened = source.connect(job.settings)
    listener = Listener(opened)
    try:
        return record(job, opened, listener, views, stop)
    finally:
        listener.close()
        for view in views:
            view.close()


def record(job, opened, listener, views=(), stop=None):
    """A sentence on the recording that was made, as ``capture`` does, from a source that is open already and stays open.

    Parameters
    ----------
    job, views, stop
        As of ``capture``, and so are the errors.
    opened
        The source, as ``source.connect`` returns it.
    listener
        Reads it.
    """
    take.check_absent(job.path)
    check_room(job.settings["duration_s"], job.settings["rate_hz"])
    began = listener.now()
    settled = began - listener.began
    settings = job.settings | {"settle_s": max(job.settings["settle_s"] - settled, 0.0)}
    if opened.rate:
        settings["rate_hz"] = opened.rate
    about = {**job.about, "source": told_source(settings, opened.name)}
    if opened.what:
        about["remarks"] = [opened.what]
    job = replace(job, settings=settings, about=about)
    kept = {"settings": settings, "about": about, "opened": began}
    journal = Journal(job.journal, kept | {"height": job.height, "sheet": str(job.sheet)})
    recorder = Recorder(settings, began)
    try:
        _run(recorder, listener, journal, views, stop or threading.Event())
    finally:
        journal.close()
    if events := [text for at, text in opened.events if at >= began]:
        job = replace(job, about={**job.about, "remarks": [*job.about.get("remarks", ()), *events]})
    return _close(job, recorder, journal.remove)


def told_source(settings, name):
    """Where a recording comes from, as an attribute of it."""
    board = "its owner's board"
    if settings["emulated"]:
        board = "an emulated board; no real apparatus was recorded"
    return f"captured from {name}: {board}"


def recover(job: Job) -> str:
    """A sentence on the recording made from the journal of a capture that was killed; InputError if there is none, or no recording comes of it.

    Of the ``job`` the name counts: what the journal holds (settings, height of a tower, the sheet) goes before what the command says.
    """
    kept, pieces = read_journal(job.journal)
    if "sheet" in kept:  # one that is older does not tell
        job = replace(job, height=kept["height"], sheet=sheets.own(kept["sheet"], "recordings"))
    job = replace(job, settings=kept["settings"], about=job.about | kept["about"])
    if job.path.exists():  # it was killed after the recording was whole
        if not sheets.mentions(job.sheet, str(job.path)):
            enter_whole(job)
        job.journal.unlink()
        return f"{job.name}: {job.path} was whole already; it is entered in {job.sheet}"
    settings, problems = kept["settings"], []
    recorder = _replay(settings, kept["opened"], pieces)
    if not recorder.rows and settings.get("trigger"):  # a swing that no release was seen in
        settings = settings | {"trigger": None, "duration_s": None}
        recorder = _replay(settings, kept["opened"], pieces)
        problems.append("no release was seen in it, so it is not known where the swing begins")
    recorder.end(STOPPED, "recovered from the raw stream of a capture that did not finish")
    if recorder.duration is None:
        problems.append("recovered from the raw stream of a capture that did not finish")
    found = replace(job, settings=settings, about={**job.about, "problems": problems})
    return _close(found, recorder, job.journal.unlink)


def _replay(settings, opened, pieces):
    """A Recorder fed with what a journal kept."""
    recorder = Recorder(settings, opened)
    for arrival, data in pieces:
        recorder.feed(data, arrival)
    return recorder


def _run(recorder, listener, journal, views, stop):
    """Feed the recorder from the listener until it ends."""
    shown, mute = 0.0, 0
    while recorder.state != "ended":
        arrival, data = listener.take() or (None, None)  # a thread that is late gives no word on what came
        mute = mute + 1 if arrival is None else 0
        if mute * LOOK > recorder.patience:
            recorder.end(TIMED_OUT, f"for {mute * LOOK:.1f} s the port did not answer")
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
        if time.monotonic() - shown > _SHOW and listener.behind < _MANY:
            for view in views:
                view.show(recorder)
            shown = time.monotonic()
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
            f"{error.strerror or error}. What arrived is kept in {job.journal}; make room, then "
            f"{recovery(job.journal)} makes the recording",
        ) from error
    except RuntimeError as error:  # what the netCDF library raises where there is room and it may not be used
        raise InputError(
            job.path,
            f"it cannot be written ({error}); what arrived is kept in {job.journal}",
            "a file system that takes the file, and no limit on its size (`ulimit -f`)",
            f"lift the limit, then {recovery(job.journal)} makes the recording",
        ) from error
    enter_whole(job)
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
    lines += filter(None, (attrs["problems"], attrs["remarks"]))
    lines.append(
        f"{job.path}, entered in {job.sheet}" + (" (emulated)" if attrs["emulated"] == "yes" else "")
    )
    return "\n".join(lines)


def _nothing(job, recorder, remove_journal):
    if recorder.status == STOPPED:
        remove_journal()
        problem = "stopped before anything was recorded"
        return InputError("capture", problem, "a release", "run the same command again")
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
        mend += f". What arrived is in {job.journal}: {recovery(job.journal)} makes a recording of it; or delete it"
    else:
        remove_journal()
    return InputError(
        f"capture.port, {job.settings.get('port') or 'the board that was found'}",
        f"nothing was recorded: {recorder.status}: {recorder.reason}{seen}",
        expected,
        mend,
    )
