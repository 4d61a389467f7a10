"""All models fitted to one swing."""

from swingdown import console, dataset
from swingdown.pendulum.model import symbol
from swingdown.studies.experiment import fit_recording


def fit_swing(angle, fitted, start, model, output):
    fits = fit_recording(dataset.read(angle), fitted, start=start, **model)
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
        say(fit_swing(snakemake.input.angle, params.fitted, params.start, params.model, snakemake.output[0]))
