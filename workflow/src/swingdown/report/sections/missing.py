"""What the models lack, campaign by campaign."""

from collections.abc import Mapping
from dataclasses import replace
from math import nan
from typing import Any

from markupsafe import Markup

from ...discovery.tell.sentence import rivals
from ...pendulum.model import model_words
from .. import numbers
from ..material import Material
from ..page import Column, Figure, Item, Section, Table, Text, cells

CAPTIONS = {
    "remainder": "What the last model still lacks: a torque over angle and speed together, how large each kind is, and when it acts.",
    "residuals": "What the base model and the last model leave of the swings that were worst at first, with the measured noise.",
    "gap": "The residual in units of the measured noise, move by move; the held-out swings had no part in any fit but their own releases.",
    "map": "The torque that is missing, over angle, velocity and time, from the equations of variation: no data are differentiated.",
    "difference": "The size of the effect that goes with what was changed, in each recording; all else is the same in all of them.",
    "half_swings": "Each half-swing's loss, period and mid-point, measured without a model, beside what the models show.",
    "ranking": "What each move was worth in the first round, by BIC.",
}


def tells(figure: str, found: dict[str, Any] | Mapping[str, Any]) -> bool:
    """True where a figure of a search has something to say: what remains where anything does, what was missing where anything was, and
    before and after where a move was made. Of what does not die away none has, and half-swings are those of a free swing."""
    if not found.get("dies_away", True):
        return False
    if figure == "difference":
        return bool(found.get("difference"))
    if figure == "remainder":
        return bool(found["where"]["remaining"])
    if figure in ("map", "ranking"):
        return bool(found["where"]["groups"])
    if figure == "half_swings":
        return not found.get("driven")
    return len(found["gap"]["fit"]) > 1


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
        if found["stand_ins"]:
            items.append(_helping(found))
        if found["where"]["groups"]:
            items.append(_where(found))
        for name, caption in CAPTIONS.items():
            if not tells(name, found):
                continue
            items += drawn(material, campaign, name, name.replace("_", " ").capitalize(), caption)
    return Section("What is missing", items)


def drawn(material: Material, campaign: str, name: str, label: str, caption: str) -> list[Figure]:
    """The figure of a pendulum, of its curves or of its search, where it was made."""
    if name in ("curves", "laws"):
        place, rule = f"curves/{campaign}/{name}.svg", "curves"
    else:
        place = f"discovery/{campaign}/figures/{name}.svg"
        rule = "discover_difference" if name == "difference" else "discover_figures"
    paths = [path for path in material.seen if path.endswith(f"/{place}")]
    return [Figure(f"{label}, {campaign}", path, caption, place, rule, (campaign,)) for path in paths]


def _added(found: dict[str, Any]) -> Table:
    caption = f"Effects that are missing from the model of {found['campaign']}; in parentheses the standard error in units of the last digits."
    moves = f"Moves: {'; '.join(map(model_words, found['moves']))}. {found['split'].capitalize()}."
    return _effects(found, "Effects", caption, found["effects"], (moves, *_stopped(found)))


def _helping(found: dict[str, Any]) -> Table:
    caption = f"Effects that may be part of what is missing from the model of {found['campaign']}, without enough evidence."
    doubts = [f"{one['name']}: {one['doubt']}".replace("_", " ") for one in found["stand_ins"]]
    notes = (f"Not asserted because: {'; '.join(doubts)}.", *(() if found["effects"] else _stopped(found)))
    return _effects(found, "Stand-ins", caption, found["stand_ins"], notes)


def _stopped(found: dict[str, Any]) -> tuple[str, ...]:
    return ("The search stopped: its time (discovery.budget_s) was used up.",) if found["stopped"] else ()


def _effects(
    found: dict[str, Any], title: str, caption: str, told: list[dict[str, Any]], notes: tuple[str, ...]
) -> Table:
    columns = [
        Column("effect", cell=lambda one: model_words(one["name"])),
        Column("parameter", cell=lambda one: one["parameter"].replace("_", " ")),
        Column("value", "", "n", lambda one: numbers.brief(one["value"], one["standard_error"])),
        Column("unit", cell=lambda one: one["unit"]),
        Column("ΔBIC", "", "n", lambda one: numbers.whole(one["delta_bic"])),
        Column("probability", "%", "n", lambda one: _percent(one.get("probability"))),
        Column("not distinguished from", cell=lambda one: ", ".join(rivals(one)) or "–"),
    ]
    each = [
        one | entry | {"parameter": name}
        for one in told
        for name, entry in one["parameters"].items()
        if entry["value"] is not None
    ]
    return _of_verdict(found["campaign"], Table(title, caption, columns, cells(columns, each), notes))


def _of_verdict(campaign: str, table: Table) -> Table:
    """The table with what all have whose numbers stand in a campaign's verdict."""
    label, link = f"{table.label}, {campaign}", f"discovery/{campaign}/verdict.json"
    return replace(table, label=label, link=link, rule="discover_verdict", of=(campaign,))


def _percent(share: float | None) -> str:
    return "–" if share is None else f"{100 * share:.0f}"


def _where(found: dict[str, Any]) -> Table:
    campaign = found["campaign"]
    at_end = {name: one.get("chi_square") for name, one in found["where"]["remaining"].items()}
    columns = [
        Column("group", cell=lambda one: one["name"]),
        Column("share of the excess", "%", "n", lambda one: _percent(one["share"])),
        Column("χ²", "", "n", lambda one: numbers.whole(one["chi_square"])),
        Column("degrees of freedom", "", "n", lambda one: int(one["freedom"])),
        Column("χ² at the end", "", "n", lambda one: numbers.whole(at_end.get(one["name"], nan))),
    ]
    rows = ({"name": name} | one for name, one in found["where"]["groups"].items())
    caption = f"Where the base model of {campaign} fails: what a torque of any form in one variable, a sensor error or a line would explain."
    notes = ("Groups overlap: shares do not add up. “At the end” is given where something remains.",)
    return _of_verdict(campaign, Table("Disagreement", caption, columns, cells(columns, rows), notes))
