"""Recordings of a pendulum share a model where they hold angles; why another one stands alone is told."""

import numpy as np
import pytest
import xarray as xr

from swingdown.measurement.angle import UNSCALED
from swingdown.measurement.points.points_recording import POINTS_ALONE
from swingdown.measurement.sharing import sharing

TIMES = np.arange(100) / 50


def angle(name, points=False, **attrs):
    made = xr.Dataset(
        {"angle": ("time", np.cos(TIMES))}, {"time": TIMES}, {"recording": name, "mode": ""} | attrs
    )
    return made.assign(half_swings=("time", np.arange(100))) if points else made


def test_angles_share_a_model():
    assert sharing([angle("a"), angle("b")]) == ([0, 1], {}) and sharing([]) == ([], {})


def test_readings_without_a_scale_stand_alone_and_why_is_told():
    together, alone = sharing([angle("a"), angle("b", mode=UNSCALED), angle("c")])
    assert together == [0, 2] and list(alone) == [1]
    assert (
        alone[1].where == "recording b"
        and "they allow no search" in alone[1].problem
        and "scale" in alone[1].mend
    )


@pytest.mark.parametrize("others", [0, 1])
def test_points_of_the_motion_stand_alone_beside_others_or_not(others):
    together, alone = sharing([*(angle("a") for _ in range(others)), angle("p", points=True)])
    assert (
        together == list(range(others))
        and alone[others].code == POINTS_ALONE
        and alone[others].where == "recording p"
    )


def test_a_unit_of_its_own_stands_alone_beside_others_only():
    own = angle("a", own_unit="mm", own_step=0.1)
    assert sharing([own]) == ([0], {})
    together, alone = sharing([own, angle("b")])
    assert together == [1] and "how large its unit is" in alone[0].problem


@pytest.mark.parametrize(("unit", "shared"), [("mm", True), ("V", True), ("units", False), ("px", False)])
def test_a_unit_of_its_own_is_shared_where_it_is_as_large_in_each_recording(unit, shared):
    together, alone = sharing([angle(name, own_unit=unit, own_step=0.1) for name in "ab"])
    assert together == ([0, 1] if shared else []) and len(alone) == (0 if shared else 2)
