"""Which recordings are read once more, how they are read then, and by which cells of the sheet."""

import numpy as np
import pytest
import xarray as xr

from swingdown.measurement.angle import UNSCALED
from swingdown.measurement.second_reading import OPEN, cells, may_be_read_again, readings, without_unit

TIMES = np.arange(1500) / 50
SWING = 0.3 * np.exp(-TIMES / 30) * np.cos(2 * np.pi * TIMES / 1.3)
EMPTY = {"start_s": np.nan, "stop_s": np.nan, "scale": "", "signal_unit": "", "input_column": None}


def angles(values=SWING, **attrs):
    """A dataset of angles about 0.02 rad, with uncertainties."""
    parts = {
        "_standard_uncertainty": 5e-3,
        "_random_uncertainty": 3e-3,
        "_systematic_uncertainty": 4e-3,
        "_bound": 8e-3,
    }
    made = {"angle": ("time", values + 0.02, {"units": "rad"})}
    made |= {f"angle{part}": ("time", np.full(TIMES.size, size)) for part, size in parts.items()}
    return xr.Dataset(made, {"time": TIMES}, {OPEN: "yes", "mode": ""} | attrs)


@pytest.mark.parametrize("stated", [{}, *({key: 0.0} for key in EMPTY), *({key: "V"} for key in EMPTY)])
def test_a_recording_is_read_again_where_nothing_is_stated_that_a_reading_overrules(stated):
    assert may_be_read_again(EMPTY | stated, guessed=False) == (not stated)
    assert not may_be_read_again(EMPTY | stated, guessed=True)
    assert may_be_read_again({}, guessed=False)


def test_a_swing_is_read_without_its_unit_and_the_sheets_cell_says_so():
    (found,) = readings(angles())
    assert found.attrs["mode"] == UNSCALED and found.attrs[OPEN] == "no"
    assert found.attrs["again"].startswith("PERIOD AND DECAY ALONE ARE REPORTED")
    assert cells(found) == {"scale": "relative"} and cells(angles()) == {}
    assert list(readings(angles(), in_rad=True)) == []


@pytest.mark.parametrize("closed", [{OPEN: "no"}, {OPEN: ""}])
def test_what_may_not_be_read_again_is_not(closed):
    assert list(readings(angles(**closed))) == []


def test_the_free_stretch_is_read_first_and_its_window_stands_in_the_sheet():
    late = TIMES >= 10
    kicked = np.where(late, 3 * SWING * np.exp(10 / 30), SWING)
    part, alone = readings(angles(kicked))
    start, stop = (cells(part)[key] for key in ("start_s", "stop_s"))
    assert 9.5 < start < 11.5 and stop == pytest.approx(TIMES[-1], abs=1.4)
    assert float(part["time"][0]) == pytest.approx(start, abs=1e-6)
    assert float(part["time"][-1]) == pytest.approx(stop, abs=1e-6)
    assert part.attrs["again"].startswith(f"USED FROM {start:.3f} TO {stop:.3f} s ALONE")
    assert cells(alone) == {"start_s": start, "stop_s": stop, "scale": "relative"}
    assert "; PERIOD AND DECAY ALONE" in alone.attrs["again"]
    assert [one.attrs["mode"] for one in readings(angles(kicked), in_rad=True)] == [""]


def test_readings_without_a_unit_are_small_about_their_middle_with_uncertainties_as_small():
    made = without_unit(angles())
    assert made["angle"].attrs["units"] == "rad" and made.attrs["unit_told"] == "yes"
    scale = float(np.ptp(made["angle"].values) / np.ptp(SWING))
    assert 0 < np.abs(made["angle"]).max() < 0.05
    assert made["angle"].values == pytest.approx(scale * SWING, abs=scale * 2e-3)
    assert made["angle_random_uncertainty"].values == pytest.approx(scale * 3e-3)
    assert made["angle_bound"].values == pytest.approx(scale * 8e-3)
    # what is the same for all samples is no doubt of a reading without a scale
    assert made["angle_standard_uncertainty"].values == pytest.approx(scale * 3e-3)
    assert "angle_systematic_uncertainty" not in made
    assert without_unit(made) is made
