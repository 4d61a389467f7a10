"""The book of a sweep's chunks, copied to where all nodes can read it."""

import shutil

from swingdown import console
from swingdown.paths import written_whole

with console.job(snakemake.log[0]), written_whole(snakemake.output[0]) as partial:
    shutil.copyfile(snakemake.params.book, partial)
