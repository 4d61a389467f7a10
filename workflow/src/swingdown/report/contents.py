"""What the report says: one function for each section. A further section is a further function in ``SECTIONS``."""

from dataclasses import dataclass, field
from pathlib import Path

import pandas as pd
import yaml
from markupsafe import Markup, escape

from ..model import symbol
from ..simulation import INFERRED_NOTE
from . import numbers, provenance
from .page import Column, Figure, Findings, Listing, Section, Table, Text

EMULATED = (
    "The bench of this report is emulated. The paper's raw data were never published; the recordings of the campaign "
    "{campaigns} come from a simulated apparatus with known truth, not from a pendulum."
)


@dataclass(frozen=True)
class Material:
    """What a report is made from.

    ``tables``: name of a file in ``results/tables`` without ending: DataFrame. ``figures``: name (``fig08``): path of
    the picture and caption. ``recordings``: the attributes of each recording. ``settings``: the complete config.
    """

    tables: dict
    figures: dict
    recordings: list
    settings: dict
    inputs: list = field(default_factory=list)  # files whose checksums are told

    @property
    def emulated(self):
        """The campaigns that come from an emulated apparatus, each once."""
        return list(dict.fromkeys(r["campaign"] for r in self.recordings if r.get("emulated") == "yes"))

    def shown(self, *names):
        """The figures of those names that were made."""
        return [
            Figure(f"Figure {int(name.removeprefix('fig'))}", *self.figures[name])
            for name in names
            if name in self.figures
        ]


def sections(material):
    """The report's sections in reading order; a section with nothing to show is left out."""
    return [section for make in SECTIONS if (section := make(material)) and section.items]


def head(material):
    """Title, subtitle, footer, and the notices that a reader must see before anything else."""
    swings = [recording for recording in material.recordings if recording.get("role") != "static"]
    campaigns = ", ".join(dict.fromkeys(recording["campaign"] for recording in swings))
    subtitle = f"{len(swings)} swings of {campaigns}" if swings else "simulation study"
    notices = [EMULATED.format(campaigns=", ".join(material.emulated))] if material.emulated else []
    footer = "Made by swingdown. The datasets behind every table and figure lie in the results folder beside this page."
    return {
        "title": "Damping of a swinging pendulum",
        "subtitle": subtitle,
        "notices": notices,
        "footer": footer,
    }


def plain_findings(material):
    """The findings as plain text, for the terminal."""
    items = findings(material).items
    return [Markup(line).striptags() for line in items[0].lines] if items else []


def model_symbol(label):
    """A model's symbol as HTML, the effects as subscript; ``error bounds`` and the like as they are."""
    try:
        text = symbol(label)
    except ValueError:
        return Markup(escape(label.replace("_", " ")))
    return Markup(f"{text[0]}<sub>{escape(text[1:])}</sub>")


# --- the sections -------------------------------------------------------------------------------------------------


def findings(material):
    """The sentences that open the report."""
    lines = []
    table, comparison = material.tables.get("table3"), material.tables.get("comparison")
    for campaign, rows in table.groupby("campaign", sort=False) if table is not None else ():
        lines += _experiment_findings(campaign, rows, comparison, material)
    if (table := material.tables.get("table2")) is not None:
        compared = table.dropna(subset=["published_mean", "published_std"])
        inside = (compared["mean"] - compared["published_mean"]).abs() <= compared["published_std"]
        lines.append(
            f"Simulation: {inside.sum()} of the {len(compared)} mean norms of the paper's Table 2 are reproduced within its own "
            "standard deviation, with settings inferred from that table."
            if len(compared)
            else f"Simulation: {len(table)} mean norms, none of which the paper tells."
        )
    return Section("Findings", [Findings(lines)] if lines else [])


def _experiment_findings(campaign, rows, comparison, material):
    models = rows[rows["fitted"] != "error_bounds"]
    if models.empty:
        return []
    best = models.loc[models["bic"].idxmin()]
    lines = [
        Markup(
            "{}: of {} models, {} has the lowest BIC; it leaves {}° RMS (mean ± std over {} swings)."
        ).format(
            campaign,
            len(models),
            model_symbol(best["fitted"]),
            numbers.spread(best["mean"], best["std"]),
            int(best["n"]),
        )
    ]
    bounds = rows[rows["fitted"] == "error_bounds"]
    if len(bounds):
        bound = bounds.iloc[0]
        reaches = "within" if best["mean"] <= bound["mean"] else "above"
        lines.append(
            f"{campaign}: that is {reaches} the bounds of the measured angle ({numbers.spread(bound['mean'], bound['std'])}°)."
        )
    if comparison is not None:
        pairs = comparison[comparison["campaign"] == campaign]
        pairs = pairs[(pairs["model_a"] == best["fitted"]) | (pairs["model_b"] == best["fitted"])]
        lines += [f"{campaign}: {text}" for text in pairs["verdict"] if "indistinguishable" in str(text)]
    return lines


def simulation(material):
    """The simulation study: Table 2 and its figures."""
    table = material.tables.get("table2")
    if table is None:
        return None
    settings = material.settings["simulation"]
    columns = [
        Column("simulated"), Column("fitted"), Column("norm, Nelder–Mead", "degrees", "n"),
        Column("norm, least squares", "degrees", "n"), Column("paper", "degrees", "n"), Column("n", style="n"),
    ]  # fmt: skip
    rows = [
        [
            model_symbol(row.simulated), model_symbol(row.fitted), numbers.spread(row.mean, row.std),
            numbers.spread(row.mean_least_squares, row.std_least_squares),
            numbers.spread(row.published_mean, row.published_std), int(row.n),
        ]
        for row in table.itertuples()
    ]  # fmt: skip
    caption = (
        f"Simulated swings ({settings['realizations']} noisy copies of each, signal to noise {settings['snr']:g}): norm of fit "
        "less noise-free swing, mean ± standard deviation over the copies."
    )
    shown = Table("Table 2", caption, columns, rows, (INFERRED_NOTE,), _groups(table["simulated"]))
    return Section("Simulation", [shown, *material.shown("fig02", "fig03", "fig04", "fig05")])


def apparatus(material):
    """The pendulum, what was measured of it, and how voltage becomes angle."""
    items = list(material.shown("fig01", "fig06", "fig07", "fig08"))
    if (budget := material.tables.get("uncertainty_budget")) is not None:
        items.append(_budget(budget))
    return Section("Pendulum and calibration", [*items, *material.shown("fig09")])


def _budget(budget):
    quantity = budget["quantity"].iloc[-1]  # the angle of one sample, to which all else leads
    columns = [
        Column("source"), Column("limit", style="n"), Column("divisor", style="n"), Column("standard uncertainty", style="n"),
        Column("unit"), Column("sensitivity", style="n"), Column("contribution", "mrad", "n"), Column("share", "%", "n"),
        Column("kind"),
    ]  # fmt: skip
    shown = budget[budget["quantity"] == quantity].sort_values("share", ascending=False)
    rows = [
        [
            row.source.replace("_", " "), numbers.plain(row.limit), numbers.plain(row.divisor), numbers.plain(row.standard_uncertainty),
            row.unit, numbers.plain(row.sensitivity), numbers.plain(1e3 * row.contribution, 2), f"{100 * row.share:.1f}", row.kind,
        ]
        for row in shown.itertuples()
    ]  # fmt: skip
    total = 1e3 * (shown["contribution"] ** 2).sum() ** 0.5
    caption = f"What each input contributes to the standard uncertainty of one {quantity.replace('_', ' ')} ({numbers.plain(total)} mrad)."
    notes = (
        "A limit over its divisor is the standard uncertainty; times the sensitivity it is the contribution.",
        "The budgets of the line, of the rest voltage and of the angle at rest are in results/tables/uncertainty_budget.csv.",
    )
    return Table("Uncertainty budget", caption, columns, rows, notes)


def experiment(material):
    """The experiment study: Table 3, which models differ, the parameters, and the figures."""
    items = []
    if (table := material.tables.get("table3")) is not None:
        items.append(_table3(table, material))
    items += material.shown("fig15")
    if (table := material.tables.get("comparison")) is not None:
        items.append(_comparison(table))
    if (table := material.tables.get("parameters")) is not None:
        items.append(_parameters(table))
    return Section("Experiment", [*items, *material.shown("fig10", "fig11", "fig12", "fig13", "fig14")])


def _table3(table, material):
    columns = [
        Column("campaign"), Column("fitted"), Column("norm", "degrees", "n"), Column("n", style="n"),
        Column("reduced χ²", style="n"), Column("BIC", "mean", "n"), Column("paper", "degrees", "n"),
    ]  # fmt: skip
    rows = [
        [
            row.campaign, model_symbol(row.fitted), numbers.spread(row.mean, row.std), int(row.n),
            numbers.plain(row.reduced_chi2), numbers.whole(row.bic), numbers.spread(row.published_mean, row.published_std),
        ]
        for row in table.itertuples()
    ]  # fmt: skip
    notes = ["Norm: RMS of data less fit, mean ± standard deviation over the swings."]
    if table["published_mean"].notna().any():
        notes.append("The paper's column is for reference: its pendulum is another one.")
    if material.emulated:
        notes.append(f"Emulated: {', '.join(material.emulated)}.")
    return Table(
        "Table 3", "The models fitted to each swing.", columns, rows, tuple(notes), _groups(table["campaign"])
    )


def _comparison(table):
    columns = [
        Column("campaign"), Column("models"), Column("difference of norms", "degrees", "n"), Column("t", style="n"),
        Column("p", style="n"), Column("ΔBIC", style="n"), Column("verdict"),
    ]  # fmt: skip
    rows = [
        [
            row.campaign, Markup("{} − {}").format(model_symbol(row.model_a), model_symbol(row.model_b)),
            numbers.brief(row.mean_difference, row.standard_error), numbers.plain(row.t, 3), numbers.plain(row.p, 2),
            numbers.whole(row.delta_bic), row.verdict,
        ]
        for row in table.itertuples()
    ]  # fmt: skip
    caption = "Paired comparison: the difference of two models' norms on the same swing, mean (standard error) over the swings."
    return Table("Paired comparison", caption, columns, rows, (), _groups(table["campaign"]))


def _parameters(table):
    keys = ["campaign", "fitted", "parameter", "unit"]
    columns = [
        Column("campaign"), Column("fitted"), Column("parameter"), Column("mean over swings", style="n"),
        Column("swings together", style="n"), Column("unit"), Column("std between swings", style="n"),
        Column("standard error of one fit", "median", "n"), Column("the same, robust", "median", "n"),
    ]  # fmt: skip
    rows, labels = [], []
    for (campaign, fitted, parameter, unit), part in table.groupby(keys, sort=False, dropna=False):
        summary = part["recording"].isin(["(mean)", "(joint)"])
        single, texts = part[~summary], dict(zip(part["recording"], part["text"], strict=True))
        mean = texts.get("(mean)", single["text"].iloc[0])
        labels.append((campaign, fitted))
        rows.append([
            campaign, model_symbol(fitted), parameter.replace("_", " "), mean.replace("-", "−"),
            texts.get("(joint)", "–").replace("-", "−"), unit, numbers.plain(single["value"].std(), 2),
            numbers.plain(single["standard_error"].median(), 2), numbers.plain(single["robust_standard_error"].median(), 2),
        ])  # fmt: skip
    caption = "Fitted parameters; in parentheses the standard error in units of the last digits."
    notes = (
        "Mean over swings: its standard error is from the scatter between swings. Swings together: one fit to all.",
        "Robust: allows for residuals that are not independent of each other.",
        "Each swing's values are in results/tables/parameters.csv.",
    )
    return Table("Parameters", caption, columns, rows, notes, _groups(labels))


def settings(material):
    """The whole config, defaults filled in."""
    text = yaml.safe_dump(material.settings, sort_keys=False, allow_unicode=True, width=110)
    return Section(
        "Settings",
        [
            Text("The complete config of this run, defaults filled in."),
            Listing(text.rstrip()),
            Text(INFERRED_NOTE),
        ],
    )


def origin(material):
    """Seed, versions and checksums: what is needed to get the same numbers again."""
    facts = [[name, value] for name, value in provenance.versions(material.settings["seed"])]
    about = Table(
        "Versions", "What computed these results.", [Column("what"), Column("which", style="code")], facts
    )
    files = [[r["recording"], r["file"], r["sha256"]] for r in material.recordings]
    files += [["", name, digest] for name, digest in provenance.checksums(material.inputs)]
    columns = [Column("recording"), Column("file"), Column("SHA-256", style="code")]
    inputs = [Table("Inputs", "Every file the results rest on.", columns, files)] if files else []
    return Section("Provenance", [about, *inputs])


SECTIONS = (findings, simulation, apparatus, experiment, settings, origin)


def _groups(labels):
    """The positions at which a column of labels changes."""
    labels = list(labels)
    return tuple(k for k in range(1, len(labels)) if labels[k] != labels[k - 1])


def read_tables(paths):
    """The tables of the given CSV files by name without ending."""
    return {Path(path).stem: pd.read_csv(path) for path in paths}
