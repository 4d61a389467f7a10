"""Samples that are lost, or there twice, at even distances while the time is numbered on are told, with what they do to the period."""

import numpy as np
import pytest

from swingdown.measurement.swings.even import evenly
from swingdown.measurement.swings.renumbered import lost_evenly

RATE = 100
TIME = np.arange(33 * RATE) / RATE


def swing(time=TIME, noise=0.001, seed=1, decay=0.03):
    clean = 0.5 * np.exp(-decay * time) * np.cos(7.25 * time)
    return clean + noise * np.random.default_rng(seed).standard_normal(time.size)


def told(signal, times=None, rate=RATE):
    times = np.arange(signal.size) / rate if times is None else times
    return lost_evenly(evenly(times, signal), 2 * np.pi / 7.25 * rate)


@pytest.mark.parametrize(
    ("of", "lost", "percent"),
    [(3, 1, "33.3"), (10, 1, "10"), (10, 2, "20"), (10, 3, "30"), (40, 1, "2.5"), (51, 1, "1.96")],
)  # fmt: skip
def test_samples_lost_at_even_distances(of, lost, percent):
    (found,) = told(swing()[(np.arange(TIME.size) + 1) % of >= lost])
    assert found.startswith(f"{lost} of every {of} samples seem{'s' if lost == 1 else ''} to be lost")
    assert f"period and decay time are too short by {percent} %" in found


@pytest.mark.parametrize("unit", [1e-3, 1, 1e5])
@pytest.mark.parametrize(("of", "percent"), [(5, "25"), (8, "14.3"), (50, "2.04")])
def test_samples_written_twice_at_even_distances(of, percent, unit):
    """Of five samples one twice: four measured in the time of five, which lasts 5 / 4 as long."""
    count = np.arange(TIME.size)
    (found,) = told(unit * swing()[count - count // of])
    assert found.startswith(f"1 of every {of} samples seems to be there twice")
    assert f"period and decay time are too long by {percent} %" in found


def test_a_loss_is_told_beside_a_long_hole():
    signal = swing()[np.arange(TIME.size) % 10 > 0]
    times = np.arange(signal.size) / RATE
    here = (times < 10) | (times > 10.3)
    (found,) = told(signal[here], times[here])
    assert found.startswith("1 of every 10 samples seems to be lost")


@pytest.mark.parametrize("every", [7, 11])
def test_a_bob_that_wobbles_as_it_swings_has_lost_no_samples(every):
    """Faster where the swing is faster, as a string makes a bob turn."""
    wobble = 1.5 * np.gradient(swing()) * np.sin(2 * np.pi * np.arange(TIME.size) / every)
    assert told(swing() + wobble) == []


@pytest.mark.parametrize("seed", range(6))
def test_nothing_is_told_where_nothing_is_lost(seed):
    """Noise that lasts or is strong, random holes, samples lost with their times kept, coarse steps, and a reading that is held."""
    draws = np.random.default_rng(seed)
    lasting = np.zeros(TIME.size)
    for k in range(1, TIME.size):
        lasting[k] = 0.9 * lasting[k - 1] + 0.01 * draws.standard_normal()
    slow = np.arange(6000) / 300
    here = draws.random(TIME.size) > 0.1
    tenth = np.arange(TIME.size) % 10 != 3
    assert told(swing(noise=0, decay=0.01 + 0.01 * seed) + lasting) == []
    assert told(swing(slow, noise=0.05, seed=seed), rate=300) == []
    assert told(swing(seed=seed)[here], TIME[here]) == []
    assert told(swing(seed=seed)[tenth], TIME[tenth]) == []
    assert told(np.round(swing(slow, noise=0, decay=0.01) / 0.1) * 0.1, rate=300) == []
    for count in (2, 3, 5, 8):
        assert told(np.repeat(swing(seed=seed)[::count], count)) == []


def test_too_short_a_recording_or_period_tells_nothing():
    """Seven samples of a polynomial within 0.3 of a period, and four such pieces, are the fewest."""
    lost = swing()[np.arange(TIME.size) % 10 > 0]
    assert told(lost[:90]) == []
    even = evenly(np.arange(lost.size) / RATE, lost)
    assert lost_evenly(even, 20) == [] == lost_evenly(even, np.nan) and lost_evenly(even, 80) != []
