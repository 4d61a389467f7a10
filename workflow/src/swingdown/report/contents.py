"""What the report says, section by section in reading order. A further section is a file in ``sections`` and a line here."""

from markupsafe import Markup

from . import sweeps as swept
from .material import Material, read_tables
from .page import Findings, Section
from .sections.apparatus import apparatus
from .sections.experiment import experiment
from .sections.findings import findings
from .sections.missing import missing
from .sections.origin import origin
from .sections.settings import settings
from .sections.simulation import simulation

__all__ = ["Material", "findings", "head", "plain_findings", "read_tables", "sections"]

EMULATED = (
    "The bench of this report is emulated. The paper's raw data were never published; the recordings of the campaign "
    "{campaigns} come from a simulated apparatus with known truth, not from a pendulum."
)


def sweeps(material: Material) -> Section:
    """The sweeps that were computed: their maps beside the paper's claim."""
    return swept.section(material.sweeps)


SECTIONS = (findings, missing, simulation, apparatus, experiment, sweeps, settings, origin)


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
