"""Whatever kind of file a recording is in, its tables are found by their runs, with units and the file's account of itself."""

import hashlib
import json
import zipfile

import netCDF4
import numpy as np
import openpyxl
import pandas as pd
import pytest
from scipy.io import savemat

from swingdown.errors import InputError
from swingdown.measurement.files import source
from swingdown.measurement.files.runs import SeveralRuns
from swingdown.measurement.files.source import check_sha256, opened, runs, table_of
from swingdown.measurement.sheet import COLUMNS

TIMES = np.arange(60) / 20
ANGLES = np.round(0.3 * np.cos(4 * TIMES), 6)
CSV = "t (s),angle (rad)\n" + "".join(f"{t},{x}\n" for t, x in zip(TIMES, ANGLES, strict=True))
TWO = "t (s) Run #1,angle (rad) Run #1,t (s) Run #2,force (N) Run #2\n" + "".join(
    f"{t},{x},{t},{2 * x}\n" for t, x in zip(TIMES, ANGLES, strict=True)
)


@pytest.fixture
def read(tmp_path):
    """A function that gives the table of a file, and all its rows, by the cells of a sheet."""

    def one(name, **cells):
        row = {**COLUMNS, "recording": "a", "file": str(tmp_path / name)} | cells
        with opened(row["file"], "sheet.csv") as stream:
            table = table_of(stream, row)
            return table, pd.concat(table.pieces)

    return one


def netcdf(path, lone=False, **variables):
    """A file with variables along dimensions of their own lengths, each with a unit that its name ends in."""
    with netCDF4.Dataset(path, "w") as file:
        file.Source = "bench"
        if lone:
            file.captured = "yes"
        for name, values in variables.items():
            along = f"n{np.shape(values)[0]}" if np.ndim(values) else ""
            if along and along not in file.dimensions:
                file.createDimension(along, np.shape(values)[0])
            one = file.createVariable(name, "f8", (along,) if along else ())
            one[...] = values
            if "_" in name:
                one.units = name.rpartition("_")[2]


def test_variables_of_a_netcdf_file_are_columns_with_their_units(tmp_path, read):
    """Those along the longest dimension, or along that of the time which the sheet names; a single number is none."""
    netcdf(tmp_path / "a.nc", gain=2.0, t_s=TIMES, x_rad=ANGLES, note=np.arange(7.0), late_s=np.arange(7) / 2)
    table, rows = read("a.nc")
    assert table.names == ("t_s", "x_rad") and table.units == {"t_s": "s", "x_rad": "rad"}
    np.testing.assert_array_equal(rows["x_rad"], ANGLES)
    assert list(rows.index[:2]) == [1, 2] and table.about["source"] == "bench"
    table, rows = read("a.nc", time_column="late_s")
    assert table.names == ("note", "late_s") and len(rows) == 7


def test_what_a_capture_keeps_of_its_device_is_no_swing_unless_it_is_named(tmp_path, read):
    kept = {"time": TIMES, "angle": ANGLES, "sent": TIMES, "sequence": TIMES, "arrival": TIMES}
    netcdf(tmp_path / "a.nc", lone=True, **kept)
    assert read("a.nc")[0].names == ("time", "angle")
    assert read("a.nc", time_column="sent")[0].names == ("time", "angle", "sent")
    assert read("a.nc", signal_column="arrival")[0].names == ("time", "angle", "arrival")
    netcdf(tmp_path / "b.nc", **kept)
    assert read("b.nc")[0].names == tuple(kept)


def test_a_netcdf_file_without_a_row_of_numbers_is_refused(tmp_path, read):
    netcdf(tmp_path / "a.nc", gain=2.0)
    with pytest.raises(InputError, match="no variable of one dimension"):
        read("a.nc")


def test_a_netcdf_file_that_takes_more_than_can_be_held_is_refused(tmp_path, read, monkeypatch):
    netcdf(tmp_path / "a.nc", t=TIMES, x=ANGLES)  # 2 x 60 numbers of 8 bytes
    monkeypatch.setattr(source, "LARGEST", 960)
    assert len(read("a.nc")[1]) == 60
    monkeypatch.setattr(source, "LARGEST", 959)
    with pytest.raises(InputError, match="its variables take"):
        read("a.nc")


def test_a_file_larger_than_any_recording_is_refused_unread(tmp_path, read, monkeypatch):
    (tmp_path / "a.csv").write_text(CSV)
    size = (tmp_path / "a.csv").stat().st_size
    monkeypatch.setattr(source, "MOST_BYTES", size)
    assert len(read("a.csv")[1]) == 60 and len(read((tmp_path / "a.csv").as_uri().split("/")[-1])[1]) == 60
    monkeypatch.setattr(source, "MOST_BYTES", size - 1)
    for name in (str(tmp_path / "a.csv"), (tmp_path / "a.csv").as_uri()):
        with pytest.raises(InputError, match="of at most 0 GB"), opened(name, "sheet.csv"):
            pass


@pytest.mark.parametrize("name", ["gone.csv", "folder"])
def test_a_file_that_is_not_there_or_is_none_is_told_with_the_reason(tmp_path, read, name):
    (tmp_path / "folder").mkdir()
    with pytest.raises(InputError, match=f"{name} cannot be read .(No such file|it is no file)"):
        read(name)
    with pytest.raises(InputError, match="cannot be read"), opened((tmp_path / "gone").as_uri(), "sheet.csv"):
        pass


def test_a_run_is_asked_for_by_its_name_or_by_what_it_alone_has(tmp_path, read):
    (tmp_path / "two.csv").write_text(TWO)
    with open(tmp_path / "two.csv", "rb") as stream:
        assert runs(stream, {**COLUMNS, "file": "two.csv"}) == ["Run #1", "Run #2"]
    np.testing.assert_allclose(read("two.csv", run="Run #2")[1].iloc[:, 1], 2 * ANGLES)
    assert len(read("two.csv", signal_column="force (N) Run #2")[0].names) == 2
    with pytest.raises(SeveralRuns) as asked:
        read("two.csv")
    assert asked.value.names == ("Run #1", "Run #2")
    with pytest.raises(InputError, match="Run #3"):
        read("two.csv", run="Run #3")


def test_a_sheet_is_asked_of_what_has_sheets_alone(tmp_path, read):
    (tmp_path / "a.csv").write_text(CSV)
    with pytest.raises(InputError, match="the file has no sheets, and the sample sheet asks for 'data'"):
        read("a.csv", sheet="data")
    book = openpyxl.Workbook()
    for title, factor in (("first", 1), ("second", 2)):
        page = book.create_sheet(title)
        for line in [["t (s)", "angle (rad)"], *zip(TIMES, factor * ANGLES, strict=True)]:
            page.append(list(line))
    del book["Sheet"]
    book.save(tmp_path / "a.xlsx")
    table, rows = read("a.xlsx", sheet="second")
    np.testing.assert_allclose(table.numbers(rows, "angle (rad)"), 2 * ANGLES)
    assert "sheet `second`" in table.layout


def test_a_file_in_an_archive_is_read_as_by_itself_and_its_place_is_told(tmp_path, read):
    savemat(tmp_path / "saved.mat", {"t": TIMES, "theta": ANGLES})
    with zipfile.ZipFile(tmp_path / "a.zip", "w") as archive:
        archive.writestr("swing.csv", CSV)
    with zipfile.ZipFile(tmp_path / "b.zip", "w") as archive:
        archive.write(tmp_path / "saved.mat", "saved.mat")
    table, rows = read("a.zip")
    np.testing.assert_allclose(table.numbers(rows, "angle (rad)"), ANGLES)
    assert "swing.csv" in table.layout
    table, rows = read("b.zip")
    np.testing.assert_allclose(rows["theta"], ANGLES)
    assert "saved.mat" in table.layout and "MATLAB" in table.layout


@pytest.mark.parametrize("named", [False, True])
def test_times_are_made_of_a_stated_rate_where_a_program_saved_none(tmp_path, read, named):
    (tmp_path / "a.json").write_text(
        json.dumps({"time" if named else "x": list(TIMES), "angle": list(ANGLES)})
    )
    table, rows = read("a.json", rate_hz=20.0)
    assert len(table.names) == (2 if named else 3) and list(rows.index[:2]) == [1, 2]
    if not named:
        np.testing.assert_allclose(rows.iloc[:, 0], np.arange(60) / 20)
    assert len(read("a.json")[0].names) == 2


def test_a_checksum_is_that_of_the_whole_file(tmp_path):
    path = tmp_path / "a.bin"
    path.write_bytes(bytes(range(256)) * 5000)  # more than a piece
    own = hashlib.sha256(path.read_bytes()).hexdigest()
    with open(path, "rb") as stream:
        assert check_sha256(stream, "", "a.bin", "sheet.csv") == own and stream.tell() == 0
        assert check_sha256(stream, own.upper(), "a.bin", "sheet.csv") == own
        with pytest.raises(InputError, match=f"the file has {own}"):
            check_sha256(stream, "0" * 64, "a.bin", "sheet.csv")
