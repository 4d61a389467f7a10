"""The scores of all verdicts against the truth, their summary and the confusion matrix."""

import pandas as pd
import yaml

from swingdown import console
from swingdown.pendulum.catalogue import catalogue
from swingdown.sealed import read_json, write_csv, write_text
from swingdown_trials.score import confusion, guard, reliability, row, summarise

with console.job(snakemake.log[0]) as say:
    files, made = snakemake.input, snakemake.output
    known = catalogue(snakemake.params.effects)
    rows, both = [], []
    for truth, verdict in zip(files.truths, files.verdicts, strict=True):
        true, found = read_json(truth), read_json(verdict)
        both += [(true[name], found[name]) for name in true]
        rows += [row(name, true[name], found[name], known) for name in true]
    table = pd.DataFrame(rows)
    write_csv(table, made.scores, float_format="%.6g")
    figures = summarise(table)
    write_csv(figures, made.summary, float_format="%.4g")
    write_csv(confusion(table, known), made.confusion, index=True, float_format="%.4g")
    write_csv(reliability(both), made.reliability, float_format="%.4g")
    write_text(
        made.guard,
        "# To be taken into workflow/src/swingdown/discovery/criterion.yaml, which verdicts quote.\n"
        + yaml.safe_dump(guard(table), sort_keys=False),
    )
    say("; ".join(f"{one.figure}: {one.value:.3g} of {one.n}" for one in figures.itertuples()))
