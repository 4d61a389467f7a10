"""The first picture of one's own recordings, and that of a class."""

import numpy as np
import pandas as pd
import pytest
from written import in_the_way

from swingdown.arrays import Shown
from swingdown.plots.answer import swings_alone, swings_with_fit, thinned
from swingdown.plots.pendulums import side_by_side

pytestmark = pytest.mark.usefixtures("frozen")

TIMES = np.arange(2000) / 100


def swing(name, angle, part="", begin=0.0):
    series = angle * np.cos(7 * TIMES)
    return Shown(name, part, TIMES + begin, series + 0.001, series, bool(part))


def test_thinned_series_keep_every_peak():
    values = np.zeros(100_000)
    values[[77, 51_234, 99_998]] = 3.0, -2.0, 5.0
    time, kept = thinned(np.arange(values.size) / 100, values)
    assert kept.size <= 1800 and np.all(np.diff(time) > 0)
    assert {3.0, -2.0, 5.0} <= set(kept)
    same = thinned(TIMES[:500], TIMES[:500])
    assert same[0].size == 500


def test_parts_of_one_recording_share_an_axis_and_what_was_held_out_is_told():
    figure = swings_with_fit(
        [swing("a", 0.3), swing("a", 0.2, "part 2 of 3", 20.0)], 0.002, {"emulated": "yes"}
    )
    assert len(figure.axes) == 2
    band = figure.axes[1].patches[0]
    assert band.get_y() + band.get_height() == pytest.approx(np.degrees(2 * 0.002))
    words = [text.get_text() for text in figure.legends[0].get_texts()]
    assert "model, on a part held out of the fit" in words and "fit" in words
    assert "emulated" in figure.get_supxlabel()


def test_each_swing_by_itself_has_room_of_its_own():
    heights = [
        swings_alone([swing(f"s{k}", 0.1) for k in range(many)], {"emulated": "no"}).get_size_inches()[1]
        for many in (1, 3)
    ]
    assert heights[1] > 2 * heights[0]


def test_of_many_recordings_the_largest_the_middle_and_the_smallest_are_drawn():
    figure = swings_with_fit([swing(f"s{k}", 0.1 * k) for k in range(1, 8)], None, {"emulated": "no"})
    assert [axes.get_title(loc="left") for axes in figure.axes[:3]] == ["s7", "s4", "s1"]
    assert "3 of 7 recordings" in figure.get_supxlabel()


def test_a_class_is_drawn_with_its_verdicts_and_what_is_not_in_it():
    rows = {
        "campaign": ["a", "b", "c"], "recording": ["a", "b", "broken"], "model": ["viscous", "viscous", None],
        "verdict": ["consistent", "unknown", "refused"], "emulated": ["no", "no", None],
    }  # fmt: skip
    for column in ("period_s", "quality", "decay_time_s"):
        rows |= {column: [1.0, 2.0, np.nan], f"{column}_u": [0.1, np.nan, np.nan]}
    figure = side_by_side(pd.DataFrame(rows))
    assert [label.get_text() for label in figure.axes[0].get_yticklabels()] == ["a", "b"]
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["nothing missing", "unknown"]
    assert "could not be used: broken" in figure.get_supxlabel()
    bars = figure.axes[0].collections
    reach = [float(np.ptp(bar.get_segments()[0][:, 0])) for bar in bars]
    assert reach == pytest.approx(
        [0.4, 0.0]
    )  # of two standard uncertainties to either side; none where it is not known


@pytest.mark.parametrize("count", [2, 12])
def test_each_pendulum_of_a_class_has_a_line_of_its_own(count):
    names = [f"pendulum {k}" for k in range(count)]
    rows = {
        "campaign": names,
        "recording": names,
        "model": "viscous",
        "verdict": "consistent",
        "emulated": "no",
    }
    for column in ("period_s", "quality", "decay_time_s"):
        rows |= {column: np.linspace(1.0, 2.0, count), f"{column}_u": 0.1}
    assert not in_the_way(side_by_side(pd.DataFrame(rows)))
    never = side_by_side(pd.DataFrame(rows | {"verdict": np.nan}))  # as a table of such is read from its file
    assert [text.get_text() for text in never.legends[0].get_texts()] == ["not searched"]
