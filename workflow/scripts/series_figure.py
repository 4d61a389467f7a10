"""A series, or groups side by side."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

from swingdown import console
from swingdown.language import language
from swingdown.plots import save
from swingdown.plots.series import drawn
from swingdown.plots.style import in_language
from swingdown.sealed import read_csv
from swingdown.series import of_sheet


def draw(table, stated, kind, outputs, lang):
    read = read_csv(table)
    emulated = "yes" if (read["emulated"] == "yes").any() else "no"
    figure = in_language(drawn(kind, of_sheet(read, stated), emulated), language(lang))
    for path in outputs:
        save(figure, path)


if __name__ == "__main__":
    with console.job(snakemake.log[0]):
        params = snakemake.params
        draw(snakemake.input.table, params.stated, snakemake.wildcards.kind, snakemake.output, params.lang)
