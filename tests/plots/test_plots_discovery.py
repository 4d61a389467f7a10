"""What a search saw and did, as it is drawn."""

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from swingdown.plots import discovery

pytestmark = pytest.mark.usefixtures("frozen")


def test_the_larger_gap_is_told_above():
    """Labels on fixed sides say of two marks close to each other the wrong number."""
    found = {"gap": {"fit": [4.45, 1.0], "holdout": [4.14, 1.01]}, "moves": ["add presliding"]}
    axes = discovery.gap(found).axes[0]
    places = {text.get_text(): text.xyann[1] for text in axes.texts}
    assert places["4.45"] > 0 > places["4.14"] and places["1.01"] > 0 > places["1"]
    assert [one.get_text() for one in axes.get_xticklabels()] == ["base model", "add presliding"]


def table(count):
    x = np.linspace(0.1, 0.5, count)
    rows = pd.DataFrame({"swing": "a", "of": "measured", "amplitude_rad": x, "energy_loss": 0.02, "period_ratio": 1 + 1e-3 * np.sin(99 * x), "midpoint_rad": 0.0})  # fmt: skip
    return pd.concat([rows, rows.assign(of="modelled", period_ratio=1.0)])


@pytest.mark.parametrize("count, bars", [(20, 0), (80, 0), (81, 12), (400, 12)])
def test_many_half_swings_are_told_by_means(count, bars):
    below = discovery.half_swings(table(count), table(count)).axes[4]
    assert len(below.containers) == 2 * bars  # of the base model and of the last


def test_a_half_swing_is_measured_less_modelled_in_the_swing_s_own_order():
    both = table(20)
    both.loc[both["of"] == "modelled", "energy_loss"] = 0.015
    upper, lower = (discovery.half_swings(both, both).axes[k] for k in (0, 3))
    np.testing.assert_allclose(upper.lines[0].get_ydata(), 2.0)  # per cent
    np.testing.assert_allclose(upper.lines[0].get_xdata(), np.degrees(np.linspace(0.1, 0.5, 20)))
    np.testing.assert_allclose(lower.lines[0].get_ydata(), 0.5)


def test_a_swing_that_is_over_in_three_has_a_figure_without_half_swings(tmp_path):
    columns = ["time_s", "amplitude_rad", "energy_loss", "period_ratio", "midpoint_rad", "swing", "of"]
    pd.DataFrame(columns=columns).to_csv(tmp_path / "half_swings.csv", index=False)
    empty = pd.read_csv(tmp_path / "half_swings.csv")
    shown = discovery.half_swings(empty, empty)
    assert [text.get_text() for axes in shown.axes[:3] for text in axes.texts] == ["no half-swing"] * 3


def fits(model, sizes, held, emulated="no"):
    """A round's fits: swings of 100 samples that leave so much each, in rad."""
    times = np.tile(np.arange(100) / 10, len(sizes)) + 5
    swing = np.repeat(np.arange(len(sizes)), 100)
    angle = 0.3 * np.cos(7 * times)
    return xr.Dataset(
        {
            "angle": ("sample", angle, {"units": "rad"}),
            "fit": ("sample", angle - np.repeat(sizes, 100) * np.sin(3 * times)),
            "swing": ("sample", swing),
            "time": ("sample", times),
            "held_out": ("which", held),
            "name": ("which", [f"swing {k}" for k in range(len(sizes))]),
        },
        attrs={"model": model, "campaign": "bench", "noise_rms_rad": 0.001, "emulated": emulated},
    )


def test_the_residuals_that_are_worst_at_first_are_shown_before_and_after():
    held = [False, False, True, True]
    first = fits("viscous", [0.002, 0.006, 0.004, 0.001], held)
    last = fits("viscous+magnet", [0.001, 0.0012, 0.0011, 0.003], held)
    fitted, out = discovery.residuals(first, last).axes
    assert [axes.get_title(loc="left") for axes in (fitted, out)] == [
        "swing 1 (fitted)",
        "swing 2 (held out)",
    ]
    for axes, sizes in ((fitted, (0.006, 0.0012)), (out, (0.004, 0.0011))):
        lines = {line.get_label(): line for line in axes.lines}
        for label, size in zip(("base model", "last model"), sizes, strict=True):
            drawn = lines[label].get_ydata()
            assert np.abs(drawn).max() == pytest.approx(np.degrees(size), rel=0.01)
            assert lines[label].get_xdata()[0] == 0
        assert axes.get_ylabel() == "data − fit (°)" and axes.get_xlim() == pytest.approx((0, 9.9))
    (alone,) = discovery.residuals(
        fits("viscous", [0.002], [False], "yes"), fits("viscous", [0.002], [False])
    ).axes
    assert "(no move was made)" in [line.get_label() for line in alone.lines]


def test_what_a_torque_explains_alone_stands_above_it():
    x = np.linspace(-1, 1, 20)
    parts = [("position", "", 1.0), ("velocity", "", 1.0), ("time", "drag", 1.0), ("time", "push", 3.0)]
    first = pd.concat(
        pd.DataFrame({"over": over, "part": part, "x": x, "torque": size * x**2, "band": 0.1})
        for over, part, size in parts
    )
    groups = [{"name": "position", "share": 0.123}, {"name": "time", "share": 0.5}]
    figure = discovery.missing_torque(first, first, [{"groups": groups, "missing": True}] * 2)
    position, velocity, time = figure.axes
    titles = [axes.get_title(loc="left") for axes in figure.axes]
    assert titles == [
        "position\nexplains 12 % alone",
        "velocity\nnot seen",
        "time: push\nexplains 50 % alone",
    ]
    np.testing.assert_allclose(position.lines[0].get_xdata(), np.degrees(x))
    np.testing.assert_allclose(velocity.lines[0].get_xdata(), x)
    np.testing.assert_allclose(time.lines[0].get_ydata(), 3 * x**2)
    band = position.collections[0].get_paths()[0].vertices[:, 1]
    assert band.max() == pytest.approx(1.2) and band.min() == pytest.approx(x[10] ** 2 - 0.2)
    none = discovery.missing_torque(first, first, [{"groups": groups, "missing": False}])
    assert "nothing is missing" in none.axes[0].get_title(loc="left")
    assert [line.get_label() for line in none.axes[0].lines][:1] == ["lacked by the base model"]
    assert len(none.axes[0].lines) == 2  # one curve and the line at nothing


def test_the_moves_are_ranked_with_what_became_of_each():
    ranked = pd.DataFrame(
        {
            "move": ["add magnet", "add backlash", "add presliding", "add detent"] + ["add viscous"] * 10,
            "gain_bic": [120.0, 115.0, 60.0, -20.0] + [-30.0] * 10,
            "tied": [True, True, False, False] + [False] * 10,
            "refused": [np.nan, "", "is not physical", ""] + [""] * 10,
        }
    )
    (axes,) = discovery.ranking(ranked, "add magnet").axes
    assert [text.get_text() for text in axes.texts][:4] == [
        "120  chosen",
        "115  tied",
        "60  refused: is not physical",
        "-20",
    ]
    assert len(axes.patches) == 12 and [bar.get_width() for bar in axes.patches][:4] == [120, 115, 60, -20]
    assert axes.get_xlim() == pytest.approx((-31.5, 180)) and axes.yaxis_inverted()
    empty = discovery.ranking(ranked[:0], "")
    assert [text.get_text() for text in empty.texts] == ["Nothing was missing: no move was looked for."]


def test_a_campaign_without_a_verdict_says_where_its_reason_stands():
    assert "bench: no verdict" in discovery.no_verdict("bench").texts[0].get_text()
