"""Measurements of CASSY Lab 2 (LD Didactic), ``.labx``: its channels, run by run."""

from typing import BinaryIO
from xml.etree.ElementTree import Element

from ...errors import InputError
from .columns import TIME, meaning
from .elements import Columns, number, of_elements, roots, text_in

PROGRAM = "CASSY Lab"


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
        raise InputError(
            name,
            "it holds no channel of times with a channel of values beside it",
            "a measurement against time",
            "measure against the time t, or export the table as text",
        )
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
    kept = [
        (one, values)
        for one, values in filled
        if len(values) not in spectra and values != counted[: len(values)]
    ]
    if len(kept) < 2:
        return None
    begun = next((date for one, _ in kept if (date := one.get("datetime"))), "")
    about = {"source": PROGRAM} | ({"begun": begun} if begun else {})
    return of_elements(kept, ("quantity", "symbol", "unit"), "channels of CASSY Lab", about)


def _values(channel: Element) -> list[float]:
    values = channel.find("values")
    return [] if values is None else [number(one.text) for one in values.findall("value")]
