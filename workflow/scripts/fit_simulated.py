"""The norms of every model fitted to the noisy swings of one simulated damping term."""

from swingdown import console, dataset
from swingdown.pendulum.model import symbol
from swingdown.studies.simulation import simulation_norms

with console.job(snakemake.log[0]) as say:
    params, simulated = snakemake.params, snakemake.wildcards.simulated
    swings = dataset.read(snakemake.input.realizations)
    norms = simulation_norms(swings, simulated, params.fitted, params.start, params.effects)
    dataset.write(norms, snakemake.output[0])
    means = norms["norm"].mean("realization").sel(simulated=simulated)
    best = str(means["fitted"].values[means.argmin("fitted")])
    say(
        f"simulated {simulated}: {means.size} models × {norms.sizes['realization']} swings; "
        f"{symbol(best)} is closest to the truth ({float(means.min()):.3f}° RMS)"
    )
