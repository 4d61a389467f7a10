"""The verdict of a campaign: status, effects with their values and ties, the gap by round, and a sentence."""

import numpy as np

from .. import effects
from .locate import KINDS
from .name import TIE


def verdict(rounds, models, rankings, groups):
    """The contents of verdict.json as a dict, from the rounds in order (their round.json, model, ranking and groups).

    ``status``: ``consistent`` nothing was missing, ``named`` what was added stands alone and nothing significant remains,
    ``ambiguous`` the same with a tie, ``unknown`` where something significant remains that no entry explains.
    """
    last, model = rounds[-1], models[-1]
    added, removed = [], []
    for k, state in enumerate(rounds[:-1]):
        move = state["chosen"]
        if move["added"]:
            added.append(_effect(move, k, rankings[k], model))
        elif move["dropped"]:
            removed.append(move["dropped"])
    added = [one for one in added if one["name"] in model.effects]
    removed += [one["replaces"] for one in added if one["replaces"]]
    if last["missing"]:
        status = "unknown"
    elif not added and not removed:
        status = "consistent"
    else:
        status = "ambiguous" if any(one["tied_with"] for one in added) else "named"
    found = {
        "campaign": last["campaign"],
        "status": status,
        "effects": added,
        "removed": sorted(set(removed)),
        "where": _where(groups[0] if rounds[0]["missing"] else [], groups[-1] if last["missing"] else []),
        "gap": {
            "unit": "noise standard deviations",
            "fit": [state["gap"]["fit"] for state in rounds],
            "holdout": [state["gap"]["holdout"] for state in rounds],
        },
        "noise_rms_rad": last["noise_rms_rad"],
        "noise_correlation": last["noise_correlation"],
        "split": last["split"],
        "next_measurement": _next(added, status),
        "signs": _signs(model),
        "calibrated": False,  # how often such verdicts are right has not been measured
    }
    found["sentence"] = sentence(found)
    return found


def _effect(move, number, ranking, model):
    effect = effects.effect(move["added"])
    near = ranking[(ranking["delta_bic"] < TIE) & ranking["tied"] & (ranking["added"] != move["added"])]
    rest = ranking[(ranking["added"] != move["added"]) & ranking["refused"].isna()]["delta_bic"]
    own = ranking.loc[ranking["move"] == move["move"], "delta_bic"]
    return {
        "name": move["added"],
        "round": number + 1,
        "parameters": {
            p.name: {
                "value": model.values.get(p.name),
                "standard_error": _finite(model.standard_errors.get(p.name)),
                "unit": p.unit,
            }
            for p in effect.parameters
        },
        "delta_bic": float(rest.min() - own.min()) if len(rest) and len(own) else None,
        "tied_with": [str(name) for name in near["added"].dropna().unique()],
        "replaces": move["dropped"],
    }


def _finite(value):
    return float(value) if value is not None and np.isfinite(value) else None


def _where(first, last):
    def told(groups):
        return {row["name"]: {"share": row["share"], "chi_square": row["chi_square"], "p": row["p"]} for row in groups}

    largest = max(first, key=lambda row: row["share"], default=None)
    return {
        "kind": KINDS[largest["name"]] if largest else None,
        "groups": told(first),
        "remaining": told(last),
    }


_SPLITS = (
    ({"constant_torque", "sensor_zero"}, "Read the angle at rest, turn the pendulum's mount end for end, and read it again."),
    ({"cubic_stiffness", "torsion_spring"}, "Measure the period at two amplitudes, one below 5°, or measure the geometry."),
    ({"cubic_stiffness", "sensor_gain"}, "Calibrate the sensor at rest against known angles."),
    ({"quadratic_drag", "damping_drift"}, "Release from half and from twice the angle, in both orders."),
)


def _next(added, status):
    for one in added:
        names = {one["name"], *one["tied_with"]}
        for pair, text in _SPLITS:
            if pair <= names:
                return text
    if any(one["tied_with"] for one in added):
        return "Release from angles spread as far as the apparatus allows, and from both sides."
    if status == "unknown":
        return "Record swings from several release angles, from both sides, and the pendulum at rest for a minute."
    return None


def _signs(model):
    """Parameters that ended at zero or below: a sign that the model is not the pendulum's."""
    return [d.name for d in model.definitions if d.lower == 0.0 and model.values.get(d.name, 1.0) <= 0.0]


def sentence(found):
    """What a person would say of a verdict."""
    fit, holdout = found["gap"]["fit"], found["gap"]["holdout"]
    shrink = f"Held-out residual {holdout[0]:.3g} → {holdout[-1]:.3g} times the noise."
    names = [_described(one) for one in found["effects"]]
    if found["status"] == "consistent":
        return f"Nothing is missing: the model leaves {fit[-1]:.3g} times the noise on fitted and {holdout[-1]:.3g} on held-out swings."
    said = f"Missing from the model: {' and '.join(names)}. {shrink}" if names else shrink if found["removed"] else ""
    if found["removed"]:
        said += f" Not needed, or replaced: {', '.join(found['removed'])}."
    if found["status"] == "unknown":
        where = found["where"]["remaining"]
        largest = max(where, key=lambda name: where[name]["share"]) if where else None
        rest = f"{holdout[-1]:.3g} times the noise remains that no effect of the catalogue explains"
        said += f" {rest}" + (f", mostly {KINDS[largest]}." if largest else ".")
    return said.strip()


def _described(one):
    name = one["name"].replace("_", " ")
    first = next(iter(one["parameters"].items()), None)
    if first is None or first[1]["value"] is None:
        return name
    value, error, unit = first[1]["value"], first[1]["standard_error"], first[1]["unit"]
    size = f"{value:.3g}" + (f" ± {error:.1g}" if error else "") + ("" if unit == "1" else f" {unit}")
    ties = f", or {', '.join(t.replace('_', ' ') for t in one['tied_with'])}: the data do not tell them apart" if one["tied_with"] else ""
    return f"{name} ({first[0].replace('_', ' ')} {size}{ties})"
