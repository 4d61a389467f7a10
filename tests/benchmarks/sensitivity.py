"""How many verdicts change where a number of the search is halved, and where it is doubled, as a table in Markdown.

    .venv/bin/python tests/benchmarks/sensitivity.py [--only TEXT ...] [--campaigns TEXT ...] [--pickles FOLDER]

``CRITERION`` has the numbers that decide (discovery/criterion.py), ``SETTINGS`` every numerical setting of the search by which a verdict could change: whole
numbers at least 1, shares at most 0.999. The campaigns are the frozen ones (tests/discovery/test_frozen.py), and those of others that
``labelled.py --pickles`` wrote to FOLDER. A verdict has changed where another effect is asserted, alone or in ties, or the status is another.
``_FEW`` and the like stand in signatures as well: both are changed.
"""

import argparse
import importlib
import pickle
import sys
import warnings
from dataclasses import fields, replace
from functools import partial
from pathlib import Path

from swingdown.discovery import criterion as rules
from swingdown.discovery.data.campaign import Swing, campaign
from swingdown.discovery.search import discover
from swingdown.discovery.tell.files import summary
from swingdown.discovery.tell.verdict import verdict
from swingdown.pendulum.model import BASES, Model

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "discovery"))
from test_frozen import CAMPAIGNS, swings

SETTINGS = {
    "criterion": ("CLEAR",),
    "data.noise": ("_FORGETS", "_APART", "FINEST"),
    "judge.structures": ("_COUNTS",),
    "see.friction": ("_ANGLES", "_EACH"),
    "see.envelope": ("_NODES",),
    "see.discrepancy": ("_BINS", "_SEEN", "_NOISE_KNOWN"),
    "see.kinds": ("_ANGLES", "_SPEEDS", "_TIMES", "SMOOTH", "_KEPT", "_FINE"),
    "see.restricted": ("_ANY",),
    "search": ("_AGAIN",),
    "move.admissible": ("_VAGUE", "_HOPELESS", "_CHANCE"),
    "move.ranking": ("_PROMISING", "_FIRST", "_FEW", "_LED", "_MORE", "_FAR", "_FELL_SHORT", "_SHAPES"),
    "move.evidence": ("TIE",),
    "move.candidates": ("WIDEST", "_FIRST"),
    "move.mimics": ("_ALIKE",),
    "move.own_frequency": ("_SUBSTANTIAL", "_FEWEST"),
    "move.refit": ("_BETTER",),
}  # fmt: skip
CRITERION = [one.name for one in fields(rules.USUAL)]
SHARES = {"probable", "_ALIKE"}  # below 1: what they leave of 1 is halved and doubled
RATIOS = {"_FELL_SHORT"}  # above 1: what they have beyond 1 is


def scaled(name, value, factor):
    """Return a setting times a factor, of its own kind."""
    if isinstance(value, tuple):
        return tuple(scaled(name, one, factor) for one in value)
    if name in SHARES:
        return 1 - (1 - value) * factor
    if name in RATIOS:
        return 1 + (value - 1) * factor
    return max(1, round(value * factor)) if isinstance(value, int) else value * factor


def changed(module, name, factor):
    """Return the call that puts everything back; a setting is another until then, wherever it was imported and in functions' defaults."""
    value = getattr(module, name)
    other = scaled(name, value, factor)
    holders = [module, *(one for one in _rooms() if module is rules and name in vars(one))]
    functions = [
        one
        for holder in holders
        for one in vars(holder).values()
        if getattr(one, "__defaults__", None) and value in one.__defaults__
    ]
    kept = [one.__defaults__ for one in functions]
    for holder in holders:
        setattr(holder, name, other)
        _forget(holder)
    if name.startswith("_") and isinstance(value, int):
        for one in functions:
            one.__defaults__ = tuple(other if each is value else each for each in one.__defaults__)

    def back():
        for holder in holders:
            setattr(holder, name, value)
            _forget(holder)
        for one, defaults in zip(functions, kept, strict=True):
            one.__defaults__ = defaults

    return back


def _rooms():
    """The modules of the search, that import the numbers which decide."""
    return [one for name, one in list(sys.modules.items()) if name.startswith(f"{rules.__package__}.")]


def _forget(module):
    """What a module keeps was computed with its other settings."""
    for one in vars(module).values():
        if hasattr(one, "cache_clear"):
            one.cache_clear()


def told(one, base, rounds=4, criterion=rules.USUAL):
    """Return what is compared of a campaign's verdict."""
    states = discover(one, base, rounds, criterion=criterion)
    found = verdict([summary(state, one) for state in states], base.catalogue)
    return found["status"], {each["name"]: tuple(each["tied_with"]) for each in found["effects"]}


def frozen(hidden, values, releases, special):
    """Return the campaign and the base of a frozen one."""
    pairs = zip(*swings(hidden, values, releases, **special), strict=True)
    one = campaign("frozen", [Swing(str(k), *pair) for k, pair in enumerate(pairs)])
    reading, restoring = special.get("reading", "angle"), special.get("restoring", "sine")
    base = Model(BASES[restoring], restoring=restoring).of(reading)
    object.__setattr__(one, "reading", reading)
    return one, base, special.get("rounds", 4)


def labelled(path):
    """Return the campaign and the base of one that labelled.py wrote."""
    _, _, base, restoring, *_ = pickle.loads(path.with_name(path.name.replace(".campaign", "")).read_bytes())
    return pickle.loads(path.read_bytes()), Model(base, restoring=restoring), 4


def main(argv=None):
    """The table printed, a line a setting."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--only", nargs="*", default=[""], help="settings whose module.name holds one of these texts"
    )
    parser.add_argument(
        "--campaigns", nargs="*", default=[""], help="campaigns whose name holds one of these texts"
    )
    parser.add_argument("--pickles", type=Path)
    given = parser.parse_args(argv)

    def asked(room, names):
        """Those of a room's settings that are wanted."""
        return [name for name in names if any(text in f"{room}.{name}" for text in given.only)]

    makers = {name: partial(frozen, *parts) for name, parts in CAMPAIGNS.items()}
    if given.pickles:
        makers |= {
            path.name.split(".")[0]: partial(labelled, path)
            for path in sorted(given.pickles.glob("*.campaign.pkl"))
        }
    made = {name: make() for name, make in makers.items() if any(text in name for text in given.campaigns)}
    usual = {name: told(*one) for name, one in made.items()}
    print(f"| setting | is | halved | doubled | of {len(made)} verdicts |\n|---|---|---|---|---|", flush=True)

    def row(name, is_now, tried):
        """One line: how many verdicts change with half the setting, and with twice, and whose."""
        cells = [[one for one in made if now[one] != usual[one]] for now in tried]
        which = ", ".join(dict.fromkeys([*cells[0], *cells[1]]))
        print(f"| `{name}` | {is_now} | {len(cells[0])} | {len(cells[1])} | {which} |", flush=True)

    def all_told(**options):
        return {one: told(*parts, **options) for one, parts in made.items()}

    for name in asked("criterion", CRITERION):
        is_now = getattr(rules.USUAL, name)
        others = [replace(rules.USUAL, **{name: scaled(name, is_now, factor)}) for factor in (0.5, 2)]
        row(f"criterion.{name}", is_now, [all_told(criterion=other) for other in others])
    for room, names in SETTINGS.items():
        module = importlib.import_module(f"swingdown.discovery.{room}")
        for name in asked(room, names):
            is_now, tried = getattr(module, name), []
            for factor in (0.5, 2):
                back = changed(module, name, factor)
                try:
                    tried.append(all_told())
                finally:
                    back()
            row(f"{room}.{name}", is_now, tried)


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    main()
