"""The form of the report: sections of texts, tables and figures, rendered into one self-contained HTML file."""

import base64
import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from markupsafe import Markup, escape

from ..extras import needed
from ..language import ENGLISH, Language, language
from ..paths import printable
from ..sealed import read_bytes, write_text
from . import trace

_FOLDER = Path(__file__).parent
_PAGE, _STYLE, _PROGRAM = (_FOLDER / f"page.{ending}" for ending in ("html", "css", "js"))
FILES = (_PAGE, _STYLE, _PROGRAM, *trace.STYLE, *trace.PROGRAM)  # what a page is made of besides its sections


class Value(NamedTuple):
    """A cell that is sorted by another thing than its text."""

    text: str
    value: float | str

    def __str__(self) -> str:
        return self.text


Cell = str | int | Markup | Value
_WIDE = 6  # columns; a table of more is set smaller
_MEDIA = {".png": "image/png", ".svg": "image/svg+xml"}


@dataclass(frozen=True)
class Text:
    """A paragraph; ``style`` is ``lead`` for what a reader should see before all else."""

    text: str
    style: str = ""

    def html(self, spoken: Language) -> Markup:
        return Markup("<p{}>{}</p>\n").format(_class(self.style), self.text)


@dataclass(frozen=True)
class Findings:
    """What a reader in a hurry takes away: a few sentences."""

    lines: list[str]

    def html(self, spoken: Language) -> Markup:
        return Markup('<ul class="findings">{}</ul>\n').format(_each("<li>{}</li>", self.lines))


@dataclass(frozen=True)
class Listing:
    """Text as it stands in a file."""

    text: str

    def html(self, spoken: Language) -> Markup:
        return Markup("<pre>{}</pre>\n").format(self.text)


@dataclass(frozen=True)
class Column:
    """A table's column: its head, the unit under it, ``n`` (number) or ``code`` as style, and its cell of what a row is made of."""

    head: str
    unit: str = ""
    style: str = ""
    cell: Callable[[Any], Cell] | None = None


def cells(columns: Sequence[Column], given: Iterable[Any]) -> list[list[Cell]]:
    """The rows of a table that are made of what is given, each by the columns' own functions."""
    return [[one.cell(row) for one in columns if one.cell] for row in given]


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

    def html(self, spoken: Language) -> Markup:
        head = Markup("").join(
            Markup("<th{}>{}{}</th>").format(_class(one.style), one.head, _each("<small>{}</small>", filter(None, [one.unit])))
            for one in self.columns
        )  # fmt: skip
        rows = Markup("").join(
            Markup("<tr{}>{}</tr>\n").format(_class("group" if k in self.groups else ""), self._cells(row))
            for k, row in enumerate(self.rows)
        )
        return Markup(
            '<div class="scroll{}" id="{}">\n<table{}>\n<caption><b>{}.</b> {}{}</caption>\n'
            "<thead><tr>{}</tr></thead>\n<tbody>\n{}</tbody>\n</table>\n</div>\n{}"
        ).format(
            " wide" if len(self.columns) > _WIDE else "", _anchor(self.label), _class("sortable" if self.sortable else ""),
            self.label, self.caption, _origin(self, spoken), head, rows,
            Markup('<ul class="notes">{}</ul>\n').format(_each("<li>{}</li>", self.notes)) if self.notes else "",
        )  # fmt: skip

    def _cells(self, row: Sequence[Cell]) -> Markup:
        return Markup("").join(
            Markup("<td{}{}>{}</td>").format(
                _class(column.style),
                Markup(' data-value="{}"').format(cell.value) if isinstance(cell, Value) else "",
                str(cell) if isinstance(cell, Value) else cell,
            )
            for cell, column in zip(row, self.columns, strict=True)
        )


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

    @property
    def caption(self) -> Markup:
        return Markup(rst(self.text))

    def html(self, spoken: Language) -> Markup:
        picture = Markup("<noscript>It is drawn where the page may run its own script.</noscript>")
        if self.path:
            drawn = base64.b64encode(read_bytes(self.path)).decode()
            source = f"data:{_MEDIA[Path(self.path).suffix]};base64,{drawn}"
            picture = Markup('<img src="{}" alt="{}">').format(source, self.label)
            picture = Markup('<a href="{}">{}</a>').format(self.link, picture) if self.link else picture
        numbers = Markup('<div class="live"></div><script type="application/json">{}</script>\n')
        return Markup(
            '<figure id="{}"{}>\n{}\n{}<figcaption><b>{}.</b> {}{}</figcaption>\n</figure>\n'
        ).format(
            _anchor(self.label), Markup(" data-trace") if self.numbers else "", picture,
            numbers.format(self.numbers) if self.numbers else "", self.label, self.caption, _origin(self, spoken),
        )  # fmt: skip


Item = Text | Findings | Listing | Table | Figure


@dataclass(frozen=True)
class Section:
    """A heading and what stands under it; ``folded`` is what a reader opens who asks for it."""

    title: str
    items: list[Item]
    folded: bool = False

    @property
    def listed(self) -> list[Table | Figure]:
        return [item for item in self.items if isinstance(item, Table | Figure)]

    def entry(self) -> Markup:
        """Its line in the table of contents."""
        listed = Markup("").join(_ENTRY.format(_anchor(one.label), one.label, "") for one in self.listed)
        inside = Markup("\n<ol>{}</ol>\n").format(listed) if listed else ""
        return _ENTRY.format(_anchor(self.title), self.title, inside)

    def html(self, spoken: Language) -> Markup:
        head, end = Markup("<h2>{}</h2>\n").format(self.title), ""
        if self.folded:
            head, end = Markup("<details><summary>{}</summary>\n").format(head), Markup("</details>\n")
        items = Markup("").join(one.html(spoken) for one in self.items)
        return Markup('<section id="{}">\n{}{}{}</section>\n').format(_anchor(self.title), head, items, end)


_ENTRY = Markup('<li><a href="#{}">{}</a>{}</li>\n')


def _class(style: str) -> Markup:
    return Markup(' class="{}"').format(style) if style else Markup("")


def _each(pattern: str, texts: Iterable[str]) -> Markup:
    return Markup("").join(Markup(pattern).format(text) for text in texts)


def _origin(item: Table | Figure, spoken: Language) -> Markup:
    """Where its numbers stand, and what made them."""
    if not item.link:
        return Markup("")
    rule = spoken.text(f", rule {item.rule}") if item.rule else ""
    return Markup(' <span class="source">(<a href="{0}">{0}</a>{1})</span>').format(item.link, rule)


# what reStructuredText takes for more than words
_MARKED = re.compile(r"[*`|\\]|_\b|\n\s*\n|^\.\.", re.MULTILINE)


def rst(text: str) -> str:
    """The HTML of a caption in reStructuredText; mathematics becomes plain HTML, which needs no font of its own."""
    if not _MARKED.search(text):
        return str(escape(text.strip()))
    options = {"math_output": "HTML", "report_level": 3, "halt_level": 5, "file_insertion_enabled": False}
    parts = needed("docutils.core").publish_parts(text, writer="html5", settings_overrides=options)
    body = parts["body"].strip()
    single = re.fullmatch(r"<p>(.*)</p>", body, re.DOTALL)
    return single[1] if single and "<p>" not in single[1] else body


class Head(NamedTuple):
    """What stands above and below the sections: title, subtitle, the notices that a reader must see before anything else, the footer;
    and the language of the page."""

    title: str
    subtitle: str
    notices: Sequence[str]
    footer: str
    lang: str = ENGLISH


def write(path: str | Path, sections: Sequence[Section], head: Head) -> Path:
    """The path written: the report with its sections, in one file."""
    zoomable = any(isinstance(item, Figure) and item.numbers for one in sections for item in one.items)
    style, program = (
        Markup("\n".join(one.read_text(encoding="utf-8") for one in (own, *(more if zoomable else ()))))
        for own, more in ((_STYLE, trace.STYLE), (_PROGRAM, trace.PROGRAM))
    )  # fmt: skip
    spoken = language(head.lang)
    html = Markup(_PAGE.read_text(encoding="utf-8")).format(
        lang=head.lang, title=head.title, subtitle=head.subtitle, footer=head.footer, style=style, program=program,
        sort=spoken.text("sort by this column"), contents=spoken.text("Contents"),
        entries=Markup("").join(one.entry() for one in sections), notices=_each('<p class="notice">{}</p>\n', head.notices),
        sections=Markup("").join(one.html(spoken) for one in sections),
    )  # fmt: skip
    return write_text(path, printable(html))


def _anchor(label: str) -> str:
    return re.sub(r"[^a-z0-9]+", "-", label.lower()).strip("-")
