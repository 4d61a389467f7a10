"""The manifest of a target: path, size and SHA-256 of every file that it left."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

from pathlib import Path

from swingdown import console
from swingdown.manifest import write_manifest


def check_stores(results):
    """None where the stores of sweeps are what was written."""
    for folder in sorted(path.parent for path in Path(results).glob("sweeps/*/draws.zarr")):
        from swingdown.sweep import store  # takes a while to import, and few studies have one

        store.check(folder)


if __name__ == "__main__":
    with console.job(snakemake.log[0]) as say:
        params, output = snakemake.params, snakemake.output[0]
        if "sweeps" in params.parts:
            check_stores("results")
        count = write_manifest("results", output, params.parts, params.without)
        say(f"{count} files in {output}")
