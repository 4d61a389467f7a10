"""A figure is the same file each time, whatever matplotlib is set to, and never half a file."""

import ast
from pathlib import Path

import matplotlib
import numpy as np
import pytest

from swingdown import plots
from swingdown.plots import FIGURES, save, style


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
