"""What is written beside first answers: curves and laws of all pendulums, pictures of a few, none of what does not die away."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

import swingdown
from swingdown import plots
from swingdown.answer import curve_files
from swingdown.answer.curve_files import write_beside
from swingdown.curves.dataset import COLUMNS as CURVE_COLUMNS
from swingdown.curves.laws import COLUMNS as LAW_COLUMNS
from swingdown.engine.trajectory import simulate
from swingdown.language import language
from swingdown.pendulum.model import Model
from swingdown.studies.pendulums import NOT_DYING

TIMES = np.arange(1201) / 50
SWING = simulate(Model("viscous", {"natural_frequency": 4.4, "viscous_ratio": 0.007}), TIMES, 0.35)
SWING = SWING + 1e-3 * np.random.default_rng(3).standard_normal(TIMES.size)
FEW = {"fitted": ["viscous", "load_coulomb", "viscous+load_coulomb"]}


@pytest.fixture(scope="module")
def answer():
    """The parts of an answer that are asked for, each computed once."""
    found = swingdown.fit(TIMES, SWING, unit="rad", **FEW)
    curves, laws = found.curves(), found.laws()
    return SimpleNamespace(label=found.label, row=found.row, curves=lambda: curves, laws=lambda: laws)


@pytest.fixture(scope="module")
def short():
    """Too few half-swings for curves."""
    return swingdown.fit(TIMES[:220], SWING[:220], unit="rad", **FEW)


@pytest.fixture(autouse=True)
def quick(monkeypatch):
    """Pictures are made, and their files are empty: to write them takes longer than all else."""
    monkeypatch.setattr(plots, "save", lambda figure, path: path.touch())


def pictures(folder):
    return sorted(path.name for path in folder.glob("*.png"))


def test_of_one_pendulum_tables_and_pictures_have_no_name_before_them(answer, tmp_path):
    told = write_beside({"anna": answer}, tmp_path)
    assert pictures(tmp_path) == ["curves.png", "laws.png"]
    assert told[-1] == "against the amplitude: curves.csv; what each law of damping leaves: laws.csv, with a picture of each"  # fmt: skip
    assert len(told) == 2 and not told[0].startswith("anna")
    curves, laws = (pd.read_csv(tmp_path / f"{name}.csv") for name in ("curves", "laws"))
    assert set(curves["campaign"]) == set(laws["campaign"]) == {"anna"}
    assert not (tmp_path / "resonance.csv").exists()


def test_of_several_each_has_its_name_and_of_more_than_three_there_are_no_pictures(answer, tmp_path):
    told = write_beside({"anna": answer, "ben": answer}, tmp_path)
    assert pictures(tmp_path) == ["anna-curves.png", "anna-laws.png", "ben-curves.png", "ben-laws.png"]
    assert [line.split(":")[0] for line in told[:2]] == ["anna", "ben"]
    many = tmp_path / "many"
    many.mkdir()
    told = write_beside(dict.fromkeys("abcd", answer), many)
    assert pictures(many) == [] and told == ["against the amplitude: curves.csv; what each law of damping leaves: laws.csv"]  # fmt: skip
    assert list(dict.fromkeys(pd.read_csv(many / "laws.csv")["campaign"])) == list("abcd")


def test_what_does_not_die_or_has_too_few_swings_has_no_curves(answer, short, tmp_path):
    motor = SimpleNamespace(label=NOT_DYING)
    assert write_beside({"motor": motor}, tmp_path) == []
    for name, columns in (("curves", CURVE_COLUMNS), ("laws", LAW_COLUMNS)):
        assert list(pd.read_csv(tmp_path / f"{name}.csv").columns) == list(columns)
    write_beside({"motor": motor, "short": short, "anna": answer}, tmp_path)
    assert set(pd.read_csv(tmp_path / "curves.csv")["campaign"]) == {"anna"}
    assert set(pd.read_csv(tmp_path / "laws.csv")["campaign"]) == {"short", "anna"}
    assert pictures(tmp_path) == ["anna-curves.png", "anna-laws.png", "short-laws.png"]


def test_under_drives_the_steady_swings_are_foretold_or_why_not(answer, tmp_path, monkeypatch):
    told = write_beside({"anna": answer}, tmp_path, [0.05])
    table = pd.read_csv(tmp_path / "resonance.csv")
    assert set(table["drive_rad_per_s2"]) == {0.05} and "resonance.png" in pictures(tmp_path)
    assert not any(line.startswith("anna") for line in told)
    monkeypatch.setattr(curve_files, "has", lambda package: False)
    both = write_beside({"anna": answer, "ben": answer}, tmp_path, [0.05])
    assert sum(line.startswith("ben: ") for line in both) >= 2
    weak = tmp_path / "weak"
    weak.mkdir()
    assert any(
        line.startswith("no resonance curve: ") for line in write_beside({"anna": answer}, weak, [1e-9])
    )
    assert not (weak / "resonance.csv").exists()


def test_without_matplotlib_all_is_said_in_the_language_and_nothing_is_drawn(answer, tmp_path, monkeypatch):
    monkeypatch.setattr(curve_files, "has", lambda package: False)
    english, german = (write_beside({"anna": answer}, tmp_path, (), language(one))[0] for one in ("en", "de"))
    assert english != german and pictures(tmp_path) == []
