"""The verdict of a campaign: status, what is asserted and what merely helps, with values and ties, the gap by round, a sentence."""

from collections.abc import Iterable, Mapping, Sequence
from importlib import resources
from itertools import combinations
from typing import Any

import yaml

from ..pendulum.catalogue import ANGLE, READINGS, SHIPPED, Catalogue
from ..pendulum.effect import Effect
from ..pendulum.formula import evaluate
from ..pendulum.free_form import FreeForm
from .locate import KINDS
from .next_swing import APART
from .sentence import sentence

_TOLD = 0.001  # probability of an effect, below which it is not listed
GUARD = yaml.safe_load(resources.files(__package__).joinpath("guard.yaml").read_text())


def verdict(rounds: Sequence[Mapping[str, Any]], catalogue: Catalogue = SHIPPED) -> dict[str, Any]:
    """The contents of verdict.json as a dict, from the contents of the rounds' round.json, in order.

    ``status``: ``consistent`` nothing was missing, ``named`` what was added stands alone and nothing significant remains,
    ``ambiguous`` the same with a tie, ``partial`` something is established and something significant remains, ``unknown``
    where something significant remains, or none of many effects that leave nothing is established. ``effects`` holds what is asserted, ``stand_ins`` what
    merely helps.
    """
    first, last = rounds[0], rounds[-1]
    reading = last.get("reading", ANGLE)
    unnamed = [form.name for form in catalogue.free_forms]
    # beside a torque without a name the values of the named ones mean little: it can do their work
    sound = [state for state in rounds if not any(name in unnamed for name in state["found"])][-1]
    remains = last["missing"] or any(name in unnamed for name in last["found"])
    judged = remains or last["established"] is not None  # of many that leave nothing, each is judged, too
    doubts = last["established"] or {}
    asserted, stand_ins = [], []
    for name in last["found"]:
        sure = judged and name not in unnamed and doubts.get(name) == ""
        # beside terms that are not established an established one's values mean as little
        told = rounds[last["established_in"]] if sure else last if name in unnamed else sound
        one = _effect(
            catalogue[name], rounds, told, remains, last.get("jackknife", {}) if sure and remains else {}
        )
        if judged and (name in unnamed or doubts.get(name, "not looked into")):
            doubt = "it has no name" if name in unnamed else doubts.get(name, "it was not looked into")
            stand_ins.append(one | {"doubt": doubt})
        else:
            asserted.append(one)
    if remains or stand_ins:
        status = "partial" if asserted else "unknown"
    elif not asserted:
        status = "consistent"
    else:
        status = "ambiguous" if any(one["tied_with"] for one in asserted) else "named"
    # the rounds before a torque without a name was added tell what has none
    remaining = next(
        (state for state in rounds if state["chosen"] and state["chosen"]["added"] in unnamed), last
    )
    found = {
        "campaign": last["campaign"],
        "reading": reading,
        "unit": READINGS[reading],
        "status": status,
        "effects": asserted,
        "stand_ins": stand_ins,
        "probabilities": {name: p for name, p in last.get("probabilities", {}).items() if p >= _TOLD},
        "removed": [name for name in first["effects"] if name not in last["effects"]],
        "where": {
            "kind": KINDS.get(first["kind"]),
            "seen": first["seen"],
            "groups": _groups(first) if first["missing"] else {},
            "remaining": _groups(remaining) if remaining["missing"] else {},
            "remaining_kind": KINDS.get(remaining["kind"]),
        },
        "gap": {
            "unit": "noise standard deviations",
            "fit": [state["gap"]["fit"] for state in rounds],
            "holdout": [state["gap"]["holdout"] for state in rounds],
            in_unit("holdout", reading): [state["gap"]["holdout"] * noise_rms(state) for state in rounds],
            "explained": _explained(first, sound),
            "left": {
                "noise": sound["gap"]["holdout"],
                "rad" if reading == ANGLE else "rad_per_s": sound["gap"]["holdout"] * noise_rms(sound),
            },
        },
        "noise_rms_rad": None,  # of a rate there is none in rad
        in_unit("noise_rms", reading): noise_rms(last),
        "noise_correlation": last["noise_correlation"],
        "split": last["split"],
        "moves": [state["chosen"]["move"] for state in rounds if state["chosen"]],
        "model": last["parameters"],
        "own_frequency": last.get("own_frequency", {}),
        "conclusion": last.get("conclusion"),
        "nuisance": last.get("nuisance", {}),
        "misspecified": _at_their_bounds([catalogue[name] for name in sound["effects"]], sound["parameters"]),
        "next_measurement": _next_measurement(asserted, status, catalogue, last.get("next_swing")),
        "next_swing": last.get("next_swing"),
        "stopped": bool(last["spent"]),
        "guard": GUARD,
    }
    found["sentence"] = sentence(found, catalogue)
    return found


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
    effect: Effect,
    rounds: Sequence[Mapping[str, Any]],
    fitted: Mapping[str, Any],
    remains: bool,
    jackknife: Mapping[str, float],
) -> dict[str, Any]:
    """What is told of one effect: its round, values as ``fitted``, evidence, and what the data do not tell it from.

    Where something ``remains`` standard errors do not know of it; those of the ``jackknife`` do, and the larger is told.
    """
    last, name = rounds[-1], effect.name
    state = next(state for state in reversed(rounds) if state["chosen"] and name in _names(state["chosen"]))
    rows, move = [row for row in state["ranking"] if row["tied"]], state["chosen"]["move"]
    # of one that was chosen for what held-out swings say, the evidence of the fitted ones ties nothing
    near = [row for row in rows if row["move"] != move] if any(row["move"] == move for row in rows) else []
    ties = {other: row for row in near for other in _names(row) if other not in _names(state["chosen"])}
    tied: list[str]
    alike: dict[str, float]
    if isinstance(effect, FreeForm):
        tied, alike = [], {}
    elif name in last["rivals"] or remains:  # they were looked for in another way than by evidence
        tied, alike = last["rivals"].get(name, []), {}
    else:
        tied, alike = list(ties), {other: row["correlation"] for other, row in ties.items()}
    known = fitted["parameters"]
    return {
        "name": name,
        "round": state["round"] + 1,
        "parameters": {p.name: _with_error(known.get(p.name, {"value": None, "standard_error": None, "unit": p.unit}), jackknife.get(p.name))
                       for p in effect.parameters},
        "probability": last.get("probabilities", {}).get(name),
        "delta_bic": state["chosen"]["gain_bic"],
        "tied_with": tied,
        "correlation": alike,
        "replaces": state["chosen"]["dropped"],
        "within_calibration": _within_calibration(effect, fitted),
    }  # fmt: skip


def _with_error(entry: Mapping[str, Any], error: float | None) -> dict[str, Any]:
    """A value with the larger of its standard error and another one, where both are known."""
    own = entry["standard_error"]
    return dict(entry) if own is None or error is None else {**entry, "standard_error": max(own, error)}


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
            if text := catalogue.measurement(*pair):
                return text
    if tied and swing is not None:
        return str(swing["text"])
    if tied:
        return "Release from angles spread as far as the apparatus allows, and from both sides."
    return (
        "Record swings from several release angles, from both sides, and the pendulum at rest for a minute."
    )
