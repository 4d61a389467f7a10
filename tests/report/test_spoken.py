"""A report in another language: its texts, and its numbers' decimal sign; somebody's names and what stands in files stay."""

import matplotlib
import numpy as np
from markupsafe import Markup

from swingdown.language import language
from swingdown.plots import style
from swingdown.report.page import Column, Figure, Findings, Listing, Section, Table, Text, Value
from swingdown.report.spoken import in_language, words

GERMAN = language("de")


def test_texts_and_numbers_are_said_in_the_language_and_names_stay():
    columns = [
        Column("recording"),
        Column("period", "s", "n"),
        Column("verdict"),
        Column("which", style="code"),
    ]
    rows = [["period 1.5", "0.871(3)", "Named", "1.5"], ["b", Value("1.20(3)", 1.2), "Unknown", "0.1"]]
    table = Table("Quantities, anna", "Fitted parameters; in parentheses the standard error in units of the last digits.", columns, rows)  # fmt: skip
    (made,) = in_language([Section("The answer", [Text("Nothing else is needed."), table])], GERMAN)
    text, found = made.items
    assert made.title == "Die Antwort" and text.text == "Mehr ist nicht nötig."
    assert found.label == "Größen, anna" and [one.head for one in found.columns[:3]] == [
        "Aufnahme",
        "Periode",
        "Urteil",
    ]
    assert [list(map(str, row)) for row in found.rows] == [
        ["period 1.5", "0,871(3)", "Benannt", "1.5"],
        ["b", "1,20(3)", "Unbekannt", "0.1"],
    ]
    assert found.rows[1][1].value == 1.2  # by which it sorts


def test_findings_and_figures_are_said_and_what_a_file_holds_stays():
    items = [
        Findings(["Nothing else is needed.", Markup("<b>Named.</b>")]),
        Figure("Quantities, anna", "a.svg", "Named."),
        Listing("Nothing else is needed."),
    ]
    findings, figure, listing = in_language([Section("The answer", items)], GERMAN)[0].items
    assert findings.lines == ["Mehr ist nicht nötig.", "<b>Benannt.</b>"]
    assert (figure.label, figure.text, figure.path) == ("Größen, anna", "Benannt.", "a.svg")
    assert listing == items[2]


def test_cells_are_said_by_what_their_column_holds():
    """A count stays a count; of markup among numbers the text is said, and its decimal sign is that of the language."""
    columns = [Column("cells", style="n"), Column("period", "s", "n"), Column("verdict"), Column("campaign")]
    rows = [[3, "0.5", Markup("<b>Named</b>"), "Named"], [4, Markup("<i>Named</i>"), "Named", "0.5"]]
    table = Table("Quantities, anna", "Named", columns, rows, notes=("Nothing else is needed.",))
    (found,) = in_language([Section("The answer", [table])], GERMAN)[0].items
    assert found.rows == [[3, "0,5", "<b>Benannt</b>", "Named"], [4, "<i>Benannt</i>", "Benannt", "0.5"]]
    assert found.caption == "Benannt" and found.notes == ("Mehr ist nicht nötig.",)


def test_in_markup_the_text_between_tags_is_said_and_code_stays():
    told = words(Markup("<b>Named.</b> Not needed: load Coulomb. <code>time</code> &lt;"), GERMAN)
    assert told == "<b>Benannt.</b> Nicht nötig: Coulomb (lastabhängig). <code>time</code> &lt;"


def test_english_is_as_it_was():
    sections = [Section("The answer", [Text("0.5 of it")])]
    assert in_language(sections, language("en")) == sections


def test_a_figure_has_its_words_and_its_marks_in_the_language():
    figure = style.new_figure(6)
    axes = figure.subplots()
    axes.plot(np.linspace(0, 1, 9), np.linspace(0, 0.5, 9), label="free of a model")
    axes.set(xlabel="time (s)", ylabel="angle (°)")
    figure.legend(loc="outside upper left")
    style.in_language(figure, GERMAN)
    figure.draw_without_rendering()
    said = {one.get_text() for one in figure.findobj(matplotlib.text.Text)}
    assert {"Zeit (s)", "Winkel (°)", "frei von einem Modell", "0,2"} <= said and "0.2" not in said


def test_words_at_an_axis_are_in_the_language():
    figure = style.new_figure(6)
    axes = figure.subplots()
    axes.set_xticks([0, 1], ["base model", "exchange load Coulomb for presliding"])
    axes.set_title("time: push")
    style.in_language(figure, GERMAN)
    figure.draw_without_rendering()
    said = {one.get_text() for one in figure.findobj(matplotlib.text.Text)}
    assert {"Grundmodell", "Zeit: Stoß"} <= said and not any("exchange" in one for one in said)


def test_a_legend_with_longer_words_stays_in_the_figure():
    figure = style.new_figure(6)
    axes = figure.subplots()
    for k in range(4):
        axes.plot([0, 1], [0, k], label=f"± 2 standard deviations of the noise{' ' * k}")
    legend = figure.legend(loc="outside upper left", ncols=4)
    style.in_language(figure, GERMAN)
    figure.draw_without_rendering()
    assert legend.get_window_extent().width <= figure.bbox.width
