"""The confusion matrix of hidden effects, and how often they are found by size."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

from pathlib import Path

from swingdown import console
from swingdown.plots import save, trials
from swingdown.sealed import read_csv
from swingdown_trials.score import read_scores


def figures(scores, confusion, outputs):
    """Each of the outputs written."""
    drawn = {
        "confusion": trials.confusion(read_csv(confusion)),
        "detection": trials.detection(read_scores(scores)),
    }
    for output in map(Path, outputs):
        save(drawn[output.stem], output)


if __name__ == "__main__":
    with console.job(snakemake.log[0]):
        figures(snakemake.input.scores, snakemake.input.confusion, snakemake.output)
