"""The line from voltage to angle in three modes of uncertainty, and the uncertainty budget."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

import numpy as np

from swingdown import calibration, console, dataset
from swingdown.measurement.apparatus import read_apparatus
from swingdown.measurement.recording import read_recording
from swingdown.measurement.refused import problem_in
from swingdown.sealed import write_csv


def calibrate(apparatus, rest, draws, seed, mode, line_output, budget_output):
    usable = [path for path in rest if problem_in(path) is None]
    still = read_recording(usable[0]) if usable else None
    line, budget = calibration.calibrate(read_apparatus(apparatus), still, draws=draws, seed=seed, mode=mode)
    dataset.write(line, line_output)
    write_csv(budget, budget_output)
    intercept, slope = np.degrees(line["line"].sel(mode=mode).values)
    told = [
        f"angle = {slope:.4f} °/V × voltage {intercept:+.3f}° (mode {mode}, {line.sizes['point']} tower heights)"
    ]
    told += [
        f"flagged: tower height {number}: {reason}"
        for number, reason in zip(line["point"].values, line["flag_reason"].values, strict=True)
        if str(reason)
    ]
    return "\n".join(told)


if __name__ == "__main__":
    with console.job(snakemake.log[0]) as say:
        params, files, made = snakemake.params, snakemake.input, snakemake.output
        say(
            calibrate(
                files.apparatus, files.rest, params.draws, params.seed, params.mode, made.line, made.budget
            )
        )
