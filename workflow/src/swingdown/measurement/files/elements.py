"""What programs save as XML, read within bounds: its elements, and the columns that a reader finds in them."""

import re
import zipfile
import zlib
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, BinaryIO, NamedTuple
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import pandas as pd

from ...arrays import Floats
from ...errors import InputError

ZIP = b"PK\x03\x04"
DAMAGED = (zipfile.BadZipFile, zlib.error, RuntimeError, EOFError)  # what a zip archive raises that is so
FEWEST = 10  # numbers in an array; a shorter one is a setting
LARGEST = 100_000_000  # bytes of XML: the tree is held whole and takes some ten times as much


class Columns(NamedTuple):
    """The columns of one recording as a program saved them: numbers, NaN where it has none."""

    frame: pd.DataFrame
    layout: str  # told to the user
    units: dict[str, str] = {}
    about: dict[str, Any] = {}
    remarks: tuple[str, ...] = ()  # to the user, beside the layout
    usual: dict[str, float] = {}  # cells of the sample sheet where it says nothing
    ordered: bool = True  # False of arrays that were saved by their names: the first of them is the swing no more than another

    @classmethod
    def of_arrays(cls, kept: Mapping[str, Floats], kind: str, more: str = "") -> "Columns":
        """The Columns of arrays that ``kind`` saved, by their names; those of one array, ``name 1`` and so on, are in order."""
        frame, alike = pd.DataFrame(kept), {re.sub(r" \d+$", "", name) for name in kept}
        return cls(frame, f"arrays of {kind}{more}", about={"source": kind}, ordered=len(alike) == 1)


def of_elements(
    filled: Sequence[tuple[Element, list[float]]],
    tags: tuple[str, str, str],
    layout: str,
    about: dict[str, Any],
) -> Columns:
    """The Columns of elements with their numbers; ``tags`` hold what each is called, what tells it from others called so, and its unit."""
    called, more, units = ([text_in(one, tag) for one, _ in filled] for tag in tags)
    names = distinct(called, more)
    frame = pd.DataFrame({key: pd.Series(values) for key, (_, values) in zip(names, filled, strict=True)})
    return Columns(frame, layout, {key: unit for key, unit in zip(names, units, strict=True) if unit}, about)


def columns_in(key: str, value: Any) -> dict[str, Floats]:
    """The columns of an array of numbers: itself, or of two dimensions as many as the shorter has, ``key 1``, ``key 2``; none of a setting."""
    if value.dtype.kind not in "fiu" or value.ndim not in (1, 2) or max(value.shape, default=0) < FEWEST:
        return {}
    if value.ndim == 1:
        return {key: value.astype(float)}
    across = value if value.shape[0] >= value.shape[1] else value.T
    return {f"{key} {k}": one.astype(float) for k, one in enumerate(across.T, 1)}


def no_arrays(name: str, mend: str) -> InputError:
    """What is told of a file in which no array is long enough."""
    problem = f"it holds no array of {FEWEST} numbers or more"
    return InputError(name, problem, "arrays of a time and a swing", mend)


class _Plain(ElementTree.TreeBuilder):
    """Elements of a document that defines no entities: those that these programs write never do, and entities can fill the memory."""

    def doctype(self, name: str, pubid: str, system: str) -> None:
        raise ValueError("it declares a document type, which these programs never do")


def roots(source: BinaryIO, name: str, program: str, ending: str, way: str = "as CSV") -> Iterator[Element]:
    """The root element of an open XML file, or of each that ends in ``ending`` inside a zip archive.

    InputError for what is no XML, declares entities, or has more than ``LARGEST`` bytes; ``program`` is who writes such files,
    and ``way`` how its table is exported there.
    """
    head = source.read(4)
    source.seek(0)
    try:
        if head != ZIP:
            yield _root(source.read(LARGEST + 1), name)
            return
        with zipfile.ZipFile(source) as archive:
            inside = [one for one in archive.namelist() if one.lower().endswith(ending)]
            if not inside:
                problem = f"the archive holds no file that ends in {ending}"
                expected = f"an archive that {program} saved"
                raise InputError(name, problem, expected, f"save it again in {program}")
            for one in inside:
                with archive.open(one) as file:
                    yield _root(file.read(LARGEST + 1), f"{name}, {one}")
    except InputError:
        raise
    except (ElementTree.ParseError, LookupError, ValueError, *DAMAGED) as error:
        no_xml = isinstance(error, ElementTree.ParseError)
        what = "it is no XML, or not whole" if no_xml else f"it cannot be read ({error})"
        mend = f"save it again in {program}, or export its table {way}"
        raise InputError(name, what, f"a file as {program} saves it", mend) from error


def _root(content: bytes, name: str) -> Element:
    if len(content) > LARGEST:
        problem = f"it has more than {LARGEST / 1e6:.0f} MB"
        raise InputError(name, problem, "a smaller file", "export its table as CSV")
    return ElementTree.fromstring(content, ElementTree.XMLParser(target=_Plain()))


def text_in(element: Element, tag: str) -> str:
    """The text of a child, "" where there is none, on one line."""
    return " ".join((element.findtext(tag) or "").split())


def number(text: str | None) -> float:
    """A number as programs write it, with a point or a comma; NaN for a cell that holds none."""
    try:
        return float((text or "").replace(",", "."))
    except ValueError:
        return float("nan")


def distinct(names: list[str], more: list[str]) -> list[str]:
    """The names, each once: one that repeats takes what stands for it in ``more``, and a number if that does not help."""
    found: list[str] = []
    for name, other in zip(names, more, strict=True):
        chosen, count = name, 1
        if names.count(name) > 1 and other:
            chosen = name = f"{name} {other}"
        while chosen in found:
            count += 1
            chosen = f"{name} {count}"
        found.append(chosen)
    return found
