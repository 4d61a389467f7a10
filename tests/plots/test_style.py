"""A figure is the same file each time, whatever matplotlib is set to, and never half a file."""

import ast
import json
from pathlib import Path

import matplotlib
import numpy as np
import pytest

from swingdown import plots
from swingdown.plots import FIGURES, save, style


@pytest.mark.usefixtures("frozen")
@style.styled
def test_each_part_of_a_figure_looks_as_it_does_in_all():
    figure = style.new_figure(9)
    models, lines, log, bare = figure.subplots(2, 2).ravel()
    style.model_axis(models, ["viscous", "viscous+load_coulomb", ("bounds", "of the\nangle")])
    style.runs(models, 0.0, [1.0, 2.0, 4.0], style.colour("viscous"), "o")
    style.runs(models, 1.0, [2.0], style.colour("none of the seven"), "D")
    style.published(models, 2.0, 1.5, 0.5)
    style.published(models, 2.0, np.nan, 0.5)
    style.noise_band(lines, 0.5)
    lines.plot([0, 1], [0.2, -3.0], label="line")
    lines.errorbar([0.5], [1.0], [0.3], label="bar")
    lines.bar([0.5], [1.0], hatch="//", label="hatched")
    style.symmetric(lines, [0.2, -3.0])
    lines.grid(True)
    style.legend_above(lines)
    log.plot([1, 10], [1, 10])
    log.set_xscale("log")
    style.decimal_log(log.xaxis)
    style.legend_above(
        log,
        [
            style.mark(".", "red", "a dot"),
            style.mark("D", "blue", "hollow", hollow=True),
            style.mark("s", "red", "s"),
        ],
    )
    style.dots(bare, [1], [2], 3.0, "red", alpha=0.5)
    style.noted(bare, "note", (1, 2), (4, -5))
    style.footnote(figure, "one", "", "two")
    assert [one.get_text() for one in models.get_xticklabels()][2] == "bounds"
    assert [text.get_text() for text in models.texts] == [
        "viscous",
        "viscous +",
        "Coulomb",
        "of the",
        "angle",
    ]
    assert figure.get_supxlabel() == "one · two"


@pytest.mark.parametrize(("length", "lines"), [(118, 1), (119, 2), (300, 3)])
def test_remarks_are_broken_where_the_figure_ends(length, lines):
    words = ("word " * 80)[: length - 1] + "x"
    told = style.footnote(style.new_figure(4), words).get_supxlabel().split("\n")
    assert len(told) == lines and max(map(len, told)) <= 118
    first = "a" * 100
    joined = style.footnote(style.new_figure(4), first, "b" * 15, "c" * 15).get_supxlabel()
    assert joined == f"{first} · {'b' * 15}\n{'c' * 15}"


@pytest.mark.parametrize(
    ("stated", "told"), [("yes", True), (True, True), ("1", True), ("no", False), (None, False)]
)
def test_what_says_so_is_called_emulated(stated, told):
    assert style.emulated_note({} if stated is None else {"emulated": stated}) == (
        style.EMULATED if told else ""
    )


@pytest.mark.parametrize(("points", "pixels"), [(10_000, False), (10_001, True)])
def test_a_series_of_more_samples_than_a_page_has_room_for_is_stored_as_pixels(tmp_path, points, pixels):
    figure = style.new_figure(4)
    figure.subplots().plot(np.zeros(points))
    (path,) = save(figure, tmp_path / "a.svg")
    assert (b"<image" in path.read_bytes()) is pixels


def test_what_several_panels_draw_is_named_once():
    figure = style.new_figure(4)
    for axes in figure.subplots(1, 2):
        axes.plot([0, 1], label="fit")
    figure.axes[1].plot([0, 1], label="data")
    assert [one.get_label() for one in style.handles_of(figure)] == ["fit", "data"]


def test_signs_and_angles_are_as_the_axes_have_them():
    assert (
        style.signed("-1.5") == "−1.5"
        and style.name("viscous+load_coulomb+magnet") == "viscous + Coulomb + magnet"
    )
    np.testing.assert_allclose(style.degrees([0.0, np.pi / 2]), [0, 90])
    assert style.colour("viscous") != style.colour("magnet") == style.colour("backlash")


def test_two_runs_write_the_same_bytes(tmp_path, realizations):
    for run in ("one", "two"):
        save(FIGURES["fig02"](realizations), tmp_path / run / "fig02")
    for suffix in (".svg", ".png"):
        first, second = ((tmp_path / run / f"fig02{suffix}").read_bytes() for run in ("one", "two"))
        assert first == second
    assert b"<dc:date>" not in first


def test_the_callers_settings_change_nothing(tmp_path, realizations):
    save(FIGURES["fig02"](realizations), tmp_path / "plain.svg")
    with matplotlib.rc_context(
        {"font.size": 20, "svg.hashsalt": "other", "axes.grid": True, "mathtext.fontset": "cm"}
    ):
        save(FIGURES["fig02"](realizations), tmp_path / "set.svg")
    assert (tmp_path / "plain.svg").read_bytes() == (tmp_path / "set.svg").read_bytes()


def test_what_is_emulated_says_so_once_beside_a_figures_own_remarks(tmp_path):
    long = "a remark that takes most of the line, so that the next one cannot stand beside it on the same one"
    figure = style.footnote(style.new_figure(4), "one", long, "two")
    for ending in ("svg", "png"):
        save(figure, tmp_path / f"a.{ending}", style.EMULATED)
    assert figure.get_supxlabel() == f"one · {long} · two\n{style.EMULATED}"
    bare = style.new_figure(4)
    save(bare, tmp_path / "b.svg", style.EMULATED)
    assert bare.get_supxlabel() == style.EMULATED
    save(plain := style.new_figure(4), tmp_path / "c.svg", "")
    assert plain.get_supxlabel() == ""


def test_the_suffix_chooses_the_format(tmp_path):
    assert [path.name for path in save(style.absent("nothing to see"), tmp_path / "fig01")] == [
        "fig01.svg",
        "fig01.png",
    ]
    assert save(style.absent("nothing to see"), tmp_path / "only.png") == [tmp_path / "only.png"]
    left = sorted(path.name for path in tmp_path.iterdir() if not path.name.startswith("."))
    assert left == ["fig01.png", "fig01.svg", "only.png"]


def test_a_png_is_as_wide_as_the_column_at_200_dpi(tmp_path):
    (path,) = save(style.absent("nothing to see"), tmp_path / "fig01.png")
    width = int.from_bytes(path.read_bytes()[16:20], "big")
    assert width / 200 * 2.54 == pytest.approx(style.WIDTH_CM, abs=0.02)


def test_a_failed_save_leaves_the_old_file_and_nothing_else(tmp_path, monkeypatch):
    figure = style.absent("nothing to see")
    (path,) = save(figure, tmp_path / "fig01.png")
    before = path.read_bytes()
    monkeypatch.setattr("os.fsync", lambda _: (_ for _ in ()).throw(OSError("the disk is full")))
    with pytest.raises(OSError):
        save(figure, path)
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


def test_plots_rest_on_datasets_symbols_statuses_rounding_and_the_way_files_are_written_alone():
    usual = {
        "matplotlib",
        "numpy",
        "pandas",
        "xarray",
        "collections",
        "functools",
        "io",
        "os",
        "pathlib",
        "textwrap",
        "typing",
    }
    for file in Path(plots.__file__).parent.glob("*.py"):
        allowed = usual | (
            {"tkinter", "time"} if file.name == "live.py" else set()
        )  # the one that has a window
        for node in ast.walk(ast.parse(file.read_text())):
            if isinstance(node, ast.Import):
                assert {alias.name.split(".")[0] for alias in node.names} <= allowed, file.name
            elif isinstance(node, ast.ImportFrom) and node.level == 0:
                assert node.module.split(".")[0] in allowed, file.name
            elif isinstance(node, ast.ImportFrom) and node.level == 2:
                assert node.module in (
                    "arrays",
                    "dataset",
                    "language",
                    "own_unit",
                    "pendulum.model",
                    "paths",
                    "rounding",
                    "sealed",
                    "status",
                ), file.name


def test_an_axis_of_values_that_are_not_known_is_one_around_zero():
    axes = style.new_figure(4).subplots()
    assert style.symmetric(axes, [np.nan, np.nan]).get_ylim() == (-1, 1)
    assert style.symmetric(axes, [np.nan, -2.0, np.inf]).get_ylim() == (-2.24, 2.24)


def test_a_logarithmic_axis_is_marked_at_one_two_and_five():
    axes = style.new_figure(4).add_subplot()
    axes.set_xlim(0.09, 6)
    axes.set_xscale("log")
    style.decimal_log(axes.xaxis)
    axes.figure.draw_without_rendering()
    marked = [one.get_text() for one in axes.get_xticklabels() if 0.09 <= one.get_position()[0] <= 6]
    assert marked == ["0.1", "0.2", "0.5", "1", "2", "5"]


def test_the_dots_of_one_model_lie_apart_beside_its_place():
    axes = style.new_figure(4).add_subplot()
    style.runs(axes, 1.0, [3.0, 1.0, 2.0, np.nan], "black", "o")
    across, along = axes.lines[0].get_data()
    assert list(along) == [1, 2, 3] and np.abs(across - 1.09).max() < 0.026
    assert np.abs(np.diff(across)).min() > 0.01


def test_each_frozen_look_is_of_a_test_that_is_there(root):
    """One whose name changed would be held against nothing."""
    known = json.loads((root / "tests/plots/frozen.json").read_text())
    for name in known:
        file, test = name.split("[")[0].split("::")
        assert f"\ndef {test}(" in (root / "tests/plots" / file).read_text(), name
