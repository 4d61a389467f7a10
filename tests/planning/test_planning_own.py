"""A study of somebody's files: which of a folder are looked at, what each is called, and what is written for the workflow."""

import os

import numpy as np
import pandas as pd
import pytest
import yaml

from swingdown.errors import InputError
from swingdown.planning.own import (
    CONFIG,
    LEFT_OUT,
    SHEET,
    Refused,
    Taken,
    apart,
    files,
    names,
    place,
    rows,
    take,
    write,
)

TIMES = np.arange(600) / 30
ANGLES = 0.3 * np.exp(-0.03 * TIMES) * np.cos(4.4 * TIMES)


def write_csv(path, *columns, header="t (s),angle (rad)"):
    lines = [",".join(f"{x:.6g}" for x in row) for row in zip(*columns, strict=True)]
    path.write_text("\n".join([header, *lines, ""]))
    return path


def test_files_of_a_folder_come_by_their_numbers_and_others_are_told(tmp_path):
    for name in ("swing 10.csv", "swing 2.csv", "Notes.TXT", "a.png", "b.docx", "noending", ".hidden.csv"):
        (tmp_path / name).write_text("")
    (tmp_path / "more").mkdir()
    (tmp_path / "old-swingdown").mkdir()
    found, passed = files([tmp_path, tmp_path / "b.docx", tmp_path / "swing 2.csv"])
    assert [one.name for one in found] == ["Notes.TXT", "swing 2.csv", "swing 10.csv", "b.docx"]
    assert {one.file: one.problem for one in passed} == {
        "a.png": "not looked at: a picture is no recording",
        "b.docx": "not looked at: files that end in .docx are none of recordings",
        "more": "not looked at: a folder in the folder",
        "noending": "not looked at: files without an ending are none of recordings",
    }


def test_a_path_that_is_not_there_is_told_with_a_near_one_and_so_is_a_folder_without_any(tmp_path):
    (tmp_path / "swing.csv").write_text("")
    with pytest.raises(InputError, match="there is no such file") as told:
        files([tmp_path / "swng.csv"])
    assert told.value.mend == f"correct the path; did you mean {tmp_path / 'swing.csv'}?"
    with pytest.raises(InputError) as told:
        files([tmp_path / "gone" / "other.csv"])
    assert told.value.mend == "correct the path"
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match="there is no recording in this folder"):
        files([tmp_path / "empty"])


def test_a_name_that_no_sheet_can_hold_is_refused(tmp_path):
    odd = os.fsdecode(os.fsencode(tmp_path) + b"/s\xfcd.csv")
    open(odd, "w").close()
    (tmp_path / "a.csv").write_text("")
    found, (one,) = files([tmp_path])
    assert [path.name for path in found] == ["a.csv"]
    assert one.file == "süd.csv" and "in another encoding than UTF-8" in one.problem


def test_each_file_has_a_name_of_its_own_on_any_system(tmp_path):
    paths = [tmp_path / name for name in ("a.csv", "A.txt", "b c.csv", "x/a.csv", "b_c.csv")]
    found = names(paths)
    assert found[0] == "a" and found[1].lower() == "a-2" and found[3] == "a-3"
    assert len({one.lower() for one in found}) == 5


def test_a_study_lies_beside_its_first_file_and_is_named_after_it(tmp_path):
    assert place([tmp_path / "a.b.csv", tmp_path / "c.csv"]) == tmp_path / "a.b-swingdown"
    (tmp_path / "runs.d").mkdir()
    assert place([tmp_path / "runs.d"]) == tmp_path / "runs.d-swingdown"


def test_rows_have_names_paths_from_the_folder_and_what_holds_for_all(tmp_path):
    paths = [tmp_path / "a.csv", tmp_path / "b c.csv"]
    found = rows(paths, tmp_path / "study", told={"length": "1 m", "mass": None})
    assert found[0] == {"recording": "a", "campaign": "a", "file": "../a.csv", "length": "1 m"}
    assert found[1]["label"] == "b c" and found[1]["campaign"] == found[1]["recording"] != "b c"
    assert {one["campaign"] for one in rows(paths, tmp_path, together=True)} == {"pendulum"}


def taken(path, together=False, **told):
    (row,) = rows([path], path.parent, together, told)
    return take(row, path)


RUNS = ",".join(f"t (s) Run #{k},angle (rad) Run #{k}" for k in (1, 2))


@pytest.mark.parametrize("together", [False, True])
def test_runs_are_pendulums_of_their_own_unless_all_are_one(tmp_path, together):
    path = write_csv(tmp_path / "two.csv", TIMES, ANGLES, TIMES, 0.5 * ANGLES, header=RUNS)
    found = taken(path, together)
    assert [one.row["run"] for one in found] == ["Run #1", "Run #2"]
    assert [one.row["label"] for one in found] == ["two, Run #1", "two, Run #2"]
    campaigns = [one.row["campaign"] for one in found]
    assert campaigns == (["pendulum"] * 2 if together else [one.row["recording"] for one in found])
    np.testing.assert_allclose(found[1].angle["angle"], 0.5 * ANGLES, atol=2e-6)


@pytest.mark.parametrize(("share", "rests"), [(0.049, True), (0.051, False)])
def test_what_moves_by_less_than_a_twentieth_of_another_column_is_at_rest_beside_it(tmp_path, share, rests):
    path = write_csv(tmp_path / "two.csv", TIMES, ANGLES, TIMES, share * ANGLES, header=RUNS)
    first, second = taken(path)
    assert isinstance(first, Taken) and isinstance(second, Refused) is rests
    if rests:
        assert second.problem.endswith(
            "it moves by 4.9 % of what another column of the file does: at rest beside it"
        )
        assert second.recording.endswith("2") and second.label == "two, Run #2"
    other = write_csv(tmp_path / "units.csv", TIMES, 57 * ANGLES, TIMES, share * ANGLES, header=RUNS.replace("rad", "deg", 1))  # fmt: skip
    assert all(isinstance(one, Taken) for one in taken(other))


def test_a_file_that_cannot_be_used_is_refused_with_its_line(tmp_path):
    path = write_csv(tmp_path / "a.csv", TIMES, 0 * TIMES)
    (one,) = taken(path, length="1 m")
    assert isinstance(one, Refused) and "the signal is constant (0)" in one.problem
    assert one.error.where == "a.csv" and one.error.problem == one.problem


def test_what_shares_no_model_with_the_others_is_a_pendulum_of_its_own(tmp_path):
    paths = [write_csv(tmp_path / f"{name}.csv", TIMES, ANGLES) for name in "ab"]
    points = 0.7 * np.arange(30) + 0.02 * np.random.default_rng(1).standard_normal(30)
    paths.append(write_csv(tmp_path / "c.csv", points, 0.3 * 0.97 ** np.arange(30) * (-1.0) ** np.arange(30)))
    found = [
        one for row, path in zip(rows(paths, tmp_path, True), paths, strict=True) for one in take(row, path)
    ]
    assert [one.row["campaign"] for one in apart(found)] == ["pendulum", "pendulum", "c"]
    assert [one.row["campaign"] for one in apart(found[2:])] == ["pendulum"]


ROWS = [
    {"recording": "a", "campaign": "a", "file": "a.csv"},
    {"recording": "b", "campaign": "b", "file": "b.csv"},
]


def written(folder, left_out=(), searched=("a", "b"), **more):
    path = write(folder, ROWS, left_out, searched, **more)
    return yaml.safe_load(path.read_text())


def test_a_config_says_what_differs_from_the_defaults_alone(tmp_path):
    plain = written(tmp_path)
    assert list(plain) == ["recordings", "simulation", "experiment"] and plain["recordings"] == SHEET
    assert not (tmp_path / LEFT_OUT).exists()
    lost = Refused("c", "c.csv", "it is empty", "a table", "export it again")
    more = written(tmp_path, [lost], ["b"], restoring="linear", lang="de")
    assert more["discovery"] == {"campaigns": ["b"]} and more["left_out"] == LEFT_OUT
    assert more["model"] == {"restoring": "linear"} and more["lang"] == "de"
    assert list(pd.read_csv(tmp_path / LEFT_OUT)["problem"]) == ["it is empty"]
    assert list(pd.read_csv(tmp_path / SHEET)["file"]) == ["a.csv", "b.csv"]


def test_what_somebody_changed_there_is_not_written_over(tmp_path):
    written(tmp_path)
    config, sheet = (tmp_path / name for name in (CONFIG, SHEET))
    as_written = {path: path.read_text() for path in (config, sheet)}
    for path in (config, sheet):
        path.write_text(as_written[path] + "\n# mine\n")
        with pytest.raises(InputError, match=f"{SHEET} and {CONFIG} there were changed"):
            written(tmp_path)
        assert path.read_text().endswith("# mine\n")
        path.write_text(as_written[path])
    written(tmp_path)
    config.unlink()
    with pytest.raises(InputError, match=f"^[^:]*: {SHEET} there was changed"):
        written(tmp_path)


def test_a_folder_that_cannot_be_written_is_told(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="it cannot be written .File exists"):
        written(tmp_path / "file")
