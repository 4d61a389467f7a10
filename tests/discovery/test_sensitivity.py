"""The table of the search's numbers, each halved and doubled: that it names numbers that are there."""

import importlib
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "benchmarks"))

from sensitivity import SETTINGS


@pytest.mark.parametrize("module", SETTINGS)
def test_each_number_of_the_table_is_one_of_the_search(module):
    there = vars(importlib.import_module(f"swingdown.discovery.{module}"))
    assert not set(SETTINGS[module]) - set(there)
