"""A file's encoding is told, and its lines come whole, each with its number, marks of other programs taken away."""

import io

import pytest

from swingdown.errors import InputError
from swingdown.measurement.files import text as module
from swingdown.measurement.files.text import charset, encoding, pieces_of

ROWS = "t (s);Winkel (°)\n0,1;12,5\n0,2;−12,5\n"


def coded(content):
    return encoding(io.BytesIO(content), "a.csv")


def lines(content, coding="utf-8-sig"):
    """The text of all pieces, and the number of the first line of each."""
    found = list(pieces_of(io.BytesIO(content), coding, "a.csv"))
    return b"".join(text for _, text in found).decode(charset(coding)), [number for number, _ in found]


@pytest.mark.parametrize(
    ("written", "found"),
    [("utf-8", "utf-8-sig"), ("utf-8-sig", "utf-8-sig"), ("cp1252", "cp1252"), ("utf-16", "utf-16"), ("utf-16-le", "utf-16-le"), ("utf-16-be", "utf-16-be")],
)  # fmt: skip
def test_text_is_read_as_it_was_written(written, found):
    plain = ROWS.replace("−", "-")
    content = plain.encode(written)
    assert coded(content) == found
    assert lines(content, found) == (plain, [1])
    assert coded(content + b"\0" * 600) == found  # of a logger that lost its power


def test_a_byte_late_in_a_file_still_tells_its_encoding():
    content = b"1;2\n" * 300_000 + "3;°\n".encode("cp1252")
    assert coded(content) == "cp1252" and coded(content[:-3] + "°\n".encode()) == "utf-8-sig"


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"\x89PNG\r\n\x1a\n", "a PNG picture"),
        (b"\xef\xbb\xbf \n<html>", "XML or a web page"),
        (b"1;2\n\x01\x02\n", "control characters"),
        (b" \t\r\n\n", "it is empty"),
        (b"", "it is empty"),
        ("1;2\n".encode("utf-16") + b"\x00\xd8\x00\x00", "it is not text"),
    ],
)  # fmt: skip
def test_what_is_no_text_is_refused(content, words):
    with pytest.raises(InputError, match=words):
        coded(content)


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("size", [1, 2, 3, 7, 100])
def test_lines_end_in_any_way_and_come_whole_in_pieces_of_any_size(monkeypatch, end, size):
    monkeypatch.setattr(module, "PIECE", size)
    text = "a;b\n1;22\n\n333;4"
    whole, numbers = lines(text.replace("\n", end).encode())
    assert whole == text + "\n"
    assert numbers == sorted(numbers) and numbers[0] == 1
    if size == 1:
        assert numbers == [1, 2, 3, 4]


def test_a_line_longer_than_any_table_s_is_refused_with_its_number(monkeypatch):
    monkeypatch.setattr(module, "PIECE", 10)
    monkeypatch.setattr(module, "LONGEST", 30)
    assert lines(b"a\n" + b"1" * 30 + b"\n")[0].count("\n") == 2
    with pytest.raises(InputError, match="a.csv, line 2: the line is longer than 30 bytes"):
        lines(b"a\n" + b"1" * 60 + b"\n")


@pytest.mark.parametrize(
    ("written", "read"),
    [
        ("'0:0:0.01,'0.3'\n", "0:0:0.01,0.3\n"),
        ("it's 3 o'clock\n", "it's 3 o'clock\n"),
        ('"0.1;0.2;0.3"\n', "0.1;0.2;0.3\n"),
        ("0.35D+00 1.0d-3\n", "0.35E+00 1.0E-3\n"),
        ("1;−2.5;–3\n", "1;-2.5;-3\n"),
        ("12–13\n", "12–13\n"),  # a range
    ],
)
def test_marks_of_other_programs_are_taken_for_what_they_mean(written, read):
    assert lines(written.encode())[0] == read


@pytest.mark.parametrize(
    ("written", "degrees"),
    [
        ("12°30'", 12.5),
        ("-12°30.6'", -12.51),
        ("0°15'36\"", 0.26),
        ("1° 6′ 18″", 1.105),
        ("+2°0'0.36''", 2.0001),
    ],
)
def test_minutes_and_seconds_of_arc_are_sixtieths(written, degrees):
    found, _ = lines(f"0.1;{written}\n".encode())
    cell = found.strip().removeprefix("0.1;")
    assert cell.endswith("°") and float(cell[:-1]) == pytest.approx(degrees)
    assert cell.startswith(("+", "-")) == written.startswith(("+", "-"))
