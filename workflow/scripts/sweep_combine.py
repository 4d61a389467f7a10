"""All chunks of a sweep as one dataset, and the table of its probabilities."""

from swingdown import console
from swingdown.sealed import write_csv
from swingdown.sweep.combine import combine, read_maps
from swingdown.sweep.summary import combined, table
from swingdown.sweep.table import sweeps

with console.job(snakemake.log[0]) as say:
    chunks, made = list(snakemake.params.chunks), snakemake.output
    sweep = sweeps(snakemake.config)[snakemake.wildcards.sweep]
    combine(sweep, chunks, made.data)
    rows = table(read_maps(made.data))
    write_csv(rows, made.table)
    say("\n".join(combined(sweep, rows, len(chunks))))
