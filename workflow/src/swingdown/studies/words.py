"""An answer in words: the lines that a call, a command and a report's table have in common."""

from collections.abc import Mapping
from math import degrees
from typing import Any, NamedTuple

from ..rounding import value_with_uncertainty
from .pendulums import SEARCH, quantities_of, residual_of

STATUS = {
    "consistent": "Nothing is missing",
    "named": "Named",
    "ambiguous": "Tied",
    "partial": "Named in part",
    "unknown": "Unknown",
    "refused": "Not read",
    "": "Not searched",
}
_WORDS = {
    "period": "period",
    "natural_frequency": "natural frequency",
    "quality": "quality Q",
    "decay_time": "decay time (1/e)",
}
NAMING = ("named", "ambiguous", "partial")  # verdicts that assert an effect
_WITH = "natural frequency"


class QuantityRow(NamedTuple):
    """One quantity as it is told: name, words, value, standard uncertainty, unit, and at which amplitude it holds."""

    name: str
    words: str
    value: float
    uncertainty: float
    unit: str
    condition: str


def quantity_rows(row: Mapping[str, Any], verdict: Mapping[str, Any] | None = None) -> list[QuantityRow]:
    """The quantities of a row of ``studies.pendulums``, those that it has, the period first.

    Where a verdict names what the models of damping lack, the natural frequency beside that follows theirs.
    """
    at = f"{degrees(row['amplitude_rad']):.3g}°"
    conditions = {
        "natural_frequency": "of small undamped swings",
        "period": f"at {at}",
        "quality": f"at {at}",
        "decay_time": f"from {at}",
    }
    found = quantities_of(row)
    order = [name for name in _WORDS if name in found] + [name for name in found if name not in _WORDS]
    told = [
        QuantityRow(name, _WORDS.get(name, name.replace("_", " ")), *found[name], conditions.get(name, ""))
        for name in order
    ]
    if verdict and verdict["status"] in NAMING and row.get("model_of") != SEARCH:
        known = verdict["model"]["natural_frequency"]
        error = known["standard_error"] if known["standard_error"] is not None else float("nan")
        place = 1 + next((k for k, one in enumerate(told) if one.name == "natural_frequency"), -1)
        told.insert(place, QuantityRow("natural_frequency_with_effects", _WITH, known["value"], error, known["unit"], "with the effects named"))  # fmt: skip
    return told


def model_words(label: str) -> str:
    """A model's effects in words: ``viscous and load Coulomb``."""
    names = [name.replace("_", " ").replace("coulomb", "Coulomb") for name in label.split("+")]
    return " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)


def lines(row: Mapping[str, Any], verdict: Mapping[str, Any] | None = None) -> list[str]:
    """What is said of one pendulum, a line each: its quantities, its damping, and the verdict's sentence where there is one."""
    told = [
        f"{one.words:18} {value_with_uncertainty(one.value, one.uncertainty)}"
        + ("" if one.unit == "1" else f" {one.unit}")
        + (f"   {one.condition}" if one.condition else "")
        for one in quantity_rows(row, verdict)
    ]
    residual, unit = residual_of(row)
    told.append(
        f"{'model' if row.get('model_of') == SEARCH else 'damping':18} {model_words(str(row['model']))}; it leaves {1e3 * residual:.3g} m{unit} RMS"
    )
    if row.get("emulated") == "yes":
        told.append("emulated: computed, not measured on a real pendulum")
    if verdict:
        told.append(". ".join(said(verdict)))
    return told


def said(verdict: Mapping[str, Any]) -> tuple[str, str]:
    """The status of a verdict in a word or three, and its sentence, which does not say the same again."""
    status = STATUS.get(verdict["status"], verdict["status"])
    sentence = str(verdict["sentence"]).removeprefix(status).lstrip(",: ")
    return status, sentence[:1].upper() + sentence[1:]
