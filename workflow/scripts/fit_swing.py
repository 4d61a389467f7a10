"""All models fitted to one swing; or why it is no swing of a pendulum that swings by itself."""

from swingdown import console, dataset
from swingdown.errors import InputError
from swingdown.measurement.refused import doubted, problem_in, refuse
from swingdown.pendulum.model import models, symbol
from swingdown.studies.doubt import NotFree, ask, fit_any
from swingdown.studies.experiment import with_drive


def fit_swing(angle, fitted, start, output):
    if (problem := problem_in(angle)) is not None:
        return refuse(problem, dataset.attributes(angle), output, known=True)
    swing = dataset.read(angle)
    try:
        fitted = with_drive(fitted, [swing])
        fits = fit_any(swing, fitted, start)
    except InputError as problem:
        return refuse(problem, swing.attrs, output)
    doubt = None
    try:
        ask(fits, swing, fitted, start)
    except NotFree as problem:
        doubt = problem
    fits = doubted(fits, swing.attrs, doubt)
    dataset.write(fits, output)
    order = fits["norm"].sortby(fits["norm"])
    told = ", ".join(
        f"{symbol(str(label))} {float(norm):.4f}°"
        for label, norm in zip(order["fitted"].values, order.values, strict=True)
    )
    name = fits["recording"].item()
    return f"{name}: RMS of data less fit: {told}" + (f"\n{name}: NO FREE SWING: {doubt}" if doubt else "")


with console.job(snakemake.log[0]) as say:
    params = snakemake.params
    fitted = models(params.fitted, params.effects, **params.model)
    say(fit_swing(snakemake.input.angle, fitted, params.start, snakemake.output[0]))
