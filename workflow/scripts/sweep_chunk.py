"""One chunk of a sweep, of whatever the sweep computes."""

from swingdown import console
from swingdown.sweep.job import record, work

with console.job(snakemake.log[0]) as say:
    made, params = snakemake.output[0], snakemake.params
    book = snakemake.input[0] if snakemake.input else params.book
    say(work(book, snakemake.wildcards.chunk, params.results or made))
    if params.results:
        record(params.results, made)
