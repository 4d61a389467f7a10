"""The form of the report: sections of texts, tables and figures, rendered into one self-contained HTML file."""

import base64
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import jinja2
from markupsafe import Markup, escape

from ..extras import needed
from ..language import ENGLISH, language
from ..paths import printable
from ..sealed import read_bytes, write_text
from . import trace

TEMPLATE = Path(__file__).with_name("report.html.j2")


class Value(NamedTuple):
    """A cell that is sorted by another thing than its text."""

    text: str
    value: float | str

    def __str__(self) -> str:
        return self.text


Cell = str | int | Markup | Value
_MEDIA = {".png": "image/png", ".svg": "image/svg+xml"}


@dataclass(frozen=True)
class Text:
    """A paragraph; ``style`` is ``lead`` for what a reader should see before all else."""

    text: str
    style: str = ""
    kind = "text"


@dataclass(frozen=True)
class Findings:
    """What a reader in a hurry takes away: a few sentences."""

    lines: list[str]
    kind = "findings"


@dataclass(frozen=True)
class Listing:
    """Text as it stands in a file."""

    text: str
    kind = "listing"


@dataclass(frozen=True)
class Column:
    """A table's column: its head, the unit under it, and ``n`` (number) or ``code`` as style."""

    head: str
    unit: str = ""
    style: str = ""


@dataclass(frozen=True)
class Table:
    """A table of texts; ``groups`` are the rows that open a group, ``notes`` stand below it.

    ``link`` is the file that its numbers stand in, from the report's folder, ``rule`` what made that; ``of`` are the campaigns
    that it rests on. A reader may sort the rows of a ``sortable`` one.
    """

    label: str
    caption: str
    columns: Sequence[Column]
    rows: Sequence[Sequence[Cell]]
    notes: tuple[str, ...] = ()
    groups: tuple[int, ...] = ()
    link: str = ""
    rule: str = ""
    of: tuple[str, ...] = ()
    sortable: bool = False
    kind = "table"

    @property
    def anchor(self) -> str:
        return _anchor(self.label)


@dataclass(frozen=True)
class Figure:
    """A figure file and its caption (reStructuredText); ``link``, ``rule`` and ``of`` as of a ``Table``.

    ``numbers`` are what ``trace.js`` draws in the place of the picture where the page is looked at on a screen. Without the picture
    (``path`` is empty) they are all there is.
    """

    label: str
    path: str
    text: str
    link: str = ""
    rule: str = ""
    of: tuple[str, ...] = ()
    numbers: Markup | None = None
    kind = "figure"

    @property
    def anchor(self) -> str:
        return _anchor(self.label)

    @property
    def source(self) -> str:
        path = Path(self.path)
        return f"data:{_MEDIA[path.suffix]};base64,{base64.b64encode(read_bytes(path)).decode()}"

    @property
    def caption(self) -> Markup:
        return Markup(rst(self.text))


Item = Text | Findings | Listing | Table | Figure


@dataclass(frozen=True)
class Section:
    """A heading and what stands under it; ``folded`` is what a reader opens who asks for it."""

    title: str
    items: list[Item]
    folded: bool = False

    @property
    def anchor(self) -> str:
        return _anchor(self.title)

    @property
    def listed(self) -> list[Table | Figure]:
        return [item for item in self.items if isinstance(item, Table | Figure)]


_MARKED = re.compile(
    r"[*`|\\]|_\b|\n\s*\n|^\.\.", re.MULTILINE
)  # what reStructuredText takes for more than words


def rst(text: str) -> str:
    """The HTML of a caption in reStructuredText; mathematics becomes plain HTML, which needs no font of its own."""
    if not _MARKED.search(text):
        return str(escape(text.strip()))
    options = {"math_output": "HTML", "report_level": 3, "halt_level": 5, "file_insertion_enabled": False}
    body = (
        needed("docutils.core")
        .publish_parts(text, writer="html5", settings_overrides=options)["body"]
        .strip()
    )
    single = re.fullmatch(r"<p>(.*)</p>", body, re.DOTALL)
    return single[1] if single and "<p>" not in single[1] else body


def write(path: str | Path, sections: Sequence[Section], **head: str | Sequence[str]) -> Path:
    """The path written: the report with its sections; ``head`` fills title, subtitle, notices, footer and ``lang``."""
    environment = jinja2.Environment(autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True)
    zoomable = any(
        isinstance(item, Figure) and item.numbers for section in sections for item in section.items
    )
    more = {
        name: Markup("\n".join(path.read_text(encoding="utf-8") for path in paths)) if zoomable else ""
        for name, paths in (("styles", trace.STYLE), ("programs", trace.PROGRAM))
    }
    say = language(str(head.get("lang", ENGLISH))).text
    html = environment.from_string(TEMPLATE.read_text(encoding="utf-8")).render(
        sections=sections, say=say, **more, **head
    )
    return write_text(path, printable(html))


def _anchor(label: str) -> str:
    return re.sub(r"[^a-z0-9]+", "-", label.lower()).strip("-")
