"""The table of labelled recordings: that its list is sound, and that a campaign is fetched, read, searched and judged."""

import csv
import hashlib
import pickle
import subprocess
import sys
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

from swingdown.engine.trajectory import simulate
from swingdown.pendulum.catalogue import SHIPPED
from swingdown.pendulum.model import Model

sys.path.insert(0, str(Path(__file__).parent / "benchmarks" / "labelled"))

import labelled
import twins


def test_an_apparatus_is_open_or_searched_once_and_of_each_are_a_dozen():
    of = {split: set() for split in labelled.HALVES}
    for rows in labelled.listed().values():
        of[rows[0]["split"]] |= {row["apparatus"] for row in rows} | {row["repository"] for row in rows}
    for one, other in combinations(of.values(), 2):
        assert not one & other - {""}
    assert min(map(len, of.values())) >= 24


def test_a_campaign_is_of_one_apparatus_and_what_is_known_of_it_is_not_in_its_base():
    for name, rows in labelled.listed().items():
        shared = ("apparatus", "base", "restoring", "label", "split")
        assert len({tuple(row[key] for key in shared) for row in rows}) == 1, name
        known, base = rows[0]["label"].split("|"), rows[0]["base"].split("+")
        assert set(known) <= set(SHIPPED.names) and set(base) <= set(SHIPPED.names), name
        assert not set(known) & set(base), name
        assert all(row["source"] and len(row["sha256"]) == 64 for row in rows), name
        # those without a commit were prepared by others
        assert all(len(row["commit"]) == 40 or row["split"] == "learn" and not row["commit"] for row in rows), name  # fmt: skip
        read = [tuple(row[key] for key in ("repository", "path", *labelled.TOLD)) for row in rows]
        assert len(set(read)) == len(read), name


def test_the_page_counts_the_rows_of_its_table(root):
    with (root / "docs/labelled.csv").open(encoding="utf-8", newline="") as file:
        rows = [(row["half"], row["told"]) for row in csv.DictReader(file)]
    page = (root / "docs/trials.md").read_text(encoding="utf-8")
    halves = {half for half, _ in rows}
    assert halves >= set(labelled.HALVES.values())
    for half in halves:
        counts = [rows.count((half, told)) for told in ("right", "nothing", "wrong")]
        assert f"| {half} | {sum(counts)} | {' | '.join(map(str, counts))} |" in page


@pytest.mark.parametrize(
    ("effects", "there", "wrong"),
    [
        ({"viscous": []}, True, False),
        ({"magnet": ["viscous"]}, True, False),
        ({"magnet": [], "quadratic_drag": []}, True, False),
        ({"magnet": ["detent"]}, False, True),
        ({}, False, False),
    ],
)
def test_what_is_right_and_what_is_wrong(effects, there, wrong):
    assert labelled.right("viscous|quadratic_drag", effects) == (there, wrong)


@pytest.fixture
def recorded(tmp_path, monkeypatch):
    """A mirror of a repository with a recording in degrees of a viscous wheel, and a list of it; the folder and its file's sum."""
    times = np.arange(0, 30, 0.05)
    model = Model(
        "viscous+constant_coulomb",
        {"natural_frequency": 4.0, "viscous_ratio": 0.02, "constant_friction": 0.05},
        restoring="linear",
    )
    angle = simulate(model, times, 1.0) + 0.001 * np.random.default_rng(7).standard_normal(times.size)
    home = tmp_path / "mirrors" / "somebody+wheel"
    home.mkdir(parents=True)
    np.savetxt(home / "wheel.csv", np.column_stack([times, np.degrees(angle)]), "%.5f", ",", header="t,phi", comments="")  # fmt: skip
    subprocess.run(["git", "init", "-q"], cwd=home, check=True)
    subprocess.run(["git", "add", "."], cwd=home, check=True)
    who = ["-c", "user.name=a", "-c", "user.email=a@b"]
    subprocess.run(["git", *who, "commit", "-qm", "wheel"], cwd=home, check=True)
    row = dict.fromkeys(next(iter(labelled.listed().values()))[0], "") | {
        "apparatus": "wheel", "campaign": "wheel", "repository": "somebody/wheel", "path": "wheel.csv",
        "commit": subprocess.run(["git", "rev-parse", "HEAD"], cwd=home, check=True, capture_output=True, text=True).stdout.strip(),
        "sha256": hashlib.sha256((home / "wheel.csv").read_bytes()).hexdigest(), "unit": "deg", "column": "phi",
        "base": "constant_coulomb", "restoring": "linear", "label": "viscous", "source": "made here", "split": "learn",
    }  # fmt: skip
    monkeypatch.setattr(labelled, "LIST", tmp_path / "list.csv")

    def listed(*rows, **changed):
        with labelled.LIST.open("w", newline="") as file:
            table = csv.DictWriter(file, row)
            table.writeheader()
            table.writerows(row | changed | one for one in rows or [{}])
        return [str(tmp_path / "files"), "--split", "learn", "--mirrors", str(tmp_path / "mirrors")]

    return listed


def test_a_known_effect_is_told_and_counted(recorded, capsys):
    labelled.main(recorded())
    said = capsys.readouterr().out
    assert "wheel | open | constant_coulomb, linear | viscous | viscous | named | right | " in said
    assert (
        "told right: 1 of 1 campaigns, wrong: 0; of 1 apparatuses every campaign: 1, at least one: 1" in said
    )


def test_a_row_takes_the_place_that_its_campaign_had_in_the_table(recorded, tmp_path):
    table = tmp_path / "table.csv"
    other = ["other", "open", *"2345678"]
    labelled.main(
        [*recorded({}, {"campaign": "other", "label": "magnet"}), "--only", "wheel", "--out", str(table)]
    )
    labelled.written([other], table)
    labelled.main(
        [*recorded({}, {"campaign": "other"}, label="magnet"), "--only", "wheel", "--out", str(table)]
    )
    with table.open(newline="") as file:
        head, wheel, kept = csv.reader(file)
    assert head == list(labelled.COLUMNS)
    assert wheel[:7] == ["wheel", "open", "constant_coulomb, linear", "magnet", "viscous", "named", "wrong"]
    assert kept == other


def test_what_was_searched_once_keeps_its_row_where_it_is_searched_again(recorded, tmp_path):
    table = tmp_path / "table.csv"
    asked = [*recorded(split="apart"), "--out", str(table)]
    asked[asked.index("learn")] = "apart"
    labelled.main(asked)
    labelled.main([*asked, "--again"])
    with table.open(newline="") as file:
        assert [row[:2] for row in csv.reader(file)][1:] == [["wheel", "searched once"], ["wheel", "again"]]


def test_another_effect_in_its_place_is_counted_as_wrong(recorded, capsys):
    labelled.main(recorded(label="magnet"))
    assert "told right: 0 of 1 campaigns, wrong: 1;" in capsys.readouterr().out


def test_a_file_with_another_content_is_not_searched(recorded, capsys):
    labelled.main(recorded(sha256="0" * 64))
    said = capsys.readouterr()
    assert "ANOTHER CONTENT somebody/wheel wheel.csv" in said.err
    assert "told right: 0 of 1 campaigns" in said.out and "not read" in said.out


def test_a_row_of_the_role_holdout_is_held_out(recorded, tmp_path):
    begins, ends = {"stop": "18", "role": "holdout"}, {"start": "12"}  # by amplitude the other would be
    labelled.main([*recorded(begins, ends), "--pickles", str(tmp_path / "kept")])
    one = pickle.loads((tmp_path / "kept" / "wheel.campaign.pkl").read_bytes())
    assert [swing.times[0] >= 12 for swing in one.fit] == [True]
    assert [swing.times[-1] <= 18 for swing in one.holdout] == [True]


def test_a_twin_has_what_is_known_and_nothing_else(recorded, tmp_path, capsys):
    """What its search tells is what the recording could tell."""
    asked, table = recorded({}, {"campaign": "short", "stop": "2.9"}), tmp_path / "table.csv"
    labelled.main([*asked, "--out", str(table)])
    capsys.readouterr()
    asked = [
        *asked[: asked.index("--mirrors")],
        "--table",
        str(table),
        "--draws",
        "1",
        "--told",
        "right",
        "nothing",
    ]
    twins.main(asked)
    said = capsys.readouterr().out
    assert "wheel | right 1 | nothing 0 | wrong 0" in said
    assert "short: not read: 3 half-swings" in said
    assert "of most twins: 1 of 1 campaigns" in said
