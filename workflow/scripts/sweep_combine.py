"""All chunks of a sweep as one dataset, and the table of its probabilities."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

from swingdown import console
from swingdown.sealed import write_csv
from swingdown.sweep.combine import combine, read_maps
from swingdown.sweep.summary import combined, table
from swingdown.sweep.table import sweeps


def sweep_combine(sweep, chunks, data_output, table_output):
    combine(sweep, chunks, data_output)
    rows = table(read_maps(data_output))
    write_csv(rows, table_output)
    return "\n".join(combined(sweep, rows, len(chunks)))


if __name__ == "__main__":
    with console.job(snakemake.log[0]) as say:
        made = snakemake.output
        sweep = sweeps(snakemake.config)[snakemake.wildcards.sweep]
        say(sweep_combine(sweep, list(snakemake.params.chunks), made.data, made.table))
