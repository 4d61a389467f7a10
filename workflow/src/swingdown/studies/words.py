"""An answer in words: the lines that a call, a command and a report's table have in common."""

from collections.abc import Mapping
from math import degrees, isfinite
from typing import Any, NamedTuple

from ..pendulum.catalogue import SHIPPED, Catalogue
from ..pendulum.effect import Effect
from ..pendulum.model import model_words
from .pendulums import NOT_DYING, SEARCH, by_verdict, doubted, quantities_of, residual_of
from .quantities import Quantity
from .turning_points import NOT_DAMPED

STATUS = {
    "consistent": "Nothing is missing",
    "named": "Named",
    "ambiguous": "Tied",
    "partial": "Named in part",
    "unknown": "Unknown",
    "refused": "Not read",
    "no_verdict": "No verdict",
    "": "Not searched",
}
_WORDS = {
    "period": "period",
    "natural_frequency": "natural frequency",
    "quality": "quality Q",
    "decay_time": "decay time (1/e)",
    "decay_swings": "decay in swings (1/e)",
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

    @property
    def text(self) -> str:
        """Value, uncertainty and unit as every sentence and table has them: ``0.87148(26) s``."""
        return str(self.quantity)

    @property
    def quantity(self) -> Quantity:
        """Value, standard uncertainty and unit."""
        return Quantity(self.value, self.uncertainty, self.unit)


def quantity_rows(row: Mapping[str, Any], verdict: Mapping[str, Any] | None = None) -> list[QuantityRow]:
    """The quantities of a row of ``studies.pendulums``, those that it has, the period first.

    Where a verdict names what the models of damping lack, the natural frequency beside that follows theirs.
    """
    stated = row.get("amplitude_text")  # of turning points in no unit of angles
    amplitude = degrees(row["amplitude_rad"])
    known = f"{amplitude:.3g}°" if isfinite(amplitude) else "the amplitude recorded"
    at = stated if isinstance(stated, str) else known
    conditions = {
        "natural_frequency": "of small undamped swings",
        "period": f"at {at}",
        "quality": f"at {at}",
        "decay_time": f"from {at}",
        "decay_swings": f"from {at}",
        "g": str(row.get("g_of", "")),
    }
    found = quantities_of(row)
    only = f"if it is {model_words(str(row['model']))}" if or_models(row) else ""
    order = [name for name in _WORDS if name in found] + [name for name in found if name not in _WORDS]
    told = [
        QuantityRow(name, _WORDS.get(name, name.replace("_", " ")), *found[name], conditions.get(name, only))
        for name in order
    ]
    if verdict and verdict["status"] in NAMING and row.get("model_of") != SEARCH:
        known = verdict["model"]["natural_frequency"]
        error = known["standard_error"] if known["standard_error"] is not None else float("nan")
        place = 1 + next((k for k, one in enumerate(told) if one.name == "natural_frequency"), -1)
        told.insert(place, QuantityRow("natural_frequency_with_effects", _WITH, known["value"], error, known["unit"], "with the effects named"))  # fmt: skip
    return told


def headline(
    row: Mapping[str, Any],
    verdict: Mapping[str, Any] | None = None,
    catalogue: Catalogue = SHIPPED,
    restoring: str = "sine",
) -> str:
    """What stops the pendulum of a row of ``studies.pendulums``, its period and its quality, in a sentence.

    ``verdict`` is that of a search, where there was one; ``catalogue`` the one that the row's model is of, and ``restoring`` its
    restoring torque: what brakes a wheel on a spring need not be air.
    """
    numbers = short(row)
    model = str(row["model"])
    if model == NOT_DYING:
        return f"What stops it {NOT_DYING}. {numbers}."
    if model == NOT_DAMPED:
        return f"What stops it is {NOT_DAMPED}. {numbers}."
    each = [words for one in (model, *or_models(row)) if (words := _stops(one, catalogue, restoring))]
    joined = " or ".join(dict.fromkeys(map(_listed, each)))
    verb = "s" if each and len(each[-1]) == 1 else ""
    end = f": {numbers}." if numbers else "."
    status = verdict["status"] if verdict else ""
    if not joined or doubted(row) or status == "unknown":
        nearest = f"; {joined} come{verb} nearest" if joined else ""
        return f"What stops it is not established{nearest}{end}"
    stop = f"{joined[:1].upper()}{joined[1:]} stop{verb} it{end}"
    return stop + _ENDINGS.get(status, "")


def short(row: Mapping[str, Any], verdict: Mapping[str, Any] | None = None) -> str:
    """Period and quality of a row of ``studies.pendulums`` as ``T = 0.87148(26) s, Q = 58.8(1.9)``; of those that it has not, nothing.

    With a ``verdict`` those of the model that its search ended with, where that has any.
    """
    known = quantities_of(by_verdict(row, verdict) if verdict else row)
    return ", ".join(f"{symbol} = {known[name]}" for name, symbol in _SYMBOLS.items() if name in known)


_SYMBOLS = {"period": "T", "quality": "Q"}
_ENDINGS = {
    "consistent": " Nothing else is needed.",
    "ambiguous": " Something else acts; the data leave open what.",
    "partial": " Something remains that has no name here.",
}


def _stops(model: str, catalogue: Catalogue, restoring: str) -> list[str]:
    """What a sentence calls the effects of a model that stop a pendulum."""
    effects = [catalogue[name] for name in model.split("+") if name in catalogue]
    return list(filter(None, (_takes_energy(one, restoring) for one in effects)))


def _listed(words: list[str]) -> str:
    return " and ".join([*filter(None, [", ".join(words[:-1])]), words[-1]])


def or_models(row: Mapping[str, Any]) -> list[str]:
    """The labels of the models of damping that describe a row's turning points as well as its own does."""
    others = row.get("or_model")
    return others.split("; ") if isinstance(others, str) and others else []


def damping_words(row: Mapping[str, Any]) -> str:
    """The models of damping of a row in words: its own, or others that describe it as well."""
    return " or ".join(map(model_words, (str(row["model"]), *or_models(row))))


def _takes_energy(effect: Effect, restoring: str) -> str:
    """What a sentence calls an effect that stops a pendulum; empty for one that does not."""
    if effect.acts_on != "torque":
        return ""
    if restoring == "linear" and effect.spoken_of_wheel:
        return effect.spoken_of_wheel
    own = effect.name not in SHIPPED and "thetadot" in effect.term
    return effect.spoken or (effect.name.replace("_", " ") if own else "")


def lines(
    row: Mapping[str, Any],
    verdict: Mapping[str, Any] | None = None,
    catalogue: Catalogue = SHIPPED,
    restoring: str = "sine",
) -> list[str]:
    """What is said of one pendulum, a line each: what stops it, its quantities, its damping, and the verdict's sentence where there is one.

    Arguments as of ``headline``.
    """
    told = [headline(row, verdict, catalogue, restoring), *details(row, verdict)]
    return [*told, ". ".join(said(verdict))] if verdict else told


def details(row: Mapping[str, Any], verdict: Mapping[str, Any] | None = None) -> list[str]:
    """The lines on one pendulum below its sentence: a doubt, its quantities, its damping, and what is to be known of them."""
    told = [f"Beware: {row['remark']}"] if row.get("remark") else []
    told += [
        f"{one.words:18} {one.text}" + (f"   {one.condition}" if one.condition else "")
        for one in quantity_rows(row, verdict)
    ]
    residual, unit = residual_of(row)
    leaves = f"; it leaves {1e3 * residual:.3g} m{unit} RMS" if isfinite(residual) else ""
    told.append(f"{'model' if row.get('model_of') == SEARCH else 'damping':18} {damping_words(row)}{leaves}")
    told += notes(row)
    if row.get("emulated") == "yes":
        told.append("emulated: computed, not measured on a real pendulum")
    return told


def notes(row: Mapping[str, Any]) -> list[str]:
    """What is to be known of a row of turning points alone, a sentence each; nothing of a sampled swing."""
    note = row.get("note")
    return note.split("; ") if isinstance(note, str) else []


def said(verdict: Mapping[str, Any]) -> tuple[str, str]:
    """The status of a verdict in a word or three, and its sentence, which does not say the same again."""
    status = STATUS.get(verdict["status"], verdict["status"])
    sentence = str(verdict["sentence"]).removeprefix(status).lstrip(",: ")
    return status, sentence[:1].upper() + sentence[1:]
