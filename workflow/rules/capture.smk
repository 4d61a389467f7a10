# What happens at the bench, only where `--config recording=NAME`, `session=true` or `monitor=true` asks for it.
# needs: a board, or a converter, at capture.port
# makes: resources/recordings/NAME.nc and its entry in the sample sheet (or, for a tower height, in the apparatus sheet), for
#        each recording that is asked for; nothing where only the signal is watched
#
# The recording is no output of the rule on purpose: Snakemake deletes outputs that it takes for outdated or unfinished, and
# runs rules whose outputs another one wants. So nothing else can start a capture, and only the script writes recordings.
# Several recordings are one job, not one each: the port stays open, and a person is led from one to the next.

import signal

from swingdown.capture.job import check_room

# Ctrl-C ends the recording, which the script sees to. Snakemake would take it for the end of a failed job.
signal.signal(signal.SIGINT, signal.SIG_IGN)

with console.job():
    if not config.get("monitor"):
        NAMES = [take["recording"] for take in takes.takes(config)]
        BENCH = f"Recording {', '.join(NAMES)}", NAMES[0]
        check_room(folder=".")
    else:
        BENCH = "Watching the signal; nothing is recorded (Ctrl-C ends it)", "monitor"


rule capture:
    log:
        f"results/logs/capture/{BENCH[1]}.log",
    localrule: True
    params:
        config=config,
    message:
        BENCH[0]
    script:
        "../scripts/capture.py"
