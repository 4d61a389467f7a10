"""What was asked for at the bench: a swing, a tower height, the pendulum at rest, several of these in one go, or only a look."""

import signal
import threading

from swingdown import console
from swingdown.capture import job, live, monitor, recording, session, takes
from swingdown.capture.guide import Guide
from swingdown.plots.live import Window


def capture(config, say):
    stop, leave = threading.Event(), threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, lambda number, _: [stop.set(), number == signal.SIGINT or leave.set()])
    view = live.TerminalView()
    if config.get("monitor"):
        return monitor.watch(config["capture"], view.lines, stop)
    asked = takes.takes(config)
    if config.get("recover"):
        return "\n".join(recording.recover(job.job(config | take)) for take in asked)
    jobs = [job.job(config | take, again=len(asked) > 1) for take in asked]
    views = [view]
    if config.get("live"):
        try:
            views.append(Window(jobs[0].name, jobs[0].settings["signal_unit"], live.status, live.recent))
        except OSError as problem:
            say(f"no live window: {problem}. The recording goes on without it.")
    if len(jobs) == 1:
        return recording.capture(jobs[0], views, stop)
    guide = Guide(config["capture"]["countdown_s"], stop)
    return session.run(jobs, guide, views, stop, leave, say)


with console.job(snakemake.log[0]) as say:
    say(capture(snakemake.params.config, say))
