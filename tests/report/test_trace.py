"""What the page's figure of a swing is given: all samples, or those that the fit misses most."""

import base64
import json

import numpy as np
import pytest

from swingdown.arrays import Shown
from swingdown.report.trace import MOST, trace

TIMES = 5.0 + np.arange(1000) / 50


def shown(name="one", count=1000, **more):
    left = np.random.default_rng(count).normal(0, 1e-3, count)
    times = 5.0 + np.arange(count) / 50
    return Shown(name, "", times, 0.1 * np.cos(times) + left, 0.1 * np.cos(times), **more)


def told(*parts, **how):
    content = json.loads(trace(parts, 1e-3, **how))
    for one in content["recordings"]:
        for key in ("time", "angle", "fit"):
            one[key] = np.frombuffer(base64.b64decode(one[key]), "<f4")
    return content


def test_a_short_swing_is_shown_whole_in_degrees_from_its_first_sample():
    one = shown()
    content = told(one)
    (found,) = content["recordings"]
    assert found["samples"] == found["kept"] == 1000 and found["parts"] == [[1000, False]]
    assert found["time"] == pytest.approx(TIMES - 5.0, abs=1e-5)
    assert found["angle"] == pytest.approx(np.degrees(one.angle), abs=1e-5)
    assert found["fit"] == pytest.approx(np.degrees(one.fit), abs=1e-5)
    assert content["noise"] == pytest.approx(np.degrees(1e-3)) and content["what"] == "angle (°)"


def test_of_a_long_one_those_stay_that_the_fit_misses_most():
    one = shown()
    (found,) = told(one, most=200)["recordings"]
    assert 150 < found["kept"] <= 200 and found["samples"] == 1000
    left = np.abs(found["angle"] - found["fit"])
    assert left.max() == pytest.approx(np.degrees(np.abs(one.angle - one.fit).max()), rel=1e-3)
    assert left.mean() > 1.5 * np.degrees(np.abs(one.angle - one.fit)).mean()


def test_recordings_and_their_parts_share_what_a_page_holds_by_their_samples():
    first, second = shown("two", 3000), shown("two", 1000, held_out=True)
    one, two = told(shown(), first, second, most=800)["recordings"]
    assert one["kept"] <= 400 and two["kept"] <= 400 and two["samples"] == 4000
    (fitted, kept_out), (held, is_held) = two["parts"]
    assert (kept_out, is_held) == (False, True) and fitted == pytest.approx(3 * held, rel=0.1)


def test_a_page_stays_small_whatever_is_recorded():
    """A quarter of a megabyte: three numbers of four bytes a sample, in base 64."""
    (found,) = told(shown(count=100_000))["recordings"]
    assert found["kept"] <= MOST
    assert len(trace([shown(count=100_000)], None)) < 300_000


def test_a_rate_is_told_in_degrees_a_second():
    content = told(shown(unit="rad/s"), unit="rad/s")
    assert content["what"] == "angular rate (°/s)" and content["left"] == "data − fit (°/s)"
    assert json.loads(trace([shown()], None))["noise"] is None
