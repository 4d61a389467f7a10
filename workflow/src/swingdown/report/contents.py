"""What the report says, section by section in reading order. A further section is a file in ``sections`` and a line here."""

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

from markupsafe import Markup, escape

from ..language import Language
from . import sweeps as swept
from .material import Material, read_tables
from .page import Figure, Findings, Head, Item, Section, Table, Text
from .sections.apparatus import apparatus, calibration
from .sections.experiment import experiment
from .sections.findings import findings
from .sections.left_out import left_out, notice
from .sections.missing import missing
from .sections.origin import origin
from .sections.own import amplitude, answer, damping, evidence
from .sections.series import series
from .sections.settings import settings
from .sections.simulation import simulation
from .spoken import in_language, words

__all__ = ["Material", "findings", "head", "plain_findings", "read_tables", "sections"]

EMULATED = (
    "The bench of this report is emulated. The paper's raw data were never published; the recordings of the campaign "
    "{campaigns} come from a simulated apparatus with known truth, not from a pendulum."
)
OWN_EMULATED = (
    "The recordings of {campaigns} are emulated: they come from a computed pendulum and not from a real one."
)
LABEL = "Emulated: computed, not measured on a real apparatus."


def sweeps(material: Material) -> Section:
    """The sweeps that were computed: their maps beside the paper's claim."""
    return swept.section(material.sweeps)


SECTIONS = (findings, left_out, missing, simulation, apparatus, experiment, sweeps, settings, origin)
# what the answers rest on, until asked for
FOLDED = (evidence, amplitude, damping, calibration, settings, origin)
OWN = (answer, series, left_out, *FOLDED)  # of a study of one's own


def sections(material: Material) -> list[Section]:
    """The report's sections in reading order; a section with nothing to show is left out.

    Tables and figures that rest on emulated recordings say so.
    """
    made = [(make, make(material)) for make in (OWN if material.own else SECTIONS)]
    shown = [
        replace(_labelled(section, material), folded=material.own and make in FOLDED)
        for make, section in made
        if section and section.items
    ]
    return in_language(shown, material.spoken)


def _labelled(section: Section, material: Material) -> Section:
    """The section with every table and figure of emulated recordings saying that they are."""
    emulated = set(material.emulated)
    items: list[Item] = []
    for item in section.items:
        if isinstance(item, Table) and emulated & set(item.of):
            item = replace(item, caption=f"{item.caption} {LABEL}")
        elif isinstance(item, Figure) and emulated & set(item.of):
            item = replace(item, text=f"{item.text.rstrip()} {LABEL}")
        items.append(item)
    return replace(section, items=items)


def head(material: Material) -> Head:
    """What stands above and below the report's sections."""
    spoken = material.spoken
    swings = [recording for recording in material.recordings if recording.get("role") != "static"]
    campaigns = list(dict.fromkeys(recording["campaign"] for recording in swings))
    kind = f" ({spoken.text('emulated')})" if material.emulated else ""
    if material.own:
        title, emulated = f"What stops these {len(campaigns)} pendulums?", OWN_EMULATED
        if len(campaigns) == 1:
            title = "What stops this pendulum?"
        many = spoken.text(f"{len(swings)} recordings")
        read = [_read(one, spoken) for one in swings] if len(swings) <= 3 else [many]
        subtitle: str = Markup(Markup("; ").join(read) + kind)
    else:
        title, emulated = "Damping of a swinging pendulum", EMULATED
        subtitle = f"{len(swings)} swings of {', '.join(campaigns)}{kind}" if swings else "Simulation study"
    notices = [emulated.format(campaigns=", ".join(material.emulated))] if material.emulated else []
    told = [words(one, spoken) for one in (*notices, *notice(material))]
    footer = "Made by swingdown. The datasets behind every table and figure lie in the results folder beside this page."
    return Head(spoken.text(title), subtitle, told, spoken.text(footer), spoken.code)


def _read(recording: dict[str, Any], spoken: Language) -> Markup:
    """A recording and how its file was read, with names of columns as code."""
    taken = f" ({spoken.text(str(recording['taken']))})" if recording.get("taken") else ""
    remarks = f": {spoken.text(str(recording['remarks']))}" if recording.get("remarks") else ""
    text = str(escape(f"{Path(str(recording['file'])).name}{taken}{remarks}"))
    return Markup(re.sub(r"`([^`]+)`", r"<code>\1</code>", text))


def plain_findings(material: Material) -> list[str]:
    """The findings as plain text, for the terminal."""
    made = [item for section in sections(material)[:1] for item in section.items]
    lines = [line for item in made if isinstance(item, Findings) for line in item.lines]
    lines += [item.text for item in made if isinstance(item, Text) and item.style == "lead"]
    return [Markup(line).striptags() for line in lines]
