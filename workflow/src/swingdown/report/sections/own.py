"""A report of one's own recordings: the answer first, then what it rests on."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import pandas as pd
from markupsafe import Markup

from ...discovery.tell.verdict import noise_rms
from ...language import capital
from ...own_unit import small
from ...pendulum.catalogue import catalogue
from ...pendulum.model import model_words
from ...studies.pendulums import NO_MODEL, NOT_DYING, REFUSED, SEARCH, TOGETHER, residual_of
from ...studies.turning_points import NOT_DAMPED
from ...studies.words import STATUS, damping_words, headline, notes, quantity_rows, said
from .. import numbers
from ..material import Material
from ..page import Cell, Column, Figure, Item, Section, Table, Text, Value, cells
from ..trace import MOST, trace
from ..wording import model_symbol
from . import FEW
from .experiment import fitted_parameters, paired, table3
from .missing import CAPTIONS, drawn, missing, tells

_CURVES = (
    "Frequency, loss and damping ratio against the amplitude, restoring torque over the angle, friction over the speed: free of a model, "
    "and of the model that describes it. Where the two differ, the model lacks something."
)
_LAWS = (
    "The turning points of the recording, with each single law of damping and the law with the most evidence."
)
_FITTED = "The recording, the fit of the last model, and the residual. Parts in green are held out: only their release is fitted."


def answer(material: Material) -> Section | None:
    """Of each pendulum the verdict in a sentence and how sure it is, the recording with its fit, its quantities, the missing torque.

    What else there is of it is folded away below.
    """
    table = material.tables.get("pendulums")
    if table is None:
        return None
    used = table[table["verdict"] != REFUSED]
    if used["campaign"].nunique() > FEW:
        return Section("All pendulums", list(_side_by_side(table, material)))
    items: list[Item] = []
    verdicts = {found["campaign"]: found for found in material.verdicts}
    for campaign, rows in used.assign(campaign=used["campaign"].astype(str)).groupby("campaign", sort=False):
        found = verdicts.get(campaign)
        # the quantities of all recordings together are of none of them
        if not (found and found.get("difference")):
            items.append(_headline(rows, found, material, used["campaign"].nunique() > 1))
        if found is not None:
            items += _verdict(found)
        if found is not None and tells("remainder", found):
            items += drawn(material, campaign, "remainder", "What remains", CAPTIONS["remainder"])
        items += drawn(material, campaign, "difference", "What follows the change", CAPTIONS["difference"])
        fitted = drawn(material, campaign, "answer", "Recording and fit", _FITTED)
        if not fitted and material.swings.get(campaign):
            fitted = [Figure(f"Recording and fit, {campaign}", "", _FITTED, of=(campaign,))]
        items += [_zoomable(figure, material, found) for figure in fitted]
        if len(rows) == 1:
            items.append(_quantities(rows, found))
        else:
            caption = f"Each recording of {campaign}, and all of them fitted together."
            items.append(_table(f"Quantities, {campaign}", caption, rows, (campaign,), searched=False))
        if found is not None and tells("map", found):
            items += drawn(material, campaign, "map", "Missing torque", CAPTIONS["map"])
    return Section("The answer", items)


def _headline(rows: pd.DataFrame, found: Mapping[str, Any] | None, material: Material, several: bool) -> Text:
    """What stops a pendulum, with the period and quality of its swing or of all of them together."""
    settings, row = material.settings, rows.iloc[-1].to_dict()
    told = headline(row, found, catalogue(settings.get("effects")), settings["model"]["restoring"])
    name = Markup("<code>{}:</code> ").format(row["campaign"]) if several else ""  # in no language another
    return Text(Markup("{}{}").format(name, numbers.in_sentence(told)), "lead")


def _verdict(found: Mapping[str, Any]) -> Iterator[Text]:
    yield Text(Markup("<b>{}.</b> {}").format(*said(found)), "lead")
    yield Text(_sure(found))
    if found["next_measurement"]:
        yield Text(Markup("<b>Next measurement.</b> {}").format(found["next_measurement"]))


def _sure(found: Mapping[str, Any]) -> Markup:
    """How sure a verdict is: what was held out of every fit, and what each effect gained."""
    noise = small(noise_rms(found), found.get("unit", "rad"))
    held = f"{found['gap']['holdout'][-1]:.3g} times the noise of {noise}"
    parts = [f"The held-out residual is {held}; a complete model leaves 1."]
    for one in found["effects"]:
        words, gained = model_words(one["name"]), numbers.whole(one["delta_bic"])
        parts.append(f"With {words} ΔBIC is {gained}; above 10 is very strong evidence.")
    place = f"discovery/{found['campaign']}/verdict.json"
    link = Markup('<a href="{0}">{0}</a>, rule discover_verdict').format(place)
    return Markup("<b>How sure.</b> {} All numbers: {}.").format(" ".join(parts), link)


def _zoomable(figure: Figure, material: Material, found: Mapping[str, Any] | None) -> Figure:
    """The figure with the numbers behind it, where they are there."""
    swings = material.swings.get(figure.of[0])
    if not swings:
        return figure
    unit = found.get("unit", "rad") if found else "rad"  # of what is read, an angle or a rate
    noise = noise_rms(found) if found else None
    return replace(figure, numbers=trace(swings, noise, MOST // len(material.swings), unit, material.spoken))


def _quantities(rows: pd.DataFrame, found: Mapping[str, Any] | None) -> Table:
    """What a single recording gives, a line a quantity."""
    row = rows.iloc[0].to_dict()
    campaign = str(row["campaign"])
    columns = [
        Column("quantity", cell=lambda one: one.words),
        Column("value", "", "n", lambda one: numbers.brief(one.value, one.uncertainty, one.known)),
        Column("unit", cell=lambda one: "" if one.unit == "1" else one.unit),
        Column("amplitude", cell=lambda one: one.condition),
    ]
    own = tuple(f"{capital(one)}." for one in notes(row))
    known: tuple[str, ...] = _NOTES[:-1] if row.get("model_of") == SEARCH else _NOTES
    if row["model"] in NO_MODEL:
        known = _NOTES[:1]
    return Table(
        f"Quantities, {campaign}", _of_model(row), columns, cells(columns, quantity_rows(row, found)), (*own, *known), (),
        "tables/pendulums.csv", "pendulums", (campaign,),
    )  # fmt: skip


_NOTES = (
    "In parentheses the standard uncertainty in units of the last digits: that of the fit, for residuals that need not be independent. "
    "Errors of the sensor's scale are not in it.",
    "Period and Q are those of the fitted model's first whole swing, at the amplitude in its middle. Q is π over the logarithmic decrement of "
    "the first whole swing; the decay time is that in which the amplitude falls to 1/e.",
    "Models of damping alone: where something is missing, their values absorb some of it.",
)

_SYMBOLS = (
    "Model: κ with v for viscous, q for quadratic drag, c for dry friction in proportion to the load (load Coulomb); other effects by "
    "their names. Where a search established something, it is its last model."
)


def _of_model(row: Mapping[str, Any]) -> str:
    if row["model"] == NOT_DAMPED:
        return "The period of passages through a light gate: nothing but their times was recorded."
    residual, unit = residual_of(row)
    words, left = damping_words(row), "a scatter told below"
    if math.isfinite(residual):
        left = f"{small(residual, unit, numbers.plain)} RMS"
    if row["model"] == NOT_DYING:
        return f"What stops it {NOT_DYING}. The period is that of the best model, and it leaves {left}."
    if row.get("model_of") == SEARCH:
        return f"The last model of the search, {words}, fitted to the whole of every recording; it leaves {left}."
    return f"The model of damping with {words} describes the recording best; it leaves {left}."


def _side_by_side(table: pd.DataFrame, material: Material) -> Iterator[Item]:
    """A class of pendulums: the table, the picture, and what was not used."""
    used = table[table["verdict"] != REFUSED]
    campaigns = tuple(dict.fromkeys(used["campaign"].astype(str)))
    each = used.drop_duplicates("campaign")["verdict"].astype(object).fillna("")
    counts = each.map(lambda kind: STATUS.get(kind, kind)).value_counts()
    said = ", ".join(f"{word[:1].lower() + word[1:]}: {count}" for word, count in counts.items())
    refused = len(table) - len(used)
    lost = f"{refused} files could not be used" if refused > 1 else f"{refused} file could not be used"
    left = f"; {lost}" if refused else ""
    yield Text(f"{len(campaigns)} pendulums. {capital(said)}{left}.", "lead")
    caption = "Each pendulum; a click on a column's head sorts by it, and the name leads to its files."
    yield _table("Pendulums", caption, table, campaigns, searched=True)
    if "pendulums" in material.figures:
        path, text = material.figures["pendulums"]
        yield Figure("All pendulums", path, text, "figures/pendulums.svg", "pendulums_figure", campaigns)


def _table(
    label: str, caption: str, table: pd.DataFrame, campaigns: tuple[str, ...], searched: bool
) -> Table:
    columns = [
        Column("pendulum" if searched else "recording"),
        *([Column("verdict")] if searched else []),
        Column("period", "s", "n"),
        Column("quality Q", style="n"),
        Column("decay time (1/e)", "s", "n"),
        Column("amplitude", "degrees", "n"),
        Column("natural frequency", "rad/s", "n"),
        Column("model"),
    ]
    rows: list[list[Cell]] = []
    for row in table.to_dict("records"):
        name = "all together" if row["recording"] == TOGETHER else str(row.get("label", row["recording"]))
        if row["verdict"] == REFUSED:
            rows.append([name, _why(row), *[""] * (len(columns) - 2)])
            continue
        amplitude = _sorted(numbers.plain(math.degrees(row["amplitude_rad"])), row["amplitude_rad"])
        period, quality, decay, frequency = (
            _sorted(numbers.brief(row[column], row[f"{column}_u"]), row[column])
            for column in ("period_s", "quality", "decay_time_s", "natural_frequency_rad_per_s")
        )
        first: list[Cell] = [_linked(name, row), _why(row)] if searched else [name]
        model = str(row["model"])
        symbol = model if model in NO_MODEL else model_symbol(model)
        rows.append([*first, period, quality, decay, amplitude, frequency, symbol])
    told = (*_NOTES, _SYMBOLS), (), "tables/pendulums.csv", "pendulums"
    return Table(label, caption, columns, rows, *told, campaigns, searched)


def _sorted(text: str, value: float) -> Cell:
    return Value(text, value) if math.isfinite(value) else text


def _linked(name: str, row: Mapping[str, Any]) -> Cell:
    if not isinstance(row["verdict"], str) or not row["verdict"]:
        return name
    return Markup('<a href="discovery/{}/figures/answer.svg">{}</a>').format(row["campaign"], name)


def _why(row: Mapping[str, Any]) -> Cell:
    """The verdict of a row: its status, what it names, or why there is none."""
    kind = row["verdict"] if isinstance(row["verdict"], str) else ""
    more = [row[key] for key in ("missing", "remark") if isinstance(row[key], str) and row[key]]
    text = ": ".join([STATUS.get(kind, kind), *more]).replace("_", " ")
    if kind in ("", REFUSED):
        return text
    return Markup('<a href="discovery/{}/verdict.json">{}</a>').format(row["campaign"], text)


def amplitude(material: Material) -> Section | None:
    """Of each pendulum, where they are few, its curves against the amplitude and what the laws of damping leave."""
    table = material.tables.get("pendulums")
    if table is None:
        return None
    campaigns = dict.fromkeys(table[table["verdict"] != REFUSED]["campaign"].astype(str))
    if len(campaigns) > FEW:
        return None
    items: list[Item] = []
    for campaign in campaigns:
        items += drawn(material, campaign, "curves", "Curves", _CURVES)
        items += drawn(material, campaign, "laws", "Laws of damping", _LAWS)
    return Section("Against the amplitude", items)


def evidence(material: Material) -> Section | None:
    """What the verdicts rest on; of many pendulums where it lies."""
    if len(material.verdicts) > FEW:
        return Section("Evidence", [Text(_FOLDERS)])
    shown: list[Item] = [item for item in missing(material).items if not isinstance(item, Text)]
    rest = [one for one in shown if not (isinstance(one, Figure) and Path(one.path).stem in _SHOWN)]
    return Section("Evidence", rest)


_SHOWN = ("map", "remainder", "difference")  # with the answer
_FOLDERS = Markup(
    "Of each pendulum the folder <code>discovery/</code> beside this page has the verdict with all its numbers, the rounds of the search, "
    "and its figures: recording and fit, missing torque, half-swings, residuals, ranking. "
    'Every value of every fit: <a href="tables/parameters.csv">tables/parameters.csv</a>.'
)


def damping(material: Material) -> Section | None:
    """The models of damping side by side, and their parameters."""
    if len(material.verdicts) > FEW or "table3" not in material.tables:
        return None
    tables = material.tables
    own = tables["table3"][tables["table3"]["fitted"] != "error_bounds"]
    compared = table3(own, material)
    items: list[Item] = [replace(compared, notes=(*compared.notes, _SYMBOLS))]
    if own.groupby("campaign")["n"].max().max() > 1 and "comparison" in tables:
        items.append(paired(tables["comparison"]))
    if "parameters" in tables:
        items.append(fitted_parameters(tables["parameters"]))
    return Section("Models of damping", items)
