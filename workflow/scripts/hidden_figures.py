"""The confusion matrix of hidden effects, and how often they are found by size."""

from pathlib import Path

from swingdown import console
from swingdown.plots import save, trials
from swingdown.sealed import read_csv
from swingdown_trials.score import read_scores

with console.job(snakemake.log[0]):
    files = snakemake.input
    drawn = {
        "confusion": trials.confusion(read_csv(files.confusion)),
        "detection": trials.detection(read_scores(files.scores)),
    }
    for output in snakemake.output:
        save(drawn[Path(output).stem], output)
