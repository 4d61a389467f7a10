"""Simulated swings, noise-free and with noise, for every simulated damping term."""

from swingdown import console, dataset
from swingdown.studies.simulation import Settings, realizations

with console.job(snakemake.log[0]) as say:
    params, seed = snakemake.params, snakemake.params.seed
    settings = {key: value for key, value in params.simulation.items() if key not in ("fitted", "start")}
    data = realizations(Settings(**settings, **params.model, seed=seed))
    dataset.write(data, snakemake.output[0])
    counts = data.sizes
    say(
        f"{counts['simulated']} damping terms × {counts['realization']} noisy swings of {counts['time']} samples "
        f"({settings['stream']} stream, seed {seed})"
    )
