"""Several recordings in one go: the port stays open, each is asked for in its turn and written as it ends."""

import threading

from ..console import block
from ..errors import InputError
from . import recording, source
from .journal import in_the_way
from .listener import Listener
from .monitor import Monitor, went_away


def run(jobs, guide, views=(), stop=None, leave=None, say=print):
    """A sentence on what was recorded in a session.

    Parameters
    ----------
    jobs
        In their order. What is there already is left as it is, and so is what an earlier capture left unfinished; it is named before the
        first is asked for.
    guide
        The prompts.
    views
        As of ``recording.capture``.
    stop
        The event that ends the recording that goes on, and the session where none does.
    leave
        The event that ends both.
    say
        Called with each line.

    Raises
    ------
    InputError
        At the end, if a recording did not come out whole, or none was to be made.
    """
    stop, leave = stop or threading.Event(), leave or threading.Event()
    wanted = [job for job in jobs if not job.path.exists()]
    unfinished = [job for job in wanted if job.journal.exists()]
    if not wanted:
        problem = f"all {len(jobs)} recordings are there already, and no recording is ever overwritten"
        expected = "a recording that is not there yet"
        raise InputError("config, key recording", problem, expected, "choose other names")
    for job in jobs:
        if job not in wanted:
            say(f"{job.name}: there already, and left as it is")
    for job in unfinished:
        say(block(in_the_way(job.journal)))
    asked_for = [job for job in wanted if job not in unfinished]
    if not asked_for:
        return _told(wanted, [], [job.name for job in unfinished], False)
    opened = source.connect(asked_for[0].settings)
    listener, done, failed = Listener(opened), [], [job.name for job in unfinished]
    try:
        for number, job in enumerate(asked_for, 1):
            text = f"{job.name} ({number} of {len(asked_for)}): {asked(job)}"
            # where nothing but the experimenter can tell that it may begin
            waits = job.height is not None or not job.settings.get("trigger")
            if not guide.prompt(text, waits, _looker(job, opened, listener)):
                break
            try:
                say(recording.record(job, opened, listener, views, stop))
                done.append(job.name)
            except InputError as error:
                failed.append(job.name)
                say(block(error))
            stop.clear()
            if listener.gone or leave.is_set():
                break
    finally:
        listener.close()
        guide.close()
        for view in views:
            view.close()
    return _told(wanted, done, failed, listener.gone)


def asked(job):
    """What the experimenter does for this recording."""
    if job.height is not None:
        return f"rest the bob on the tower of {job.height:g} m"
    if job.about["role"] == "static":
        return "let the bob hang at rest, and keep off the table"
    if job.settings.get("trigger"):
        return "lift the bob and hold it still where you will let it go; let go when it says ARMED"
    return "lift the bob; the recording begins when the countdown ends"


def _looker(job, opened, listener):
    """A function that takes what came meanwhile, and tells the signal in a line."""
    rate = {"rate_hz": opened.rate} if opened.rate else {}
    monitor = Monitor(job.settings | rate | {"settle_s": 0}, listener.now())

    def look():
        if found := listener.take():
            arrival, data = found
            if isinstance(data, Exception):
                raise went_away(
                    opened, data, f" before {job.name}", ": it goes on with what is not there yet"
                )
            monitor.feed(data, arrival)
        return monitor.line()

    return look


def _told(wanted, done, failed, gone):
    left = [job.name for job in wanted if job.name not in (*done, *failed)]
    sentence = f"{len(done)} of {len(wanted)} recorded"
    if left:
        sentence += f"; not yet: {', '.join(left)} (the same command goes on with them)"
    if failed or gone:
        problem = f"{sentence}; not whole, or not at all: {', '.join(failed) or 'the port went away'}"
        mend = "what the lines above say; whole recordings stay"
        raise InputError("config, key recording", problem, "recordings that are whole", mend)
    return sentence
