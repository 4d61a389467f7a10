"""All models fitted to the swings of one campaign together: shared parameters, a release for each swing."""

import numpy as np

from swingdown import console, dataset
from swingdown.errors import InputError
from swingdown.measurement.refused import refuse, taking_part
from swingdown.measurement.sharing import sharing
from swingdown.pendulum.model import models, symbol
from swingdown.studies import experiment


def fit_campaign(angles, alone, campaign, fitted, start, output):
    """The joint fit written, of the swings whose fits ``alone`` say that they can be used and that share a model; or why there is none."""
    kept, _ = taking_part(alone, [campaign])
    used = [dataset.read(path) for path, fit in zip(angles, alone, strict=True) if fit in kept]
    used = [used[k] for k in sharing(used)[0]]
    try:
        if len(used) < 2:
            problem = f"{len(used)} of its {len(angles)} swings can be used"
            raise InputError(f"campaign {campaign}", problem, "two or more to be fitted together")
        fits = experiment.fit_campaign(used, experiment.with_drive(fitted, used), start=start)
    except InputError as problem:
        return refuse(problem, {"campaign": campaign}, output)
    dataset.write(fits, output)
    norms = np.sqrt((fits["norm"] ** 2).mean("recording"))
    best = str(norms["fitted"].values[norms.argmin("fitted")])
    return (
        f"{campaign}: {len(used)} swings together: {symbol(best)} leaves least, {float(norms.min()):.4f}° RMS"
    )


with console.job(snakemake.log[0]) as say:
    params, campaign = snakemake.params, snakemake.wildcards.campaign
    fitted = models(params.fitted, params.effects, **params.model)
    files = snakemake.input
    say(fit_campaign(files.angles, files.fits, campaign, fitted, params.start, snakemake.output[0]))
