"""Each figure shows what the paper's shows: labels with units, every model and point, and where its data come from."""

import inspect
import re
from base64 import b64encode
from pathlib import Path
from xml.etree import ElementTree

import cv2
import matplotlib
import numpy as np
import pytest
import xarray as xr
from matplotlib.text import Text
from written import in_the_way

from swingdown.pendulum.model import PAPER_MODELS, symbol
from swingdown.plots import FIGURES, style

EMULATED = {"fig07", "fig08", "fig09", "fig10", "fig11", "fig12", "fig13", "fig14", "fig15"}
WITH_AXES = set(FIGURES) - {"fig07"}
DRAWINGS = ("fig01", "fig06")  # take no data
FONTS = Path(matplotlib.get_data_path()) / "fonts/ttf"


@pytest.fixture
def draw(request):
    """Draws a figure, by name, from the small datasets; ``changed`` replaces some of them."""

    def draw(name, **changed):
        wanted = inspect.signature(FIGURES[name]).parameters.values()
        needed = [p.name for p in wanted if p.default is p.empty]
        source = {"norms": "norms" if name < "fig10" else "run_norms"}
        data = {key: request.getfixturevalue(source.get(key, key)) for key in needed if key not in changed}
        return FIGURES[name](**data, **changed)

    return draw


def texts(figure):
    """Everything that is written on a figure."""
    return [text.get_text() for text in figure.findobj(Text) if text.get_text().strip()]


def said(figure):
    return "\n".join(texts(figure))


def test_the_fifteen_figures_of_the_paper_are_there():
    assert sorted([*FIGURES, *DRAWINGS]) == [f"fig{number:02d}" for number in range(1, 16)]


@pytest.mark.parametrize(
    ("name", "words"),
    [("fig01", ("pivot", "tension", "damping")), ("fig06", ("rotary", "magnets", "not to scale"))],
)
def test_a_drawing_names_its_parts_and_is_as_wide_as_the_others_in_both_formats(root, name, words):
    drawn = ElementTree.parse(root / f"workflow/report/{name}.svg").getroot()
    said = " ".join("".join(text.itertext()) for text in drawn.iter("{http://www.w3.org/2000/svg}text"))
    assert all(word in said for word in words)
    *_, wide, high = map(float, drawn.get("viewBox").split())
    head = (root / f"workflow/report/{name}.png").read_bytes()[16:24]
    width, height = int.from_bytes(head[:4], "big"), int.from_bytes(head[4:], "big")
    assert width / 200 * 2.54 == pytest.approx(style.WIDTH_CM, abs=0.02)
    assert height / width == pytest.approx(high / wide, rel=2e-3)


@pytest.mark.parametrize("name", DRAWINGS)
def test_a_drawing_is_one_picture_in_both_formats(root, browser, name):
    """As a browser draws the SVG in the fonts that it names; in means over a letter a tenth of black is less than any line or word."""
    path = root / f"workflow/report/{name}.png"
    kept = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE).astype(float)
    fonts = "".join(
        f"@font-face {{font-family: STIXGeneral; font-style: {slant}; src: url(data:font/ttf;base64,{b64encode(file.read_bytes()).decode()})}}"
        for slant, file in (
            ("normal", FONTS / "STIXGeneral.ttf"),
            ("italic", FONTS / "STIXGeneralItalic.ttf"),
        )
    )
    high, wide = kept.shape
    drawing = path.with_suffix(".svg").read_text(encoding="utf-8")
    drawing = re.sub('width="[^"]*" height="[^"]*"', f'width="{wide}" height="{high}"', drawing, count=1)
    page = browser.new_page(viewport={"width": wide, "height": high})
    page.set_content(f"<style>{fonts} body {{margin: 0}} svg {{display: block}}</style>{drawing}")
    page.evaluate("document.fonts.ready")
    seen = cv2.imdecode(np.frombuffer(page.screenshot(), np.uint8), cv2.IMREAD_GRAYSCALE).astype(float)
    page.close()
    assert np.abs(cv2.blur(seen - kept, (15, 15))).max() < 25.5


@pytest.mark.parametrize("name", sorted(WITH_AXES))
def test_every_axis_says_its_quantity_and_unit(draw, name):
    for axes in draw(name).axes:
        named = [axes.get_ylabel()] + (
            [] if "κ" in said(axes) or r"\kappa" in said(axes) else [axes.get_xlabel()]
        )
        for label in filter(None, named):
            assert label.endswith(("(s)", "(°)", "(V)")), label
    assert any(axes.get_ylabel().endswith("(°)") for axes in draw(name).axes)


@pytest.mark.parametrize("name", sorted(FIGURES))
def test_emulated_data_are_called_emulated_and_no_others(draw, name):
    assert ("emulated bench" in said(draw(name))) == (name in EMULATED)


def test_a_real_recording_is_not_called_emulated(draw, angles):
    assert "emulated" not in said(draw("fig09", angles=angles.assign_attrs(emulated="no")))


@pytest.mark.parametrize("name", ["fig02", "fig03", "fig04", "fig05"])
def test_a_simulation_says_that_settings_were_inferred(draw, name, realizations, norms):
    assert "inferred from its Table 2" in said(draw(name))
    known = {"realizations": realizations} if name == "fig02" else {"norms": norms}
    ((key, data),) = known.items()
    assert "inferred" not in said(draw(name, **{key: data.drop_attrs(deep=False)}))


@pytest.mark.usefixtures("frozen")
@pytest.mark.parametrize("name", sorted(FIGURES))
def test_nothing_that_is_written_overlaps_or_leaves_the_figure(draw, name):
    assert not in_the_way(draw(name))


@pytest.mark.parametrize(
    ("name", "label"), list(zip(["fig10", "fig11", "fig12"], PAPER_MODELS[:3], strict=True))
)
def test_a_fit_shows_its_model_norm_and_residual_in_the_models_colour(draw, name, label, fits):
    figure = draw(name)
    assert f"{float(fits['norm'].sel(fitted=label)):#.3g}°" in said(figure)
    strip = next(axes for axes in figure.axes if axes.get_ylabel().startswith("data − fit"))
    drawn = [line for line in strip.lines if len(line.get_xdata()) == fits.sizes["time"]]
    assert [line.get_color() for line in drawn] == [style.colour(label)]
    np.testing.assert_allclose(drawn[0].get_ydata(), np.degrees(fits["residual"].sel(fitted=label)))


def test_a_residual_far_within_the_error_bound_sets_the_scale_and_says_so(draw, fits):
    small = fits.copy(deep=True)
    small["residual"] *= 0.05
    for data, within in ((fits, False), (small, True)):
        figure = draw("fig10", fits=data)
        strip = next(axes for axes in figure.axes if axes.get_ylabel().startswith("data − fit"))
        largest = float(np.degrees(np.abs(data["residual"].sel(fitted="viscous")).max()))
        assert largest < strip.get_ylim()[1] < 1.5 * largest
        assert ("reaches beyond this strip" in said(figure)) == within


def test_the_noise_band_is_drawn_where_the_noise_is_known(draw, angles):
    assert "random uncertainties" in said(draw("fig10"))
    assert "random uncertainties" not in said(
        draw("fig10", angles=angles.drop_vars("angle_random_uncertainty"))
    )


def test_the_pairs_shown_are_the_best_of_the_swings_own_campaign(draw, run_norms):
    best = {"viscous+load_coulomb": 0.01, "viscous+quadratic_drag": 0.02}
    norms = run_norms.copy(deep=True)
    for label, value in best.items():
        norms["norm"].loc[{"fitted": label}] = value
    other = norms.copy(deep=True).assign_coords(
        recording=[f"other-{k}" for k in range(10)], campaign=("recording", ["other"] * 10)
    )
    other["norm"][:] = 9.0
    other["norm"].loc[{"fitted": "quadratic_drag+load_coulomb"}] = 0.0
    both = xr.concat([norms, other], "recording")
    for name, label in zip(("fig13", "fig14"), best, strict=True):
        assert symbol(label, mathtext=True) in said(draw(name, norms=both))


def test_the_true_model_and_the_papers_values_are_marked(draw, table2):
    figure = draw("fig04")
    assert "the true model" in said(figure)
    hollow = [line for line in figure.axes[0].lines if line.get_marker() == "s" and len(line.get_xdata())]
    rows = table2[table2["simulated"] == "quadratic_drag"]
    assert sorted(float(line.get_ydata()[0]) for line in hollow) == sorted(rows["published_mean"])


def test_both_methods_and_every_realisation_are_drawn(draw, norms):
    other = norms.assign(least_squares_norm=1.2 * norms["norm"])
    axes = draw("fig03", norms=other).axes[0]
    count = {marker: [line for line in axes.lines if line.get_marker() == marker] for marker in "oD."}
    assert len(count["o"]) == len(count["D"]) == len(PAPER_MODELS)
    assert (
        sum(len(line.get_xdata()) for line in count["."])
        == 2 * len(PAPER_MODELS) * norms.sizes["realization"]
    )


def test_flagged_points_are_told_apart(draw, calibration):
    assert "flagged" in said(draw("fig08"))
    none = calibration.assign(flagged=("point", [False] * 4))
    assert "flagged" not in said(draw("fig08", calibration=none))


def test_the_calibration_shows_the_mode_that_was_asked_for(draw, calibration):
    for mode in ("monte-carlo", "gum"):
        assert mode in said(draw("fig08", calibration=calibration.assign_attrs(mode=mode)))


def test_a_box_is_called_what_it_is(draw, calibration):
    paper, gum = (
        said(draw("fig08", calibration=calibration.assign_attrs(mode=mode))) for mode in ("paper", "gum")
    )
    assert "± limit of error" in paper and "± standard uncertainty" in gum and "2 times as large" in gum


def test_a_point_left_out_of_the_line_is_drawn_without_a_box(draw, calibration):
    left_out = calibration.copy(deep=True)
    left_out["voltage_uncertainty"][:, 0] = np.nan
    boxes = [len(draw("fig08", calibration=data).axes[1].patches) for data in (calibration, left_out)]
    assert boxes == [4, 3]


def test_every_length_stands_with_its_limit(draw):
    words = texts(draw("fig07"))
    for text in ("208.00", "12.700", "246.35", "25.400", "19.50", "50.90", "± 0.002", "± 0.04"):
        assert text in words


def test_the_papers_own_norms_are_not_taken_for_this_benchs(draw):
    assert "paper's apparatus" in said(draw("fig15"))


@pytest.mark.parametrize("name", ["fig04", "fig05"])
def test_a_study_that_leaves_a_model_out_says_so(draw, name, norms):
    assert "does not simulate" in said(draw(name, norms=norms.sel(simulated=["viscous"])))


@pytest.mark.parametrize("name", ["fig11", "fig14"])
def test_a_fit_that_was_not_made_is_not_drawn(draw, name, fits, run_norms):
    one = ["viscous", "viscous+load_coulomb"]
    given = {"fits": fits.sel(fitted=one)} | ({"norms": run_norms.sel(fitted=one)} if name == "fig14" else {})
    assert "This study" in said(draw(name, **given))


def test_each_of_the_seven_models_has_a_colour_of_its_own():
    assert list(style.COLOURS) == list(PAPER_MODELS)
    assert len(set(style.COLOURS.values())) == len(PAPER_MODELS)


def test_methods_that_agree_have_one_mark(draw):
    """Two marks beside each other for one optimum say that there are two."""
    figure = draw("fig03")
    assert "Nelder–Mead and least squares alike" in said(figure) and "differs" not in said(figure)
    assert not [line for line in figure.axes[0].lines if line.get_marker() == "D"]


def test_samples_are_seen_behind_a_fit(draw):
    whole, _, early, late = draw("fig13").axes
    for axes in (whole, early, late):
        samples = axes.get_lines()[0]
        assert samples.get_linestyle() == "None" and samples.get_markerfacecolor() == "none"
