"""The raw stream on disk is what had arrived, to the last whole piece."""

import json

import pytest

from swingdown.capture.journal import RUNNING, Journal, read_journal, recovery
from swingdown.errors import InputError

PIECES = [(1.5, b"abc"), (2.25, b""), (3.0, bytes(range(256)) * 9)]


@pytest.fixture
def journal(tmp_path):
    made = Journal(tmp_path / "new" / "a.raw", {"rate": 100})
    for arrival, data in PIECES:
        made.add(data, arrival)
    yield made
    made.path.unlink(missing_ok=True)


def test_what_was_kept_is_read_again(journal):
    with pytest.raises(InputError, match="still running") as told:
        read_journal(journal.path)
    assert told.value.code == RUNNING
    with pytest.raises(InputError) as told:
        Journal(journal.path, {})
    assert told.value.code == RUNNING
    journal.close()
    assert read_journal(journal.path) == ({"rate": 100}, PIECES)


def test_one_that_is_cut_off_goes_as_far_as_it_goes(journal):
    journal.close()
    whole = journal.path.read_bytes()
    for less, pieces in ((1, 3), (256 * 9, 3), (256 * 9 + 1, 2), (256 * 9 + 12, 2), (256 * 9 + 13, 1)):
        journal.path.write_bytes(whole[:-less])
        found = read_journal(journal.path)[1]
        assert len(found) == pieces and found[:2] == PIECES[:2][:pieces]


def test_one_that_was_left_stands_in_the_way_and_says_how_it_is_recovered(journal):
    journal.close()
    with pytest.raises(InputError, match="did not finish") as told:
        Journal(journal.path, {})
    assert (
        recovery(journal.path) == "`--config recording=a recover=true`"
        and recovery(journal.path) in told.value.mend
    )
    journal.remove()
    assert not journal.path.exists()
    with pytest.raises(InputError, match="there is no raw stream"):
        read_journal(journal.path)


@pytest.mark.parametrize("content", [b"", b"no json\n", b"\xff\xfe\n"])
def test_another_file_is_none(tmp_path, content):
    (tmp_path / "a.raw").write_bytes(content)
    with pytest.raises(InputError, match="does not begin as a raw stream does"):
        read_journal(tmp_path / "a.raw")


def test_what_is_forced_to_the_disk_is_so_once_a_second(tmp_path, monkeypatch):
    forced, clock = [], [10.0]
    monkeypatch.setattr("os.fsync", forced.append)
    monkeypatch.setattr("swingdown.capture.journal.time.monotonic", lambda: clock[0])
    made = Journal(tmp_path / "a.raw", {})
    for at, count in ((10.9, 0), (11.05, 1), (11.9, 1), (12.1, 2)):
        clock[0] = at
        made.add(b"x", at)
        assert len(forced) == count
    made.close()
    assert json.loads((tmp_path / "a.raw").read_bytes().partition(b"\n")[0]) == {}
