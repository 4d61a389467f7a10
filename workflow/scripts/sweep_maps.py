"""One picture of a sweep's probabilities, as SVG and PNG."""

from swingdown import console
from swingdown.plots import save
from swingdown.plots.sweep import MAPS
from swingdown.sweep.combine import read_maps

with console.job(snakemake.log[0]):
    figure = MAPS[snakemake.wildcards.map](read_maps(snakemake.input.data))
    for path in snakemake.output:
        save(figure, path)
