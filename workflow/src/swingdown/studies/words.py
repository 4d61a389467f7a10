"""An answer in words: the lines that a call, a command and a report's table have in common."""

from collections.abc import Mapping
from math import degrees, isfinite, nan
from typing import Any, NamedTuple

from ..language import ENGLISH, IN_ENGLISH, Language, capital, listed
from ..own_unit import small
from ..pendulum.catalogue import SHIPPED, Catalogue
from ..pendulum.effect import Effect
from ..pendulum.model import model_words
from ..pendulum.slack import ZERO
from ..rounding import SURE, probability, value_with_uncertainty
from ..status import NAMING, Status
from .pendulums import NOT_DYING, SEARCH, by_verdict, doubted, quantities_of, residual_of
from .quantities import Quantity, in_its_middle
from .turning_points import NOT_DAMPED

STATUS: dict[str, str] = {
    Status.CONSISTENT: "Nothing is missing",
    Status.NAMED: "Named",
    Status.AMBIGUOUS: "Tied",
    Status.PARTIAL: "Named in part",
    Status.UNKNOWN: "Unknown",
    "refused": "Not read",
    Status.NO_VERDICT: "No verdict",
    "": "Not searched",
}
_WORDS = {
    "period": "period",
    "natural_frequency": "natural frequency",
    "quality": "quality Q",
    "decay_time": "decay time (1/e)",
    "decay_swings": "decay in swings (1/e)",
}
_WITH = "natural frequency"


class QuantityRow(NamedTuple):
    """One quantity as it is told: name, words, value, standard uncertainty, unit, at which amplitude it holds, and what part of an
    unknown uncertainty is known."""

    name: str
    words: str
    value: float
    uncertainty: float
    unit: str
    condition: str
    known: float = nan

    @property
    def number(self) -> str:
        """Value and uncertainty as every sentence and table has them: ``0.87148(26)``."""
        return value_with_uncertainty(self.value, self.uncertainty, self.known)

    @property
    def text(self) -> str:
        """The number with its unit: ``0.87148(26) s``."""
        return self.number if self.unit == "1" else f"{self.number} {self.unit}"

    @property
    def quantity(self) -> Quantity:
        """Value, standard uncertainty and unit."""
        return Quantity(self.value, self.uncertainty, self.unit)


def quantity_rows(row: Mapping[str, Any], verdict: Mapping[str, Any] | None = None) -> list[QuantityRow]:
    """The quantities of a row of ``studies.pendulums``, those that it has, the period first.

    Where a verdict names what the models of damping lack, the natural frequency beside that follows theirs.
    """
    stated = row.get("amplitude_text")  # of turning points in no unit of angles
    found, release = quantities_of(row), float(row["amplitude_rad"])
    at, begun = (
        stated if isinstance(stated, str) else f"{degrees(one):.3g}°" if isfinite(one) else "the amplitude recorded"
        for one in (in_its_middle(release, found), release)
    )  # fmt: skip
    conditions = {
        "natural_frequency": "of small undamped swings",
        "period": f"at {at}",
        "quality": f"at {at}",
        "decay_time": f"from {begun}{_beyond(row)}",
        "decay_swings": f"from {begun}",
        "g": str(row.get("g_of", "")),
        ZERO: "at rest, as fitted",
    }
    only = _only(row)
    order = [name for name in _WORDS if name in found] + [name for name in found if name not in _WORDS]
    known = {"g": float(row.get("g_u_without_length_m_per_s2", nan))}
    words = {name: _WORDS.get(name, name.replace("_", " ")) for name in order}
    told = [
        QuantityRow(name, words[name], *found[name], conditions.get(name, only), known.get(name, nan))
        for name in order
    ]
    if verdict and verdict["status"] in NAMING and row.get("model_of") != SEARCH:
        known = verdict["model"]["natural_frequency"]
        error = known["standard_error"] if known["standard_error"] is not None else float("nan")
        place = 1 + next((k for k, one in enumerate(told) if one.name == "natural_frequency"), -1)
        told.insert(place, QuantityRow("natural_frequency_with_effects", _WITH, known["value"], error, known["unit"], "with the effects named"))  # fmt: skip
    return told


def _only(row: Mapping[str, Any]) -> str:
    """Words for values that mean something beside one law alone: which, and how probable it is among the others; none where that is sure."""
    chance = nan if doubted(row) else float(row.get("model_probability", nan))
    if chance > SURE or row.get("model_of") == SEARCH:
        return ""
    sure = f" (P {probability(chance)})" if isfinite(chance) else ""
    return f"if it is {model_words(str(row['model']))}{sure}"


def _beyond(row: Mapping[str, Any]) -> str:
    """Words for a decay time that is longer than the record: that it is extrapolated."""
    record, decay = (float(row.get(key, float("nan"))) for key in ("record_s", "decay_time_s"))
    return f", extrapolated: the record has {record:.3g} s" if decay > record else ""


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
    if model in _UNTOLD:
        return f"{_UNTOLD[model]} {numbers}."
    seen = "+".join(_seen(model, quantities_of(row), catalogue)) or model
    each = [words for one in (seen, *or_models(row)) if (words := _stops(one, catalogue, restoring))]
    joined = " or ".join(dict.fromkeys(map(listed, each)))
    status = verdict["status"] if verdict else ""
    remains = "" if verdict and verdict.get("unit_doubt") else _ENDINGS.get(status, "")
    alone, ending = bool(each) and len(each[-1]) == 1, ""
    if not joined:
        told = _NOT_ESTABLISHED
    elif doubted(row) or status == Status.UNKNOWN:
        told = _NEAREST if alone else _NEAREST_TOGETHER
    else:
        told, ending = _STOPS if alone else _STOP_TOGETHER, remains
    if not numbers:
        told = told.replace(": {numbers}", "")
    told = told.format(what=joined, What=capital(joined), numbers=numbers)
    return f"{told} {ending}".rstrip()


# Whole sentences, so that each can be said in another language.
_UNTOLD = {
    NOT_DYING: "What stops it cannot be told: it does not die away.",
    NOT_DAMPED: "What stops it is not in the data.",
}
_STOPS = "{What} stops it: {numbers}."
_STOP_TOGETHER = "{What} stop it: {numbers}."
_NEAREST = "What stops it is not established; {what} comes nearest: {numbers}."
_NEAREST_TOGETHER = "What stops it is not established; {what} come nearest: {numbers}."
_NOT_ESTABLISHED = "What stops it is not established: {numbers}."


def short(row: Mapping[str, Any], verdict: Mapping[str, Any] | None = None) -> str:
    """Period and quality of a row of ``studies.pendulums`` as ``T = 0.87148(26) s, Q = 58.8(1.9)``; of those that it has not, nothing.

    With a ``verdict`` those of the model that its search ended with, where that has any.
    """
    known = quantities_of(by_verdict(row, verdict) if verdict else row)
    return ", ".join(f"{symbol} = {known[name]}" for name, symbol in _SYMBOLS.items() if name in known)


_SYMBOLS = {"period": "T", "quality": "Q"}
_ENDINGS: dict[str, str] = {
    Status.CONSISTENT: "Nothing else is needed.",
    Status.AMBIGUOUS: "Something else acts; the data leave open what.",
    Status.PARTIAL: "Something remains that has no name here.",
}


def _seen(model: str, known: Mapping[str, Quantity], catalogue: Catalogue) -> list[str]:
    """The effects of a model but those whose size is within its uncertainty of nothing: these are in it, and stop no pendulum."""
    effects = [catalogue[name] for name in model.split("+") if name in catalogue]
    sizes = {one.name: known.get(one.size.name) if one.size else None for one in effects}
    return [name for name, size in sizes.items() if size is None or size.value > max(0.0, size.uncertainty)]


def _stops(model: str, catalogue: Catalogue, restoring: str) -> list[str]:
    """What a sentence calls the effects of a model that stop a pendulum."""
    effects = [catalogue[name] for name in model.split("+") if name in catalogue]
    return list(filter(None, (_takes_energy(one, restoring) for one in effects)))


def or_models(row: Mapping[str, Any]) -> list[str]:
    """The labels of the models of damping that describe a row's swings as well as its own does."""
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
    spoken: Language = IN_ENGLISH,
) -> list[str]:
    """What is said of one pendulum, a line each: what stops it, its quantities, its damping, and the verdict's sentence where there is one.

    Arguments as of ``headline``; ``spoken`` is the language.
    """
    told = [spoken.text(headline(row, verdict, catalogue, restoring)), *details(row, verdict, spoken)]
    return [*told, told_of(verdict, spoken)] if verdict else told


def details(
    row: Mapping[str, Any], verdict: Mapping[str, Any] | None = None, spoken: Language = IN_ENGLISH
) -> list[str]:
    """The lines on one pendulum below its sentence: a doubt, its quantities, its damping, and what is to be known of them."""
    told = [f"Beware: {row['remark']}"] if row.get("remark") else []
    quantities = [
        (spoken.text(one.words), spoken.number(one.text), spoken.text(one.condition))
        for one in quantity_rows(row, verdict)
    ]
    residual, unit = residual_of(row)
    leaves = f"; it leaves {small(residual, unit)} RMS" if isfinite(residual) else ""
    model = spoken.text("model" if row.get("model_of") == SEARCH else "damping")
    width = max([18, *(len(words) for words, *_ in quantities if spoken.code != ENGLISH)])
    more = [*notes(row), *([EMULATED] if row.get("emulated") == "yes" else [])]
    return [
        *map(spoken.text, told),
        *(f"{words:{width}} {text}" + (f"   {where}" if where else "") for words, text, where in quantities),
        f"{model:{width}} {spoken.text(damping_words(row) + leaves)}",
        *map(spoken.text, more),
    ]


EMULATED = "emulated: computed, not measured on a real pendulum"


def told_of(verdict: Mapping[str, Any], spoken: Language = IN_ENGLISH) -> str:
    """What a verdict says, in a line."""
    return spoken.text(". ".join(said(verdict)))


def notes(row: Mapping[str, Any]) -> list[str]:
    """What is to be known of the values of a row beside their uncertainties, a sentence each."""
    note = row.get("note")
    return note.split("; ") if isinstance(note, str) and note else []


def said(verdict: Mapping[str, Any]) -> tuple[str, str]:
    """The status of a verdict in a word or three, and its sentence, which does not say the same again."""
    status = STATUS.get(verdict["status"], verdict["status"])
    sentence = str(verdict["sentence"]).removeprefix(status).lstrip(",: ")
    return status, capital(sentence)
