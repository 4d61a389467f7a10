"""The verdict of a campaign: status, effects with their values and ties, the gap by round, and a sentence."""

from importlib import resources

import yaml

from ..pendulum import catalogue as effects
from ..rounding import plus_minus
from .locate import KINDS

GUARD = yaml.safe_load(resources.files(__package__).joinpath("guard.yaml").read_text())


def verdict(rounds):
    """The contents of verdict.json as a dict, from the contents of the rounds' round.json, in order.

    ``status``: ``consistent`` nothing was missing, ``named`` what was added stands alone and nothing significant remains,
    ``ambiguous`` the same with a tie, ``unknown`` where something significant remains, or remained, without a name.
    """
    first, last = rounds[0], rounds[-1]
    # beside a torque without a name the values of the named ones mean little: it can do their work
    sound = [state for state in rounds if not any(name in effects.FREE_FORM for name in state["found"])][-1]
    added = [_effect(name, rounds, last if name in effects.FREE_FORM else sound) for name in last["found"]]
    nameless = [one for one in added if one["name"] in effects.FREE_FORM]
    if last["missing"] or nameless:
        status = "unknown"
    elif not added:
        status = "consistent"
    else:
        status = "ambiguous" if any(one["tied_with"] for one in added) else "named"
    # the rounds before a torque without a name was added tell what has none
    remaining = next(
        (state for state in rounds if state["chosen"] and state["chosen"]["added"] in effects.FREE_FORM), last
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
        "misspecified": _at_their_bounds(sound["effects"], sound["parameters"]),
        "next_measurement": _next(added, status),
        "guard": GUARD,
    }
    found["sentence"] = sentence(found)
    return found


def _effect(name, rounds, fitted):
    """What is told of one effect: its round, values as ``fitted``, evidence, and what the data do not tell it from."""
    last = rounds[-1]
    state = next(state for state in reversed(rounds) if state["chosen"] and state["chosen"]["added"] == name)
    ties = [row for row in state["ranking"] if row["tied"] and row["added"] not in (None, name)]
    if name in effects.FREE_FORM:  # what was tied in that round was refused for it
        tied, alike = [], {}
    elif name in last["rivals"]:
        tied, alike = last["rivals"][name], {}
    else:
        tied, alike = [row["added"] for row in ties], {row["added"]: row["correlation"] for row in ties}
    known = fitted["parameters"]
    return {
        "name": name,
        "round": state["round"] + 1,
        "parameters": {p.name: known.get(p.name, {"value": None, "standard_error": None, "unit": p.unit}) for p in effects.effect(name).parameters},
        "delta_bic": state["chosen"]["gain_bic"],
        "tied_with": tied,
        "correlation": alike,
        "replaces": state["chosen"]["dropped"],
        "within_calibration": _within_calibration(name, fitted),
    }  # fmt: skip


def _within_calibration(name, state):
    """True if a sensor effect is no larger than what the calibration leaves open (two standard uncertainties)."""
    reach = {"sensor_gain": state["largest_angle_rad"], "sensor_zero": 1.0, "eccentricity": 1.0}.get(name)
    if reach is None or not state["systematic_rad"]:
        return False
    size = state["parameters"][effects.effect(name).parameters[0].name]["value"]
    return abs(size) * reach <= 2 * state["systematic_rad"]


def _groups(state):
    return {
        row["name"]: {key: row[key] for key in ("share", "chi_square", "freedom", "p")}
        for row in state["groups"]
    }


def _at_their_bounds(names, values):
    """Parameters of the model that ended where their effect is not there: signs that the model is not the pendulum's."""
    firsts = [effects.effect(name).parameters[0] for name in names if effects.effect(name).parameters]
    return [p.name for p in firsts if p.lower == 0.0 and p.name in values and values[p.name]["value"] <= 0.0]


_SPLITS = (
    ({"constant_torque", "sensor_zero"}, "Read the angle at rest, turn the pendulum's mount end for end, and read it again: a torque stays, a wrong zero turns."),
    ({"cubic_stiffness", "torsion_spring"}, "Release from below 5° and from as far as the apparatus allows: a spring shifts the period of both, a cubic one only of the large swing."),
    ({"cubic_stiffness", "sensor_gain"}, "Read the sensor at rest at two known angles: only a wrong gain shows there."),
    ({"torsion_spring", "sensor_gain"}, "Read the sensor at rest at two known angles: only a wrong gain shows there."),
    ({"eccentricity", "sensor_gain"}, "Read the sensor at rest at known angles on both sides."),
    ({"eccentricity", "sensor_zero"}, "Read the sensor at rest at known angles on both sides."),
    ({"quadratic_drag", "damping_drift"}, "Release from half and from twice the angle, in both orders: drag follows the angle, a drift the clock."),
    ({"quadratic_drag", "power_law_drag"}, "Release from twice the angle: the exponent shows in the first swings."),
    ({"quadratic_drag", "steady_wind"}, "Release from both sides with the draught shut off."),
    ({"constant_torque", "steady_wind"}, "Repeat with the pendulum shielded from the air: a torque stays."),
    ({"constant_coulomb", "presliding"}, "Sample swings of less than 1°, and let one die out: only friction that winds up shortens the period there."),
)  # fmt: skip


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


def sentence(found):
    """What a person would say of a verdict."""
    fit, holdout, where = found["gap"]["fit"], found["gap"]["holdout"], found["where"]
    dropped = f" Not needed: {_listed(found['removed'])}." if found["removed"] else ""
    if found["status"] == "consistent":
        text = f"Nothing is missing: the model leaves {fit[-1]:.3g} times the noise on fitted and {holdout[-1]:.3g} on held-out swings."
        return text + dropped + _misspecified(found)
    named = [one for one in found["effects"] if one["name"] not in effects.FREE_FORM]
    seen = where["seen"][:1].upper() + where["seen"][1:] + ": " if where["seen"] else ""
    said = []
    if named:
        joined = " and ".join(map(_described, named))
        said.append(f"{seen}{joined} {'is' if len(named) == 1 else 'are'} missing.")
    elif seen:
        said.append(f"{seen.removesuffix(': ')}.")
    if len(fit) > 1:
        said.append(f"Held-out residual {holdout[0]:.3g} → {holdout[-1]:.3g} times the noise.")
    if found["status"] == "unknown":
        kind = f", mostly {where['remaining_kind']}" if where["remaining_kind"] else ""
        nameless = [one["name"] for one in found["effects"] if one["name"] in effects.FREE_FORM]
        before = holdout[-1 - len(nameless)]
        said.append(f"What remains, {before:.3g} times the noise{kind}, has no name in the catalogue"
                    + (f"; it is kept as {' and '.join(nameless)}." if nameless else "."))  # fmt: skip
    return " ".join(said) + dropped + _misspecified(found)


def _misspecified(found):
    names = found["misspecified"]
    return (
        f" {_listed(names)} would be negative if it could: a sign that the model is not the pendulum's."
        if names
        else ""
    )


def _listed(names):
    return ", ".join(name.replace("_", " ") for name in names)


_SCALES = {"rad": ((1e-3, "mrad"),), "s": ((1e-3, "ms"),)}


def _described(one):
    """An effect with the parameter that tells most of it, and its rivals."""
    name = one["name"].replace("_", " ")
    values = {key: entry for key, entry in one["parameters"].items() if entry["value"] is not None}
    # a width or a time is easier to picture than a friction over an inertia
    key = next(
        (key for key, entry in values.items() if entry["unit"] in ("rad", "s", "Hz")),
        next(iter(values), None),
    )
    ties = (
        f", or {' or '.join(tie.replace('_', ' ') for tie in one['tied_with'])}, which the data do not tell apart,"
        if one["tied_with"]
        else ""
    )
    if key is None:
        return name + ties
    value, error, unit = (values[key][part] for part in ("value", "standard_error", "unit"))
    for scale, smaller in _SCALES.get(unit, ()):
        if abs(value) < 0.1:
            value, error, unit = value / scale, error and error / scale, smaller
    words = key.replace("_", " ").removeprefix(name + " ").removeprefix(name.split()[0] + " ")
    size = (plus_minus(value, error, "one") if error else f"{value:.3g}") + (
        "" if unit == "1" else f" {unit}"
    )
    calibration = ", within what the calibration leaves open" if one["within_calibration"] else ""
    return f"{name} ({words} {size}{calibration}){ties}"
