"""The manifest of a target: path, size and SHA-256 of every file that it left."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

from swingdown import console
from swingdown.manifest import write_manifest

if __name__ == "__main__":
    with console.job(snakemake.log[0]) as say:
        params, output = snakemake.params, snakemake.output[0]
        count = write_manifest("results", output, params.parts, params.without)
        say(f"{count} files in {output}")
