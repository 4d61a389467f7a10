"""One recording as it was read, and which part of it is used, as SVG and PNG."""

from swingdown import console
from swingdown.measurement.recording import read_recording
from swingdown.plots import save
from swingdown.plots.recordings import used_part

with console.job(snakemake.log[0]):
    drawn = used_part(read_recording(snakemake.input.recording))
    for path in snakemake.output:
        save(drawn, path)
