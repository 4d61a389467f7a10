"""Names and tables as files have them: safe on any system, and text in a spreadsheet that is text."""

import errno
import os

import pandas as pd
import pytest

from swingdown import paths
from swingdown.errors import InputError, Unwritten


@pytest.mark.parametrize(
    ("label", "name"),
    [
        ("swing-01.b_2", "swing-01.b_2"), ("Jürgen", "Jurgen"), ("weiß", "weiss"), ("Ærø, Œuvre & Đ", "AEro-OEuvre-D"), ("Łø", "Lo"),
        ("a  b", "a-b"), ("..a..", "a"), ("-a_", "a"), ("_a", "a"), ("a" * 100, "a" * 100), ("common", "common"), ("console.txt", "console.txt"),
    ],
)  # fmt: skip
def test_a_label_is_told_in_letters_that_every_system_has(label, name):
    assert paths.safe_name(label).lower() == name.lower()


@pytest.mark.parametrize(
    "label", ["con", "NUL.txt", "com1", "lpt9.csv", "a" * 101, "小明", "小明 2", "...", ""]
)
def test_a_label_that_no_file_can_have_gets_a_mark_of_its_own(label):
    name = paths.safe_name(label)
    assert len(name) <= 100 and name == paths.safe_name(label) != label
    kept, _, mark = name.rpartition("-")
    assert kept and len(mark) == 8 and all(one in "0123456789abcdef" for one in mark)


def test_what_commands_a_terminal_is_shown_and_lines_stay():
    assert paths.printable("a\x1b[31m\x07é\n\t√ \u202eb") == "a\\x1b[31m\\x07é\n\t√ \\u202eb"


def test_a_name_that_is_too_long_for_any_file_is_refused_and_another_comes_back(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match=r"no file can have so long a name \(5000 characters\)"):
        paths.find("x" * 5000)
    assert str(paths.find("nowhere.csv")) == "nowhere.csv" and str(paths.find("a\0b")) == "a\0b"
    assert [paths.is_url(one) for one in ("https://a", "http://a", "file:///a", "a.csv")] == [True] * 3 + [False]  # fmt: skip


@pytest.mark.parametrize(
    ("cell", "marked"),
    [
        ("=1+1", "'=1+1"), ("@a", "'@a"), ("+a", "'+a"), ("-a", "'-a"), ("'=a", "''=a"), ("\ta", "'\ta"), ("-1.5", "-1.5"),
        ("+3", "+3"), ("-1.20(34)e-5", "-1.20(34)e-5"), ("1.2(3)", "1.2(3)"), ("-.5", "-.5"), ("-1-1", "'-1-1"), ("a=b", "a=b"), ("'a", "'a"), ("", ""),
    ],
)  # fmt: skip
def test_a_formula_is_text_in_a_spreadsheet_and_comes_back_as_it_was(cell, marked):
    table = pd.DataFrame({"=head": [cell, "b"], "n": [1.0, -2.0], 3: [1, -2]})
    shown = paths.for_spreadsheets(table)
    assert shown.iloc[0, 0] == marked and list(shown.columns) == ["'=head", "n", 3]
    assert list(shown["n"]) == [1.0, -2.0]
    pd.testing.assert_frame_equal(paths.from_spreadsheets(shown), table)


@pytest.mark.parametrize(
    ("number", "told", "mend"),
    [
        (errno.ENOSPC, "the disk is full: ", "make room"), (errno.EDQUOT, "the disk is full for this user: ", "make room"),
        (errno.EROFS, "the folder cannot be written: ", "--directory"), (errno.EACCES, "the folder cannot be written: ", "--directory"),
        (errno.EPERM, "the folder cannot be written: ", "--directory"),
    ],
)  # fmt: skip
def test_a_write_that_fails_tells_where_and_the_mend_and_leaves_what_was(tmp_path, number, told, mend):
    path = paths.write_text(tmp_path / "a.txt", "before")
    with pytest.raises(Unwritten, match=f"{told}.*a.txt. Mend: .*{mend}") as failed:  # noqa: SIM117
        with paths.written_whole(path) as partial:
            partial.write_text("half")
            raise OSError(number, os.strerror(number))
    assert failed.value.errno == number
    assert path.read_text() == "before" and list(tmp_path.iterdir()) == [path]
    assert paths.in_words(errno.ENOENT, path) == "" and paths.in_words(None, path) == ""


def test_another_failure_is_told_as_it_is(tmp_path):
    with pytest.raises(IsADirectoryError), paths.written_whole(tmp_path / "a.txt"):
        raise IsADirectoryError(errno.EISDIR, "a folder")
    assert list(tmp_path.iterdir()) == []


def test_a_table_is_written_without_its_index_unless_it_is_asked_for(tmp_path):
    table = pd.DataFrame({"a": [1, 2]})
    assert paths.write_csv(table, tmp_path / "a.csv").read_text() == "a\n1\n2\n"
    assert paths.write_csv(table, tmp_path / "b.csv", index=True, sep=";").read_text() == ";a\n0;1\n1;2\n"
