"""The norms of every model fitted to the noisy swings of one simulated damping term."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

from swingdown import console, dataset
from swingdown.pendulum.model import symbol
from swingdown.studies.simulation import simulation_norms


def fit_simulated(realizations, simulated, fitted, start, effects, output):
    norms = simulation_norms(dataset.read(realizations), simulated, fitted, start, effects)
    dataset.write(norms, output)
    means = norms["norm"].mean("realization").sel(simulated=simulated)
    best = str(means["fitted"].values[means.argmin("fitted")])
    return (
        f"simulated {simulated}: {means.size} models × {norms.sizes['realization']} swings; "
        f"{symbol(best)} is closest to the truth ({float(means.min()):.3f}° RMS)"
    )


if __name__ == "__main__":
    with console.job(snakemake.log[0]) as say:
        params = snakemake.params
        simulated = snakemake.wildcards.simulated
        say(
            fit_simulated(
                snakemake.input.realizations, simulated, params.fitted, params.start, params.effects,
                snakemake.output[0],
            )
        )  # fmt: skip
