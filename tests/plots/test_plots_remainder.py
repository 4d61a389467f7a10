"""The picture of what a model still lacks: where the torque acts, how large it is, and when."""

import matplotlib.colors
import numpy as np
import pandas as pd
import pytest
from written import in_the_way

from swingdown.plots import style
from swingdown.plots.remainder import remainder

pytestmark = pytest.mark.usefixtures("frozen")

TOLD = {
    "campaign": "bench",
    "lacks": {"restoring": 0.00123, "dissipative": 0.005, "time": 0.0075, "sensor": 0.0},
}


@pytest.fixture
def table():
    """A torque of 2 rad/s^2 where the angle is positive, and of -1 where it is not; some of it weak, or not determined."""
    angle, speed = np.meshgrid(np.linspace(-0.3, 0.3, 5), [0.0, 1.0, 2.0, -0.0, -1.0, -2.0], indexing="ij")
    table = pd.DataFrame({"angle_rad": angle.ravel(), "speed_rad_per_s": speed.ravel()})
    table["torque"] = np.where(table["angle_rad"] > 0, 2.0, -1.0)
    table["band"], table["known"], table["seen"] = 0.4, 0.9, 0.01
    table.loc[0, "known"] = 0.2  # of the torque where the angle is -0.3 and the speed 0
    table.loc[29, "seen"] = 0.0  # and where they are 0.3 and -2
    table.loc[7, "band"] = 0.51  # where they are -0.15 and 1: just less than two standard errors
    return table


@pytest.fixture
def course():
    times = np.arange(50) / 10
    small = pd.DataFrame({"swing": "quiet", "time_s": times, "torque": 0.01, "band": 0.1})
    loud = pd.DataFrame({"swing": "loud", "time_s": times + 5, "torque": np.sin(times), "band": 0.25})
    return pd.concat([small, loud], ignore_index=True)


@pytest.fixture
def figure(table, course):
    return remainder(table, course, TOLD)


def test_the_map_has_each_torque_in_its_place_and_none_that_is_not_determined(figure):
    here = next(axes for axes in figure.axes if axes.get_title(loc="left") == "where it acts")
    halves = here.collections
    drawn = np.ma.concatenate([half.get_array().ravel() for half in halves])
    assert drawn.size == 30 and np.ma.count(drawn) == 28
    assert set(drawn.compressed()) == {2.0, -1.0}
    assert all(half.norm.vmin == -2 and half.norm.vmax == 2 for half in halves)
    forward, back = (half.get_coordinates()[..., 1] for half in halves)
    assert forward.max() >= 2 and back.min() <= -2 and forward.min() > -1.1 and back.max() < 1.1
    (weak,) = (line for line in here.lines if line.get_marker() == ".")
    assert weak.get_xydata() == pytest.approx(np.array([[np.degrees(-0.15), 1.0]]))


def test_each_size_stands_right_of_its_bar(figure):
    here = next(axes for axes in figure.axes if axes.get_title(loc="left") == "how much")
    bars = {bar.get_y() + bar.get_height() / 2: bar.get_width() for bar in here.patches}
    names = dict(zip(here.get_yticks(), (one.get_text() for one in here.get_yticklabels()), strict=True))
    assert {names[place]: width for place, width in bars.items()} == {
        "restoring": 0.00123,
        "dissipative": 0.005,
        "time-dependent": 0.0075,
        "sensor": 0.0,
    }
    assert names[max(names)] == "restoring"  # uppermost
    assert {names[text.xy[1]]: text.get_text() for text in here.texts} == {
        "restoring": "1.2 mrad",
        "dissipative": "5 mrad",
        "time-dependent": "7.5 mrad",
        "sensor": "0 mrad",
    }
    assert all(text.xy[0] == bars[text.xy[1]] for text in here.texts)
    assert not in_the_way(figure)


def test_sizes_of_rates_and_of_lengths_have_their_own_unit(table, course):
    def said(unit, **more):
        figure = remainder(table, course, TOLD | more, unit)
        here = next(axes for axes in figure.axes if axes.get_title(loc="left") == "how much")
        return here.texts[0].get_text(), here.texts[-1].get_text()

    assert said("rad", reading="rate") == ("0 mrad/s", "1.2 mrad/s")
    assert said("V") == ("0 V", "0.0012 V")


def test_the_course_is_that_of_the_swing_that_lacks_most_with_its_plain_times_marked(figure, course):
    here = next(axes for axes in figure.axes if axes.get_title(loc="left").startswith("when it acts"))
    assert here.get_title(loc="left") == "when it acts: loud"
    loud = course[course["swing"] == "loud"]
    torque = next(line for line in here.lines if line.get_label() == "missing torque")
    assert torque.get_xdata()[0] == 0 and here.get_xlim() == pytest.approx((0, 4.9))
    np.testing.assert_allclose(torque.get_ydata(), loud["torque"])
    edges = here.collections[0].get_paths()[0].vertices[:, 1]
    assert edges.max() == pytest.approx(loud["torque"].max() + 0.5) and edges.min() == pytest.approx(
        loud["torque"].min() - 0.5
    )
    marks = next(line for line in here.lines if line.get_marker() == "|")
    np.testing.assert_allclose(marks.get_xdata(), loud["time_s"][loud["torque"].abs() > 0.5] - 5)
    assert 0 < marks.get_ydata().max() < 0.1  # along the lower edge
    low, high = here.get_ylim()
    assert low < edges.min() and high > edges.max()


def test_where_it_acts_and_when_have_a_line_at_nothing(figure):
    flat = [line for axes in figure.axes for line in axes.lines if len(set(line.get_ydata())) == 1]
    levels = [line.get_ydata()[0] for line in flat if line.get_marker() in ("", "None", None)]
    assert levels == [0, 0]


def test_where_no_torque_is_left_the_picture_says_so(table, course):
    figure = remainder(table[:0], course[:0], TOLD)
    assert [text.get_text() for text in figure.texts] == ["no torque is left to draw"]
    assert matplotlib.colors.same_color(figure.texts[0].get_color(), style.GREY)
