"""The verdict of a campaign: status, effects with their values and ties, the gap by round, and a sentence."""

from collections.abc import Iterable, Mapping, Sequence
from importlib import resources
from itertools import combinations
from typing import Any

import yaml

from ..pendulum.catalogue import SHIPPED, Catalogue
from ..pendulum.effect import Effect
from ..pendulum.formula import evaluate
from ..pendulum.free_form import FreeForm
from .locate import KINDS
from .sentence import sentence

GUARD = yaml.safe_load(resources.files(__package__).joinpath("guard.yaml").read_text())


def verdict(rounds: Sequence[Mapping[str, Any]], catalogue: Catalogue = SHIPPED) -> dict[str, Any]:
    """The contents of verdict.json as a dict, from the contents of the rounds' round.json, in order.

    ``status``: ``consistent`` nothing was missing, ``named`` what was added stands alone and nothing significant remains,
    ``ambiguous`` the same with a tie, ``unknown`` where something significant remains, or remained, without a name.
    """
    first, last = rounds[0], rounds[-1]
    unnamed = [form.name for form in catalogue.free_forms]
    # beside a torque without a name the values of the named ones mean little: it can do their work
    sound = [state for state in rounds if not any(name in unnamed for name in state["found"])][-1]
    added = [_effect(catalogue[name], rounds, last if name in unnamed else sound) for name in last["found"]]
    nameless = [one for one in added if one["name"] in unnamed]
    if last["missing"] or nameless:
        status = "unknown"
    elif not added:
        status = "consistent"
    else:
        status = "ambiguous" if any(one["tied_with"] for one in added) else "named"
    # the rounds before a torque without a name was added tell what has none
    remaining = next(
        (state for state in rounds if state["chosen"] and state["chosen"]["added"] in unnamed), last
    )
    found = {
        "campaign": last["campaign"],
        "status": status,
        "effects": added,
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
        },
        "noise_rms_rad": last["noise_rms_rad"],
        "noise_correlation": last["noise_correlation"],
        "split": last["split"],
        "moves": [state["chosen"]["move"] for state in rounds if state["chosen"]],
        "model": last["parameters"],
        "nuisance": last.get("nuisance", {}),
        "misspecified": _at_their_bounds([catalogue[name] for name in sound["effects"]], sound["parameters"]),
        "next_measurement": _next_measurement(added, status, catalogue),
        "guard": GUARD,
    }
    found["sentence"] = sentence(found, catalogue)
    return found


def _effect(effect: Effect, rounds: Sequence[Mapping[str, Any]], fitted: Mapping[str, Any]) -> dict[str, Any]:
    """What is told of one effect: its round, values as ``fitted``, evidence, and what the data do not tell it from."""
    last, name = rounds[-1], effect.name
    state = next(state for state in reversed(rounds) if state["chosen"] and state["chosen"]["added"] == name)
    ties = [row for row in state["ranking"] if row["tied"] and row["added"] not in (None, name)]
    tied: list[str]
    alike: dict[str, float]
    if isinstance(effect, FreeForm):  # what was tied in that round was refused for it
        tied, alike = [], {}
    elif name in last["rivals"]:
        tied, alike = last["rivals"][name], {}
    else:
        tied, alike = [row["added"] for row in ties], {row["added"]: row["correlation"] for row in ties}
    known = fitted["parameters"]
    return {
        "name": name,
        "round": state["round"] + 1,
        "parameters": {p.name: known.get(p.name, {"value": None, "standard_error": None, "unit": p.unit}) for p in effect.parameters},
        "delta_bic": state["chosen"]["gain_bic"],
        "tied_with": tied,
        "correlation": alike,
        "replaces": state["chosen"]["dropped"],
        "within_calibration": _within_calibration(effect, fitted),
    }  # fmt: skip


def _within_calibration(effect: Effect, state: Mapping[str, Any]) -> bool:
    """True if a sensor effect is no larger than what the calibration leaves open (two standard uncertainties)."""
    if not effect.reading_error or not state["systematic_rad"]:
        return False
    known = {p.symbol: state["parameters"][p.name]["value"] for p in effect.parameters}
    error = evaluate(effect.reading_error, largest_angle=state["largest_angle_rad"], **known)
    return bool(error <= 2 * state["systematic_rad"])


def _groups(state: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    return {
        row["name"]: {key: row[key] for key in ("share", "chi_square", "freedom", "p")}
        for row in state["groups"]
    }


def _at_their_bounds(effects: Iterable[Effect], values: Mapping[str, Any]) -> list[str]:
    """Sizes in the model that ended where their effect is not there: signs that the model is not the pendulum's."""
    sizes = [effect.size for effect in effects if effect.size and effect.one_sided]
    return [p.name for p in sizes if p.name in values and values[p.name]["value"] <= 0.0]


def _next_measurement(added: Sequence[Mapping[str, Any]], status: str, catalogue: Catalogue) -> str | None:
    """The measurement that would tell more, as a sentence, or None: of tied effects, what the catalogue says of two of them."""
    for one in added:
        for pair in combinations(catalogue.ordered({one["name"], *one["tied_with"]}), 2):
            if text := catalogue.measurement(*pair):
                return text
    if any(one["tied_with"] for one in added):
        return "Release from angles spread as far as the apparatus allows, and from both sides."
    if status == "unknown":
        return "Record swings from several release angles, from both sides, and the pendulum at rest for a minute."
    return None
