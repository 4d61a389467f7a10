"""The work of fits is counted by each thread for itself."""

import threading

import numpy as np
import pytest

from swingdown.fitting import effort
from swingdown.fitting.least_squares import fit_jointly
from swingdown.pendulum.model import Model


def test_work_adds_up_and_each_thread_counts_its_own():
    before = effort.done()
    effort.add(3, 4, 10.0, 0)
    effort.add(1, 2, 1.0, 2 * effort.SAMPLES)
    assert effort.done() == before + 126
    seen = []

    def elsewhere():
        effort.add(5, 1, 1.0, 0)
        seen.append(effort.done())

    other = threading.Thread(target=elsewhere)
    other.start()
    other.join()
    assert seen == [5] and effort.done() == before + 126


def work(rate, seconds):
    """That of a fit of a swing of so many samples a second."""
    times = np.arange(0, seconds, 1 / rate)
    began = effort.done()
    fit_jointly(Model("viscous"), [(times, 0.5 * np.exp(-0.05 * times) * np.cos(7 * times))])
    return effort.done() - began


def test_work_goes_with_the_half_swings_and_hardly_with_the_samples():
    assert work(200, 24) < 2.5 * work(20, 24)
    assert work(50, 48) / work(50, 24) == pytest.approx(2, rel=0.3)
