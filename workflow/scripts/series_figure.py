"""A series, or groups side by side."""

from swingdown import console
from swingdown.language import language
from swingdown.plots import save
from swingdown.plots.series import drawn
from swingdown.plots.style import in_language
from swingdown.sealed import read_csv
from swingdown.series import of_sheet

with console.job(snakemake.log[0]):
    params, table = snakemake.params, read_csv(snakemake.input.table)
    emulated = "yes" if (table["emulated"] == "yes").any() else "no"
    figure = drawn(snakemake.wildcards.kind, of_sheet(table, params.stated), emulated)
    for path in snakemake.output:
        save(in_language(figure, language(params.lang)), path)
