"""What is handed in: the answer in one's language, the report as PDF, the table for LaTeX and as a spreadsheet."""

import json
import math
import os
import re
import shutil
from dataclasses import replace
from pathlib import Path

import openpyxl
import pandas as pd
import pytest
import yaml
from exporting import export

import swingdown
from swingdown.__main__ import main
from swingdown.answer import hand_in
from swingdown.answer import study as by_config
from swingdown.errors import InputError, PackageError
from swingdown.language import language
from swingdown.sealed import write_csv
from swingdown.studies.pendulums import REFUSED

CHROMIUM = os.environ.get("SWINGDOWN_CHROMIUM") or shutil.which("chromium")


@pytest.fixture(scope="module")
def answer(tmp_path_factory):
    return swingdown.fit(export(tmp_path_factory.mktemp("anna") / "anna.csv"))


def test_the_first_answer_is_told_in_another_language_and_files_stay_english(here, capsys):
    export(here / "anna.csv")
    assert main(["anna.csv", "--quick", "--lang", "de"]) == 0
    told = capsys.readouterr().out
    assert "  Luftwiderstand (viskos) oder " in told and "bremsen die Schwingung: T = 0,87" in told
    for words in (
        "Eigenfrequenz",
        "Güte Q",
        "Abklingzeit (1/e)",
        "genommen `Angle (°)` als Grad",
        "Exponentiell: ",
    ):
        assert words in told
    assert "period " not in told and "Air drag" not in told
    folder = here / "anna-swingdown"
    assert yaml.safe_load((folder / "study.yaml").read_text())["lang"] == "de"
    row = pd.read_csv(folder / "first_answer.csv").iloc[0]
    assert row["model"] == "viscous" and row["period_s_text"].startswith("0.87")


def test_json_is_english_in_every_language(here, capsys):
    export(here / "anna.csv")
    assert main(["anna.csv", "--quick", "--json", "--lang", "fr"]) == 0
    told = capsys.readouterr()
    (found,) = json.loads(told.out)["pendulums"]
    assert found["sentence"].startswith("Air drag (viscous) or ") and "stop it: T = 0.87" in found["sentence"]
    assert "La traînée de l'air (visqueuse) ou " in told.err and "amortissent l'oscillation" in told.err


def test_an_unknown_language_is_refused_with_a_hint(capsys):
    with pytest.raises(SystemExit) as stopped:
        main(["anna.csv", "--lang", "dee"])
    assert stopped.value.code == 2 and "did you mean de?" in capsys.readouterr().err


def test_a_caption_keeps_its_nouns_as_german_writes_them(answer):
    emulated = hand_in.Studied({**answer.row, "emulated": "yes"}, None, answer.sentence, [])
    assert "Emuliert: berechnet, nicht an einem wirklichen Pendel gemessen." in hand_in.latex(
        {"anna": emulated}, language("de")
    )


def test_the_table_for_latex_has_every_quantity_with_its_unit(answer):
    text = hand_in.latex({"anna": answer}, language("de"))
    lines = text.splitlines()
    assert [line for line in lines if "rule" in line] == [r"\toprule", r"\midrule", r"\bottomrule"]
    period = next(line for line in lines if line.startswith("Periode"))
    assert period.split(" & ")[1:3] == [answer["period"].__str__().removesuffix(" s").replace(".", ","), "s"]
    assert sum(line.endswith(r"\\") for line in lines) == 1 + len(answer.quantities)


def test_names_and_units_are_escaped_for_latex(answer):
    text = hand_in.latex({"50% of_it & $x^2": answer, "b": answer}, language())
    assert r"50\% of\_it \& \$x\textsuperscript{2} &" in text and "rad/s" in text
    assert hand_in._escaped("1.2(3) × 10^-7 rad/s^2") == (
        r"1.2(3) $\times$ 10\textsuperscript{$-$7} rad/s\textsuperscript{2}"
    )


def test_emulated_values_say_so_where_they_are_handed_in(answer, tmp_path):
    table = answer.table.assign(emulated="yes")
    made = {"anna": replace(answer, table=table)}
    assert "emulated" not in hand_in.latex({"anna": answer}, language()).lower()
    assert "Emulated: computed" in hand_in.latex(made, language())
    book = openpyxl.load_workbook(hand_in.spreadsheet(made, tmp_path / "a.xlsx", language()))
    assert any("emulated" in str(row[1]) for row in book["answer"].iter_rows(values_only=True))


def test_a_spreadsheet_has_numbers_as_numbers_and_no_formulas(answer, tmp_path):
    path = hand_in.spreadsheet({"=1+1": answer}, tmp_path / "a.xlsx", language("it"))
    sheet = openpyxl.load_workbook(path)["grandezze"]
    head, *rows = sheet.iter_rows(values_only=True)
    assert head[:5] == ("pendolo", "grandezza", "valore", "incertezza tipo", "unità")
    by_name = {row[6]: row for row in rows}
    period = answer["period"]
    assert by_name["period"][2:4] == pytest.approx(tuple(period[:2]), rel=1e-14)
    assert by_name["period"][4] == "s" and math.isfinite(by_name["quality"][2])
    cells = [cell for row in sheet.iter_rows() for cell in row]
    assert not [cell.value for cell in cells if cell.data_type == "f"] and rows[0][0] == "'=1+1"


def test_a_pdf_of_a_first_answer_is_refused_before_anything_is_computed(here, capsys):
    export(here / "anna.csv")
    with pytest.raises(SystemExit):
        main(["anna.csv", "--quick", "--pdf"])
    assert "--quick ends before the report" in capsys.readouterr().err
    assert not (here / "anna-swingdown").exists()


def test_without_openpyxl_a_spreadsheet_is_refused_with_the_mend(monkeypatch):
    monkeypatch.setattr(hand_in, "has", lambda name: False)
    with pytest.raises(PackageError, match="spreadsheet"):
        hand_in.check_able(["xlsx"])


def test_without_a_browser_it_is_told_how_to_print(tmp_path, monkeypatch):
    (tmp_path / "report.html").write_text("<p>here</p>")
    monkeypatch.delenv("SWINGDOWN_CHROMIUM", raising=False)
    monkeypatch.setattr(hand_in.shutil, "which", lambda name: None)
    told = hand_in.printed(tmp_path / "report.html", tmp_path / "report.pdf")
    assert "open" in told and "print" in told and "\n" not in told and not (tmp_path / "report.pdf").exists()


def test_a_browser_prints_the_report_with_its_headings_as_bookmarks_and_none_at_the_foot_of_a_page(tmp_path):
    if not CHROMIUM:
        pytest.skip("NOT TESTED: no browser (tools/install-test-tools, or set SWINGDOWN_CHROMIUM)")
    style = (Path(hand_in.__file__).parents[1] / "report/page.css").read_text(encoding="utf-8")
    part = "<details open><summary><h2>Here</h2></summary><figure style='height: 15cm'></figure></details>"
    (tmp_path / "report.html").write_text(
        f"<style>{style}</style><main><h1>First</h1><div style='height: 17cm'></div>{part}</main>"
    )
    hand_in.printed(tmp_path / "report.html", tmp_path / "report.pdf")
    pdf = (tmp_path / "report.pdf").read_bytes()
    found = re.findall(rb"/Title \((\w+)\)\n/Dest \[(\d+) 0 R /XYZ \S+ (\S+) ", pdf)
    at = {name: (page, float(points)) for name, page, points in found}
    assert (
        at[b"Here"][0] != at[b"First"][0] and at[b"Here"][1] > 700
    )  # the head of the second page, of 792 points


def test_a_browser_that_prints_nothing_leaves_no_file(tmp_path, monkeypatch):
    (tmp_path / "report.html").write_text("<p>here</p>")
    monkeypatch.setenv("SWINGDOWN_CHROMIUM", shutil.which("false"))
    with pytest.raises(InputError, match="printed no page"):
        hand_in.printed(tmp_path / "report.html", tmp_path / "report.pdf")
    assert [path.name for path in tmp_path.iterdir()] == ["report.html"]


def test_a_study_by_config_hands_in_what_its_tables_tell(answer, tmp_path, monkeypatch, capsys):
    (tmp_path / "study.yaml").write_text("recordings: sheet.csv\nsimulation: {simulated: []}\nlang: it\n")

    def run(project, config, folder, cores, targets):
        tables = folder / "results" / "tables"
        tables.mkdir(parents=True)
        lost = {"recording": "b", "campaign": "b", "verdict": REFUSED}
        rows = [answer.table.assign(campaign="anna"), pd.DataFrame([lost])]
        write_csv(pd.concat(rows), tables / "pendulums.csv")
        return 0

    monkeypatch.setattr(by_config, "run_workflow", run)
    assert main([str(tmp_path / "study.yaml"), "--latex", "--xlsx"]) == 0
    assert "answer.tex" in (told := capsys.readouterr().out) and "answer.xlsx" in told
    assert (tmp_path / "answer.tex").read_text() == hand_in.latex({"anna": answer}, language("it"))
    direct = hand_in.spreadsheet({"anna": answer}, tmp_path / "direct.xlsx", language("it"))
    cells = [
        [list(sheet.iter_rows(values_only=True)) for sheet in openpyxl.load_workbook(path)]
        for path in (tmp_path / "answer.xlsx", direct)
    ]
    assert cells[0] == cells[1] and len(cells[0][0]) == 1 + len(answer.quantities)


def test_a_study_without_pendulums_says_that_it_has_no_table(tmp_path):
    (told,) = hand_in.hand_in(("xlsx", "latex"), {}, tmp_path, language())
    assert "no --xlsx or --latex" in told and not list(tmp_path.iterdir())


def test_a_refusal_is_told_in_another_language_with_its_labels(here, capsys):
    with pytest.raises(SystemExit):
        main(["anna.csv", "--quick", "--lang", "de"])
    told = capsys.readouterr().err
    for words in (
        "Diese Eingabe lässt sich nicht verwenden.",
        "Fehler:    diese Datei gibt es nicht",
        "Abhilfe:   den Pfad berichtigen",
    ):
        assert words in told
    assert "problem" not in told and "This input" not in told
