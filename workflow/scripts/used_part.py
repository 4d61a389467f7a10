"""One recording as it was read, and which part of it is used, as SVG and PNG."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

from swingdown import console
from swingdown.measurement.recording import read_recording
from swingdown.plots import save
from swingdown.plots.recordings import used_part

if __name__ == "__main__":
    with console.job(snakemake.log[0]):
        drawn = used_part(read_recording(snakemake.input.recording))
        for path in snakemake.output:
            save(drawn, path)
