"""The report in another language: every text of its sections looked up, every number with that language's decimal sign."""

import re
from collections.abc import Sequence
from dataclasses import replace
from html import unescape

from markupsafe import Markup, escape

from ..language import ENGLISH, Language
from .page import Cell, Column, Figure, Findings, Item, Section, Table, Text, Value

_TAG = re.compile(r"(<[^>]+>)")
_NAMES = ("recording", "campaign", "file", "pendulum")  # heads of columns whose cells are somebody's names


def in_language(sections: Sequence[Section], spoken: Language) -> list[Section]:
    """The sections with their texts in this language; what its catalogue has not stays English."""
    if spoken.code == ENGLISH:
        return list(sections)
    return [
        replace(one, title=spoken.text(one.title), items=[_item(item, spoken) for item in one.items])
        for one in sections
    ]


def words(text: str, spoken: Language) -> str:
    """A text in this language; of markup each text between tags."""
    if not isinstance(text, Markup):
        return spoken.text(text)
    parts = _TAG.split(str(text))
    named = [k for k in range(2, len(parts), 2) if parts[k - 1] == "<code>"]  # stays as it is in a file
    for k in set(range(0, len(parts), 2)) - set(named):
        parts[k] = str(escape(spoken.text(unescape(parts[k]))))
    return Markup("".join(parts))


def _item(item: Item, spoken: Language) -> Item:
    if isinstance(item, Text):
        return replace(item, text=words(item.text, spoken))
    if isinstance(item, Findings):
        return replace(item, lines=[words(line, spoken) for line in item.lines])
    if isinstance(item, Table):
        return _table(item, spoken)
    if isinstance(item, Figure):
        return replace(item, label=spoken.text(item.label), text=words(item.text, spoken))
    return item


def _table(table: Table, spoken: Language) -> Table:
    columns = [replace(one, head=spoken.text(one.head), unit=spoken.text(one.unit)) for one in table.columns]
    rows = [
        [_cell(cell, column, spoken) for cell, column in zip(row, table.columns, strict=True)]
        for row in table.rows
    ]
    notes = tuple(words(note, spoken) for note in table.notes)
    label, caption = spoken.text(table.label), words(table.caption, spoken)
    return replace(table, label=label, caption=caption, columns=columns, rows=rows, notes=notes)


def _cell(cell: Cell, column: Column, spoken: Language) -> Cell:
    if isinstance(cell, int) or column.style == "code" or column.head in _NAMES:
        return cell
    if isinstance(cell, Value):
        return cell._replace(text=spoken.number(cell.text))
    if column.style == "n" and not isinstance(cell, Markup):
        return spoken.number(cell)
    return words(cell, spoken)
