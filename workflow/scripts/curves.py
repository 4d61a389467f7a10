"""What a pendulum shows against the amplitude, and what each law of damping leaves: a table and a picture of each."""

import pandas as pd

from swingdown import console
from swingdown.curves import laws
from swingdown.curves.campaign import recorded
from swingdown.curves.dataset import COLUMNS, table
from swingdown.errors import InputError
from swingdown.language import language
from swingdown.measurement.refused import used
from swingdown.pendulum.catalogue import catalogue
from swingdown.plots import absent, save
from swingdown.plots.curves import backbone, envelopes
from swingdown.plots.style import in_language
from swingdown.sealed import read_csv, read_json, write_csv


def given(files, campaign, params):
    """The campaign as its files hold it."""
    pairs = [tuple(map(one_of, pair)) for pair in zip(files.angles, files.fits, strict=True)]
    verdicts, known = [read_json(path) for path in files.verdict], catalogue(params.effects)
    restoring = params.model.get("restoring", "sine")
    return recorded(
        campaign, pairs, used(list(files.joint))[0], verdicts, read_csv(files.table), known, restoring
    )


def one_of(path):
    """The dataset of a file; None of a recording that was refused."""
    kept, _ = used([path])
    return kept[0] if kept else None


def made(files, campaign, params, outputs):
    """Both tables and pictures written; of what there is nothing of an empty table, and a picture that says why."""
    curves, spoken = None, language(params.lang)
    try:
        curves = given(files, campaign, params).curves()
        written(outputs.curves, table(curves).assign(campaign=campaign), backbone(curves), spoken)
    except InputError as problem:
        written(
            outputs.curves, pd.DataFrame(columns=COLUMNS), absent(f"no curves: {problem.problem}"), spoken
        )
    try:
        one = given(files, campaign, params)
        found = one.laws()
        drawn = laws.envelopes(found, curves, one.emulated)
        written(outputs.laws, laws.table(found, campaign), envelopes(drawn), spoken)
    except InputError as problem:
        none = absent(f"no laws of damping: {problem.problem}")
        written(outputs.laws, pd.DataFrame(columns=laws.COLUMNS), none, spoken)


def written(outputs, rows, figure, spoken):
    """A table and its picture in the files that are named."""
    write_csv(rows, outputs[0], float_format="%.9g")
    for path in outputs[1:]:
        save(in_language(figure, spoken), path)


with console.job(snakemake.log[0]):
    made(snakemake.input, snakemake.wildcards.campaign, snakemake.params, snakemake.output)
