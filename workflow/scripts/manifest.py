"""The manifest of a target: path, size and SHA-256 of every file that it left."""

from pathlib import Path

from swingdown import console
from swingdown.manifest import write_manifest

with console.job(snakemake.log[0]) as say:
    params, output = snakemake.params, snakemake.output[0]
    stores = Path("results").glob("sweeps/*/draws.zarr") if "sweeps" in params.parts else ()
    for path in sorted(stores):
        from swingdown.sweep import store  # takes a while to import, and few studies have one

        store.check(path.parent)
    say(f"{write_manifest('results', output, params.parts, params.without)} files in {output}")
