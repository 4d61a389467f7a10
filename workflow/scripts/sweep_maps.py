"""One picture of a sweep's probabilities, as SVG and PNG."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

from swingdown import console
from swingdown.plots import save
from swingdown.plots.sweep import MAPS
from swingdown.sweep.combine import read_maps


def sweep_maps(name, data, outputs):
    drawn = MAPS[name](read_maps(data))
    for path in outputs:
        save(drawn, path)


if __name__ == "__main__":
    with console.job(snakemake.log[0]):
        sweep_maps(snakemake.wildcards.map, snakemake.input.data, snakemake.output)
