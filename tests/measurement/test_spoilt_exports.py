"""Files of other programs with a row that is spoilt: the others are read and that is told, or no number comes of it."""

import numpy as np
import pandas as pd
import pytest
from exports import EXPORTS, SWING, TIME, rows

from swingdown.errors import InputError
from swingdown.measurement.files import series

BROKEN = {
    "a picture": lambda text: b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR",
    "empty": lambda text: "",
    "blank": lambda text: "\n \n\n",
    "a workbook": lambda text: b"PK\x03\x04\x14\x00\x06\x00",
    "its program's own document": lambda text: '<?xml version="1.0"?>\n<document/>\n',
    "another header": lambda text: text + text,
}
# What is spoilt of a sample or two, and what is told: the others are read as they stand.
SPOILT = {
    "a cell more": lambda text: edit(text, 50, lambda cells: [*cells, "1"]),
    "a lost line end": lambda text: edit(text, 50, lambda cells: [*cells, *cells]),
    "an empty line inside": lambda text: edit(text, 50, lambda cells: [""]),
    "a cell of text": lambda text: edit(text, 50, lambda cells: [*cells[:-1], "oops"]),
    "not a number": lambda text: edit(text, 50, lambda cells: [*cells[:-1], "NaN"]),
    "a cell less": lambda text: edit(text, 50, lambda cells: cells[:-1]),
    "thousands": lambda text: edit(text, 50, lambda cells: ["1.234,5", *cells[1:]]),
    "two rows exchanged": lambda text: exchange(text),
    "a row twice": lambda text: edit(text, 50, lambda cells: cells, again=True),
    "a row gone": lambda text: "".join(
        line for k, line in enumerate(text.splitlines(True)) if k not in (50, 51)
    ),
}
IN_THE_LAST_CELL = ("a cell of text", "not a number", "a cell less")
WORDS = {
    "two rows exchanged": "put in order of time",
    "a row twice": "repeat the time of another",
    "a row gone": "samples are missing",
}


def edit(text, number, change, again=False):
    lines = text.splitlines()
    separator = next(one for one in (";", "\t", ",", "  ", " ") if one in lines[number])
    changed = separator.join(change(lines[number].split(separator)))
    return "\n".join([*lines[:number], *([changed] * (2 if again else 1)), *lines[number + 1 :]]) + "\n"


def exchange(text):
    lines = text.splitlines(True)
    lines[50], lines[51] = lines[51], lines[50]
    return "".join(lines)


@pytest.mark.parametrize("how", BROKEN)
@pytest.mark.parametrize("program", [name for name in EXPORTS if name != "quoted"])
def test_a_broken_export_gives_no_number(take, program, how):
    text, encoding, _ = EXPORTS[program]
    with pytest.raises(InputError, match=r"swing\.csv.*Mend:"):
        take(BROKEN[how](text), encoding=encoding)


@pytest.mark.parametrize("how", SPOILT)
@pytest.mark.parametrize("program", [name for name in EXPORTS if name != "quoted"])
def test_of_an_export_spoilt_in_a_row_the_others_are_read_and_that_is_told(take, program, how):
    text, encoding, _ = EXPORTS[program]
    if (
        program == "phyphox_gyroscope" and how in IN_THE_LAST_CELL
    ):  # that is how fast it turns in all, which nothing is read from
        text = "".join(line.rpartition(";")[0] + "\n" for line in text.splitlines())
    whole = take(text, encoding=encoding)
    made = take(SPOILT[how](text), encoding=encoding)
    assert WORDS.get(how, "missing") in made.attrs["remarks"]
    lost = whole.sizes["time"] - made.sizes["time"]
    assert lost == {"two rows exchanged": 0, "a row twice": 0, "a row gone": 2}.get(how, 1)
    near = np.abs(made["time"].values[:, None] - whole["time"].values).min(axis=1)
    assert near.max() < 1e-5
    if program != "tracker":  # the angle of positions depends on all of them
        assert set(made["signal"].values) <= set(whole["signal"].values)


@pytest.mark.parametrize("program", EXPORTS)
def test_of_a_decimal_sign_of_the_other_kind_no_number_is_made(take, program):
    text, encoding, _ = EXPORTS[program]
    lines = text.splitlines(True)
    cells = lines[300]
    lines[300] = cells.replace(",", ".") if "." not in cells else cells.replace(".", ",")
    try:
        told = take("".join(lines), encoding=encoding).attrs["remarks"]
    except InputError as error:
        assert "swing.csv" in str(error)
    else:
        assert "missing" in told
    half = [line.replace(".", ",") if k % 2 else line.replace(",", ".") for k, line in enumerate(lines)]
    if program not in ("logger_pro", "capstone", "arduino", "quoted"):  # there the comma separates
        with pytest.raises(InputError, match="decimal"):
            take("".join(half), encoding=encoding)


@pytest.mark.parametrize("cut", range(1, 18))
@pytest.mark.parametrize("program", EXPORTS)
def test_a_file_cut_in_the_middle_of_a_row_keeps_only_whole_numbers(take, program, cut):
    text, encoding, unit = EXPORTS[program]
    whole = take(text, encoding=encoding)
    kept = text[: len(text) // 2]
    kept = kept[: kept.rindex("\n") + 1 + cut]
    try:
        made = take(kept, encoding=encoding)
    except InputError as error:
        # of quoted cells the last quote is lost, and then nothing tells where the cell ends
        assert any(words in str(error) for words in ("finite", "empty", "EOF inside string"))
        return
    n = made.sizes["time"]
    assert n > 250
    if program != "tracker":  # the angle of positions depends on all of them
        assert (made["signal"].values == whole["signal"].values[:n]).all()
    assert made["time"].values == pytest.approx(
        whole["time"].values[:n], abs=1e-5
    )  # rounded stamps are an even clock's


def test_a_decimal_comma_between_commas_is_refused(take):
    with pytest.raises(InputError, match="the header names 2 column.s. and the rows have 4 cells"):
        take("t,angle\n" + rows(TIME, SWING, comma=True))


def test_the_first_row_is_not_taken_for_a_header_when_a_cell_is_spoilt(take):
    made = take("t_s,theta_rad\n0.0,oops\n" + rows(TIME[1:], SWING[1:]))
    assert (
        "1 of 600 cells of `theta_rad` hold no number (the first 'oops' in line 2)" in made.attrs["remarks"]
    )
    assert made.sizes["time"] == 599


def test_a_long_file_is_read_in_pieces_and_has_the_same_numbers(take, monkeypatch):
    text = "t_s;theta_rad\n" + rows(TIME, SWING, separator=";", comma=True)
    whole = take(text)
    monkeypatch.setattr("swingdown.measurement.files.text.PIECE", 150)
    made = take(text)
    assert made.identical(whole)
    spoilt = take(edit(text, 301, lambda cells: [cells[0], "oops"]))
    assert "the first 'oops' in line 302" in spoilt.attrs["remarks"]
    monkeypatch.setattr(series, "MOST", 121)
    with pytest.raises(InputError, match="more than 121 samples"):
        take(text)
    assert take(text, stop_s=2).sizes["time"] == 121


@pytest.mark.parametrize(
    ("empty", "odd", "why"),
    [
        (50, 0, None),
        (51, 0, "51 of 100 cells hold no finite number"),
        (0, 5, None),
        (0, 6, "6 of 100 cells .*'oops'"),
    ],
)
def test_a_column_of_half_its_numbers_or_of_words_is_another_one(empty, odd, why):
    cells = pd.Series([*[""] * empty, *["oops"] * odd, *["1.5"] * (100 - empty - odd)])
    column = series._Spoilt()
    sound = column.note(cells, pd.to_numeric(cells, errors="coerce").to_numpy(), np.arange(2, 102))
    assert sound.sum() == 100 - empty - odd
    if why:
        with pytest.raises(InputError, match=why):
            column.told("swing.csv", "angle")
    else:
        assert column.told("swing.csv", "angle")[0].startswith(f"{empty + odd} of 100 cells of `angle`")
