"""The maps of a sweep show every cell, the paper's level, and what they are of."""

import numpy as np
import pytest
import xarray as xr
from matplotlib.text import Text

from swingdown.plots.sweep import MAPS, _with_room

pytestmark = pytest.mark.usefixtures("frozen")


def said(figure):
    return [text.get_text() for text in figure.findobj(Text) if text.get_text().strip()]


@pytest.fixture
def maps():
    """Probabilities over two models, two starts, three angles and four ratios, each cell another."""
    shape = (2, 2, 3, 4)
    share = np.arange(np.prod(shape)).reshape(shape) / np.prod(shape)
    dims = ("simulated", "start", "release_angle_deg", "snr")
    coords = {
        "simulated": ["viscous", "load_coulomb"],
        "start": ["rest", "free"],
        "release_angle_deg": [5.0, 20.0, 40.0],
        "snr": [5.0, 20, 50, 100],
    }
    names = [f"true_by_{kind}{end}" for kind in ("norm", "bic", "ten") for end in ("", "_low_95", "_high_95")]
    count = dict.fromkeys(("made", "independent", "sets_of_ten"), (dims, np.full(shape, 40.0)))
    made = xr.Dataset(
        dict.fromkeys(names, (dims, share)) | count,
        coords,
        {"axes": " ".join(dims), "realizations": 40, "seed": 150},
    )
    made["release_angle_deg"].attrs = {"long_name": "release angle", "units": "degrees"}
    return made


def test_of_as_many_values_as_there_is_room_for_all_are_shown(maps):
    dims = ["release_angle_deg", "snr"]
    assert _with_room(maps, dims, 12) == ({}, dims, [])
    chosen, shown, words = _with_room(maps, dims, 11)
    assert chosen == {"snr": 2}
    assert shown == ["release_angle_deg"]
    assert "50" in words[0]


@pytest.mark.parametrize("name", ["by_norm", "by_bic", "by_ten"])
def test_every_cell_is_written_in_per_cent_beside_the_papers_level(maps, name):
    texts = said(MAPS[name](maps))
    for value in maps["true_by_norm"].values.ravel():
        assert f"{100 * value:.0f}" in texts
    assert "68 %\n(paper)" in texts
    assert {
        "viscous simulated",
        "Coulomb simulated",
        "start rest",
        "start free",
        "SNR",
        "release angle (°)",
    } <= set(texts)
    kind = "sets of ten draws" if name == "by_ten" else "draws"
    assert any(f"40 {kind} a cell" in text and "seed 150" in text for text in texts)


def test_axes_that_do_not_fit_a_page_are_shown_at_one_value_that_is_told(maps):
    wide = xr.concat([maps, maps], "form").assign_coords(form=["consistent", "printed"])
    many = xr.concat([wide] * 9, "sampling_rate_hz").assign_coords(sampling_rate_hz=np.arange(9) * 10.0 + 50)
    many = many.transpose("sampling_rate_hz", "form", *maps.attrs["axes"].split())
    many["sampling_rate_hz"].attrs = {"long_name": "sampling rate", "units": "Hz"}
    many.attrs = maps.attrs | {"axes": "sampling_rate_hz form " + maps.attrs["axes"]}
    figure = MAPS["by_norm"](many)
    assert any("shown at sampling rate 90 Hz" in text for text in said(figure))
    assert len(figure.axes) == 2 * 4 + 1


def test_one_axis_alone_is_a_row_of_cells(maps):
    one = maps.isel(start=0, release_angle_deg=0, simulated=0, drop=True).assign_attrs(
        maps.attrs | {"axes": "snr"}
    )
    assert len(MAPS["by_norm"](one).axes) == 2


def test_too_few_draws_for_the_papers_comparison_are_told(maps):
    assert any(
        "fewer than ten draws" in text
        for text in said(MAPS["by_ten"](maps.assign(true_by_ten=maps["true_by_ten"] * np.nan)))
    )


def test_what_discovery_said_adds_up_to_all_campaigns():
    said_words = ["nothing", "named", "among_others", "unknown", "wrong", "failed"]
    share = np.zeros((2, 3, 6))
    share[:, 0, 0] = 1
    share[:, 1:, 1], share[:, 1:, 4] = 0.75, 0.25
    maps = xr.Dataset(
        {"share": (("effect", "size", "said"), share)}
        | dict.fromkeys(("named", "named_low_95", "named_high_95"), (("effect", "size"), share[:, :, 1]))
        | {
            name: (("effect", "size"), np.full((2, 3), 12.0))
            for name in ("made", "independent", "left_by_base", "reached")
        },
        {"effect": ["quadratic_drag", "detent"], "size": [0.0, 0.3, 1.0], "said": said_words},
        {"axes": "effect size", "realizations": 12, "seed": 1},
    )
    figure = MAPS["detection"](maps)
    heights = np.zeros((2, 3))
    for panel, axes in enumerate(figure.axes[:2]):
        for bar in axes.patches:
            heights[panel, round(bar.get_x() + bar.get_width() / 2)] += bar.get_height()
    assert np.allclose(heights, 100)
    texts = said(figure)
    assert {"quadratic drag", "detent", "another effect", "the hidden effect, alone"} <= set(texts)
    assert "failed" not in texts and any("12 campaigns a bar" in text for text in texts)
