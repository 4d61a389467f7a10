"""Campaigns with hidden effects: a sample sheet with its CSV files, and the truth in another place."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

from pathlib import Path

import pandas as pd

from swingdown import console
from swingdown.measurement.apparatus import read_apparatus
from swingdown.pendulum.catalogue import catalogue
from swingdown.sealed import write_csv, write_json
from swingdown_trials.schedule import Planned, drawn
from swingdown_trials.trial import write_trial


def make(chunk, trials, seed, known, apparatus, sheet, excluded, truth):
    """The chunk's files written, and how many trials it has."""
    folder = Path(sheet).parent
    folder.mkdir(parents=True, exist_ok=True)
    rows, truths, lacks = [], {}, {}
    for number, one in enumerate(map(Planned._make, trials), 1):
        trial = drawn(seed, one, known)
        if trial is None:  # no size within reason leaves such a residual
            continue
        name = f"c{chunk}{number:02d}"
        more, truths[name] = write_trial(trial, seed, name, folder, known, apparatus)
        rows += more
        if trial.kind == "removed":
            lacks[name] = list(trial.hidden)
    write_csv(pd.DataFrame(rows), sheet)
    write_json(excluded, lacks)
    write_json(truth, truths)
    return f"{len(truths)} of {len(trials)} trials drawn"


if __name__ == "__main__":
    with console.job(snakemake.log[0]) as say:
        params, output = snakemake.params, snakemake.output
        known = catalogue(params.effects)
        apparatus = read_apparatus(snakemake.input.apparatus, check_files=False)
        say(
            make(
                snakemake.wildcards.chunk, params.trials, params.seed, known, apparatus, output.sheet, output.excluded,
                output.truth,
            )
        )  # fmt: skip
