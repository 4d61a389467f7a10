"""What the report says: one function for each section. A further section is a further function in ``SECTIONS``."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pandas as pd
import yaml
from markupsafe import Markup, escape

from ..fitting.nested import contains
from ..pendulum.model import symbol
from ..studies.comparison import WORTH
from ..studies.simulation import INFERRED_NOTE
from . import numbers, provenance
from . import sweeps as swept
from .page import Cell, Column, Figure, Findings, Item, Listing, Section, Table, Text

EMULATED = (
    "The bench of this report is emulated. The paper's raw data were never published; the recordings of the campaign "
    "{campaigns} come from a simulated apparatus with known truth, not from a pendulum."
)


@dataclass(frozen=True)
class Material:
    """What a report is made from.

    ``tables``: name of a file in ``results/tables`` without ending: DataFrame. ``figures``: name (``fig08``): path of
    the picture and caption. ``recordings``: the attributes of each recording. ``settings``: the complete config.
    ``sweeps``: those whose results are there, as ``sweeps.made`` returns them.
    """

    tables: dict[str, pd.DataFrame]
    figures: dict[str, tuple[str, str]]
    recordings: list[dict[str, Any]]
    settings: dict[str, Any]
    inputs: list[str] = field(default_factory=list)  # files whose checksums are told
    verdicts: list[dict[str, Any]] = field(default_factory=list)  # contents of each campaign's verdict.json
    seen: list[str] = field(
        default_factory=list
    )  # paths of their figures, discovery/{campaign}/figures/{name}.svg
    sweeps: dict[str, swept.Made] = field(default_factory=dict)

    @property
    def emulated(self) -> list[str]:
        """The campaigns that come from an emulated apparatus, each once."""
        return list(dict.fromkeys(r["campaign"] for r in self.recordings if r.get("emulated") == "yes"))

    def shown(self, *names: str) -> list[Figure]:
        """The figures of those names that were made."""
        return [
            Figure(f"Figure {int(name.removeprefix('fig'))}", *self.figures[name])
            for name in names
            if name in self.figures
        ]


def sections(material: Material) -> list[Section]:
    """The report's sections in reading order; a section with nothing to show is left out."""
    return [section for make in SECTIONS if (section := make(material)) and section.items]


def head(material: Material) -> dict[str, str | list[str]]:
    """Title, subtitle, footer, and the notices that a reader must see before anything else."""
    swings = [recording for recording in material.recordings if recording.get("role") != "static"]
    campaigns = ", ".join(dict.fromkeys(recording["campaign"] for recording in swings))
    kind = " (emulated)" if material.emulated else ""
    subtitle = f"{len(swings)} swings of {campaigns}{kind}" if swings else "Simulation study"
    notices = [EMULATED.format(campaigns=", ".join(material.emulated))] if material.emulated else []
    footer = "Made by swingdown. The datasets behind every table and figure lie in the results folder beside this page."
    return {
        "title": "Damping of a swinging pendulum",
        "subtitle": subtitle,
        "notices": notices,
        "footer": footer,
    }


def plain_findings(material: Material) -> list[str]:
    """The findings as plain text, for the terminal."""
    items = [item for item in findings(material).items if isinstance(item, Findings)]
    return [Markup(line).striptags() for item in items for line in item.lines]


def model_symbol(label: str) -> Markup:
    """A model's symbol as HTML, the effects as subscript; the row of the error bounds, which is no model, in words."""
    if label == "error_bounds":
        return Markup(escape(label.replace("_", " ")))
    text = symbol(label)
    return Markup(f"{text[0]}<sub>{escape(text[1:])}</sub>")


# --- the sections -------------------------------------------------------------------------------------------------


def findings(material: Material) -> Section:
    """The sentences that open the report."""
    lines = [f"{found['campaign']}: {found['sentence']}" for found in material.verdicts]
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


def _experiment_findings(
    campaign: str, rows: pd.DataFrame, comparison: pd.DataFrame, material: Material
) -> list[str]:
    models = rows[rows["fitted"] != "error_bounds"].set_index("fitted")
    if models.empty:
        return []
    pairs = comparison[comparison["campaign"] == campaign]
    lowest = models["bic"].idxmin()
    label = simplest(lowest, pairs)
    best, swings = models.loc[label], int(models.loc[label, "n"])
    them = "swing" if swings == 1 else f"{swings} swings"
    words = f"{campaign}: {{}} ({wording(label)}) describes the {them} best; it leaves {{}}° RMS."
    lines: list[str] = [Markup(words).format(model_symbol(label), numbers.spread(best["mean"], best["std"]))]
    if label != lowest:
        further = "{}: {} comes closer still, by terms that are not worth their parameters."
        lines.append(Markup(further).format(campaign, model_symbol(lowest)))
    for row in pairs[(pairs["model_a"] == label) | (pairs["model_b"] == label)].itertuples():
        if "indistinguishable" in row.verdict:
            lines.append(with_symbols(f"{campaign}: {row.verdict}."))
    if pd.notna(best["reduced_chi2"]):
        words = f"{campaign}: what it leaves is {numbers.plain(best['reduced_chi2'])} times the variance that the angle's random "
        lines.append(f"{words}uncertainty explains (reduced χ²); a complete model leaves 1.")
    bound = rows[rows["fitted"] == "error_bounds"]
    if bound["mean"].notna().any():
        within = "within" if best["mean"] <= bound["mean"].iloc[0] else "above"
        size = numbers.spread(bound["mean"].iloc[0], bound["std"].iloc[0])
        lines.append(
            f"{campaign}: it is {within} the paper's benchmark, the bounds of the measured angle ({size}°)."
        )
    return lines


def simplest(label: str, pairs: pd.DataFrame) -> str:
    """The smallest model inside ``label`` that its further terms do not improve by more than they cost."""
    enough = [
        (row.model_a, row.mean_difference)
        for row in pairs.itertuples()
        if row.model_b == label and contains(label, row.model_a) and row.delta_bic_effective <= WORTH
    ]
    return min(enough, key=lambda found: (found[0].count("+"), found[1]))[0] if enough else label


def wording(label: str) -> str:
    """A model's effects in words: ``quadratic drag and load Coulomb``."""
    names = [name.replace("_", " ").replace("coulomb", "Coulomb") for name in label.split("+")]
    return " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)


_SEEN = {
    "residuals": "What the base model and the last one leave of the swings that were worst at first, with the measured noise.",
    "gap": "The residual in units of the measured noise, move by move; the held-out swings had no part in any fit but their own releases.",
    "map": "The torque that is missing, over angle, velocity and time, from the equations of variation: no data are differentiated.",
    "half_swings": "Each half-swing's loss, period and mid-point, measured without a model, beside what the models show.",
    "ranking": "What each move was worth in the first round, by BIC.",
}


def missing(material: Material) -> Section:
    """What the models lack: each campaign's verdict, where they fail, and the figures."""
    items: list[Item] = []
    for found in material.verdicts:
        campaign = found["campaign"]
        items.append(Text(Markup("<b>{}</b> ({}): {}").format(campaign, found["status"], found["sentence"])))
        if found["next_measurement"]:
            items.append(Text(f"Next measurement: {found['next_measurement']}"))
        if found["effects"]:
            items.append(_added(found))
        if found["where"]["groups"]:
            items.append(_where(found))
        for name, caption in _SEEN.items():
            paths = [
                path for path in material.seen if path.endswith(f"discovery/{campaign}/figures/{name}.svg")
            ]
            items += [
                Figure(f"{name.replace('_', ' ').capitalize()}, {campaign}", path, caption) for path in paths
            ]
    return Section("What is missing", items)


def _added(found: dict[str, Any]) -> Table:
    columns = [
        Column("effect"),
        Column("parameter"),
        Column("value", style="n"),
        Column("unit"),
        Column("BIC gained", style="n"),
        Column("not told apart from"),
    ]
    rows = [
        [
            one["name"].replace("_", " "),
            name.replace("_", " "),
            numbers.brief(entry["value"], entry["standard_error"]),
            entry["unit"],
            numbers.whole(one["delta_bic"]),
            ", ".join(one["tied_with"]).replace("_", " ") or "–",
        ]
        for one in found["effects"]
        for name, entry in one["parameters"].items()
        if entry["value"] is not None
    ]
    caption = f"What was added to the model of {found['campaign']}; in parentheses the standard error in units of the last digits."
    notes = [f"Moves: {'; '.join(found['moves']).replace('_', ' ')}. {found['split'].capitalize()}."]
    return Table(f"Effects, {found['campaign']}", caption, columns, rows, tuple(notes))


def _where(found: dict[str, Any]) -> Table:
    columns = [
        Column("group"),
        Column("share of the excess", "%", "n"),
        Column("χ²", style="n"),
        Column("freedom", style="n"),
        Column("χ² at the end", style="n"),
    ]
    last = found["where"]["remaining"]
    rows = [
        [
            name,
            f"{100 * one['share']:.0f}",
            numbers.whole(one["chi_square"]),
            int(one["freedom"]),
            numbers.whole(last[name]["chi_square"]) if name in last else "–",
        ]
        for name, one in found["where"]["groups"].items()
    ]
    caption = f"Where the base model of {found['campaign']} fails: what a torque of any form in one variable, a sensor error or a line would explain."
    return Table(
        f"Disagreement, {found['campaign']}",
        caption,
        columns,
        rows,
        ("Groups overlap: shares do not add up. “At the end” is told where something remains.",),
    )


def simulation(material: Material) -> Section | None:
    """The simulation study: Table 2 and its figures."""
    table = material.tables.get("table2")
    if table is None:
        return None
    settings = material.settings["simulation"]
    columns = [
        Column("simulated"),
        Column("fitted"),
        Column("norm, Nelder–Mead", "degrees", "n"),
        Column("norm, least squares", "degrees", "n"),
        Column("paper", "degrees", "n"),
        Column("n", style="n"),
    ]
    rows: list[list[Cell]] = [
        [
            model_symbol(row.simulated),
            model_symbol(row.fitted),
            numbers.spread(row.mean, row.std),
            numbers.spread(row.mean_least_squares, row.std_least_squares),
            numbers.spread(row.published_mean, row.published_std),
            int(row.n),
        ]
        for row in table.itertuples()
    ]
    caption = (
        f"Simulated swings ({settings['realizations']} noisy copies of each, signal to noise {settings['snr']:g}): norm of fit "
        "less noise-free swing, mean ± standard deviation over the copies."
    )
    shown = Table(
        "Table 2", caption, columns, rows, (INFERRED_NOTE.replace("_", " "),), _groups(table["simulated"])
    )
    return Section("Simulation", [shown, *material.shown("fig02", "fig03", "fig04", "fig05")])


def apparatus(material: Material) -> Section:
    """The pendulum, what was measured of it, and how voltage becomes angle."""
    items: list[Item] = list(material.shown("fig01", "fig06", "fig07", "fig08"))
    if (budget := material.tables.get("uncertainty_budget")) is not None:
        items.append(_budget(budget))
    return Section("Pendulum and calibration", [*items, *material.shown("fig09")])


def _budget(budget: pd.DataFrame) -> Table:
    quantity = budget["quantity"].iloc[-1]  # the angle of one sample, to which all else leads
    columns = [
        Column("source"),
        Column("limit", style="n"),
        Column("divisor", style="n"),
        Column("u", "standard", "n"),
        Column("unit"),
        Column("sensitivity", style="n"),
        Column("contribution", "mrad", "n"),
        Column("share", "%", "n"),
        Column("kind"),
    ]
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


def experiment(material: Material) -> Section:
    """The experiment study: Table 3, which models differ, the parameters, and the figures."""
    items: list[Item] = []
    if (table := material.tables.get("table3")) is not None:
        items.append(_table3(table, material))
    items += material.shown("fig15")
    if (table := material.tables.get("comparison")) is not None:
        items.append(_comparison(table))
    if (table := material.tables.get("parameters")) is not None:
        items.append(_parameters(table))
    return Section("Experiment", [*items, *material.shown("fig10", "fig11", "fig12", "fig13", "fig14")])


def _table3(table: pd.DataFrame, material: Material) -> Table:
    columns = [
        Column("campaign"),
        Column("fitted"),
        Column("norm", "degrees", "n"),
        Column("reduced χ²", style="n"),
        Column("ΔBIC", "above the lowest", "n"),
        Column("variance inflation", style="n"),
        Column("n", style="n"),
        Column("paper", "degrees", "n"),
    ]
    rows = [
        [
            row.campaign,
            model_symbol(row.fitted),
            numbers.spread(row.mean, row.std),
            numbers.plain(row.reduced_chi2),
            numbers.whole(row.delta_bic),
            numbers.whole(row.variance_inflation),
            int(row.n),
            numbers.spread(row.published_mean, row.published_std),
        ]
        for row in table.itertuples()
    ]
    notes = [
        "Norm: RMS of data less fit, mean ± standard deviation over the n swings. BIC: summed over them.",
        "Variance inflation: how many times the standard errors squared are too small for taking residuals as independent.",
    ]
    if table["published_mean"].notna().any():
        notes.append("The paper's column is for reference: its pendulum is another one.")
    for row in table.itertuples():
        about = [part for part in str(row.note).split("; ") if "below 0" in part]
        notes += [
            Markup("{}: {}.").format(model_symbol(row.fitted), part.replace("_", " ")) for part in about
        ]
    if material.emulated:
        notes.append(f"Emulated: {', '.join(material.emulated)}.")
    return _by_campaign("Table 3", "The models fitted to each swing.", columns, rows, notes)


def _comparison(table: pd.DataFrame) -> Table:
    columns = [
        Column("campaign"),
        Column("models"),
        Column("difference", "degrees", "n"),
        Column("p", "after Holm", "n"),
        Column("ΔBIC", "independent samples", "n"),
        Column("verdict"),
    ]
    rows = [
        [
            row.campaign,
            Markup("{}\u00a0−\u00a0{}").format(model_symbol(row.model_a), model_symbol(row.model_b)),
            numbers.brief(row.mean_difference, row.standard_error),
            numbers.plain(row.p_holm, 2),
            numbers.whole(row.delta_bic_effective),
            with_symbols(row.verdict),
        ]
        for row in table.itertuples()
    ]
    caption = "The difference of two models' norms on the same swing: mean (standard error) over the swings."
    notes = ["p: Student's for the mean difference, corrected for the number of pairs."]
    return _by_campaign("Paired comparison", caption, columns, rows, notes)


def _parameters(table: pd.DataFrame) -> Table:
    keys = ["campaign", "fitted", "parameter", "unit"]
    columns = [
        Column("campaign"),
        Column("fitted"),
        Column("parameter"),
        Column("mean over swings", style="n"),
        Column("swings together", style="n"),
        Column("unit"),
        Column("std between swings", style="n"),
        Column("standard error of one fit", "robust, median", "n"),
    ]
    rows = []
    for (campaign, fitted, parameter, unit), part in table.groupby(keys, sort=False, dropna=False):
        single = part[~part["recording"].isin(["(mean)", "(joint)"])]
        rows.append([
            campaign, model_symbol(fitted), parameter.replace("_", " "), _told(part, "(mean)") or _told(single),
            _told(part, "(joint)") or "–", unit, numbers.plain(single["value"].std(), 2),
            numbers.plain(single["robust_standard_error"].median(), 2),
        ])  # fmt: skip
    caption = "Fitted parameters; in parentheses the standard error in units of the last digits."
    notes = [
        "Mean over swings: its standard error is from the scatter between swings. Swings together: one fit to all.",
        "Robust: allows for residuals that are not independent of each other. Each swing's values: tables/parameters.csv.",
    ]
    return _by_campaign("Parameters", caption, columns, rows, notes)


def _told(part: pd.DataFrame, recording: str | None = None) -> str:
    """``value(standard error)`` of the first row, of one kind of row; nothing where there is none."""
    chosen = part if recording is None else part[part["recording"] == recording]
    if chosen.empty:
        return ""
    row = chosen.iloc[0]
    robust = row["robust_standard_error"]
    return numbers.brief(row["value"], robust if pd.notna(robust) else row["standard_error"])


def _by_campaign(
    label: str, caption: str, columns: list[Column], rows: list[list[Cell]], notes: Sequence[str]
) -> Table:
    """A table whose first column is the campaign: grouped by it, or without it where there is only one."""
    campaigns = [row[0] for row in rows]
    if len(set(campaigns)) > 1:
        return Table(label, caption, columns, rows, tuple(notes), _groups(campaigns))
    fitted = [row[1] for row in rows]
    return Table(
        label,
        caption,
        columns[1:],
        [row[1:] for row in rows],
        tuple(notes),
        _groups(fitted) if label == "Parameters" else (),
    )


def sweeps(material: Material) -> Section:
    """The sweeps that were computed: their maps beside the paper's claim."""
    return swept.section(material.sweeps)


def settings(material: Material) -> Section:
    """The whole config, defaults filled in."""
    text = yaml.safe_dump(material.settings, sort_keys=False, allow_unicode=True, width=110)
    return Section(
        "Settings",
        [
            Text("The complete config of this run, defaults filled in."),
            Listing(text.rstrip()),
            Text(INFERRED_NOTE.replace("_", " ")),
        ],
    )


def origin(material: Material) -> Section:
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


SECTIONS = (findings, missing, simulation, apparatus, experiment, sweeps, settings, origin)


def with_symbols(text: str) -> Markup:
    """A sentence with the models' symbols typeset: ``κv,q`` with its subscript."""
    return Markup(re.sub(r"κ(\w+(?:,\w+)*)", r"κ<sub>\1</sub>", str(escape(text))))


def _groups(labels: Iterable[object]) -> tuple[int, ...]:
    """The positions at which a column of labels changes."""
    labels = list(labels)
    return tuple(k for k in range(1, len(labels)) if labels[k] != labels[k - 1])


def read_tables(paths: Iterable[str | Path]) -> dict[str, pd.DataFrame]:
    """The tables of the given CSV files by name without ending."""
    return {Path(path).stem: pd.read_csv(path) for path in paths}
