"""Recordings that cannot be used leave their reason behind, and who is left of several."""

import io

import pytest
import xarray as xr

from swingdown import dataset
from swingdown.errors import InputError
from swingdown.measurement.files.source import check_sha256
from swingdown.measurement.refused import (
    COLUMNS,
    doubt_in,
    doubted,
    left_out,
    may_pass,
    none_left,
    place_in,
    problem_in,
    refuse,
    row_on,
    taking_part,
    used,
)

ROW = {"recording": "r1", "campaign": "bench", "file": "r1.csv"}
BROKEN = InputError("r1.csv, line 3", "a cell holds no number", "numbers", "correct it")
PUSHED = InputError("r1.csv", "the amplitude grows", "a free swing", "leave it out")


@pytest.fixture
def file(tmp_path):
    """A function that writes the file of a swing: of a free one, of one that cannot be used, or of one in doubt."""

    def written(recording, campaign="bench", problem=None, doubt=None):
        path, about = tmp_path / f"{recording}.nc", {**ROW, "recording": recording, "campaign": campaign}
        if problem:
            refuse(problem, about, path)
        else:
            dataset.write(
                doubted(xr.Dataset({"x": ("k", [1.0], {"units": "1", "long_name": "x"})}), about, doubt), path
            )
        return path

    return written


def test_who_reads_a_refused_recording_meets_its_problem(tmp_path):
    path = tmp_path / "r1.nc"
    assert refuse(BROKEN, ROW, path) == f"r1: NOT USED: {BROKEN}"
    assert refuse(BROKEN, ROW, path, known=True) == "r1: left out, as reported before"
    assert refuse(BROKEN, {"campaign": "bench"}, tmp_path / "all.nc").startswith("campaign bench: NOT USED")
    with pytest.raises(InputError) as met:
        dataset.read(path)
    assert str(met.value) == str(problem_in(path)) == str(BROKEN)


def test_a_row_tells_the_place_inside_the_file(file):
    row = left_out(file("r1", problem=BROKEN))
    assert tuple(row) == COLUMNS
    assert row["problem"] == "line 3: a cell holds no number" and row["label"] == "r1"
    assert (row["expected"], row["mend"], row["code"]) == ("numbers", "correct it", "")
    named = row_on({**ROW, "label": "the long one"}, InputError("x", "bad", "good", "mend", "some code"))
    assert (named["label"], named["problem"], named["code"]) == ("the long one", "bad", "some code")


def test_a_doubt_leaves_the_data_and_a_free_swing_has_none(file):
    free, doubt = file("free"), file("r1", doubt=PUSHED)
    assert left_out(free) == {} and doubt_in(free) == {} and problem_in(free) is None
    assert left_out(doubt)["problem"] == "the amplitude grows" and problem_in(doubt) is None
    assert doubt_in(doubt) == {"where": "r1.csv", "problem": "the amplitude grows", "expected": "a free swing", "mend": "leave it out"}  # fmt: skip
    assert float(dataset.read(doubt)["x"][0]) == 1.0


def test_a_doubtful_swing_is_left_out_beside_free_ones_only(file):
    free, beside, alone = file("a"), file("b", doubt=PUSHED), file("c", "other", doubt=PUSHED)
    broken = file("d", "other", problem=BROKEN)
    kept, lost = taking_part([free, beside, alone, broken], explained=("bench", "other"))
    assert kept == [free, alone] and [row["recording"] for row in lost] == ["b", "d"]
    kept, lost = taking_part([free, beside, alone])
    assert kept == [free] and len(lost) == 2


def test_of_several_files_those_that_can_be_used_are_read(file):
    kept, lost = used([file("a"), file("b", problem=BROKEN)])
    assert [one.attrs["recording"] for one in kept] == ["a"] and [row["recording"] for row in lost] == ["b"]


@pytest.mark.parametrize(
    ("where", "place"),
    [
        ("r1.csv", ""),
        ("r1.csv, line 3", "line 3: "),
        ("sheet.csv, row 2", ""),
        ("r1.csv (recordings.csv, row 2, r1), column angle", "column angle: "),
        ("r1.csv (recordings.csv, row 2, r7), column angle", "(recordings.csv, row 2, r7), column angle: "),
    ],
)
def test_a_place_is_told_within_its_file(where, place):
    assert place_in("r1.csv", where, "r1") == place


def test_where_none_is_left_the_first_says_why_and_how_many_there_are(file):
    row = left_out(file("r1", problem=BROKEN))
    assert none_left([row]).where == "r1 (r1.csv)"
    both = none_left([row, row | {"recording": "r2"}])
    assert both.where == "none of 2 recordings can be used; the first, r1 (r1.csv)"
    assert (both.problem, both.mend) == (row["problem"], "correct it")


def test_what_was_out_of_reach_may_pass_and_a_bad_file_does_not():
    reached = InputError("r1.csv", "it cannot be reached")
    reached.__cause__ = OSError("no route")
    with pytest.raises(InputError) as told:
        check_sha256(io.BytesIO(b"cut off"), "0" * 64, "r1.csv", "row 2")
    damaged = told.value
    far = {"file": "https://example.org/r1.csv"}
    assert may_pass(reached, ROW) and may_pass(damaged, far)
    assert not may_pass(damaged, ROW) and not may_pass(BROKEN, far) and not may_pass(BROKEN, ROW)
