"""What is frozen in a file of JSON, and whether it is still so: words as they were, numbers within one of their last digit.

After a change that is meant, ``FROZEN_WRITE=1`` before the test's command writes the file anew, and the diff shows what it did.
"""

import fcntl
import json
import os
import re

NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e[-+]?\d+)?")


def held(path, names, name, now, indent=None):
    """Asserts that one of the ``names`` is what a file holds of it, or writes it there: in one line, or in many (``indent``)."""
    if os.environ.get("FROZEN_WRITE"):
        return _write(path, names, name, now, indent)
    known = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    assert name in known, f"{name}: not frozen yet; FROZEN_WRITE=1 freezes it"
    lines = list(by_keys(now, known[name]))
    assert not lines, "\n".join([f"{name}: where this is meant, write it anew with FROZEN_WRITE=1", *lines])


def by_keys(now, was):
    """What is not as it was, a line for each key."""
    for key in was | now:
        if key not in now or key not in was or differs(now[key], was[key]):
            yield f"{key} was {was.get(key)}, is now {now.get(key)}"


def differs(now, was):
    """True where words are others, or a number is another by more than one of its last digit."""
    if isinstance(was, list):
        return len(now) != len(was) or any(differs(*both) for both in zip(now, was, strict=True))
    if not isinstance(was, str) or NUMBER.sub("#", now) != NUMBER.sub("#", was):
        return now != was
    both = zip(NUMBER.findall(now), NUMBER.findall(was), strict=True)
    return any(abs(float(a) - float(b)) > 1.01 * unit(b) for a, b in both)


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
