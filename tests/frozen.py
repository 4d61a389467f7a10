"""What is frozen in a file of JSON, and whether it is still so.

After a change that is meant, ``FROZEN_WRITE=1`` before the test's command writes the file anew, and the diff shows what it did.
"""

import fcntl
import json
import os
import re

NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e[-+]?\d+)?")


def exactly(now, was):
    """True where it is another."""
    return now != was


def by_a_digit(now, was):
    """True where words are others, or a number is another by more than one of its last digit."""
    return _differs(now, was, whole=False)


def by_a_decimal(now, was):
    """The same, but whole numbers are as they were."""
    return _differs(now, was, whole=True)


def unrounded(now, was):
    """True of a number, not yet rounded, that lies a tenth of the last digit that is kept beyond where it is rounded to another."""
    return abs(now - float(was)) > 0.6 * unit(was) if isinstance(now, float) else now != was


def held(path, names, name, now, differs=exactly, kept=dict, indent=None):
    """Asserts that one of the ``names`` is what a file holds of it, or writes it there as it is ``kept``: in one line, or in many (``indent``)."""
    if os.environ.get("FROZEN_WRITE"):
        return _write(path, names, name, kept(now), indent)
    known = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    assert name in known, f"{name}: not frozen yet; FROZEN_WRITE=1 freezes it"
    was = known[name]
    lines = [
        f"{key} was {was.get(key)}, is now {now.get(key)}"
        for key in was | now
        if key not in now or key not in was or differs(now[key], was[key])
    ]
    assert not lines, "\n".join([f"{name}: where this is meant, write it anew with FROZEN_WRITE=1", *lines])


def _differs(now, was, whole):
    if isinstance(was, list):
        return len(now) != len(was) or any(_differs(*both, whole) for both in zip(now, was, strict=True))
    if not isinstance(was, str) or NUMBER.sub("#", now) != NUMBER.sub("#", was):
        return now != was
    both = zip(NUMBER.findall(now), NUMBER.findall(was), strict=True)
    return any(
        a != b if whole and b.isdigit() else abs(float(a) - float(b)) > 1.01 * unit(b) for a, b in both
    )


def unit(number):
    """One of the last digit of a number as it is written."""
    digits, _, power = number.partition("e")
    return 10.0 ** (int(power or 0) - len(digits.partition(".")[2]))


def _write(path, names, name, now, indent):
    """What a name has put into the file, beside what other processes write at the same time."""
    with path.open("a+", encoding="utf-8") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        file.seek(0)
        found = json.loads(file.read() or "{}") | {name: now}
        file.truncate(0)
        told = {
            key: json.dumps(found[key], ensure_ascii=False, indent=indent) for key in names if key in found
        }
        file.write("{\n" + ",\n".join(f"{json.dumps(key)}: {one}" for key, one in told.items()) + "\n}\n")
