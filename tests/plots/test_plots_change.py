"""What follows a change: sizes over what was changed, and the law through them."""

import numpy as np
import pytest

from swingdown.plots.change import over_the_change

pytestmark = pytest.mark.usefixtures("frozen")

LAW = {"exponent": 2.0, "u_exponent": 0.05, "offset": 0.001, "u_offset": 1e-4, "factor": 0.02, "at": 0.5, "widened_by": 1.0}  # fmt: skip


def found(values, law=None, **more):
    rows = [{"value": value, "size": 0.01 * k, "standard_error": 0.001} for k, value in enumerate(values, 1)]
    return {
        "sizes": rows, "law": law, "quantity_name": "current", "quantity_unit": "A", "unit": "1/s",
        "parameter": "viscous_ratio", **more,
    }  # fmt: skip


def bars(figure):
    """The points of the recordings, and how far each bar reaches to either side."""
    (axes,) = figure.axes
    points = axes.lines[0].get_xydata()
    segments = axes.collections[0].get_segments()
    return points, [float(np.ptp(one[:, 1])) / 2 for one in segments]


def test_each_recording_has_its_size_with_two_standard_uncertainties():
    figure = over_the_change(found([0.2, 0.4, 0.6]))
    points, reach = bars(figure)
    np.testing.assert_allclose(points, [[0.2, 0.01], [0.4, 0.02], [0.6, 0.03]])
    assert reach == pytest.approx([0.002] * 3)
    (axes,) = figure.axes
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("current (A)", "viscous ratio (1/s)")
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["recordings"]


def test_the_law_is_drawn_over_all_recordings_and_a_little_beyond():
    figure = over_the_change(found([0.2, 0.4, 0.6], LAW))
    law = next(line for line in figure.axes[0].lines if line.get_label().startswith("power"))
    assert law.get_label() == "power 2.000(50), beside what stays"
    at = law.get_xdata()
    assert 0.17 < at[0] < 0.2 and 0.6 < at[-1] < 0.63
    np.testing.assert_allclose(law.get_ydata(), 0.001 + 0.02 * (at / 0.5) ** 2)
    assert "widened" not in figure.get_supxlabel()
    bare = over_the_change(found([0.2, 0.4, 0.6], LAW | {"u_offset": None, "offset": 0.0, "widened_by": 1.5}))
    assert {text.get_text() for text in bare.legends[0].get_texts()} == {"recordings", "power 2.000(50)"}
    assert "widened to the scatter of the points" in bare.get_supxlabel()


def test_a_law_from_nothing_on_stays_above_nothing():
    figure = over_the_change(found([0.0, 0.5, 1.0], LAW | {"exponent": -1.0}))
    law = next(line for line in figure.axes[0].lines if line.get_label().startswith("power"))
    assert 0 < law.get_xdata()[0] < 0.01 and np.isfinite(law.get_ydata()).all()


def test_names_stand_side_by_side_in_their_order():
    figure = over_the_change(found(["right", "left"], quantity_unit="", unit="1"))
    (axes,) = figure.axes
    assert [one.get_text() for one in axes.get_xticklabels()] == ["left", "right"]
    points, _ = bars(figure)
    np.testing.assert_allclose(points, [[1, 0.01], [0, 0.02]])
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("current", "viscous ratio")


def test_an_error_that_is_not_known_has_no_bar():
    one = found([0.2, 0.4])
    one["sizes"][0]["standard_error"] = None
    (axes,) = over_the_change(one).axes
    assert [len(bar) for bar in axes.collections[0].get_segments()] == [0, 2]


@pytest.mark.parametrize(
    ("nothing", "said"),
    [(None, "no effect follows the change between the recordings"), (found([]), "no effect follows the current")],
)  # fmt: skip
def test_where_nothing_follows_the_picture_says_so(nothing, said):
    assert [text.get_text() for text in over_the_change(nothing).texts] == [said]
