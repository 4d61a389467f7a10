"""A file as text: its encoding, told before anything else is, and its lines, some at a time and never more than can be held."""

import codecs
import re
from collections.abc import Iterator
from typing import BinaryIO

from ...errors import InputError

HEAD = 1 << 16  # bytes from which encoding and layout are told
PIECE = 1 << 20  # bytes held at a time
LONGEST = 1 << 20  # bytes of a line: that of an office program's widest sheet, 16384 columns of 60 digits
# a spreadsheet's mark for text before a number, or its quotes: `'0:0:0.01`, `'0.3'`
# they begin with the sign itself, which is sought at once, and look behind it then
_QUOTED = re.compile(rb"'(?<![^\n,;\t\" ]')([-+.]?\d[-+.,:\deE]*)'?(?![^\n,;\t\" ])")
_ROW = re.compile(rb'(?m)^"([^"\n]*[,;\t][^"\n]*)"$')  # a row that was taken for one cell
# degrees and minutes of arc, and seconds: `12°34.5'`
_ARC = re.compile(
    rb"([-+]?)(\d+)((?:\xc2)?\xb0) ?(\d+(?:\.\d+)?)(?:'|\xe2\x80\xb2)(?: ?(\d+(?:\.\d+)?)(?:''|\"|\xe2\x80\xb3))?"
)
# a video's times with hundredths or thousandths of a second behind a third colon: `0:00:01:67`; up to 59 they might as well be frames
_VIDEO = re.compile(rb"(?<![\d:])(\d{1,2}:\d\d:\d\d):(\d{2,3})(?![\d:])")
_NO_FRAMES = re.compile(rb"(?<![\d:])\d{1,2}:\d\d:\d\d:(?:[6-9]\d|\d{3})(?![\d:])")
_FORTRAN = re.compile(rb"[dD](?<=[\d.].)(?=[-+]\d)")  # its sign of an exponent: `0.35D+00`
# a minus as programs write it in some countries, and the dash that word processors make of it
_MINUS = re.compile(rb"\xe2\x88\x92(?=[\d.,])|(?<![\w.)])\xe2\x80\x93(?=[\d.,])")
FOREIGN = {
    b"\x89PNG": ("a PNG picture", "export the table of numbers, not its picture"),
    b"\xff\xd8\xff": ("a JPEG picture", "export the table of numbers, not its picture"),
    b"GIF8": ("a GIF picture", "export the table of numbers, not its picture"),
    b"%PDF": ("a PDF document", "export the table of numbers itself"),
    b"PK\x03\x04": ("a zip archive inside another", "unpack it"),
    b"\x1f\x8b": ("compressed with gzip", "unpack it"),
    b"\x89HDF": ("netCDF or HDF5", "name it .nc"),
    b"CDF": ("netCDF", "name it .nc"),
    b"<": (
        "XML or a web page, as programs save their own documents",
        "export the data as CSV from the program",
    ),
}


def encoding(source: BinaryIO, name: str) -> str:
    """The encoding of a text file, read through by the megabyte; InputError if it is no text."""
    source.seek(0)
    head = source.read(HEAD)
    found, fault = _marked(head), None
    decoder = codecs.getincrementaldecoder(found)()
    _check_text(head, name, found)
    source.seek(0)
    try:
        while piece := source.read(PIECE):
            decoder.decode(piece)
        decoder.decode(b"", final=True)
    except UnicodeDecodeError as error:
        fault = error
    source.seek(0)
    if fault and found != "utf-8-sig":
        raise _no_text(name, str(fault))
    return "cp1252" if fault else found


def _marked(head: bytes) -> str:
    """UTF-16 where its mark or its zeros are seen, else UTF-8 until a byte says otherwise."""
    head = head.rstrip(b"\0")  # what a logger leaves that lost its power
    if head.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return "utf-16"
    if len(head) > 3 and head.count(0) > 0.3 * len(head):
        return "utf-16-le" if head[1] == 0 else "utf-16-be"
    return "utf-8-sig"


def _check_text(head: bytes, name: str, found: str) -> None:
    for mark, (what, mend) in FOREIGN.items():
        if head.removeprefix(codecs.BOM_UTF8).lstrip().startswith(mark):
            raise InputError(name, f"it is {what}, not text", "a table of numbers as text, or netCDF", mend)
    text = head.decode(found, errors="replace").rstrip("\0")
    if re.search(r"[\x00-\x08\x0e-\x1f]", text):
        raise _no_text(name, "it holds control characters")
    if not text.strip("\ufeff \t\r\n"):
        raise InputError(name, "it is empty: not a table", "a table of numbers", "export it again")


def _no_text(name: str, why: str) -> InputError:
    return InputError(name, f"it is not text ({why})", "CSV, or netCDF", "convert it")


def _in_degrees(found: re.Match[bytes]) -> bytes:
    sign, degrees, mark, minutes, seconds = found.groups()
    angle = int(degrees) + float(minutes) / 60 + float(seconds or 0) / 3600
    return sign + f"{angle:.6f}".encode() + mark


def pieces_of(source: BinaryIO, encoding: str, name: str) -> Iterator[tuple[int, bytes]]:
    """Whole lines of a text, a megabyte at a time, each ended by a line feed, with the number of the first.

    They are in UTF-8 where the file is in UTF-16, else as the file has them (``charset``). InputError for a line that cannot be held.
    """
    source.seek(0)
    decoder = codecs.getincrementaldecoder(encoding)("replace") if encoding.startswith("utf-16") else None
    line, rest, ended, parts = 1, b"", False, False
    while not ended:
        raw = source.read(PIECE)
        ended = not raw
        if line == 1 and not rest:
            raw = raw.removeprefix(codecs.BOM_UTF8)
        text = rest + (decoder.decode(raw, final=ended).encode() if decoder else raw)
        half = b"\r" if text.endswith(b"\r") and not ended else b""  # the line feed of its pair may follow
        text = text.removesuffix(half).replace(b"\r\n", b"\n").replace(b"\r", b"\n")
        if ended and text and not text.endswith(b"\n"):
            text += b"\n"
        cut = text.rfind(b"\n") + 1
        if cut:
            whole = _MINUS.sub(b"-", text[:cut])
            whole = _ARC.sub(_in_degrees, whole) if b"\xb0" in whole else whole
            if b":" in whole:
                parts = parts or bool(_NO_FRAMES.search(whole))
                whole = _VIDEO.sub(rb"\1.\2", whole) if parts else whole
            yield line, _FORTRAN.sub(b"E", _ROW.sub(rb"\1", _QUOTED.sub(rb"\1", whole)))
            line += text.count(b"\n", 0, cut)
        rest = text[cut:] + half
        if len(rest) > LONGEST:
            problem = f"the line is longer than {LONGEST} bytes: it is not a table"
            raise InputError(f"{name}, line {line}", problem, "a table of numbers as text", "export it again")


def charset(encoding: str) -> str:
    """What the bytes of ``pieces_of`` are in, of a file in this encoding."""
    return "cp1252" if encoding == "cp1252" else "utf-8"
