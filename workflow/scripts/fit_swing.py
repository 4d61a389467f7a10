"""All models fitted to one swing."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

from swingdown import console, dataset
from swingdown.pendulum.model import models, symbol
from swingdown.studies.experiment import fit_recording


def fit_swing(angle, fitted, start, output):
    fits = fit_recording(dataset.read(angle), fitted, start=start)
    dataset.write(fits, output)
    order = fits["norm"].sortby(fits["norm"])
    told = ", ".join(
        f"{symbol(str(label))} {float(norm):.4f}°"
        for label, norm in zip(order["fitted"].values, order.values, strict=True)
    )
    return f"{fits['recording'].item()}: RMS of data less fit: {told}"


if __name__ == "__main__":
    with console.job(snakemake.log[0]) as say:
        params = snakemake.params
        fitted = models(params.fitted, params.effects, **params.model)
        say(fit_swing(snakemake.input.angle, fitted, params.start, snakemake.output[0]))
