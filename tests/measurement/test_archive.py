"""Workbooks and zip archives: the sheet's numbers are read as those of a text file are, and what is no table is refused."""

import io
import zipfile

import numpy as np
import openpyxl
import pandas as pd
import pytest
from exports import zipped
from scipy.io import savemat

from swingdown.__main__ import main
from swingdown.errors import InputError
from swingdown.measurement.recording import ingest
from swingdown.measurement.sheet import read_sheet

TIME = np.arange(1500) / 50
SWING = np.round(np.degrees(0.4 * np.exp(-0.03 * TIME) * np.cos(5 * TIME)), 4)


@pytest.fixture
def read(tmp_path, monkeypatch):
    """A function that reads a file of these bytes and this name, as a study does."""
    monkeypatch.chdir(tmp_path)

    def one(content, name, sheet=""):
        (tmp_path / name).write_bytes(content)
        (tmp_path / "sheet.csv").write_text(f"recording,file,sheet\na,{name},{sheet}\n")
        return ingest(read_sheet("sheet.csv").loc["a"], "sheet.csv")

    return one


def workbook(**sheets):
    """The bytes of a workbook; each sheet a list of rows."""
    book = openpyxl.Workbook()
    book.remove(book.active)
    for name, rows in sheets.items():
        sheet = book.create_sheet(name)
        for row in rows:
            sheet.append(row)
    stream = io.BytesIO()
    book.save(stream)
    return stream.getvalue()


ROWS = [["Time (s)", "Angle (°)"], *map(list, zip(TIME.tolist(), SWING.tolist(), strict=True))]
TEXT = "\n".join(";".join(map(str, row)) for row in ROWS) + "\n"


def same(found):
    assert found["signal"].attrs["units"] == "deg"
    np.testing.assert_array_equal(found["time"].values, TIME)
    np.testing.assert_array_equal(found["signal"].values, SWING)


def test_the_first_sheet_of_a_workbook(read):
    found = read(workbook(Data=ROWS, Notes=[["about", 1]]), "swing.xlsx")
    same(found)
    assert found.attrs["taken"].endswith("50.0 samples a second, sheet `Data` of 2")


def test_a_sheet_by_name_with_lines_of_title_above_the_header(read):
    same(read(workbook(Notes=[["about", 1]], Data=[["Class 9b"], [], *ROWS]), "swing.xlsx", "Data"))


def test_of_two_sheets_of_numbers_the_first_is_taken_and_one_that_is_named_whatever_others_hold(read):
    other = [ROWS[0], *([time, 2 * angle] for time, angle in ROWS[1:])]
    same(read(workbook(One=ROWS, Two=other), "swing.xlsx"))
    found = read(workbook(One=ROWS, Two=other), "swing.xlsx", "Two")
    np.testing.assert_array_equal(found["signal"].values, 2 * SWING)
    with pytest.raises(InputError, match=r"swing\.xlsx"):
        read(workbook(Notes=[["about", 1]], Data=ROWS), "swing.xlsx", "Notes")
    same(read(workbook(Notes=[["about", 1]], Data=ROWS, More=other), "swing.xlsx"))


def test_a_cell_that_is_no_number_is_a_missing_sample(read):
    rows = [list(row) for row in ROWS]
    rows[40][1] = "#DIV/0!"
    found = read(workbook(Data=rows), "swing.xlsx")
    assert "1 of 1500 cells of `Angle (°)` hold no number" in found.attrs["remarks"]


def test_an_archive_as_phyphox_exports_it(read):
    found = read(
        zipped({"Raw_Data.csv": TEXT, "meta/device.csv": "property;value\n", "meta/time.csv": "a;b\n1;2\n"}),
        "x.zip",
    )
    same(found)
    assert "`Raw_Data.csv` in the archive" in found.attrs["taken"]


def test_an_archive_of_several_files_asks_which(read):
    two = zipped({"one.csv": TEXT, "two.csv": TEXT})
    with pytest.raises(InputError, match="2 files of numbers.*which.*one.csv, two.csv.*cell `sheet`"):
        read(two, "x.zip")
    same(read(two, "x.zip", "two.csv"))


def test_notes_beside_the_table_in_an_archive_are_no_second_one(read):
    same(read(zipped({"notes.txt": "Monday 12, run 3\nthe long rod\n", "data/one.csv": TEXT}), "x.zip"))


@pytest.mark.parametrize(
    ("content", "name", "sheet", "words"),
    [
        (workbook(Data=ROWS), "a.xlsx", "data", "no sheet 'data'.*Expected: Data"),
        (workbook(Data=[]), "a.xlsx", "", "empty"),
        (zipped({"readme": "x"}), "a.zip", "", "no table of numbers"),
        (zipped({"one.csv": TEXT}), "a.zip", "two.csv", "no file 'two.csv'.*one.csv"),
        (TEXT.encode(), "a.csv", "Data", "has no sheets"),
        (zipped({"one.csv": zipped({"two.csv": TEXT})}), "a.zip", "", "a zip archive inside another"),
        (b"PK\x03\x04" + bytes(100), "a.xlsx", "", "cannot be read"),
        (b"\xd0\xcf\x11\xe0" + bytes(600), "a.xls", "", r"cannot be read as a workbook \(.*(Error|error).*\)"),
    ],
)  # fmt: skip
def test_what_is_no_such_table_is_refused(read, content, name, sheet, words):
    with pytest.raises(InputError, match=words) as caught:
        read(content, name, sheet)
    assert caught.value.mend


def test_a_workbook_larger_than_can_be_held_is_refused_before_it_is_unpacked(read):
    bomb = io.BytesIO(workbook(Data=ROWS[:30]))
    with zipfile.ZipFile(bomb, "a") as packed:
        packed.writestr("xl/media/z.bin", b"")
        packed.getinfo("xl/media/z.bin").file_size = 600_000_000  # as the archive tells of what is in it
    with pytest.raises(InputError, match="600 MB when unpacked.*save the sheet as CSV"):
        read(bomb.getvalue(), "a.xlsx")


@pytest.mark.parametrize("kind", ["workbook", "archive"])
def test_damage_is_refused_or_harmless(read, kind):
    whole = workbook(Data=ROWS) if kind == "workbook" else zipped({"one.csv": TEXT})
    draws = np.random.default_rng(3)
    for k in range(60):
        damaged = bytearray(whole)
        if k % 4 == 0:
            del damaged[int(draws.integers(10, len(whole))) :]
        else:
            damaged[int(draws.integers(0, len(whole)))] ^= 1 << int(draws.integers(8))
        try:
            found = read(bytes(damaged), "a.xlsx" if kind == "workbook" else "a.zip")
        except InputError:
            continue
        same(found)


def changed(row, cells):
    """The rows with one of them replaced."""
    return [*ROWS[:row], cells, *ROWS[row + 1 :]]


# Ways in which a workbook is spoilt: the bytes of the file.
SPOILT = {
    "another header": workbook(data=[*ROWS, *ROWS]),
    "empty": workbook(data=[]),
    "only a header": workbook(data=ROWS[:1]),
    "decimal signs of two kinds, as text": workbook(
        data=[
            ROWS[0],
            *([str(t), str(x).replace(".", "," if k % 2 else ".")] for k, (t, x) in enumerate(ROWS[1:])),
        ]
    ),
    "cut in the middle": workbook(data=ROWS)[: len(workbook(data=ROWS)) // 2],
    "a picture": b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR",
    "nothing": b"",
}


# Ways in which a row or two are spoilt, and how many samples are then missing.
ROW_SPOILT = {
    "a cell of text": (changed(50, [ROWS[50][0], "oops"]), 1),
    "not a number": (changed(50, [ROWS[50][0], "NaN"]), 1),
    "an error of a formula": (changed(50, [ROWS[50][0], "#DIV/0!"]), 1),
    "a cell less": (changed(50, [ROWS[50][0]]), 1),
    "thousands": (changed(50, ["1.234,5", ROWS[50][1]]), 1),
    "two rows exchanged": ([*ROWS[:50], ROWS[51], ROWS[50], *ROWS[52:]], 0),
    "a row twice": ([*ROWS[:50], ROWS[50], *ROWS[50:]], 0),
    "a row empty": (changed(50, [None, None]), 1),
    "rows gone": ([*ROWS[:50], *ROWS[53:]], 3),
    "text numbers among numbers": (changed(50, [ROWS[50][0], f"{ROWS[50][1]}".replace(".", ",")]), 1),
}


@pytest.mark.parametrize("how", ROW_SPOILT)
def test_of_a_workbook_spoilt_in_a_row_the_others_are_read_and_that_is_told(read, how):
    rows, lost = ROW_SPOILT[how]
    found = read(workbook(data=rows), "swing.xlsx")
    assert found.attrs["remarks"] and found.sizes["time"] == SWING.size - lost
    assert set(found["signal"].values) <= set(SWING)


@pytest.mark.parametrize("how", SPOILT)
def test_a_spoilt_workbook_gives_no_number(read, how):
    with pytest.raises(InputError, match=r"swing\.xlsx") as told:
        read(SPOILT[how], "swing.xlsx")
    assert told.value.problem and told.value.mend


def test_a_workbook_called_csv_and_text_called_xlsx_are_read_or_refused(read):
    """By what they hold, and never as something else."""
    for content, name in ((workbook(data=ROWS), "swing.csv"), (TEXT.encode(), "swing.xlsx")):
        try:
            found = read(content, name)
        except InputError as error:
            assert name in str(error.where) and error.mend
        else:
            same(found)


def test_the_command_takes_the_sheet_that_is_named(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    slower = [ROWS[0], *[[1.25 * time, angle] for time, angle in ROWS[1:]]]
    (tmp_path / "two.xlsx").write_bytes(workbook(Left=ROWS, Right=slower))
    told = {}
    for sheet in ("Left", "Right"):
        assert main(["two.xlsx", "--quick", "--sheet", sheet, "--into", sheet]) == 0
        told[sheet] = float(pd.read_csv(f"{sheet}/first_answer.csv")["period_s"].iloc[0])
    assert told["Right"] == pytest.approx(1.25 * told["Left"], rel=0.01)


def test_an_archive_of_several_files_is_opened_as_a_folder(tmp_path, capsys):
    other = "\n".join(";".join(map(str, row)) for row in [ROWS[0], *([t, 0.8 * a] for t, a in ROWS[1:])])
    (tmp_path / "x.zip").write_bytes(
        zipped(
            {"one.csv": TEXT, "sub/two.csv": other, "photo.jpg": "x", "meta/device.csv": "property;value\n"}
        )
    )
    main([str(tmp_path / "x.zip"), "--quick", "--into", str(tmp_path / "study")])
    sheet = pd.read_csv(tmp_path / "study" / "recordings.csv")
    assert sheet["sheet"].tolist() == ["one.csv", "sub/two.csv"] and set(sheet["file"]) == {"../x.zip"}
    assert sheet["campaign"].is_unique
    left = pd.read_csv(tmp_path / "study" / "left_out.csv")
    assert left["problem"].str.contains("photo.jpg").tolist() == [True]
    found = pd.read_csv(tmp_path / "study" / "first_answer.csv").dropna(subset=["period_s"])
    assert found["period_s"].to_numpy() == pytest.approx(2 * np.pi / 5, rel=0.02) and len(found) == 2


def test_workbooks_and_files_of_programs_in_an_archive_are_read_as_in_a_folder(read, tmp_path, capsys):
    same(read(zipped({"deep/swing.xlsx": workbook(Notes=[["about", 1]], Data=ROWS)}), "x.zip"))
    arrays = io.BytesIO()
    savemat(arrays, {"t": TIME, "theta": np.radians(SWING)})
    both = {
        "one.csv": TEXT,
        "two.xlsx": workbook(Data=ROWS),
        "three.mat": arrays.getvalue(),
        "bad.xlsx": "no workbook",
    }
    (tmp_path / "y.zip").write_bytes(zipped(both))
    main([str(tmp_path / "y.zip"), "--quick", "--into", str(tmp_path / "study")])
    sheet = pd.read_csv(tmp_path / "study" / "recordings.csv")
    assert sheet["sheet"].tolist() == ["one.csv", "two.xlsx", "three.mat"]
    found = pd.read_csv(tmp_path / "study" / "first_answer.csv").dropna(subset=["period_s"])
    assert found["period_s"].to_numpy() == pytest.approx(2 * np.pi / 5, rel=0.02) and len(found) == 3
    assert "y.zip, bad.xlsx: NOT USED: " in capsys.readouterr().out
