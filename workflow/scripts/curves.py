"""What a pendulum shows against the amplitude, and what each law of damping leaves: a table and a picture of each."""

import pandas as pd

from swingdown import console
from swingdown.curves import laws
from swingdown.curves.chosen import of_verdict
from swingdown.curves.dataset import COLUMNS, table
from swingdown.curves.dataset import curves as curves_of
from swingdown.errors import InputError
from swingdown.language import language
from swingdown.measurement.driven import CURVES, LAWS, check_free
from swingdown.measurement.refused import used
from swingdown.measurement.sharing import in_one_step, sharing
from swingdown.pendulum.catalogue import catalogue
from swingdown.plots import absent, save
from swingdown.plots.curves import backbone, envelopes
from swingdown.plots.style import in_language
from swingdown.sealed import read_csv, read_json, write_csv
from swingdown.studies.described import described_by, values_of
from swingdown.studies.norms import combine_recordings
from swingdown.studies.pendulums import NO_MODEL, TOGETHER


class Given:
    """A campaign's recordings with what is known of them; InputError where they tell nothing of damping."""

    def __init__(self, files, campaign, params):
        self.campaign, self.known = campaign, catalogue(params.effects)
        self.restoring = params.model.get("restoring", "sine")
        pairs = [
            (used([path])[0], used([fit])[0]) for path, fit in zip(files.angles, files.fits, strict=True)
        ]
        free = [pair for pair in pairs if all(pair)]  # damping follows them; else a search may explain them
        known = [pair for pair in free or pairs if pair[0]]
        shared = sharing([angle for (angle,), _ in known])[0]
        known = [known[k] for k in shared] or known[:1]  # of what shares no model the first
        self.angles = [angle for (angle,), _ in known]
        self.fits = [fit for _, one in known for fit in one]
        self.joint = used(list(files.joint))[0] or self.fits[:1]
        self.verdicts = [read_json(path) for path in files.verdict]
        rows = read_csv(files.table)
        names = {TOGETHER, *(str(angle.attrs["recording"]) for angle in self.angles)}
        own = rows[(rows["campaign"].astype(str) == campaign) & rows["recording"].astype(str).isin(names)]
        if own.empty or not self.angles:
            raise InputError(campaign, "no recording can be used")
        self.row = own.iloc[-1].to_dict()
        self.emulated, model = str(self.row["emulated"]), str(self.row["model"])
        if model in NO_MODEL:
            raise InputError(campaign, f"damping {model}")

    def of_damping(self):
        """The model of damping that describes the recordings, and the covariance of its parameters; nothing where none follows them."""
        if not self.fits:
            return ()
        return values_of(self.joint[0], described_by(combine_recordings(self.fits), self.known), self.known)


def against(given):
    """The dataset of the curves, with the model of the search, or else that of damping; InputError where there are none."""
    check_free(given.angles, CURVES)
    found = [of_verdict(one, given.restoring, given.known) for one in given.verdicts]
    model, covariance = next(filter(None, found), None) or given.of_damping() or (None, None)
    return curves_of(in_one_step(given.angles), model, covariance, given.restoring)


def compared(given):
    """The ``Laws`` of each recording; InputError where there are none."""
    check_free(given.angles, LAWS)
    known = given.fits if len(given.fits) == len(given.angles) else [None] * len(given.angles)
    pairs = zip(given.angles, known, strict=True)
    return [laws.laws(angle, fit, given.restoring, given.known) for angle, fit in pairs]


def made(files, campaign, params, outputs):
    """Both tables and pictures written; of what there is nothing of an empty table, and a picture that says why."""
    curves, spoken = None, language(params.lang)
    try:
        given = Given(files, campaign, params)
        curves = against(given)
        written(outputs.curves, table(curves).assign(campaign=given.campaign), backbone(curves), spoken)
    except InputError as problem:
        written(
            outputs.curves, pd.DataFrame(columns=COLUMNS), absent(f"no curves: {problem.problem}"), spoken
        )
    try:
        given = Given(files, campaign, params)
        found = compared(given)
        drawn = laws.envelopes(found, curves, given.emulated)
        written(outputs.laws, laws.table(found, given.campaign), envelopes(drawn), spoken)
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
