"""What is to be recorded in one go: the recordings that the command line or the plan in the config asks for, by name."""

import re

from ..errors import InputError

KEYS = ("recording", "session", "monitor")  # of the config; any of them asks for the bench and nothing else
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]*")
_PLAN = "capture: {takes: [{recording: tower-1, height: 0.024}, {recording: rest, role: static}, {recording: swing, count: 5}]}"


def takes(config: dict) -> list[dict]:
    """The recordings that a ``config`` asks for, in their order, each with ``recording`` and, where they hold, ``height`` (m) and ``role``.

    Its ``recording`` is a name, several between commas, or a list; with ``count`` the one name becomes name-01, name-02, …; ``session``
    takes those of ``capture.takes``. InputError where a name cannot name a file, or is there twice.
    """
    if config.get("session"):
        if "recording" in config:
            problem = "recordings are named beside it"
            raise InputError("config, key session", problem, "one of the two", "leave one out")
        asked = (config.get("capture") or {}).get("takes") or []
        if not asked:
            problem = "the session has no plan"
            raise InputError("config, key capture.takes", problem, "a list of recordings", f"write {_PLAN}")
        where = "config, key capture.takes"
    else:
        where = "config, key recording"
        said = config["recording"]
        names = [name.strip() for name in said.split(",")] if isinstance(said, str) else [*map(str, said)]
        more = {key: config[key] for key in ("height", "role", "count") if key in config}
        for key in ("height", "count"):
            if key in more and len(names) > 1:
                problem = f"{len(names)} recordings are named"
                raise InputError(f"config, key {key}", problem, f"one recording, with its {key}", "name one")
        asked = [{"recording": name, **more} for name in names]
    found = [one for take in asked for one in _counted(take)]
    for number, take in enumerate(found):
        name = take["recording"]
        if not _NAME.fullmatch(name):
            problem = f"{name!r} cannot name a file" if name else "a name is empty"
            expected = "letters, digits, . _ and -, a letter or digit first"
            raise InputError(where, problem, expected, "choose another name")
        if name in [one["recording"] for one in found[:number]]:
            raise InputError(where, f"{name} is there twice", "a name for each", "choose another name")
    return found


def _counted(take):
    """The recordings of one entry: itself, or as many as its ``count`` says."""
    one = {key: value for key, value in take.items() if key != "count" and value is not None}
    if not (count := take.get("count")):
        return [one]
    digits = max(2, len(str(count)))
    return [{**one, "recording": f"{one['recording']}-{k + 1:0{digits}}"} for k in range(count)]
