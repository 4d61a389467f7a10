"""The scores of all verdicts against the truth, their summary and the confusion matrix."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

import pandas as pd
import yaml

from swingdown import console
from swingdown.pendulum.catalogue import catalogue
from swingdown.sealed import read_json, write_csv, write_text
from swingdown_trials.reliability import reliability
from swingdown_trials.score import confusion, guard, row, summarise


def score(truths, verdicts, known, scores, summary, matrix, reliable, guarded):
    """The tables written, and what they say in a line."""
    rows, both = [], []
    for truth, verdict in zip(truths, verdicts, strict=True):
        true, found = (read_json(path) for path in (truth, verdict))
        both += [(true[name], found[name]) for name in true]
        rows += [row(name, true[name], found[name], known) for name in true]
    table = pd.DataFrame(rows)
    write_csv(table, scores, float_format="%.6g")
    figures = summarise(table)
    write_csv(figures, summary, float_format="%.4g")
    write_csv(confusion(table, known), matrix, index=True, float_format="%.4g")
    write_csv(reliability(both), reliable, float_format="%.4g")
    write_text(
        guarded,
        "# To be taken into workflow/src/swingdown/discovery/guard.yaml, which verdicts quote.\n"
        + yaml.safe_dump(guard(table), sort_keys=False),
    )
    return "; ".join(f"{one.figure}: {one.value:.3g} of {one.n}" for one in figures.itertuples())


if __name__ == "__main__":
    with console.job(snakemake.log[0]) as say:
        inputs, output = snakemake.input, snakemake.output
        known = catalogue(snakemake.params.effects)
        say(
            score(
                inputs.truths, inputs.verdicts, known, output.scores, output.summary, output.confusion,
                output.reliability, output.guard,
            )
        )  # fmt: skip
