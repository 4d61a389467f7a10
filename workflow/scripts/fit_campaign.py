"""All models fitted to the swings of one campaign together: shared parameters, a release for each swing."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

import numpy as np

from swingdown import console, dataset
from swingdown.pendulum.model import models, symbol
from swingdown.studies import experiment


def fit_campaign(angles, campaign, fitted, start, output):
    fits = experiment.fit_campaign([dataset.read(path) for path in angles], fitted, start=start)
    dataset.write(fits, output)
    norms = np.sqrt((fits["norm"] ** 2).mean("recording"))
    best = str(norms["fitted"].values[norms.argmin("fitted")])
    return f"{campaign}: {len(angles)} swings together: {symbol(best)} leaves least, {float(norms.min()):.4f}° RMS"


if __name__ == "__main__":
    with console.job(snakemake.log[0]) as say:
        params, campaign = snakemake.params, snakemake.wildcards.campaign
        fitted = models(params.fitted, params.effects, **params.model)
        say(fit_campaign(snakemake.input.angles, campaign, fitted, params.start, snakemake.output[0]))
