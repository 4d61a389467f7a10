"""How models are called: symbols typeset, effects in words; and where a column of labels changes."""

import re
from collections.abc import Iterable

from markupsafe import Markup, escape

from ..pendulum.model import symbol


def model_symbol(label: str) -> Markup:
    """A model's symbol as HTML, the effects as subscript; the row of the error bounds, which is no model, in words."""
    if label == "error_bounds":
        return Markup(escape(label.replace("_", " ")))
    text = symbol(label)
    return Markup(f"{text[0]}<sub>{escape(text[1:])}</sub>")


def with_symbols(text: str) -> Markup:
    """A sentence with the models' symbols typeset: ``κv,q`` with its subscript."""
    return Markup(re.sub(r"κ(\w+(?:,\w+)*)", r"κ<sub>\1</sub>", str(escape(text))))


def groups(labels: Iterable[object]) -> tuple[int, ...]:
    """The positions at which a column of labels changes."""
    labels = list(labels)
    return tuple(k for k in range(1, len(labels)) if labels[k] != labels[k - 1])
