"""The picture of a recording shows which part of it is used."""

import numpy as np
import pytest
import xarray as xr

from swingdown.plots.recordings import used_part

pytestmark = pytest.mark.usefixtures("frozen")


def recording(**told):
    time = np.arange(1000) / 100
    return xr.Dataset(
        {"signal": ("time", np.cos(7 * time), {"units": "deg"})},
        {"time": time},
        {"recording": "a", "emulated": "no", **told},
    )


def lines(figure):
    return [{line.get_label(): line.get_xdata() for line in axes.get_lines()} for axes in figure.axes]


def test_what_is_used_stands_out_from_what_is_left_out():
    for shown in lines(used_part(recording(released_s=1.0, begins_s=1.25, ends_s=8.0))):
        assert shown["used"][0] == 1.25 and shown["used"][-1] == 8.0
        assert len(shown["left out"]) == 1000
        assert {"released 1.00 s", "used from 1.25 s", "used until 8.00 s"} <= set(shown)


def test_a_recording_that_is_used_whole_has_nothing_left_out():
    for shown in lines(used_part(recording())):
        assert len(shown["used"]) == 1000
        assert not [label for label in shown if "left out" in label or "released" in label]
