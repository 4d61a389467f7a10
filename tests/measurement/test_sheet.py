"""The sample sheet: defaults, and one clear message for whatever it may not hold."""

import math
import re

import pytest

from swingdown.errors import InputError
from swingdown.measurement.sheet import SCHEMA, TIME_UNITS, read_sheet, rows_of_parts
from swingdown.paths import PROJECT, find, safe_name
from swingdown.schema import rules


@pytest.fixture
def sheet(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.csv").write_text("t_s,theta_rad\n")

    def sheet(text):
        (tmp_path / "sheet.csv").write_text(text)
        return read_sheet("sheet.csv")

    return sheet


def test_empty_cells_take_the_defaults(sheet):
    row = sheet("recording,file,role\na,a.csv,\n").loc["a"]
    assert (row.campaign, row.time_unit, row.signal_unit, row.role, row.sha256) == (
        "pendulum",
        "",
        "",
        "",
        "",
    )
    assert math.isnan(row.start_s) and math.isnan(row.counts_per_revolution)


def test_units_follow_the_columns_name_unless_given(sheet):
    table = sheet(
        "recording,file,time_column,signal_column,signal_unit\na,a.csv,t_ms,theta_deg,\nb,a.csv,t_ms,theta_deg,rad\n"
    )
    assert list(table.signal_unit) == ["deg", "rad"] and list(table.time_unit) == ["ms", "ms"]


def test_rows_know_their_line(sheet):
    assert list(sheet("recording,file\n\na,a.csv\n,\nb,a.csv\n").line) == [3, 5]


def test_files_are_found_in_the_working_directory_first_then_in_the_project(sheet, tmp_path):
    assert find("a.csv").resolve() == tmp_path / "a.csv"
    assert find("config/recordings.csv") == PROJECT / "config/recordings.csv"
    (tmp_path / "config").mkdir()
    (tmp_path / "config/recordings.csv").write_text("")
    assert find("config/recordings.csv").resolve() == tmp_path / "config/recordings.csv"


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("recording,file,campain\na,a.csv,x\n", ["line 1, column campain", "write 'campaign'"]),
        ("recording,file,wind\na,a.csv,x\n", ["line 1, column wind", "unknown column"]),
        ("recording,file,file\na,a.csv,a.csv\n", ["column file", "twice"]),
        ("recording\na\n", ["no column 'file'"]),
        ("", ["no column 'recording'"]),
        ("recording,file\n", ["no row"]),
        ("recording,file\na,a.csv\na,a.csv\n", ["lines 2 and 3, column recording", "'a' is used twice"]),
        ("recording,file\na,\n", ["line 2, column file", "empty"]),
        (
            "recording,file\na,a.csv\nA,a.csv\n",
            ["lines 2 and 3, column recording", "'a' and 'A'", "one file"],
        ),
        (
            "recording,file\na b,a.csv\na/b,a.csv\n",
            ["lines 2 and 3", "'a b' and 'a/b' would be one file (a-b)"],
        ),
        ("recording,file\na,gone.csv\n", ["line 2, column file", "no file gone.csv"]),
        ("recording,file\na,a.csv,1\n", ["line 2, column file", "3 cells in a row of 2 columns"]),
        ("recording,file,signal_unit\na,a.csv,volt\n", ["line 2, column signal_unit", "'volt'"]),
        ("recording,file,role\na,a.csv,hold-out\n", ["line 2, column role", "write 'holdout'"]),
        ("recording,file,counts_per_revolution\na,a.csv,0\n", ["column counts_per_revolution", "> 0"]),
        ("recording,file,start_s\na,a.csv,soon\n", ["line 2, column start_s", "'soon' is not a number"]),
        ("recording,file,start_s\na,a.csv,inf\n", ["line 2, column start_s", "finite"]),
        ("recording,file,start_s\na,a.csv,nan\n", ["line 2, column start_s", "finite"]),
        ("recording,file,signal_unit\na,a.csv,v\n", ["line 2, column signal_unit", "write 'V'"]),
        ("recording,file,start_s,stop_s\na,a.csv,3,2\n", ["line 2, column stop_s", "stop_s after start_s"]),
        ("recording,file,sha256\na,a.csv,abc\n", ["line 2, column sha256", "64 hexadecimal digits"]),
    ],
)
def test_what_a_sheet_may_not_hold(sheet, text, told):
    with pytest.raises(InputError) as caught:
        sheet(text)
    for part in ("sheet.csv", *told, "Expected:", "Mend:"):
        assert part in str(caught.value), str(caught.value)


def test_every_unit_of_time_that_the_schema_knows_has_a_length():
    assert list(TIME_UNITS) == rules(SCHEMA)["properties"]["time_unit"]["enum"]


def test_files_that_are_not_there_are_told_where_they_are_asked_for(sheet, tmp_path):
    text = "recording,file\na,gone.csv\nb,https://example.org/b.csv\n"
    (tmp_path / "sheet.csv").write_text(text)
    assert list(read_sheet("sheet.csv", check_files=False).file) == ["gone.csv", "https://example.org/b.csv"]
    with pytest.raises(InputError, match="line 2, column file: there is no file gone.csv"):
        read_sheet("sheet.csv")
    assert sheet(text.replace("a,gone.csv\n", "")).loc["b", "line"] == 2


@pytest.mark.parametrize(
    ("cells", "units"),
    [("t_us,angle_counts", ("us", "counts")), ("time,theta", ("", "")), ("t_ns,U_V", ("ns", "V"))],
)
def test_a_unit_is_the_end_of_a_columns_name(sheet, cells, units):
    row = sheet(f"recording,file,time_column,signal_column\na,a.csv,{cells}\n").loc["a"]
    assert (row.time_unit, row.signal_unit) == units


def test_a_window_of_no_length_is_none(sheet):
    with pytest.raises(InputError, match="the window ends at 2 s and starts at 2 s"):
        sheet("recording,file,start_s,stop_s\na,a.csv,2,2\n")
    row = sheet("recording,file,start_s,stop_s,sha256\na,a.csv,2,2.01," + "AB" * 32 + "\n").loc["a"]
    assert (row.start_s, row.stop_s, row.sha256) == (2.0, 2.01, "ab" * 32)


def test_the_rows_of_parts_are_a_sheet_that_can_be_read(sheet):
    whole = sheet(
        "recording,campaign,file,signal_unit,counts_per_revolution\na,bob,a.csv,counts,4096\n"
    ).reset_index()
    rows = rows_of_parts(
        whole.iloc[0], [{"run": "run 1", "start_s": "1.5"}, {"run": "run 2", "start_s": "2"}]
    )
    parted = sheet(rows + "\n")
    assert list(parted.index) == ["a-1", "a-2"] and list(parted.run) == ["run 1", "run 2"]
    assert list(parted.start_s) == [1.5, 2.0] and set(parted.campaign) == {"bob"}
    assert list(parted.counts_per_revolution) == [4096, 4096] and list(parted.line) == [2, 3]
    assert "counts_per_revolution" not in rows_of_parts(
        {"recording": "a", "file": "a.csv", "line": 2}, [{"run": "1"}]
    )


def test_a_missing_sheet_is_told(tmp_path):
    with pytest.raises(InputError, match=r"gone\.csv: there is no such sample sheet"):
        read_sheet(tmp_path / "gone.csv")


@pytest.mark.parametrize(
    ("label", "name"),
    [
        ("Jürgen", "Jurgen"),
        ("swing 1", "swing-1"),
        ("Gruppe 3/a", "Gruppe-3-a"),
        ("Łukasz & Åse", "Lukasz-Ase"),
        ("../../etc/passwd", "etc-passwd"),
        ("-rf", "rf"),
        ("weiß", "weiss"),
    ],
)
def test_any_name_has_a_safe_file_and_keeps_its_label(sheet, label, name):
    row = sheet(f"recording,campaign,file\n{label},{label},a.csv\n").iloc[0]
    assert (row.name, row["campaign"], row["label"]) == (name, name, label)


@pytest.mark.parametrize("label", ["小明", "小明 2", "...", "nul", "CON.txt", "x" * 300, "é" * 300])
def test_names_of_which_little_remains_are_told_apart(sheet, label):
    row = sheet(f"recording,file\n{label},a.csv\n").iloc[0]
    assert re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9._-]{1,99}", row.name) and row["label"] == label
    assert safe_name(label) != safe_name(label + label)


def test_a_plain_name_stays_and_has_no_label(sheet):
    row = sheet("recording,file\nswing-01.b_2,a.csv\n").iloc[0]
    assert (row.name, row["label"]) == ("swing-01.b_2", "")


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_a_sheet_as_other_programs_save_it(tmp_path, monkeypatch, encoding, separator):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "a.csv").touch()
    start = "0.35" if separator == "," else "0,35"
    lines = [["recording", "file", "start_s"], ["Jürgen", "data\\a.csv", start]]
    text = "\r\n".join(separator.join(cells) for cells in lines)
    (tmp_path / "sheet.csv").write_bytes(text.encode(encoding))
    row = read_sheet("sheet.csv").iloc[0]
    assert (row["label"], row["file"], row["start_s"]) == ("Jürgen", "data/a.csv", 0.35)


LONG = "x" * 5000


@pytest.mark.parametrize(
    ("row", "column"),
    [
        (f"{LONG},a.csv,p", "column recording"),
        (f"a,a.csv,{LONG}", "column campaign"),
        (f"a,{LONG},p", "column file"),
        (f"a,{'y' * 300},p", "y{20}"),
    ],
)
def test_a_name_that_no_file_can_have_is_refused_in_few_words(sheet, row, column):
    with pytest.raises(InputError, match=column) as caught:
        sheet(f"recording,file,campaign\n{row}\n")
    assert caught.value.mend and len(str(caught.value)) < 500


def test_a_sheet_whose_name_is_too_long_is_refused():
    with pytest.raises(InputError, match="long"):
        read_sheet(LONG)


def test_a_name_is_told_without_its_control_characters(sheet):
    """They would colour a terminal, and make a figure no SVG."""
    row = sheet("recording,file,campaign\na\x1b[31mred\x07,a.csv,p\x01\n").iloc[0]
    assert (row.label, row.campaign) == ("a\\x1b[31mred\\x07", safe_name("p\x01"))
