"""The pictures beside an answer: what is written in them can be read, and what they do not show is not spoken of."""

import numpy as np
import pandas as pd
import pytest
from matplotlib.collections import LineCollection
from written import boxes, in_the_way

import swingdown
from swingdown.curves.laws import envelopes as of_laws
from swingdown.language import language, languages
from swingdown.measurement.stated import Stated
from swingdown.plots import save
from swingdown.plots.curves import backbone, envelopes, resonances
from swingdown.plots.discovery import missing_torque
from swingdown.plots.series import groups_side_by_side, over_what_was_varied
from swingdown.plots.style import in_language
from swingdown.series import series_of

TIMES = np.arange(2001) / 100
LAWS = {
    "viscous": {"viscous_ratio": 0.008},
    "quadratic_drag": {"quadratic_coefficient": 0.04},
    "viscous+load_coulomb": {"viscous_ratio": 0.004, "load_friction": 0.004},
}


@pytest.fixture(scope="module", params=LAWS)
def answer(request):
    swing = swingdown.simulate(
        request.param, TIMES, 0.35, noise=1e-3, seed=1, natural_frequency=7.25, **LAWS[request.param]
    )
    return swingdown.fit(swing, fitted=[request.param])


def test_the_qualities_beside_the_damping_ratio_can_be_read(answer):
    """From a ratio that hardly changes to one that begins near zero, where the quality knows no end."""
    figure = backbone(answer.curves())
    assert not in_the_way(figure)
    (scale,) = (one for axes in figure.axes for one in axes.child_axes)
    told = [float(one.get_text()) for one in scale.get_yticklabels()]
    assert len(told) >= 2 and min(told) > 0
    np.testing.assert_allclose(told, scale.get_yticks())


@pytest.mark.parametrize(("restoring", "there"), [("sine", True), ("linear", False)])
def test_a_spring_s_torque_is_named_where_it_is_seen_beside_the_pendulum_s(tmp_path, restoring, there):
    swing = swingdown.simulate(
        "viscous", np.arange(1801) / 10, 0.5, noise=1e-3, seed=1, restoring=restoring, natural_frequency=0.62, viscous_ratio=0.012
    )  # fmt: skip
    figure = backbone(swingdown.fit(swing, fitted=["viscous"], restoring=restoring).curves())
    save(figure, tmp_path / "curves.svg")  # the layout is settled once
    assert not in_the_way(figure)
    assert ("a spring's" in [text for text, _ in boxes(figure)]) is there


def test_the_laws_of_damping_are_named_in_full_and_none_is_cut(answer):
    figure = envelopes(of_laws(answer.laws()))
    lower = figure.axes[1]
    drawn = np.concatenate([line.get_ydata() for line in lower.lines])
    assert np.nanmax(np.abs(drawn)) <= lower.get_ylim()[1]
    assert any(text.startswith("load Coulomb") for text, _ in boxes(figure))


def test_a_resonance_beyond_the_ring_down_is_told_and_leaves_the_legend_its_room(answer):
    small, large = (resonances(answer.resonance(drive)) for drive in (None, [0.5, 1.5, 3.0]))
    assert not in_the_way(small) and not in_the_way(large)
    for figure, there in ((small, False), (large, True)):
        words = " ".join(text for text, _ in boxes(figure))
        assert ("peaks beyond the ring-down" in words) is there


def test_a_part_where_no_pendulum_stays_is_spoken_of_where_it_is_drawn(answer):
    for drive in (None, [0.5, 1.5, 3.0]):
        figure = resonances(answer.resonance(drive))
        lines = [line for line in figure.axes[0].lines if line.get_linestyle() == "--"]
        drawn = any(np.isfinite(line.get_xdata()).any() for line in lines)
        assert ("no pendulum stays" in figure.get_supxlabel()) is drawn


def test_a_band_without_an_end_leaves_the_picture_its_limits(answer):
    """A period whose lower bound is no time has a frequency without an upper one."""
    curves = answer.curves().copy(deep=True)
    curves["frequency_high"][{"source": 0, "amplitude": -1}] = np.inf
    figure = backbone(curves)
    assert all(np.isfinite([*axes.get_xlim(), *axes.get_ylim()]).all() for axes in figure.axes)


def test_nothing_is_cut_in_any_language():
    swing = swingdown.simulate("viscous", TIMES, 0.35, noise=1e-3, seed=1, natural_frequency=7.25, viscous_ratio=0.008)  # fmt: skip
    answer = swingdown.fit(swing, fitted=["viscous"])
    curves = answer.curves().assign_attrs(model="viscous+presliding", emulated="yes")
    driven = answer.resonance([0.5, 1.5, 3.0]).assign_attrs(emulated="yes")
    for code in languages():
        for figure in (
            backbone(curves),
            resonances(driven),
            over_what_was_varied(varied()),
            groups_side_by_side(between()),
            missing_torque(*lacking()),
        ):
            assert not in_the_way(in_language(figure, language(code))), code


def test_single_swings_that_tell_nothing_are_left_out():
    """A slow roll's periods, whose bars would cross the panel."""
    swing = swingdown.simulate(
        "viscous", np.arange(1801) / 10, 0.2, noise=1e-3, seed=1, restoring="linear", natural_frequency=0.62, viscous_ratio=0.012
    )  # fmt: skip
    frequency, loss = backbone(swingdown.fit(swing, fitted=["viscous"], restoring="linear").curves()).axes[:2]
    bars = [one.get_segments() for one in frequency.collections if isinstance(one, LineCollection)]
    low, high = frequency.get_xlim()
    assert all(bar[1][0] - bar[0][0] < 2 * (high - low) for part in bars for bar in part)
    assert loss.containers and len(loss.containers[0][0].get_xdata()) > 5


def lacking():
    """The tables and rounds of ``missing_torque``."""
    x = np.linspace(-1, 1, 20)
    first = pd.concat(
        pd.DataFrame({"over": over, "part": "drag", "x": x, "torque": x**2, "band": 0.1})
        for over in ("position", "velocity", "time")
    )
    groups = [{"name": name, "share": 0.123} for name in ("position", "velocity", "time")]
    return first, first, [{"groups": groups, "missing": True}] * 2


def table(**columns):
    """A table of pendulums with periods, qualities and decay times."""
    count = len(next(iter(columns.values())))
    known = {"recording": [f"r{k}" for k in range(count)], "label": ["r"] * count}
    return pd.DataFrame(
        known
        | {
            name: value
            for own, one in columns.items()
            for name, value in ((own, one), (f"{own}_u", 0.01 * one))
        }
    )


def varied():
    lengths = np.array([0.2, 0.4, 0.6, 0.9])
    found = table(period_s=2.006 * lengths**0.5 * (1 + 0.05 * np.sin(9 * lengths)), quality=60 + 9 * lengths)
    values = {
        name: {"length": Stated(at, 0.001, "m")} for name, at in zip(found["recording"], lengths, strict=True)
    }
    return series_of(found, values)


def between():
    found = table(
        period_s=np.array([1.0, 1.01, 1.2, 1.21, 1.0, 1.01]),
        quality=np.arange(60.0, 66),
        decay_time_s=np.arange(20.0, 26),
    )
    return series_of(found, {}, {name: {"group": "ABC"[k // 2]} for k, name in enumerate(found["recording"])})
