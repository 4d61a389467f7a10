"""The verdict of a campaign: status, what is asserted and what merely helps, with values and ties, the gap by round, a sentence."""

from collections.abc import Iterable, Mapping, Sequence
from itertools import combinations
from typing import Any

import numpy as np

from ...own_unit import Own
from ...pendulum.catalogue import ANGLE, READINGS, SHIPPED, Catalogue
from ...pendulum.effect import Effect
from ...pendulum.formula import evaluate
from ...studies.left_out import NO_VERDICT
from ...studies.quantities import Quantity, loss_seen
from ..guard import GUARD
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
        ``status``: ``consistent`` nothing was missing, ``named`` what was added stands alone and nothing above the noise remains,
        ``ambiguous`` the same with a tie, ``partial`` something is asserted and something remains or is not asserted, ``unknown`` where
        something is missing and nothing is asserted. ``effects`` holds what is asserted, ``stand_ins`` what merely helps.
    """
    rounds = [_in_own_unit(state) for state in rounds]
    first, last = rounds[0], rounds[-1]
    reading, own = last.get("reading", ANGLE), last.get("own")
    asserted, stand_ins = [], []
    dies_away = bool(last.get("driven")) or _dies_away(last.get("conclusion"))
    unit_doubt = last.get("unit_doubt", "") if dies_away else ""
    conclusion = None if unit_doubt else last.get("conclusion")  # in another unit it has other values
    values = last["parameters"] | ((conclusion or {}).get("values") or {})
    for name in last["findings"]:
        one = _effect(name, catalogue, rounds, {} if unit_doubt else values)
        doubt = last["findings"][name]["doubt"]
        if unit_doubt and not last["findings"][name]["any_unit"]:  # it does the work of another unit
            doubt = "another unit would explain it as well"
        if not dies_away:  # and here perhaps that of a motor
            doubt = "it does not die away"
        if doubt := doubt or _no_finding(catalogue[name], last):
            stand_ins.append(one | {"doubt": doubt})
        else:
            asserted.append(one)
    # what is idle is nothing that is missing, but where all is doubted
    doubted = [
        one for one in stand_ins if not last["findings"][one["name"]]["idle"] or unit_doubt or not dies_away
    ]
    if last["missing"] or doubted or last.get("failed"):
        status = "partial" if asserted or (difference and difference["effect"]) else "unknown"
    elif not asserted:
        status = "consistent"
    else:
        status = "ambiguous" if any(one["tied_with"] or one["law_open"] for one in asserted) else "named"
    first_of_all = _LET_GO if not dies_away else _CHECK if unit_doubt else ""
    found = {
        "campaign": last["campaign"],
        "reading": reading,
        "unit": own["name"] if own else READINGS[reading],
        "status": status,
        "effects": asserted,
        "stand_ins": stand_ins,
        "probabilities": {name: p for name, p in last.get("probabilities", {}).items() if p >= _TOLD},
        "nothing": last.get("nothing"),
        "removed": [name for name in first["effects"] if name not in last["effects"]],
        "where": {
            "kind": KINDS.get(first["kind"]),
            "seen": first["seen"],
            "groups": _groups(first) if first["missing"] else {},
            "remaining": _groups(last) if last["missing"] else {},
            "remaining_kind": KINDS.get(last["kind"]),
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
        "misspecified": _at_their_bounds([catalogue[name] for name in last["effects"]], values),
        "next_measurement": first_of_all
        or _next_measurement(asserted, status, catalogue, last.get("next_swing"), own is not None),
        "next_swing": None if first_of_all else last.get("next_swing"),
        "stopped": bool(last["spent"]),
        "unit_doubt": unit_doubt,
        "driven": bool(last.get("driven")),
        "dies_away": dies_away,
        "failed": last.get("failed", ""),
        "difference": difference if difference and difference["effect"] else None,
        "guard": GUARD,
    }
    followed = follows(difference) if difference else ""
    found["sentence"] = f"{followed} {sentence(found, catalogue)}".strip()
    return found


def _dies_away(concluded: Mapping[str, Any] | None) -> bool:
    """Whether swings die in their turning points, or the model that a search ended with loses anything; what does not may be driven, and its
    effects may be the motor's."""
    if concluded is None or concluded.get("narrows"):
        return True
    known = {
        name: Quantity(one["value"], np.nan if one["standard_uncertainty"] is None else one["standard_uncertainty"], one["unit"])
        for name, one in concluded["quantities"].items()
        if one["value"] is not None
    }  # fmt: skip
    return loss_seen(known)


def _no_finding(effect: Effect, told: Mapping[str, Any]) -> str:
    """In words why an effect's values in a round are none: a frequency that the recordings are too short for; empty where there is no
    reason."""
    longest = told.get("duration_s") or np.inf
    values = {one.name: told["parameters"].get(one.name, {}).get("value") for one in effect.parameters}
    for parameter in effect.parameters:
        value = values[parameter.name]
        if parameter.at_line and value is not None and value * longest < 1:
            return f"{parameter.name} is less than one in the longest recording"
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
        "status": NO_VERDICT,
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


def _next_measurement(
    added: Sequence[Mapping[str, Any]],
    status: str,
    catalogue: Catalogue,
    swing: Mapping[str, Any] | None,
    own: bool,
) -> str | None:
    """The measurement that would tell more, as a sentence, or None: the experiment that tells the leading structures apart where one
    does; else of tied effects what the catalogue says of two of them, or that nothing at hand does."""
    tied = any(one["tied_with"] for one in added)
    if not tied and status not in ("unknown", "partial"):
        return None
    if swing is not None and swing["separation"] >= APART:
        return str(swing["text"])
    for one in added:
        for pair in combinations(catalogue.ordered({one["name"], *one["tied_with"]}), 2):
            text = catalogue.measurement(*pair)
            if text and not (own and "°" in text):  # of what is no angle
                return text
    if tied and swing is not None:
        return str(swing["text"])
    if tied:
        return "Release from angles spread as far as the apparatus allows, and from both sides."
    return "Record swings from several release angles, from both sides, and a minute at rest."
