"""An axis as it is written in a sweep: values, a range, or several keys that change together."""

import numpy as np

from ..errors import InputError


def keys(written):
    """The keys of an axis: one, or several with commas between them."""
    return tuple(key.strip() for key in str(written).split(","))


def steps(written, entries, place):
    """The values of an axis's keys at each of its places, a list of tuples; InputError for what is no axis."""
    several = len(keys(written))
    if isinstance(entries, dict):
        if several > 1:
            raise InputError(place, "a range of several keys", "a list of lists, one value for each key",
                             "write the values out")  # fmt: skip
        return [(value,) for value in _range(entries, place)]
    if several == 1:
        return [(value,) for value in entries]
    for number, one in enumerate(entries, 1):
        if not isinstance(one, list) or len(one) != several:
            raise InputError(f"{place}, value {number}", f"{one!r}", f"a list of {several} values, one for each key",
                             "write `[20, 10]`")  # fmt: skip
    return [tuple(one) for one in entries]


def _range(entries, place):
    """The numbers of ``{from, to, steps, spacing}``, both ends among them, rounded to 12 digits."""
    first, last, count = (entries.get(key) for key in ("from", "to", "steps"))
    spacing = entries.get("spacing", "linear")
    if spacing == "log" and not (first > 0 and last > 0):
        raise InputError(place, f"from {first:g} to {last:g} in equal ratios", "both ends above 0",
                         "correct an end, or write `spacing: linear`")  # fmt: skip
    made = np.geomspace(first, last, count) if spacing == "log" else np.linspace(first, last, count)
    return [float(f"{value:.12g}") for value in made]
