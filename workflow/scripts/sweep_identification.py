"""One chunk of an identification sweep: every model fitted to every draw of its cells."""

from swingdown import console, dataset
from swingdown.sweep import identification
from swingdown.sweep.chunks import find_chunk
from swingdown.sweep.compute import compute


def sweep_chunk(book, name, output):
    data, took = compute(find_chunk(book, name), identification)
    dataset.write(data, output)
    return took


if __name__ == "__main__":
    with console.job(snakemake.log[0]) as say:
        say(sweep_chunk(snakemake.params.book, snakemake.wildcards.chunk, snakemake.output[0]))
