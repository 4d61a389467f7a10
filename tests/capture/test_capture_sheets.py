"""A new entry in a sheet: what stands there stays byte for byte, or the sheet stays as it is."""

import os
import stat
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
