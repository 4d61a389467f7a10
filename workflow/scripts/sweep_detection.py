"""One chunk of a detection sweep: discovery's verdict on every draw of its cells."""

from swingdown import console, dataset
from swingdown.sweep import detection
from swingdown.sweep.chunks import find_chunk
from swingdown.sweep.compute import compute


def sweep_chunk(book, name, output):
    data, took = compute(find_chunk(book, name), detection)
    dataset.write(data, output)
    return took


if __name__ == "__main__":
    with console.job(snakemake.log[0]) as say:
        say(sweep_chunk(snakemake.params.book, snakemake.wildcards.chunk, snakemake.output[0]))
