"""What is told of the sample sheet in the words of the command or of a call, where nobody has written a sheet yet."""

import re

CELLS = {
    "signal_unit": "--unit",
    "signal_column": "--column",
    "signal_kind": "--kind",
    "input_column": "--input",
    "input_kind": "--input-kind",
    "input_unit": "--input-unit",
    "input_free": "--input-free",
    "input_between": "--input-between",
    "time_unit": "--time-unit",
    "time_column": "--time-column",
    "rate_hz": "--rate",
    "start_s": "--start",
    "stop_s": "--stop",
    "counts_per_revolution": "--counts-per-revolution",
    "bob_diameter": "--bob-diameter",
    "bob_density": "--bob-density",
    "pivot_distance": "--kater",
    "restoring: linear": "--restoring linear",  # of the settings' key model
}
# Cells whose names are words as well stand for an option only where they are called cells.
WORDS = {"scale": "--scale", "length": "--length"}
# A cell ({}) with the words about it, the longest first, and what stands for them.
_PHRASES = (
    (r"in the cell {}( of the sheet)?\b", "with {}"),
    (r"\b{} (of|in) the sheet", "{}"),
    (r"\b{} = ", "{} "),
    (r"\bin {}\b", "with {}"),
    (r"(?<![-\w]){}\b", "{}"),
)


_ARGUMENTS = {
    "signal_unit": "unit=",
    "signal_column": "column=",
    "signal_kind": "kind=",
    "time_unit": "time_unit=",
    "time_column": "time_column=",
    "rate_hz": "rate=",
    "start_s": "start=",
    "stop_s": "stop=",
    "counts_per_revolution": "counts_per_revolution=",
    "restoring: linear": "restoring='linear'",
}


def as_options(text: str) -> str:
    """The text with each cell of the sheet that an option of the command stands for named as that option."""
    return _named(text, CELLS, WORDS)


def as_arguments(text: str) -> str:
    """The text with each cell of the sheet that an argument of ``swingdown.read`` stands for named as that argument."""
    return _named(text, _ARGUMENTS, {cell: f"{cell}=" for cell in WORDS})


def _named(text: str, cells: dict[str, str], words_as_well: dict[str, str]) -> str:
    for k, (pattern, words) in enumerate(_PHRASES):
        for cell, option in (cells if k else cells | words_as_well).items():
            text = re.sub(pattern.format(cell), words.format(option), text)
    return text
