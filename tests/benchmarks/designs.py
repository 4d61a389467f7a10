"""Campaigns of designs drawn at random through the search: how each ends, what it names, how long it takes.

    .venv/bin/python tests/benchmarks/designs.py SEED COUNT [--first K] [--kinds null,single,removed,foreign,pair] [--swings N] [--rate R]
        [--seconds S] [--samples N] [--no-friction] [--noise slow] [--misfits 0.5,1,2] [--usual]

Campaign K of a seed is always the same: so many swings of so many seconds at so many samples a second, up to an angle between 5 and 90 degrees, under
a weight or a spring, read as an angle or a rate, under white, coloured or stepped noise; half of them with a misfit that has no name.
The search begins with what damps the pendulum, or with a base that is too rich, too poor, or the default one. A line is printed for each
campaign, and at the end how often each kind ended in which way. Without friction viscous drag alone damps the pendulums, so that what rubs is
nothing that the search begins with. All noise may be of one kind: slow noise forgets in a fifth of a second. ``--misfits`` are those drawn from, in
units of the noise; ``--usual`` is the design of ``snakemake hidden_effects``, its own base included.
"""

import argparse
import time
import warnings
from collections import Counter
from contextlib import suppress
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from swingdown.discovery.data.campaign import Swing, campaign
from swingdown.discovery.search import discover
from swingdown.discovery.tell.files import summary
from swingdown.discovery.tell.verdict import verdict
from swingdown.errors import InputError
from swingdown.pendulum.catalogue import SHIPPED
from swingdown.pendulum.model import Model
from swingdown_trials import trial as trials
from swingdown_trials.schedule import Planned, drawn
from swingdown_trials.torques import FOREIGN

KINDS = ("null", "single", "single", "removed", "foreign", "foreign", "pair")
SWINGS, RATES, SECONDS, DEGREES = (1, 2, 4, 6, 12), (10.0, 30.0, 100.0, 1000.0), (10.0, 120.0), (5.0, 90.0)
RATIOS, MISFITS = (1.3, 2.0, 5.0), (0.0, 0.0, 0.0, 0.5, 1.0, 2.0)
BASES = ("own", "own", "default", "rich", "poor")
MOST = 30000  # samples of a campaign
# what takes energy, by the word for it in a verdict
DAMPS = {
    "friction": {"friction_patch", *(name for name in SHIPPED.names if SHIPPED.rubs(name))},
    "drag": {
        "one_sided_drag",
        *(name for name in SHIPPED.names if SHIPPED.damps(name) and not SHIPPED.rubs(name)),
    },
}
NOTHING = 1.1  # times the noise on held-out swings: less is nothing that could tell


class Asked(NamedTuple):
    """A campaign to draw: its design, the trial in it, the misfit beside it, and the base that the search begins with."""

    design: trials.Design
    planned: Planned
    misfit: float
    base: str


def asked(
    seed,
    number,
    kinds=KINDS,
    swings=SWINGS,
    rates=RATES,
    longest=SECONDS[1],
    most=MOST,
    rubs=True,
    misfits=MISFITS,
    usual=False,
):
    """The ``Asked`` of a seed and a number."""
    rng = np.random.default_rng([seed, number])
    while True:
        count, rate = int(rng.choice(swings)), float(rng.choice(rates))
        seconds, degrees = (
            float(np.exp(rng.uniform(*np.log(limits)))) for limits in ((SECONDS[0], longest), DEGREES)
        )
        if count * rate * seconds <= most:
            break
    largest = np.radians(degrees)
    smallest = largest if count == 1 else 0.3 * largest
    design = trials.Design(
        count, seconds, rate, smallest, (largest, largest), str(rng.choice(["sine", "sine", "linear"])),
        str(rng.choice(["angle"] * 4 + ["rate"])), rubs,
    )  # fmt: skip
    design = trials.USUAL if usual else design
    kind = str(rng.choice(kinds))
    names = trials.hideable(SHIPPED, design)
    among = {"null": [()], "foreign": [(name,) for name in FOREIGN]}.get(kind, [(name,) for name in names])
    if kind == "pair":
        among = [pair for pair in trials.PAIRS if set(pair) <= set(names)]
    hidden = among[int(rng.integers(len(among)))]
    ratio = 1.0 if kind == "null" else float(rng.choice(RATIOS))
    planned = Planned(kind, hidden, ratio, str(rng.choice(trials.NOISES)), 4 * number)
    return Asked(design, planned, float(rng.choice(misfits)), "own" if usual else str(rng.choice(BASES)))


def begun(one):
    """(what the search begins with, the effects of the pendulum's own that are hidden by that)."""
    own = one.design.base
    if one.base == "poor":
        return own[:1], own[1:]
    others = {"rich": ("quadratic_drag", "structural_damping"), "default": ("quadratic_drag",)}
    more = [name for name in others.get(one.base, ()) if name not in one.planned.hidden]
    return (*own, *more), ()


def told(one, base, allowed):
    """The verdict of a campaign."""
    return verdict([summary(state, one) for state in discover(one, base, allowed=allowed)], base.catalogue)


def end(said, there, whole=()):
    """How a verdict stands to what is there, in a word: ``named`` all of it alone or in ties, ``partly`` some of it, ``another`` that is not there,
    ``as good`` where that leaves no more than a tenth above the noise, or the status. ``whole`` is all that is there, what has no name in
    the catalogue too: "friction of another law" is one of the frictions among it."""
    status, effects = said["status"], {}
    for each in said["effects"]:
        laws = DAMPS.get(each["damping"], set()) if each["law_open"] else set()
        effects[each["name"]] = {each["name"], *each["tied_with"]}, bool(laws & {*whole})
    if any(not names & there and not another_law for names, another_law in effects.values()):
        return "as good" if said["gap"]["holdout"][-1] < NOTHING else "another"
    if effects:
        found = all(any(name in names for names, _ in effects.values()) for name in there)
        return "named" if found else "partly"
    return status


def main(argv=None):
    """Prints a line for each campaign, and how often each kind ended in which way."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("seed", type=int)
    parser.add_argument("count", type=int)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--kinds", default=",".join(KINDS))
    parser.add_argument("--swings", type=int)
    parser.add_argument("--rate", type=float)
    parser.add_argument("--seconds", type=float, default=SECONDS[1], help="of the longest swing")
    parser.add_argument("--samples", type=int, default=MOST, help="the most of a campaign")
    parser.add_argument("--no-friction", action="store_true")
    parser.add_argument("--misfits", default=",".join(map(str, MISFITS)))
    parser.add_argument("--usual", action="store_true")
    parser.add_argument("--noise", choices=(*trials.NOISES, "slow"))
    given = parser.parse_args(argv)
    swings, rates = (given.swings,) if given.swings else SWINGS, (given.rate,) if given.rate else RATES
    ends, spent = Counter(), []
    for number in range(given.first, given.first + given.count):
        one = asked(
            given.seed, number, given.kinds.split(","), swings, rates, given.seconds, given.samples, not given.no_friction,
            [float(one) for one in given.misfits.split(",")], given.usual,
        )  # fmt: skip
        if given.noise:
            one = one._replace(planned=one.planned._replace(noise=given.noise))
        sized = all(SHIPPED[name].size for name in one.planned.hidden if name in SHIPPED.names)
        trial = drawn(given.seed, one.planned, design=one.design) if sized else None
        made = []
        with suppress(ArithmeticError):  # a motion that leaves what a pendulum does
            if trial is not None and one.misfit:
                trial = trials.with_misfit(trial, given.seed, one.misfit)
            made = [
                Swing(str(k), *pair)
                for k, pair in enumerate(trials.swings(trial, given.seed) if trial else ())
            ]
        if not made:
            continue
        names, lacking = begun(one)
        there = {name for name in (*trial.hidden, *lacking) if name in SHIPPED.names}
        gone = trial.hidden if one.planned.kind == "removed" else ()
        began = time.process_time()
        try:
            base = Model(names, restoring=one.design.restoring).of(one.design.reading)
            allowed = [name for name in base.catalogue.names if name not in gone]
            read = replace(campaign("one", made), reading=one.design.reading)
            said = told(read, base, allowed)
        except InputError as problem:
            said = {"status": f"refused: {problem.problem}", "effects": []}
        spent.append(time.process_time() - began)
        word = end(said, there - set(gone), (*trial.hidden, *trial.beside, *lacking))
        ends[one.planned.kind, "misfit" if one.misfit else "", word] += 1
        d = one.design
        print(
            f"{number} {trial.name} {d.swings} x {d.duration:.0f} s at {d.rate:g}/s to {np.degrees(d.largest[0]):.0f} deg {d.restoring} {d.reading} "
            f"misfit {one.misfit:g} base {one.base}: {said['status']} {[[each['name'], *each['tied_with']] for each in said['effects']]} -> {word}, {spent[-1]:.1f} s", flush=True,
        )  # fmt: skip
    for (kind, misfit, word), count in sorted(ends.items()):
        print(f"| {kind} | {misfit} | {word} | {count} |")
    if spent:
        print(f"CPU: median {np.median(spent):.1f} s, longest {max(spent):.1f} s")


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    main()
