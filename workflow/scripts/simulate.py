"""Simulated swings, noise-free and with noise, for every simulated damping term."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

from swingdown import console, dataset
from swingdown.studies.simulation import Settings, realizations


def simulate(simulation, model, seed, output):
    settings = {key: value for key, value in simulation.items() if key not in ("fitted", "start")}
    data = realizations(Settings(**settings, **model, seed=seed))
    dataset.write(data, output)
    counts = data.sizes
    return (
        f"{counts['simulated']} damping terms × {counts['realization']} noisy swings of {counts['time']} samples "
        f"({simulation['stream']} stream, seed {seed})"
    )


if __name__ == "__main__":
    with console.job(snakemake.log[0]) as say:
        params = snakemake.params
        say(simulate(params.simulation, params.model, params.seed, snakemake.output[0]))
