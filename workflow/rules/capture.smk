# A recording from hardware, only where `--config recording=NAME` asks for it.
# needs: a board at capture.port
# makes: resources/recordings/NAME.nc and its entry in the sample sheet (or, for a tower height, in the apparatus sheet)
#
# The recording is no output of the rule on purpose: Snakemake deletes outputs that it takes for outdated or unfinished, and
# runs rules whose outputs another one wants. So nothing else can start a capture, and only the script writes recordings.

import signal

# Ctrl-C ends the recording, which the script sees to. Snakemake would take it for the end of a failed job.
signal.signal(signal.SIGINT, signal.SIG_IGN)


rule capture:
    log:
        f"results/logs/capture/{config['recording']}.log",
    localrule: True
    params:
        config=config,
    message:
        f"Recording {config['recording']}"
    script:
        "../scripts/capture.py"
