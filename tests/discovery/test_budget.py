"""A search's time is spent by its own fits alone."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np

from swingdown.discovery.budget import Budget
from swingdown.fitting.least_squares import fit_jointly
from swingdown.pendulum.model import Model


def fitted():
    times = np.arange(600) / 50
    swing = 0.5 * np.exp(-0.05 * times) * np.cos(7 * times)
    return fit_jointly(Model("viscous"), [(times, swing), (times, 0.6 * swing)])


def test_a_budget_is_spent_by_work_in_its_own_thread_alone():
    budget = Budget(1e-3)
    with ThreadPoolExecutor(1) as other:
        other.submit(fitted).result()
    assert not budget.spent
    fitted()
    assert budget.spent
    assert budget.left == 0
