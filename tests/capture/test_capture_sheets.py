"""A new entry in a sheet: what stands there stays byte for byte, or the sheet stays as it is."""

import os
import stat
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
import yaml

from swingdown.capture import sheets
from swingdown.errors import InputError
from swingdown.measurement.sheet import read_sheet
from swingdown.paths import PROJECT

ROW = {
    "recording": "new",
    "campaign": "mine",
    "file": "resources/recordings/new.nc",
    "signal_unit": "V",
    "role": "",
}
OLD = 'recording,file\nold,old.csv\n"other",other.csv\n'


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(
    "old", [OLD, OLD.rstrip("\n"), OLD.replace("\n", "\r\n"), "\ufeff" + OLD, OLD + "\n"],
    ids=["plain", "no last newline", "CRLF", "BOM", "empty line"],
)  # fmt: skip
def test_what_stands_in_the_sheet_stays(old):
    Path("sheet.csv").write_text(old, newline="")
    sheets.add_row("sheet.csv", ROW)
    new = Path("sheet.csv").read_text(encoding="utf-8")
    assert old.partition("\n")[2].strip() in new if "\r" not in old else "old,old.csv" in new
    table = read_sheet("sheet.csv", check_files=False)
    assert list(table.index) == ["old", "other", "new"]
    assert table.loc["new"].campaign == "mine" and table.loc["old"].file == "old.csv"
    assert b"\n" not in Path("sheet.csv").read_bytes().replace(b"\r\n", b"") or "\r" not in old


def test_a_sheet_is_made_where_there_is_none():
    sheets.add_row("sheet.csv", ROW)
    assert read_sheet("sheet.csv", check_files=False).loc["new"].signal_unit == "V"


def test_a_sheet_that_is_made_has_a_column_for_all_that_is_known():
    sheets.add_row("sheet.csv", ROW | {"signal_unit": "counts", "counts_per_revolution": 4096})
    assert read_sheet("sheet.csv", check_files=False).loc["new"].counts_per_revolution == 4096


def test_a_cell_with_a_comma_is_quoted():
    sheets.add_row("sheet.csv", ROW | {"file": "a,b.nc"})
    assert read_sheet("sheet.csv", check_files=False).loc["new"].file == "a,b.nc"


def test_a_name_that_is_taken_leaves_the_sheet():
    Path("sheet.csv").write_text(OLD)
    with pytest.raises(InputError, match="has a row 'old' already"):
        sheets.add_row("sheet.csv", ROW | {"recording": "old"})
    assert Path("sheet.csv").read_text() == OLD and os.listdir() == ["sheet.csv"]


def test_a_rehearsal_changes_nothing():
    Path("sheet.csv").write_text(OLD)
    sheets.add_row("sheet.csv", ROW, rehearse=True)
    assert Path("sheet.csv").read_text() == OLD and os.listdir() == ["sheet.csv"]


def test_rights_and_links_stay():
    Path("real.csv").write_text(OLD)
    Path("real.csv").chmod(0o664)
    Path("sheet.csv").symlink_to("real.csv")
    sheets.add_row("sheet.csv", ROW)
    assert Path("sheet.csv").is_symlink() and "new" in Path("real.csv").read_text()
    assert stat.S_IMODE(Path("real.csv").stat().st_mode) == 0o664


def test_a_read_only_sheet_is_left_alone_and_told_before_the_swing():
    Path("sheet.csv").write_text(OLD)
    Path("sheet.csv").chmod(0o444)
    with pytest.raises(InputError, match=r"sheet\.csv: it is read-only.*chmod u\+w"):
        sheets.add_row("sheet.csv", ROW, rehearse=True)
    assert Path("sheet.csv").read_text() == OLD and stat.S_IMODE(Path("sheet.csv").stat().st_mode) == 0o444


@pytest.mark.skipif(os.geteuid() != 0, reason="NOT TESTED: another one's file takes root")
def test_a_sheet_of_another_one_stays_that_ones():
    Path("sheet.csv").write_text(OLD)
    os.chown("sheet.csv", 1234, 1235)
    sheets.add_row("sheet.csv", ROW)
    state = Path("sheet.csv").stat()
    assert (state.st_uid, state.st_gid) == (1234, 1235) and "new" in Path("sheet.csv").read_text()


@pytest.mark.skipif(os.geteuid() != 0, reason="NOT TESTED: another one's file takes root")
def test_a_sheet_of_another_one_that_we_may_write_stays_that_ones(monkeypatch):
    folder = Path(tempfile.mkdtemp())  # pytest's own lets nobody else in
    monkeypatch.chdir(folder)
    Path("sheet.csv").write_text(OLD)
    Path("sheet.csv").chmod(0o666)
    folder.chmod(0o777)
    os.seteuid(65534)
    try:
        sheets.add_row("sheet.csv", ROW)
    finally:
        os.seteuid(0)
    assert Path("sheet.csv").stat().st_uid == 0 and Path("sheet.csv").read_text().startswith(
        OLD.partition("\n")[0]
    )
    assert list(read_sheet("sheet.csv", check_files=False).index) == ["old", "other", "new"]


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (OLD.encode("utf-16"), "UTF-16.*CSV UTF-8"),
        (OLD.encode("utf-16-le"), "UTF-16"),
        (OLD.replace("old", "Zürich").encode("latin-1"), "not in UTF-8 .byte 16 is 0xfc"),
        (OLD.replace(",", ";").encode(), "line 1: its columns are separated by semicolons.*commas"),
        (OLD.replace(",", "\t").encode(), "separated by tabs"),
        (OLD.replace("\n", "\r").encode(), "lines end in CR alone"),
    ],
    ids=["UTF-16", "UTF-16 without BOM", "Latin-1", "semicolons", "tabs", "CR"],
)
def test_a_sheet_that_is_no_csv_in_utf_8_is_told_as_what_it_is(content, told):
    Path("sheet.csv").write_bytes(content)
    with pytest.raises(InputError, match=told):
        sheets.add_row("sheet.csv", ROW, rehearse=True)
    assert Path("sheet.csv").read_bytes() == content


def test_a_folder_as_a_sheet_is_told():
    Path("sheet.csv").mkdir()
    for add in (lambda: sheets.add_row("sheet.csv", ROW), lambda: sheets.add_point("sheet.csv", POINT)):
        with pytest.raises(InputError, match="it is a folder"):
            add()


def test_many_at_once_lose_none():
    names = [f"r{k}" for k in range(8)]
    with ThreadPoolExecutor(8) as pool:
        list(pool.map(lambda name: sheets.add_row("sheet.csv", ROW | {"recording": name}), names))
    assert sorted(read_sheet("sheet.csv", check_files=False).index) == names


def test_the_projects_own_sheet_is_not_written_from_elsewhere():
    with pytest.raises(InputError, match="the project's own"):
        sheets.own("config/recordings.csv", "recordings")
    assert (PROJECT / "config/recordings.csv").is_file()


POINT = {"height": 0.05, "limit": 5e-05, "file": "resources/recordings/t.nc", "sha256": "0" * 64}


@pytest.mark.parametrize(
    "text",
    [
        "campaigns: [mine]   # the pendulum\npoints:\n  - height: 0.02\n    limit: 1.0e-05\n    file: a.csv\n\nrest:\n  limit: 0.001\n",
        "points:\n- height: 0.02   # lowest\n  limit: 1.0e-05\n  file: a.csv\n- {height: 0.03, limit: 1.0e-05, file: b.csv}\n",
        "campaigns: [mine]\npoints: []  # to come\nrest: {limit: 0.001}\n",
        "campaigns: [mine]\npoints:\nrest: {limit: 0.001}\n",
        "campaigns: [mine]",
    ],
)
def test_a_tower_height_joins_the_points(text):
    new = sheets.with_point(text, POINT)
    before, after = yaml.safe_load(text), yaml.safe_load(new)
    assert after.pop("points") == [*(before.pop("points", None) or []), POINT]
    assert after == before
    for line in text.splitlines():
        assert line.split("[]")[0].rstrip() in new


def test_an_entry_is_recognised_by_its_file():
    Path("sheet.csv").write_text("recording,file\nold,a/old.nc\n")
    Path("apparatus.yaml").write_text("points:\n  - {height: 0.02, file: a/t.nc}\n  - file: a/u.nc\n")
    assert sheets.mentions("sheet.csv", "a/old.nc")
    assert sheets.mentions("apparatus.yaml", "a/t.nc") and sheets.mentions("apparatus.yaml", "a/u.nc")
    assert not sheets.mentions("sheet.csv", "old.nc") and not sheets.mentions("sheet.csv", "a/old")
    assert not sheets.mentions("none.csv", "a/old.nc")


def test_points_laid_out_otherwise_are_left_alone():
    with pytest.raises(InputError, match=r"without touching what stands there.*add by hand: height: 0\.05"):
        sheets.with_point("points: [{height: 0.02, limit: 1.0e-05, file: a.csv}]\n", POINT)


def test_the_bench_could_take_a_point(root):
    text = (root / "config/apparatus.yaml").read_text()
    new = sheets.with_point(text, POINT)
    assert yaml.safe_load(new)["points"][-1] == POINT and "# the manual's" in new
