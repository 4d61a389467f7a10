"""Files that would take more memory, time or patience than there is: each is refused with its reason before it is laid out."""

import io
import os
import time
import zipfile

import netCDF4
import openpyxl
import pytest

from swingdown.errors import InputError
from swingdown.measurement.files import source
from swingdown.measurement.files.source import opened, table_of


def refusal(path, **row):
    """What is told of a file that is refused, and that it took no more than some seconds."""
    begun = time.monotonic()
    with pytest.raises(InputError) as caught, opened(str(path), "sheet.csv, line 2") as file:
        for _ in table_of(file, {"file": str(path), **row}).pieces:
            pass
    assert caught.value.mend and time.monotonic() - begun < 20
    return str(caught.value)


def test_twenty_gigabytes_of_zeros(tmp_path):
    for size, told in (
        (20_000_000_000, "it has 20 GB"),
        (4_000_000_000, "it is not text|longer than|is empty"),
    ):
        with (tmp_path / "zeros.csv").open("wb") as file:
            file.truncate(size)
        assert any(words in refusal(tmp_path / "zeros.csv") for words in told.split("|"))


def test_zeros_behind_a_table_are_a_line_too_long(tmp_path):
    with (tmp_path / "swing.csv").open("wb") as file:
        file.write(b"t_s,theta_rad\n" + b"".join(b"%d,0.1\n" % k for k in range(20000)))
        file.truncate(100_000_000)
    assert "longer than" in refusal(tmp_path / "swing.csv")


def test_a_zip_archive_of_line_ends(tmp_path, monkeypatch):
    monkeypatch.setattr("swingdown.measurement.files.archive.LARGEST", 60_000_000)
    for size, told in ((80, "80 MB when unpacked"), (40, "1 samples|no table|it is empty")):
        with zipfile.ZipFile(tmp_path / "bomb.zip", "w", zipfile.ZIP_DEFLATED, compresslevel=1) as packed:
            packed.writestr("swing.csv", b"t,x\n" + b"\n" * size * 1_000_000)
        assert any(words in refusal(tmp_path / "bomb.zip") for words in told.split("|"))


def test_lines_without_numbers_are_bounded(tmp_path, monkeypatch):
    monkeypatch.setattr("swingdown.measurement.files.rows.MOST_ODD", 1000)
    (tmp_path / "diary.csv").write_text("t,x\n" + "1,2\n" * 20 + "today it swung\n" * 1001)
    assert "1000 of its lines are not rows of numbers" in refusal(tmp_path / "diary.csv")


def test_a_workbook_with_a_stray_cell_far_out(tmp_path):
    book = openpyxl.Workbook()
    for k in range(100):
        book.active.append([k / 10, 0.1])
    book.active.cell(row=1048576, column=16384, value="x")
    book.save(tmp_path / "stray.xlsx")
    told = refusal(tmp_path / "stray.xlsx")
    assert "asks for more memory" in told and "far below or beside the table" in told


def test_a_netcdf_file_that_declares_more_than_there_is(tmp_path):
    with netCDF4.Dataset(tmp_path / "vast.nc", "w") as file:
        file.createDimension("time", 8_000_000_000)
        file.createVariable("angle", "f8", ("time",), chunksizes=(1_000_000,), zlib=True)
    assert "its variables take 64000 MB" in refusal(tmp_path / "vast.nc")


class Failing(io.BytesIO):
    """A file on a card that fails after its first bytes."""

    def read(self, size=-1):
        if self.tell() >= 5000:
            raise OSError(5, "Input/output error")
        return super().read(5000 if size < 0 else min(size, 5000 - self.tell()))


def test_a_read_error_in_the_middle_is_a_refusal(tmp_path, monkeypatch):
    content = b"t_s,theta_rad\n" + b"".join(b"%d,0.1\n" % k for k in range(20000))
    monkeypatch.setattr(source, "_local", lambda name: Failing(content))
    assert "cannot be read to its end (Input/output error)" in refusal("swing.csv")


def test_what_is_no_file_is_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "pipe.csv")
    assert "it is no file" in refusal(tmp_path / "pipe.csv")


def test_columns_are_bounded(tmp_path):
    (tmp_path / "wide.csv").write_text((",".join(["1"] * 20000) + "\n") * 12)
    assert "20000 columns" in refusal(tmp_path / "wide.csv")
