"""A swing, a tower height or the pendulum at rest, recorded from the board."""

import signal
import threading

from swingdown import console
from swingdown.capture import live, session
from swingdown.plots.live import Window


def capture(config, say):
    job = session.job(config)
    if config.get("recover"):
        return session.recover(job)
    views = [live.TerminalView()]
    if config.get("live"):
        try:
            views.append(Window(job.name, job.settings["signal_unit"], live.status, live.recent))
        except OSError as problem:
            say(f"no live window: {problem}. The recording goes on without it.")
    stop = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, lambda *_: stop.set())
    return session.capture(job, views, stop)


if __name__ == "__main__":
    with console.job(snakemake.log[0]) as say:
        say(capture(snakemake.params.config, say))
