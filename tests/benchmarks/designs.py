"""Campaigns of other designs than the trials' through the search: how each ends, whom it names, how long it takes.

``python tests/benchmarks/designs.py DESIGN SEED [KINDS]`` prints a line for each campaign and a summary; KINDS are ``null``,
``single``, ``removed`` (what is hidden is taken out of the catalogue), ``foreign`` and ``pair``, with commas. A design is so many swings of so
many seconds at so many samples a second.
"""

import sys
import time
import warnings
from collections import Counter

from swingdown.discovery.campaign import Swing, campaign
from swingdown.discovery.files import summary
from swingdown.discovery.search import discover
from swingdown.discovery.verdict import verdict
from swingdown.errors import InputError
from swingdown.pendulum.catalogue import SHIPPED
from swingdown.pendulum.model import Model
from swingdown.trials import trial as trials
from swingdown.trials.schedule import Planned, drawn
from swingdown.trials.torques import FOREIGN

DESIGNS = {
    "one": (1, 20.0, 100.0),
    "slow": (1, 20.0, 30.0),
    "two": (2, 20.0, 100.0),
    "four": (4, 10.0, 50.0),
    "six": (6, 20.0, 100.0),
}
RATIO, NULLS = 2.0, 30


def plan(kinds):
    """The trials of these kinds."""
    names, found = trials.hideable(SHIPPED), []
    hidden = {
        "null": [()] * NULLS,
        "single": [(name,) for name in names],
        "removed": [(name,) for name in names],
        "foreign": [(name,) for name in FOREIGN] * 2,
        "pair": trials.PAIRS,
    }
    for kind in kinds:
        for number, one in enumerate(hidden[kind]):
            ratio = 1.0 if kind == "null" else RATIO
            noise = trials.NOISES[len(found) % len(trials.NOISES)]
            found.append(Planned(kind, one, ratio, noise, 4 * number))
    return found


def told(one, allowed):
    """(status, effects with their ties) of a campaign."""
    states = discover(one, Model(trials.BASE), allowed=allowed)
    said = verdict([summary(state, one) for state in states])
    return said["status"], {each["name"]: each["tied_with"] for each in said["effects"]}


def main(design, seed, kinds):
    """Prints a line for each campaign, and how often each kind ended in which way."""
    trials.SWINGS, trials.DURATION, trials.RATE = DESIGNS[design]
    ends, spent = Counter(), []
    for planned in plan(kinds):
        trial = drawn(seed, planned)
        if trial is None:
            continue
        made = [Swing(str(k), *pair) for k, pair in enumerate(trials.swings(trial, seed))]
        allowed = [name for name in SHIPPED.names if planned.kind != "removed" or name not in trial.hidden]
        began = time.process_time()
        try:
            status, effects = told(campaign("one", made), allowed)
        except InputError as problem:
            status, effects = f"refused: {problem.problem}", {}
        spent.append(time.process_time() - began)
        there = all({name, *ties} & set(trial.hidden) for name, ties in effects.items())
        ends[planned.kind, "another named" if effects and not there else status] += 1
        print(trial.name, status, effects, f"{spent[-1]:.1f} s", flush=True)
    for (kind, end), count in sorted(ends.items()):
        print(f"| {design} | {kind} | {end} | {count} |")
    print(f"CPU: median {sorted(spent)[len(spent) // 2]:.1f} s, longest {max(spent):.1f} s")


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    words = sys.argv[1:]
    main(words[0], int(words[1]), (words[2] if words[2:] else "null,single,removed,foreign").split(","))
