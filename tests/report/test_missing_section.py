"""What the section on missing effects shows of a search, and which rule makes it."""

from types import SimpleNamespace

import pytest

from swingdown.report.sections.missing import drawn

SEEN = [
    "results/curves/wheel/curves.svg",
    "results/discovery/wheel/figures/difference.svg",
    "results/discovery/wheel/figures/remainder.svg",
]


@pytest.mark.parametrize(
    ("name", "rule"),
    [("curves", "curves"), ("difference", "discover_difference"), ("remainder", "discover_figures")],
)
def test_a_figure_says_which_rule_makes_it(name, rule):
    (figure,) = drawn(SimpleNamespace(seen=SEEN), "wheel", name, name.capitalize(), "")
    assert figure.rule == rule
    assert not drawn(SimpleNamespace(seen=SEEN), "bob", name, name.capitalize(), "")
