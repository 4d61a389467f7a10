"""A folder in which something was varied: the command fits and draws the series."""

import json

import numpy as np
import pandas as pd
import pytest
from exporting import export
from matplotlib.text import Text

from swingdown import plots
from swingdown.__main__ import main
from swingdown.errors import InputError


def frequency(length):
    """Of a point on a string (m), in rad/s."""
    return np.sqrt(9.81 / length)


def test_lengths_in_the_names_give_the_power_law_and_g(here, capsys):
    for k, length in enumerate((20, 40, 60, 90)):
        export(here / "lengths" / f"{length}cm.csv", frequency(length / 100), seed=k)
    assert main(["lengths", "--quick", "--by", "length±1mm"]) == 0
    told = capsys.readouterr().out
    assert (
        "length as the names say: 20cm → 0.2 m" in told
        and " of length, beside an error that all lengths share; theory" in told
    )
    folder = here / "lengths-swingdown"
    period = json.loads((folder / "series.json").read_text())[0]
    assert abs(period["exponent"] - 0.5) < 1e-3 < period["u_exponent_of_exact_lengths"] < period["u_exponent"]
    assert period["exponent_of_exact_lengths"] == period["power_law"]["exponent"]
    assert abs(period["gravity"]["g_m_per_s2"] - 9.81) < 0.01
    points = pd.read_csv(folder / "series.csv")
    assert list(points["x"].unique()) == [0.2, 0.4, 0.6, 0.9] and (points["u_x"] == 0.001).all()
    assert (folder / "series.png").stat().st_size > 10_000


def test_a_table_beside_the_files_is_no_recording(here, capsys):
    for k, name in enumerate(("Ann", "Ben", "Zoë")):
        export(here / "class" / f"{name}.csv", frequency(0.5 + (0.01 if k == 2 else 0)), seed=k)
    (here / "class" / "who.csv").write_text("file,group\nAnn.csv,A\nBen.csv,B\nZoë.csv,C\n", encoding="utf-8")
    assert main(["class", "--quick"]) == 0
    told = capsys.readouterr().out
    assert "values from who.csv" in told and "NOT USED" not in told
    assert "period of small swings by group: C does not agree with the others" in told
    assert (here / "class-swingdown" / "groups.png").exists()


def test_a_series_by_what_is_not_there_is_refused(here):
    for k in range(3):
        export(here / "class" / f"{k}.csv", frequency(0.5 + k / 10), seed=k)
    with pytest.raises((InputError, SystemExit)):
        main(["class", "--quick", "--by", "length"])


def shown(figure):
    """All that is written in a figure."""
    figure.draw_without_rendering()
    return "\n".join(one.get_text() for one in figure.findobj(Text))


def test_lines_and_pictures_are_in_the_language(here, capsys, monkeypatch):
    """Of a series, of groups, and of the swings that a drive would make: words and the decimal sign."""
    drawn = {}
    monkeypatch.setattr(plots, "save", lambda figure, path, *_: drawn.__setitem__(path.name, shown(figure)))
    for k, length in enumerate((40, 40, 60, 60, 90, 90)):
        export(here / "lengths" / f"{length}cm-{k}.csv", frequency(length / 100), seed=k)
    table = [f"{length}cm-{k}.csv,{'AB'[k % 2]}\n" for k, length in enumerate((40, 40, 60, 60, 90, 90))]
    (here / "lengths" / "who.csv").write_text("file,group\n" + "".join(table))
    assert main(["lengths", "--quick", "--lang", "de"]) == 0
    export(here / "a.csv")
    assert main(["a.csv", "--quick", "--lang", "fr", "--drive", "0.2", "3"]) == 0
    assert main(["a.csv", "--quick", "--lang", "it", "--drive", "1e-9", "--into", "b"]) == 0
    told = capsys.readouterr().out
    for words in (
        "une excitation de 0,2 rad/s² : 13,6° à 1,15 Hz\n",
        "une excitation de 3 rad/s² : plus ample que ne le montre l'amortissement libre\n",
        "nessuna curva di risonanza: con 1e-09 rad/s^2 oscilla meno di quanto mostri lo smorzamento libero; atteso: più di 0,145 rad/s^2\n",
    ):
        assert words in told.replace("\u00a0", " ")
    for name, words, english in (
        ("series.png", ("Länge (m)", "Periode $T$ (s)", "Exponent 0,", "Theorie 0,5", "Potenzgesetz", "0,8"), ("length", "law", "0.")),
        ("groups.png", ("gleich mit p = ", "Mittel einer Gruppe", "Güte $Q$", "graue Linie"), ("mean", "equal", "p = 0.")),
        ("resonance.png", ("fréquence de l'excitation (Hz)", "excitation 0,2 rad/s²", "retard de phase (°)", "1,15"), ("drive", "bands", "0.")),
    ):  # fmt: skip
        assert all(one in drawn[name] for one in words), drawn[name]
        assert not any(one in drawn[name] for one in english), drawn[name]
