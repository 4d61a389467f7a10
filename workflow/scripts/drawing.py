"""A figure that takes no data, as it lies drawn beside its caption."""

import shutil

from swingdown import console
from swingdown.sealed import writing

with console.job(snakemake.log[0]):
    for source, output in zip(snakemake.input, snakemake.output, strict=True):
        with writing(output) as partial:
            shutil.copyfile(source, partial)
