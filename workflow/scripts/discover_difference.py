"""The sizes of the effect that follows a change, over what was changed."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

from swingdown import console
from swingdown.plots import save
from swingdown.plots.change import over_the_change
from swingdown.sealed import read_json


def draw(difference, outputs):
    figure = over_the_change(read_json(difference))
    for path in outputs:
        save(figure, path)


if __name__ == "__main__":
    with console.job(snakemake.log[0]):
        draw(snakemake.input[0], snakemake.output)
