"""The book of a sweep's chunks, copied to where all nodes can read it."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

from pathlib import Path

from swingdown import console
from swingdown.paths import written_whole


def sweep_book(book, output):
    with written_whole(output) as partial:
        partial.write_bytes(Path(book).read_bytes())


if __name__ == "__main__":
    with console.job(snakemake.log[0]):
        sweep_book(snakemake.params.book, snakemake.output[0])
