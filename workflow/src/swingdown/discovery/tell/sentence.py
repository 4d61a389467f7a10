"""What a person would say of a verdict, in a sentence or two."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from ...language import capital, listed
from ...own_unit import small
from ...pendulum.catalogue import SHIPPED, Catalogue
from ...pendulum.effect import Effect
from ...pendulum.model import in_words
from ...pendulum.slack import ZERO, is_open
from ...rounding import plus_minus, probability
from ...status import REMAINING, Status

_OF_ANOTHER_LAW = {"friction": "friction of another law", "drag": "drag of another law"}
_SMALLER = {"rad": (1e-3, "mrad"), "rad/s": (1e-3, "mrad/s"), "s": (1e-3, "ms")}
_SMALL = 0.1  # of a unit that has a smaller one beside it


def sentence(found: Mapping[str, Any], catalogue: Catalogue = SHIPPED) -> str:
    """What a person would say of a verdict: what is missing, how sure that is, and what remains.

    Parameters
    ----------
    found
        The verdict, as in verdict.json.
    catalogue
        The one whose effects it names.

    Returns
    -------
    str
        Whole sentences in English, each of which ``language`` can say.
    """
    fit, holdout, where = found["gap"]["fit"], found["gap"]["holdout"], found["where"]
    # where nothing is missing, a size that ends at nothing is that of an effect that is not there
    needless = [*found["removed"], *(found["misspecified"] if found["status"] not in REMAINING else ())]
    dropped = f" Not needed: {_listed(needless)}." if needless else ""
    end = (
        _frequencies(found)
        + _of_parts(found)
        + _misspecified(found)
        + (" The search stopped: its time was used up." if found["stopped"] else "")
    )
    if found["status"] == Status.CONSISTENT:
        slack = _slack(found.get("nuisance", {}))
        noise = found.get("noise_rms_rad") or found.get("noise_rms_rad_per_s") or np.nan
        text = (
            f"Nothing is missing{slack}: the model leaves {fit[-1]:.3g} times the noise "
            f"({small(noise, found.get('unit', 'rad'))}) on fitted and {holdout[-1]:.3g} on held-out swings."
        )
        joined, _ = _may_be(found["stand_ins"], catalogue)
        besides = f" The model also has {joined}: without it nothing rises above the noise." if joined else ""
        return text + besides + dropped + end
    if not found.get("dies_away", True):
        return "What stops it cannot be told: it does not die away, and what a motor does is no effect of the catalogue."
    if doubt := found.get("unit_doubt"):
        known = [f"{capital(_described(one, catalogue[one['name']]))} is missing (P {_sure(one)})."
                 for one in found["effects"]]  # fmt: skip
        no_other = "No effect is named" if not known else "No other effect is named"
        return " ".join(
            [f"{capital(doubt)}.", *known, f"{no_other}: another unit would explain the swings as well."]
        )
    said = [f"{capital(where['seen'])}."] if where["seen"] else []
    if found["effects"]:
        joined = capital(" and ".join(_described(one, catalogue[one["name"]]) for one in found["effects"]))
        said.append(f"{joined} {'is' if len(found['effects']) == 1 else 'are'} missing{_without(found)}.")
    if len(fit) > 1 and (len(found["effects"]) != 1 or found["effects"][0].get("gap_without") is None):
        said.append(f"Held-out residual {holdout[0]:.3g} → {holdout[-1]:.3g} times the noise{_share(found)}.")
    if found.get("failed"):
        said.append(f"What is missing is not known: the search broke off ({found['failed']}).")
    elif found["status"] in REMAINING:
        said.append(_remains(found, catalogue))
    return " ".join(said) + dropped + end


def follows(difference: Mapping[str, Any]) -> str:
    """What is said of the effect that goes with what was changed between the recordings, and how."""
    quantity = f"the {difference['quantity_name']}"
    stopped = f" (not all were asked: {difference['stopped']})" if difference.get("stopped") else ""
    if not difference["effect"]:
        return (
            f"No effect was seen to follow {quantity}{stopped}."
            if stopped
            else f"No effect follows {quantity}."
        )
    names = " or ".join(map(in_words, (difference["effect"], *difference["tied_with"])))
    said = f"{capital(names)} follows {quantity} (P {_sure(difference)}){stopped}"
    law = difference["law"]
    if law is None:
        return f"{said}."
    beside = ""
    if law["u_offset"] is not None:
        unit = "" if difference["unit"] == "1" else f" {difference['unit']}"
        beside = f", plus a constant {plus_minus(law['offset'], law['u_offset'], 'one')}{unit}"
    power = plus_minus(difference["exponent"], difference["exponent_standard_error"], "one")
    return f"{said}: it goes as its power {power}{beside}."


def _share(found: Mapping[str, Any]) -> str:
    """How much of the excess is explained, where named effects explain any."""
    share = found["gap"]["explained"]
    return f", {100 * share:.0f} % of the excess explained" if share is not None and share > 0 else ""


def _without(found: Mapping[str, Any]) -> str:
    """How sure each effect is, and what held-out swings leave without it and with it."""
    with_it = f"{found['gap']['holdout'][-1]:.3g}"
    if len(found["effects"]) == 1:
        (one,) = found["effects"]
        if one.get("of_amplitudes"):
            left = f"{max(100 * one['share_left'], 1):.2g} %"
            return f" (P {_sure(one)}): without it the amplitudes would decay otherwise, with it {left} of that difference remains"
        if one.get("gap_without") is None:
            return f" (P {_sure(one)})"
        return f" (P {_sure(one)}): without it {one['gap_without']:.3g} times the noise remains, with it {with_it}"
    each = [f"without {in_words(one['name'])} {one['gap_without']:.3g} (P {_sure(one)})"
            for one in found["effects"] if one.get("gap_without") is not None]  # fmt: skip
    return f": with them {with_it} times the noise remains, {', '.join(each)}" if each else ""


def _sure(one: Mapping[str, Any]) -> str:
    """A probability as one says it."""
    chance = one.get("probability")
    return "unknown" if chance is None else probability(chance)


def _remains(found: Mapping[str, Any], catalogue: Catalogue) -> str:
    """What remains, how large it is, and what may be there and is not sure enough to be named."""
    kind = f", mostly {found['where']['remaining_kind']}," if found["where"]["remaining_kind"] else ","
    joined, why = _may_be(found["stand_ins"], catalogue)
    remaining = found["where"]["lacks"]
    what = "Part of it" if remaining else "The rest" if found["effects"] else "It"
    may_be = f"{what} may be {joined}: not sure enough to be named{why}." if joined else ""
    if not remaining:
        return f"{may_be} Nothing more is missing of the fitted swings." if not found["effects"] else may_be
    left = found["gap"]["left"]
    times, size = left["noise"], left.get("rad", left.get("rad_per_s"))
    rest = "The rest" if found["effects"] else "What remains"
    if times <= 1:  # held-out swings lack nothing: what remains is in the fitted ones
        size *= found["gap"]["fit"][-1] / times
        times = found["gap"]["fit"][-1]
        rest = "The rest of the fitted swings" if found["effects"] else "What remains of the fitted swings"
    amount = f"{times:.3g} times the noise ({small(size, found.get('unit', 'rad'))})"
    rest = f"{rest}, {amount}{kind} has no name in the catalogue."
    return " ".join(filter(None, (rest, may_be)))


def _may_be(stand_ins: Sequence[Mapping[str, Any]], catalogue: Catalogue) -> tuple[str, str]:
    """What helps without being asserted, and why it is not: of one effect with its values, of more their names."""
    if len(stand_ins) == 1:
        (one,) = stand_ins
        return _described(one, catalogue[one["name"]]).rstrip(","), f" ({in_words(one['doubt'])})"
    names = [in_words(one["name"]) for one in stand_ins]
    return listed(names), ""


def _slack(nuisance: Mapping[str, Any]) -> str:
    """What the data ask for of what the measurement leaves open: a zero alone, or more."""
    used = {name: one for name, one in nuisance.items() if is_open(one["value"], one["standard_error"])}
    if used.keys() == {ZERO} and nuisance.keys() == {ZERO}:
        return f" with a zero of {_quantity('', used[ZERO])}"
    return " within the calibration's uncertainty" if used else ""


def _frequencies(found: Mapping[str, Any]) -> str:
    """That the recordings have a natural frequency each, where these are not all the same."""
    own = sorted(found.get("own_frequency", {}).values())
    low, high = (f"{own[k]:.5g}" for k in (0, -1)) if own else ("", "")
    if low == high:
        return ""
    return f" The recordings differ in natural frequency, from {low} to {high} rad/s: each was given its own."


def _of_parts(found: Mapping[str, Any]) -> str:
    """That the model does not follow the whole recordings as it does the fitted swings, where it does not and its values are reported."""
    concluded = found.get("conclusion")
    if not concluded or concluded["of_the_whole"] or found["status"] == Status.UNKNOWN:
        return ""
    if (leaves := concluded["whole_leaves"]) is None:
        return (
            " The model cannot be fitted to the whole recordings: its values are those of the fitted swings."
        )
    return f" Fitted to the whole recordings the model leaves {leaves:.3g} times the noise: its values are those of the fitted swings."


def _misspecified(found: Mapping[str, Any]) -> str:
    names = _listed(found["misspecified"])
    if not names or found["status"] not in REMAINING:
        return ""
    return f" {capital(names)} would be negative if it could: the model does not fit these swings."


def _listed(names: Iterable[str]) -> str:
    return ", ".join(map(in_words, names))


def rivals(one: Mapping[str, Any]) -> list[str]:
    """What the data do not tell an effect of a verdict from, in words."""
    of_another_law = [_OF_ANOTHER_LAW[one["damping"]]] if one.get("law_open") else []
    return [*map(in_words, one["tied_with"]), *of_another_law]


def _described(one: Mapping[str, Any], effect: Effect) -> str:
    """An effect with the parameters that the catalogue has told first, and its rivals."""
    name = one["name"].replace("_", " ")
    told = [
        _quantity(_words(key, name), one["parameters"][key])
        for key in effect.told
        if _known(one["parameters"].get(key, {}))
    ]
    if told and one["within_calibration"]:
        told.append("within what the calibration leaves open")
    ties = " or ".join(rivals(one))
    return (
        in_words(name)
        + (f" ({', '.join(told)})" if told else "")
        + (f", or {ties}, which the data do not distinguish," if ties else "")
    )


def _known(entry: Mapping[str, Any]) -> bool:
    """Whether a value is known at all: to better than its own size, where its error is known."""
    value, error = entry.get("value"), entry.get("standard_error")
    return value is not None and not (error or 0.0) > abs(value) > 0


def _words(key: str, name: str) -> str:
    """A parameter's name without that of its effect; nothing where it is called as the effect is."""
    words = key.replace("_", " ")
    if words == name:
        return ""
    return words.removeprefix(name + " ").removeprefix(name.split()[0] + " ")


def _quantity(words: str, entry: Mapping[str, Any]) -> str:
    value, error, unit = (entry[part] for part in ("value", "standard_error", "unit"))
    if unit in _SMALLER and abs(value) < _SMALL:
        scale, unit = _SMALLER[unit]
        value, error = value / scale, error and error / scale
    size = plus_minus(value, error, "one") if error else f"{value:.3g}"
    return f"{words} {size}".strip() + ("" if unit == "1" else f" {unit}")
