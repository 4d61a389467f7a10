"""The catalogue's formulas and numbers are what they were: each decides where a search begins and what it may end at.

``frozen_catalogue.json`` holds them, a line for each parameter; after a change that is meant, ``FROZEN_WRITE=1 make quick
TESTS="tests/pendulum/test_frozen_catalogue.py"`` writes it anew, and the diff shows what it did.
"""

from pathlib import Path

import pytest
from frozen import held

from swingdown.pendulum.catalogue import SHIPPED

FROZEN = Path(__file__).with_name("frozen_catalogue.json")


def told(name):
    """What an effect is, in words and numbers that JSON has."""
    effect = SHIPPED[name]
    parts = {"term": effect.term, "acts on": effect.acts_on, "inertia": str(effect.inertia)}
    return parts | {one.name: " | ".join(f"{key} {value}" for key, value in one._asdict().items() if key not in ("name", "text")) for one in effect.parameters}  # fmt: skip


@pytest.mark.parametrize("name", SHIPPED.names)
def test_the_effect_is_what_it_was(name):
    held(FROZEN, SHIPPED.names, name, told(name), indent=1)
