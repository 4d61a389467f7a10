"""A figure that takes no data, as it lies drawn beside its caption."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

import shutil

from swingdown import console
from swingdown.sealed import writing


def drawing(drawn, outputs):
    for source, output in zip(drawn, outputs, strict=True):
        with writing(output) as partial:
            shutil.copyfile(source, partial)


if __name__ == "__main__":
    with console.job(snakemake.log[0]):
        drawing(snakemake.input, snakemake.output)
