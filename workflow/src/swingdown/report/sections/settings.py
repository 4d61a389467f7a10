"""The whole config."""

import yaml

from ...studies.simulation import INFERRED_NOTE
from ..material import Material
from ..page import Listing, Section, Text


def settings(material: Material) -> Section:
    """The whole config, defaults filled in."""
    text = yaml.safe_dump(material.settings, sort_keys=False, allow_unicode=True, width=110)
    return Section(
        "Settings",
        [
            Text("The complete config of this run, defaults filled in."),
            Listing(text.rstrip()),
            Text(INFERRED_NOTE.replace("_", " ")),
        ],
    )
