"""Simulated swings, noise-free and with noise, for every simulated damping term."""

from swingdown import console, dataset
from swingdown.studies.simulation import realizations

with console.job(snakemake.log[0]) as say:
    params, chosen = snakemake.params, dict(snakemake.params.simulation)
    simulated, copies, *_ = (chosen.pop(key) for key in ("simulated", "realizations", "fitted", "start"))
    data = realizations(simulated, copies, chosen | params.model | {"seed": params.seed})
    dataset.write(data, snakemake.output[0])
    counts = data.sizes
    say(
        f"{counts['simulated']} damping terms × {counts['realization']} noisy swings of {counts['time']} samples "
        f"({chosen['stream']} stream, seed {params.seed})"
    )
