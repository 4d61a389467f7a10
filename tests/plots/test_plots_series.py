"""A series as it is drawn: what its bars are, and which figure a kind asks for."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from swingdown.plots.series import drawn, groups_side_by_side
from swingdown.series import of_sheet

pytestmark = pytest.mark.usefixtures("frozen")

LENGTHS = np.array([0.2, 0.4, 0.8])
LEFT = "data − law (%)"


@pytest.fixture(scope="module")
def made():
    """Three lengths to a millimetre, with periods to 1e-4, in two groups; off the law by more than a processor rounds."""
    omega = np.sqrt(9.81 / LENGTHS) * (1 + 1e-5 * np.array([1, -2, 3]))
    known = {"natural_frequency_rad_per_s": omega, "natural_frequency_rad_per_s_u": 1e-4 * omega}
    names = {"campaign": list("abc"), "recording": list("abc"), "label": list("abc"), "emulated": "no"}
    stated = {
        name: {"length": f"{length:.3f}(1) m", "group": "left" if name == "a" else "right"}
        for name, length in zip("abc", LENGTHS, strict=True)
    }
    return of_sheet(pd.DataFrame(names | known), stated)


def test_bars_are_two_standard_uncertainties_of_both_in_per_cent_of_the_law(made):
    (lower,) = (axes for axes in drawn("series", made).axes if axes.get_ylabel() == LEFT)
    ends = lower.containers[0].lines[2][0].get_segments()
    half = [(high - low) / 2 for (_, low), (_, high) in ends]
    # T goes as the root of the length
    assert half == pytest.approx(200 * np.hypot(1e-4, 0.5 * 1e-3 / LENGTHS), rel=0.02)


@pytest.mark.parametrize(("kind", "there"), [("series", True), ("groups", False)])
def test_a_kind_has_its_figure(made, kind, there):
    figure = drawn(kind, made)
    assert (LEFT in [axes.get_ylabel() for axes in figure.axes]) is there
    groups = [label.get_text() for label in figure.axes[0].get_yticklabels()]
    assert (groups == ["left", "right"]) is not there


def test_a_legend_names_groups_that_stand_apart_where_some_do(made):
    (calm,) = (one for one in made if one.comparison)
    apart = replace(calm, comparison=replace(calm.comparison, apart=("left",)))
    for one, told in ((calm, False), (apart, True)):
        (legend,) = groups_side_by_side([one]).legends
        assert ("stands apart" in [text.get_text() for text in legend.texts]) is told
