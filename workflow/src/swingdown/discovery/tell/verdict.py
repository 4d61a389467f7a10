"""The verdict of a campaign: status, what is asserted and what merely helps, with values and ties, the gap by round, a sentence."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from itertools import combinations
from typing import Any

import numpy as np

from ...own_unit import Own
from ...pendulum.catalogue import ANGLE, READINGS, SHIPPED, Catalogue
from ...pendulum.effect import Effect
from ...pendulum.formula import evaluate
from ...status import REMAINING, Status
from ...studies.quantities import Quantity, loss_seen
from ..criterion import GUARD, USUAL, Doubt
from ..next.proposal import APART
from ..see.locate import KINDS
from .sentence import follows, sentence

_LET_GO = "Switch off what drives it, or record until its swings are smaller."
_CHECK = "Compare a reading with the angle there: its unit is in doubt."
_TOLD = 0.001  # probability of an effect, below which it is not listed


def verdict(
    rounds: Sequence[Mapping[str, Any]],
    catalogue: Catalogue = SHIPPED,
    difference: Mapping[str, Any] | None = None,
) -> dict[str, Any]:
    """The contents of verdict.json as a dict.

    Parameters
    ----------
    rounds
        The contents of ``rounds.json``.
    catalogue
        The effects that may be named.
    difference
        The contents of difference.json, where something was changed between the recordings.

    Returns
    -------
    dict
        ``status`` is a ``Status``. ``effects`` holds what is asserted, ``stand_ins`` what merely helps.
    """
    found = Verdict(tuple(map(_in_own_unit, rounds)), catalogue, difference).as_json()
    followed = follows(difference) if difference else ""
    found["sentence"] = f"{followed} {sentence(found, catalogue)}".strip()
    return found


@dataclass(frozen=True)
class Verdict:
    """What may be said of a campaign by the ``rounds`` of its search, with effects of a ``catalogue``, and by what followed a change between
    its recordings (``difference``)."""

    rounds: tuple[Mapping[str, Any], ...]
    catalogue: Catalogue
    difference: Mapping[str, Any] | None

    @property
    def last(self) -> Mapping[str, Any]:
        """The round that is judged."""
        return self.rounds[-1]

    @cached_property
    def dies_away(self) -> bool:
        """Whether swings are driven as was measured, or die away; effects of what does not may be a motor's."""
        return bool(self.last.get("driven")) or _dies_away(self.last)

    @property
    def guard(self) -> dict[str, Any]:
        """The numbers that decided; with those of criterion.yaml what these were measured to cost."""
        usual = asdict(USUAL)
        own = self.last.get("criterion", usual)
        return GUARD if own == usual else {"clear": GUARD["clear"], **own}

    @cached_property
    def unit_doubt(self) -> str:
        """Why the unit of what dies away is not to be believed; empty where it is."""
        return self.last.get("unit_doubt", "") if self.dies_away else ""

    @cached_property
    def doubts(self) -> dict[str, str]:
        """By effect found, why it is not asserted; empty where it is."""
        return {name: self._doubt(name, judged) for name, judged in self.last["findings"].items()}

    def _doubt(self, name: str, judged: Mapping[str, Any]) -> str:
        if not self.dies_away:
            return Doubt.OF_MOTOR
        if self.unit_doubt and not judged["any_unit"]:  # it does the work of another unit
            return Doubt.OF_UNIT
        return judged["doubt"] or _too_slow(self.catalogue[name], self.last)

    @property
    def asserted(self) -> dict[str, Mapping[str, Any]]:
        """What is judged of each effect that is asserted, by name."""
        return {name: self.last["findings"][name] for name, doubt in self.doubts.items() if not doubt}

    @cached_property
    def status(self) -> Status:
        """The ``Status``."""
        # what is idle is nothing that is missing, but where all is doubted
        all_doubted = self.unit_doubt or not self.dies_away
        doubted = any(
            doubt and (all_doubted or not self.last["findings"][name]["idle"])
            for name, doubt in self.doubts.items()
        )
        if self.last["missing"] or doubted or self.last.get("failed"):
            follows = self.difference and self.difference["effect"]
            return Status.PARTIAL if self.asserted or follows else Status.UNKNOWN
        if not self.asserted:
            return Status.CONSISTENT
        tied = any(one["ties"] or one["law_open"] for one in self.asserted.values())
        return Status.AMBIGUOUS if tied else Status.NAMED

    @property
    def first_of_all(self) -> str:
        """What is to be measured before anything else can be told; empty where there is no such thing."""
        return _LET_GO if not self.dies_away else _CHECK if self.unit_doubt else ""

    @property
    def next_measurement(self) -> str | None:
        """The measurement that would tell more, as a sentence, or None: the experiment that tells the leading structures apart where one
        does; else of tied effects what the catalogue says of two of them, or that nothing at hand does."""
        if self.first_of_all:
            return self.first_of_all
        swing = self.last.get("next_swing")
        ties = [{name, *one["ties"]} for name, one in self.asserted.items() if one["ties"]]
        if not ties and self.status not in REMAINING:
            return None
        if swing is not None and swing["separation"] >= APART:
            return str(swing["text"])
        for names in ties:
            for pair in combinations(self.catalogue.ordered(names), 2):
                text = self.catalogue.measurement(*pair)
                if text and not (self.last.get("own") and "°" in text):  # of what is no angle
                    return text
        if ties and swing is not None:
            return str(swing["text"])
        if ties:
            return "Release from angles spread as far as the apparatus allows, and from both sides."
        return "Record swings from several release angles, from both sides, and a minute at rest."

    def as_json(self) -> dict[str, Any]:
        """The contents of verdict.json but the sentence."""
        rounds, first, last = self.rounds, self.rounds[0], self.last
        reading, own = last.get("reading", ANGLE), last.get("own")
        # in another unit it has other values
        conclusion = None if self.unit_doubt else last.get("conclusion")
        values = last["parameters"] | ((conclusion or {}).get("values") or {})
        told = {
            name: _effect(name, self.catalogue, rounds, {} if self.unit_doubt else values)
            for name in self.doubts
        }
        return {
            "campaign": last["campaign"],
            "reading": reading,
            "unit": own["name"] if own else READINGS[reading],
            "status": str(self.status),
            "effects": [told[name] for name in self.asserted],
            "stand_ins": [told[name] | {"doubt": str(doubt)} for name, doubt in self.doubts.items() if doubt],
            "probabilities": {name: p for name, p in last.get("probabilities", {}).items() if p >= _TOLD},
            "nothing": last.get("nothing"),
            "removed": [name for name in first["effects"] if name not in last["effects"]],
            "where": {
                "kind": KINDS.get(first["kind"]),
                "seen": first["seen"],
                "groups": _groups(first) if first["missing"] else {},
                "remaining": _groups(last) if last["missing"] else {},
                "remaining_kind": KINDS.get(last["kind"]),
                "lacks": bool(last["missing"]),
            },
            "gap": {
                "unit": "noise standard deviations",
                "fit": [state["gap"]["fit"] for state in rounds],
                "holdout": [state["gap"]["holdout"] for state in rounds],
                in_unit("holdout", reading): [state["gap"]["holdout"] * noise_rms(state) for state in rounds],
                "explained": _explained(first, last),
                "left": {
                    "noise": last["gap"]["holdout"],
                    "rad" if reading == ANGLE else "rad_per_s": last["gap"]["holdout"] * noise_rms(last),
                },
            },
            "noise_rms_rad": None,  # of a rate there is none in rad
            in_unit("noise_rms", reading): noise_rms(last),
            "noise_correlation": last["noise_correlation"],
            "split": last["split"],
            "recordings": last.get("recordings", []),
            "left_out": last.get("left_out", []),
            "moves": [state["chosen"]["move"] for state in rounds if state["chosen"]],
            "model": values,
            "own_frequency": last.get("own_frequency", {}),
            "conclusion": conclusion,
            "nuisance": last.get("nuisance", {}),
            "misspecified": _at_their_bounds([self.catalogue[name] for name in last["effects"]], values),
            "next_measurement": self.next_measurement,
            "next_swing": None if self.first_of_all else last.get("next_swing"),
            "stopped": bool(last["spent"]),
            "unit_doubt": self.unit_doubt,
            "driven": bool(last.get("driven")),
            "dies_away": self.dies_away,
            "failed": last.get("failed", ""),
            "difference": self.difference if self.difference and self.difference["effect"] else None,
            "guard": self.guard,
        }


def _dies_away(told: Mapping[str, Any]) -> bool:
    """Whether swings die in their turning points, or the model that a search ended with loses anything, no more than would show in them
    and no less than what has no name does to them; what does not may be driven, and its effects may be the motor's."""
    concluded = told.get("conclusion")
    if concluded is None or concluded.get("narrows"):
        return True
    known = {
        name: Quantity(one["value"], np.nan if one["standard_uncertainty"] is None else one["standard_uncertainty"], one["unit"])
        for name, one in concluded["quantities"].items()
        if one["value"] is not None
    }  # fmt: skip
    stays = concluded.get("narrows") is False  # not where too few swings are left to tell
    return loss_seen(known) and not (
        stays and "decay_time" in known and _is_fed(told, known["decay_time"].value)
    )


def _is_fed(told: Mapping[str, Any], fades: float) -> bool:
    """Whether something feeds swings that stay wide: by themselves they would fade in this time (s) within the record, or by less than what
    has no name does to them."""
    duration, amplitude = told.get("duration_s") or 0.0, told["conclusion"].get("amplitude_rad", np.inf)
    return duration > fades or duration * amplitude < told.get("unnamed_rad", 0.0) * fades


def _too_slow(effect: Effect, told: Mapping[str, Any]) -> str:
    """The doubt of an effect with a frequency that the recordings are too short for; empty where it has none."""
    longest = told.get("duration_s") or np.inf
    for parameter in effect.parameters:
        value = told["parameters"].get(parameter.name, {}).get("value")
        if parameter.at_line and value is not None and value * longest < 1:
            return Doubt.TOO_SLOW.format(parameter=parameter.name)
    return ""


def no_verdict(state: Mapping[str, Any]) -> dict[str, Any]:
    """The contents of verdict.json of a campaign in which there was nothing to search.

    Parameters
    ----------
    state
        The only entry of its ``rounds.json``.

    Returns
    -------
    dict
        ``no_verdict`` holds why: where, problem, expected, mend.
    """
    why = state["no_verdict"]
    return {
        "campaign": state["campaign"],
        "status": str(Status.NO_VERDICT),
        "effects": [],
        "stand_ins": [],
        "removed": [],
        "where": {},
        "gap": {"unit": "noise standard deviations", "fit": [], "holdout": []},
        "noise_rms_rad": None,
        "recordings": state["recordings"],
        "left_out": state["left_out"],
        "difference": None,
        "no_verdict": why,
        "next_measurement": why["mend"] or None,
        "sentence": f"No verdict: {why['where']}: {why['problem']}.",
    }


def _in_own_unit(state: Mapping[str, Any]) -> Mapping[str, Any]:
    """A round with its values in the reading's own unit, where that is no angle: a key that ends in ``_rad`` holds them too."""
    if not state.get("own"):
        return state
    own = Own(**state["own"])
    told = dict(state) | {key: own.entries(state[key]) for key in ("parameters", "nuisance")}
    for key in ("noise_rms_rad", "systematic_rad", "largest_angle_rad"):
        told[key] = own.step * state[key]
    if found := state.get("conclusion"):
        units = [found["values"].get(name, {"unit": "1"})["unit"] for name in found["parameters"]]
        told["conclusion"] = found | {
            "values": own.entries(found["values"]),
            "quantities": own.entries(found["quantities"]),
            "amplitude_rad": own.step * found["amplitude_rad"],
            "residual": own.step * found["residual"],
            "covariance": own.covariance(found["parameters"], units, found["covariance"]),
        }
    if swing := state.get("next_swing"):
        told["next_swing"] = swing | {
            key: own.step * swing[key] for key in ("release_angle", "release_velocity")
        }
    return told


def in_unit(key: str, reading: str) -> str:
    """A key for a number of what is read, with its unit: ``noise_rms_rad``, of a rate ``noise_rms_rad_per_s``."""
    return f"{key}_{'rad' if reading == ANGLE else 'rad_per_s'}"


def noise_rms(found: Mapping[str, Any]) -> float:
    """The noise's standard deviation in a verdict, or in a round: rad, of a rate rad/s (its ``unit``)."""
    return float(found[in_unit("noise_rms", found.get("reading", ANGLE))])


def _explained(first: Mapping[str, Any], last: Mapping[str, Any]) -> float | None:
    """The share of the held-out swings' excess over the noise that named effects explain; None where there was none."""
    noise = noise_rms(last) ** 2
    before, after = ((one["gap"]["holdout"] * noise_rms(one)) ** 2 - noise for one in (first, last))
    return float(1 - max(after, 0.0) / before) if before > 0 else None


def _effect(
    name: str, catalogue: Catalogue, rounds: Sequence[Mapping[str, Any]], values: Mapping[str, Any]
) -> dict[str, Any]:
    """What is told of one effect: its round, values, evidence, what is judged of it, and what the data do not tell it from."""
    last, effect = rounds[-1], catalogue[name]
    state = next(state for state in reversed(rounds) if state["chosen"] and name in _names(state["chosen"]))
    judged = last["findings"][name]
    nothing = {"value": None, "standard_error": None}
    return {
        "name": name,
        "round": state["round"] + 1,
        "parameters": {p.name: values.get(p.name, nothing | {"unit": p.unit}) for p in effect.parameters},
        "probability": judged["probability"],
        "share_left": judged["share"],
        "held_out_left": judged["held_out"],
        "of_amplitudes": judged["of_amplitudes"],
        "gap_without": judged["without"],
        "delta_bic": state["chosen"]["gain_bic"],
        "tied_with": judged["ties"],
        "law_open": judged["law_open"],
        "damping": "friction" if catalogue.rubs(name) else "drag" if catalogue.damps(name) else None,
        "replaces": state["chosen"]["dropped"],
        "within_calibration": _within_calibration(effect, last),
    }


def _names(move: Mapping[str, Any]) -> list[str]:
    """The names of all effects that a move adds."""
    return [] if move["added"] is None else [move["added"], *move.get("also", ())]


def _within_calibration(effect: Effect, state: Mapping[str, Any]) -> bool:
    """True if a sensor effect is no larger than what the calibration leaves open (two standard uncertainties)."""
    systematic = state[in_unit("systematic", state.get("reading", ANGLE))]
    if not effect.reading_error or not systematic:
        return False
    known = {p.symbol: state["parameters"][p.name]["value"] for p in effect.parameters}
    error = evaluate(effect.reading_error, largest_angle=state["largest_angle_rad"], **known)
    return bool(error <= 2 * systematic)


def _groups(state: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    return {
        row["name"]: {key: row[key] for key in ("share", "chi_square", "freedom", "p")}
        for row in state["groups"]
    }


def _at_their_bounds(effects: Iterable[Effect], values: Mapping[str, Any]) -> list[str]:
    """Sizes in the model that ended where their effect is not there: signs that the model is not the pendulum's."""
    sizes = [effect.size for effect in effects if effect.size and effect.one_sided]
    return [p.name for p in sizes if p.name in values and values[p.name]["value"] <= 0.0]
