"""One chunk of a sweep, of whatever the sweep computes."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

from swingdown import console
from swingdown.sweep.job import record, work


def sweep_chunk(book, chunk, results, recorded):
    told = work(book, chunk, results)
    if recorded != results:
        record(results, recorded)
    return told


if __name__ == "__main__":
    with console.job(snakemake.log[0]) as say:
        made, chunk = snakemake.output[0], snakemake.wildcards.chunk
        book = snakemake.input[0] if snakemake.input else snakemake.params.book
        say(sweep_chunk(book, chunk, snakemake.params.results or made, made))
