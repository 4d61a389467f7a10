"""The sizes of the effect that follows a change, over what was changed."""

from swingdown import console
from swingdown.language import language
from swingdown.plots import save
from swingdown.plots.change import over_the_change
from swingdown.plots.style import in_language
from swingdown.sealed import read_json

with console.job(snakemake.log[0]):
    figure = over_the_change(read_json(snakemake.input[0]))
    for path in snakemake.output:
        save(in_language(figure, language(snakemake.params.lang)), path)
