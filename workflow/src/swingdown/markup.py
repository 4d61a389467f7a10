"""What a notebook shows of an object: sentences, a short table, a picture."""

import base64
import io
from collections.abc import Sequence
from html import escape
from typing import Any, Protocol


class Drawn(Protocol):
    """A figure of matplotlib, which this module need not load."""

    def savefig(self, *given: Any, **options: Any) -> Any: ...


def table(heads: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """A table as HTML: ``heads``, none where they are empty, and a row of cells each; the first column is words."""
    head = f"<tr>{''.join(f'<th>{escape(one)}</th>' for one in heads)}</tr>" if heads else ""
    return f"<table>{head}{''.join(map(_row, rows))}</table>"


def _row(cells: Sequence[object]) -> str:
    first, *others = (escape(str(one)) for one in cells)
    return f"<tr><td style='text-align:left'>{first}</td>{''.join(f'<td>{one}</td>' for one in others)}</tr>"


def page(said: Sequence[str], body: str, picture: Drawn | None = None, lead: str = "") -> str:
    """The ``lead`` in bold, lines of text, the ``body`` as it is, and the picture."""
    texts = [f"<p><b>{escape(lead)}</b></p>"] if lead else []
    texts += [f"<p>{escape(line)}</p>" for line in said]
    return "".join(texts) + body + (_image(picture) if picture is not None else "")


def _image(picture: Drawn) -> str:
    drawn = io.BytesIO()
    picture.savefig(drawn, format="png", dpi=110)
    source = base64.b64encode(drawn.getvalue()).decode()
    return f"<img alt='the swings' src='data:image/png;base64,{source}'>"
