"""Measurements of CASSY Lab (LD Didactic): the channels of ``.labx``, run by run, and the table of ``.lab``."""

import itertools
import re
from typing import BinaryIO
from xml.etree.ElementTree import Element

import pandas as pd

from ...errors import InputError
from .columns import TIME, meaning
from .elements import Columns, distinct, number, of_elements, roots, text_in

PROGRAM = "CASSY Lab"
_RANGE = re.compile(r"([-+\d.E]+ ){12,}[-+\d.E]+ ?")  # of a quantity, and how it is shown
_NUMBERS = re.compile(r"[-+\d.E ]*\d[-+\d.E ]*")
_OWN = 3  # quantities that each file names first: the row's number, the time, the frequency of a spectrum


def table(source: BinaryIO, name: str) -> dict[str, Columns]:
    """The Columns of the table in a file of CASSY Lab 1; none of another file that ends in ``.lab``, and InputError for one without rows.

    Each quantity stands in four lines: its name, symbol, unit and range. Below all of them the rows hold them in this order, but for the
    frequency, which a spectrum below has.
    """
    if not re.match(rb"CL\d+\r?\n", source.read(8)):
        source.seek(0)
        return {}
    lines = [line.strip("\r\n") for line in source.read().decode("latin-1").split("\n")]
    first = next((k for k, line in enumerate(lines) if "\t" in line), 0)
    head = lines[:first]
    told = [
        four[:3]
        for four in zip(head, head[1:], head[2:], head[3:], strict=False)
        if _RANGE.fullmatch(four[3]) and not any(map(_NUMBERS.fullmatch, four[:3]))
    ]
    rows = itertools.takewhile(lambda line: "\t" in line, lines[first:])
    cells = list(zip(*(line.split("\t")[:-1] for line in rows), strict=False))
    read = dict(zip(told[: _OWN - 1] + told[_OWN:], cells, strict=False))
    kept = list(read)[1:]
    if len(kept) < 2:
        raise InputError(
            name, "it holds no quantity beside the time", "a measurement of CASSY Lab against time", "export the table there, as text"
        )  # fmt: skip
    names = distinct([one[0] for one in kept], [one[1] for one in kept])
    frame = pd.DataFrame({key: map(number, read[one]) for key, one in zip(names, kept, strict=True)})
    units = {key: one[2] for key, one in zip(names, kept, strict=True) if one[2]}
    return {"": Columns(frame, "quantities of CASSY Lab", units, {"source": PROGRAM})}


def measurements(source: BinaryIO, name: str) -> dict[str, Columns]:
    """The Columns of each run, by ``run 1`` and so on: its channels beside the time.

    A channel that has fewer values than the time, such as a rate, ends earlier. InputError for a file without a channel of times.
    """
    found: list[Columns] = []
    for root in roots(source, name, PROGRAM, ".xml"):
        groups = [group.findall("channel") for group in root.iter("channels")]
        for k in range(max(map(len, groups), default=0)):
            if columns := _run([group[k] for group in groups if len(group) > k]):
                found.append(columns)
    if not found:
        problem = "it holds no channel of times with a channel of values beside it"
        expected = "a measurement against time"
        raise InputError(name, problem, expected, "measure against the time t, or export the table as text")
    return {f"run {k}": columns for k, columns in enumerate(found, 1)}


def _run(channels: list[Element]) -> Columns | None:
    """The channels along the time, or None without them; those along the frequencies of a spectrum are left out."""
    filled = [(one, values) for one in channels if (values := _values(one))]
    times = [len(values) for one, values in filled if meaning(text_in(one, "quantity"), text_in(one, "unit")).kind == TIME]  # fmt: skip
    if not times:
        return None
    length = times[0]
    spectra = {len(values) for one, values in filled if text_in(one, "unit") == "Hz"} - {length}
    counted = [float(k) for k in range(1, length + 1)]  # the numbers of the samples: nothing was measured
    beside = ((one, values) for one, values in filled if len(values) not in spectra)
    kept = [(one, values) for one, values in beside if values != counted[: len(values)]]
    if len(kept) < 2:
        return None
    begun = next((date for one, _ in kept if (date := one.get("datetime"))), "")
    about = {"source": PROGRAM} | ({"begun": begun} if begun else {})
    return of_elements(kept, ("quantity", "symbol", "unit"), "channels of CASSY Lab", about)


def _values(channel: Element) -> list[float]:
    values = channel.find("values")
    return [] if values is None else [number(one.text) for one in values.findall("value")]
