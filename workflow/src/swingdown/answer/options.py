"""What is told of the sample sheet in the words of the command, where a mend is an option and nobody has written a sheet yet."""

import re

CELLS = {
    "signal_unit": "--unit",
    "signal_column": "--column",
    "time_unit": "--time-unit",
    "time_column": "--time-column",
    "start_s": "--start",
    "stop_s": "--stop",
    "counts_per_revolution": "--counts-per-revolution",
    "restoring: linear": "--restoring linear",  # of the settings' key model
}
# A cell ({}) with the words about it, the longest first, and what stands for them.
_PHRASES = (
    (r"in the cell {}( of the sheet)?\b", "with {}"),
    (r"\b{} (of|in) the sheet", "{}"),
    (r"\b{} = ", "{} "),
    (r"\bin {}\b", "with {}"),
    (r"(?<![-\w]){}\b", "{}"),
)


def as_options(text: str) -> str:
    """The text with each cell of the sheet that an option of the command stands for named as that option."""
    for pattern, words in _PHRASES:
        for cell, option in CELLS.items():
            text = re.sub(pattern.format(cell), words.format(option), text)
    return text
