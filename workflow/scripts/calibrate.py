"""The line from voltage to angle in three modes of uncertainty, and the uncertainty budget."""

import numpy as np

from swingdown import calibration, console, dataset
from swingdown.measurement.apparatus import read_apparatus
from swingdown.measurement.recording import read_recording
from swingdown.measurement.refused import problem_in
from swingdown.sealed import write_csv

with console.job(snakemake.log[0]) as say:
    params, files, made = snakemake.params, snakemake.input, snakemake.output
    usable = [path for path in files.rest if problem_in(path) is None]
    still = read_recording(usable[0]) if usable else None
    line, budget = calibration.calibrate(
        read_apparatus(files.apparatus), still, draws=params.draws, seed=params.seed, mode=params.mode
    )
    dataset.write(line, made.line)
    write_csv(budget, made.budget)
    intercept, slope = np.degrees(line["line"].sel(mode=params.mode).values)
    count = line.sizes["point"]
    say(f"angle = {slope:.4f} °/V × voltage {intercept:+.3f}° (mode {params.mode}, {count} tower heights)")
    for number, reason in zip(line["point"].values, line["flag_reason"].values, strict=True):
        if str(reason):
            say(f"flagged: tower height {number}: {reason}")
