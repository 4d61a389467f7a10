"""All pendulums of a study in one picture."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

from swingdown import console
from swingdown.language import language
from swingdown.plots import save
from swingdown.plots.pendulums import side_by_side
from swingdown.plots.style import in_language
from swingdown.sealed import read_csv


def draw(table, outputs, lang):
    figure = in_language(side_by_side(read_csv(table)), language(lang))
    for path in outputs:
        save(figure, path)


if __name__ == "__main__":
    with console.job(snakemake.log[0]):
        draw(snakemake.input.table, snakemake.output, snakemake.params.lang)
