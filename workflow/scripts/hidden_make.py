"""Campaigns with hidden effects: a sample sheet with its CSV files, and the truth in another place."""

from pathlib import Path

import pandas as pd

from swingdown import console
from swingdown.measurement.apparatus import read_apparatus
from swingdown.pendulum.catalogue import catalogue
from swingdown.sealed import write_csv, write_json
from swingdown_trials.schedule import Planned, drawn
from swingdown_trials.trial import write_trial

with console.job(snakemake.log[0]) as say:
    params, files = snakemake.params, snakemake.output
    seed, known = params.seed, catalogue(params.effects)
    apparatus = read_apparatus(snakemake.input.apparatus, check_files=False)
    folder = Path(files.sheet).parent
    folder.mkdir(parents=True, exist_ok=True)
    rows, truths, lacks = [], {}, {}
    for number, one in enumerate(map(Planned._make, params.trials), 1):
        trial = drawn(seed, one, known)
        if trial is None:  # no size within reason leaves such a residual
            continue
        name = f"c{snakemake.wildcards.chunk}{number:02d}"
        more, truths[name] = write_trial(trial, seed, name, folder, known, apparatus)
        rows += more
        if trial.kind == "removed":
            lacks[name] = list(trial.hidden)
    write_csv(pd.DataFrame(rows), files.sheet)
    write_json(files.excluded, lacks)
    write_json(files.truth, truths)
    say(f"{len(truths)} of {len(params.trials)} trials drawn")
