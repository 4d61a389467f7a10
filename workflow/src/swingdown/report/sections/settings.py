"""The whole config."""

import yaml

from ...studies.simulation import INFERRED_NOTE
from ..material import Material
from ..page import Listing, Section, Text

# no result of one's own recordings rests on these
NOT_RUN = ("simulation", "hidden_effects", "coverage", "detection", "sweeps")


def settings(material: Material) -> Section:
    """The whole config, defaults filled in; of a study of one's own the parts that something of it rests on."""
    kept, lead = material.settings, "The complete config of this run, defaults filled in."
    after = [INFERRED_NOTE]
    if material.own:
        idle = NOT_RUN if "uncertainty_budget" in material.tables else (*NOT_RUN, "calibration")
        kept = {key: value for key, value in kept.items() if key not in idle}
        lead, after = "What this run rests on, defaults filled in.", []
    text = yaml.safe_dump(kept, sort_keys=False, allow_unicode=True, width=110).rstrip()
    return Section("Settings", [Text(lead), Listing(text), *(Text(one.replace("_", " ")) for one in after)])
