"""The sizes of the effect that follows a change, over what was changed."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

from swingdown import console
from swingdown.language import language
from swingdown.plots import save
from swingdown.plots.change import over_the_change
from swingdown.plots.style import in_language
from swingdown.sealed import read_json


def draw(difference, outputs, lang):
    figure = in_language(over_the_change(read_json(difference)), language(lang))
    for path in outputs:
        save(figure, path)


if __name__ == "__main__":
    with console.job(snakemake.log[0]):
        draw(snakemake.input[0], snakemake.output, snakemake.params.lang)
