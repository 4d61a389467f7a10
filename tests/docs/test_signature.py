"""The picture by which the docs show an effect."""

from importlib import import_module

import numpy as np

from swingdown.paths import PROJECT

TIMES = np.arange(500) / 100


def test_the_residual_is_drawn_over_time_and_over_the_angle_in_mrad(monkeypatch):
    monkeypatch.syspath_prepend(PROJECT / "docs")
    signature = import_module("signature").signature
    angle, residual = 0.3 * np.cos(7 * TIMES), 0.002 * np.sin(7 * TIMES)
    over_time, over_angle = signature(TIMES, angle, residual).axes
    np.testing.assert_allclose(over_time.lines[0].get_xydata().T, [TIMES, 1e3 * residual])
    np.testing.assert_allclose(over_angle.lines[0].get_xydata().T, [np.degrees(angle), 1e3 * residual])
    assert "1.4 mrad RMS" in over_time.get_title(loc="left")
    assert [over_time.get_xlabel(), over_angle.get_xlabel(), over_time.get_ylabel()] == [
        "time (s)",
        "angle (°)",
        "residual (mrad)",
    ]
