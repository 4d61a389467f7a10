"""All pendulums of a study in one picture."""

from swingdown import console
from swingdown.language import language
from swingdown.plots import save
from swingdown.plots.pendulums import side_by_side
from swingdown.plots.style import in_language
from swingdown.sealed import read_csv

with console.job(snakemake.log[0]):
    figure = side_by_side(read_csv(snakemake.input.table))
    for path in snakemake.output:
        save(in_language(figure, language(snakemake.params.lang)), path)
