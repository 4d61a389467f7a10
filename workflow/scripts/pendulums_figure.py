"""All pendulums of a study in one picture."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

import pandas as pd

from swingdown import console
from swingdown.plots import save
from swingdown.plots.pendulums import side_by_side


def draw(table, outputs):
    figure = side_by_side(pd.read_csv(table))
    for path in outputs:
        save(figure, path)


if __name__ == "__main__":
    with console.job(snakemake.log[0]):
        draw(snakemake.input.table, snakemake.output)
