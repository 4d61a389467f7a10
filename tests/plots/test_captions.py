"""Every figure has a caption that stays true when the config changes."""

import re

import pytest
from docutils.core import publish_doctree

from swingdown.plots import FIGURES
from swingdown.plots.sweep import MAPS


@pytest.mark.parametrize(
    "name",
    [
        "pendulums",
        "series",
        "groups",
        "fig01",
        "fig06",
        *sorted(FIGURES),
        *(f"sweep_{name}" for name in MAPS),
    ],
)
def test_a_caption_is_a_few_sentences_without_results_in_numbers(root, name):
    text = (root / "workflow/report" / f"{name}.rst").read_text(encoding="utf-8")
    tree = publish_doctree(text, settings_overrides={"report_level": 2, "halt_level": 2})
    plain = re.sub(r"(Figure|Table|Eqs?\.) \d+\w?( to \d+)?", "", tree.astext())
    assert 2 <= len(re.findall(r"\.(?=\s|$)", plain)) <= 5
    assert not re.search(r"\d", plain), "a number that a config could change"
