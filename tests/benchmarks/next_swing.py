"""How often the experiments that a verdict asks for leave only the true name: ties, in simulation.

    OPENBLAS_NUM_THREADS=1 .venv/bin/python tests/benchmarks/next_swing.py [--draws 4] [--seed 2026] [--wide] [--only cubic_stiffness]

Each draw takes three swings of about 0.25 rad with noise of 1 mrad (white, coloured, or steps and little else, in turn), fits the true
model and its rivals, and lets the rule choose an experiment between the two best. It is done with the second pendulum (which shares no
code with the engine): swings are fitted with the others; readings of the pendulum held at known angles, each wrong by up to what is stated,
add what either fit leaves of them. With ``--wide`` the swings are those of a campaign of ``snakemake hidden_effects`` (six, out to 0.8 to
1.05 rad, noise of 1 to 3 mrad) whose effect leaves 1.15 times the noise. Only draws in which the true name is within 10 of the best and
not alone there are ties, and only experiments that are predicted to be worth five standard deviations are done. Told by pair: ties, those
for which an experiment was found, those after which only the true name is within 10 of the best, and wrong ones; and the CPU time that it
takes to find an experiment.
"""

import argparse
import time
from collections import Counter

import numpy as np
from scipy.signal import lfilter

from swingdown.discovery.data.campaign import Swing, campaign
from swingdown.discovery.data.noise import Noise
from swingdown.discovery.move.evidence import TIE, evidence
from swingdown.discovery.next.duel import misfit
from swingdown.discovery.next.experiments import Held
from swingdown.discovery.next.proposal import APART, next_swing
from swingdown.engine.trajectory import TrajectoryError
from swingdown.fitting.least_squares import fit_jointly
from swingdown.pendulum.model import Model
from swingdown_trials.second_pendulum import trajectory
from swingdown_trials.trial import NOISES, USUAL, Planned, draw

DEVIATION, INTERVAL, DURATION = 1e-3, 0.02, 15.0  # rad, s, s
RATIO = 1.15  # of what the base leaves of wide swings to the noise
ASKED = 3  # experiments, one after the other
BASE = ("viscous", "load_coulomb")
COMMON = {"natural_frequency": 7.0, "viscous_ratio": 0.006, "load_friction": 0.002}
# base, hidden, its values (the first the size), rivals
CASES = [
    (BASE, "constant_torque", {"constant_torque": 0.2}, ("sensor_zero",)),
    (BASE, "sensor_zero", {"sensor_zero": 0.004}, ("constant_torque",)),
    (BASE, "sensor_gain", {"sensor_gain": 0.08}, ("cubic_stiffness", "torsion_spring")),
    (BASE, "cubic_stiffness", {"cubic_stiffness": 1.2}, ("sensor_gain", "torsion_spring")),
    (BASE, "torsion_spring", {"torsion_stiffness": 8.0}, ("cubic_stiffness", "sensor_gain")),
    (BASE, "quadratic_stiffness", {"quadratic_stiffness": 0.3}, ("cubic_stiffness",)),
    (BASE, "cubic_stiffness", {"cubic_stiffness": 1.0}, ("quadratic_stiffness",)),
    (BASE, "eccentricity", {"eccentricity": 0.01, "eccentricity_phase": 1.2}, ("sensor_zero",)),
    (BASE, "sensor_zero", {"sensor_zero": 0.002}, ("eccentricity",)),
    (BASE, "quadratic_drag", {"quadratic_coefficient": 0.0012}, ("damping_drift",)),
    (BASE, "quadratic_drag", {"quadratic_coefficient": 0.004}, ("power_law_drag",)),
    (BASE, "structural_damping", {"structural_coefficient": 0.6}, ("quadratic_drag",)),
    (BASE, "magnet", {"magnet_depth": 0.004, "magnet_width": 0.15}, ("torsion_spring", "quadratic_stiffness")),
    (BASE, "damping_drift", {"damping_drift": 0.0012}, ("quadratic_drag",)),
    (BASE, "added_mass", {"added_mass": 0.01}, ("quadratic_stiffness",)),
    (("viscous",), "load_coulomb", {"load_friction": 0.002}, ("constant_coulomb",)),
    (("viscous",), "constant_coulomb", {"constant_friction": 0.1}, ("load_coulomb",)),
    (("load_coulomb",), "viscous", {"viscous_ratio": 0.001}, ("structural_damping",)),
]  # fmt: skip
IN_PLACE = {"load_coulomb", "constant_coulomb", "viscous"}  # of what every pendulum has


class Bench:
    """One pendulum of the second kind, read with one kind of noise; what was recorded so far, and what readings leave of a fit."""

    def __init__(self, rng, base, hidden, values, kind):
        self.rng, self.base, self.effects, self.kind = rng, base, (*base, hidden), kind
        self.values, self.deviation, self.interval, self.held = values, DEVIATION, INTERVAL, []
        self.swings = []

    @property
    def noise(self):
        """The noise as a search knows it."""
        return Noise(self.deviation, 0.5 if self.kind == "coloured" else 0.0)

    @classmethod
    def small(cls, rng, base, hidden, values, kind):
        """Three small swings."""
        size = next(iter(values))
        drawn = {name: value * rng.uniform(0.8, 1.25) for name, value in COMMON.items()} | values
        one = cls(rng, base, hidden, drawn | {size: values[size] * rng.uniform(0.7, 1.4)}, kind)
        one.swings = [
            one.swing(angle, 0.0, DURATION) for angle in (0.26, -0.25, 0.25) * rng.uniform(0.95, 1.05, 3)
        ]
        return one

    @classmethod
    def wide(cls, rng, base, hidden, kind, seed, number):
        """The swings of a trial."""
        trial = draw(seed, Planned("single", (hidden,), RATIO, kind, number))
        one = cls(rng, base, hidden, trial.values, kind)
        one.deviation, one.interval = trial.sigma, 1 / USUAL.rate
        one.swings = [one.swing(*release, 20.0) for release in trial.releases]
        return one

    def read(self, clean):
        """A clean reading with the sensor's noise."""
        white = self.rng.standard_normal(clean.size + 100)
        if self.kind == "coloured":
            white = lfilter([np.sqrt(0.75)], [1, -0.5], white)
        if self.kind == "steps":
            step = 2 * self.deviation
            return step * np.round((clean + self.deviation * np.sqrt(1 - 4 / 12) * white[100:]) / step)
        return clean + self.deviation * white[100:]

    def swing(self, angle, velocity, duration):
        """A swing with noise."""
        times = np.arange(0, duration, self.interval)
        clean = trajectory(self.effects, self.values, times, angle, velocity).reading
        return Swing(f"{self.rng.random()}", times, self.read(clean))

    def do(self, asked):
        """The experiment done as often as it is asked for."""
        if asked.kind != "held":
            self.swings += [
                self.swing(asked.release_angle, asked.release_velocity, asked.duration)
                for _ in range(asked.times)
            ]
            return
        vertical, samples = self.rng.uniform(-asked.limit, asked.limit), round(asked.duration / self.interval)
        readings = []
        for angle in asked.angles:
            true = angle + vertical + self.rng.uniform(-asked.limit, asked.limit)
            clean = trajectory(self.effects, self.values, [0.0, self.interval], true).reading[0]
            readings.append(np.mean(self.read(np.full(samples, clean))))
        step = 2 * self.deviation if self.kind == "steps" else 0.0
        self.held.append(
            (Held(asked.angles, "", asked.limit, samples, self.interval, step), np.array(readings))
        )

    def judged(self, names):
        """By effect its fit and evidence."""
        found = {}
        for name in names:
            fit = fit_jointly(Model((*self.base, name)), [one.pair for one in self.swings], bounded=True)
            told = evidence(fit, self.noise) + sum(misfit(fit, *one, self.noise) for one in self.held)
            found[name] = (fit, told)
        return found

    def seen(self, told):
        """True where the evidence ``told`` for the hidden effect is better than without it, where there can be none."""
        if self.effects[-1] in IN_PLACE:
            return True
        fit = fit_jointly(Model(self.base), [one.pair for one in self.swings], bounded=True)
        return evidence(fit, self.noise) - told > TIE


def played(bench, hidden, rivals, seconds):
    """What became of one draw: ``no tie``, ``no experiment``, ``told`` by the first, ``told later``, ``not told`` or ``wrong``; and how.
    The CPU seconds of each choice are added to ``seconds``."""
    how = []
    for number in range(ASKED + 1):
        try:
            found = bench.judged((hidden, *rivals))
        except TrajectoryError as problem:
            return "not told", [*how, str(problem)]
        best = min(told for _, told in found.values())
        if number == 0 and not bench.seen(found[hidden][1]):
            return "no tie", ["nothing is seen"]
        order = sorted(
            (name for name, (_, told) in found.items() if told - best < TIE), key=lambda name: found[name][1]
        )
        how.append("/".join(f"{name} {found[name][1] - best:.2g}" for name in order))
        if hidden not in order:
            return ("no tie" if number == 0 else "wrong"), how
        if len(order) == 1:
            return ("no tie", "told", "told later", "told later")[number], how
        if number == ASKED:
            return "not told", how
        begun = time.process_time()
        asked = next_swing(found[order[0]][0], found[order[1]][0], campaign("tie", bench.swings), bench.noise)
        seconds.append(time.process_time() - begun)
        how.append(str(asked))
        if asked.separation < APART:
            return ("no experiment" if number == 0 else "not told"), how
        bench.do(asked)
    raise AssertionError


def main():
    """A line for each draw, the counts of each pair, and those of all."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--draws", type=int, default=4)
    parser.add_argument("--seed", type=int, default=2026)
    parser.add_argument("--wide", action="store_true")
    parser.add_argument("--only", default="")
    given = parser.parse_args()
    counts, seconds = {}, []
    for base, hidden, values, rivals in CASES:
        pair = f"{hidden} | {', '.join(rivals)}"
        if given.only not in pair or (given.wide and hidden in IN_PLACE):
            continue
        for number in range(given.draws):
            rng = np.random.default_rng([given.seed, number, *map(ord, pair)])
            kind = NOISES[number % len(NOISES)]
            if given.wide:
                try:
                    bench = Bench.wide(rng, base, hidden, kind, given.seed, number)
                except ArithmeticError as problem:
                    print(f"{pair}, {kind}: not drawn: {problem}")
                    continue
            else:
                bench = Bench.small(rng, base, hidden, values, kind)
            end, how = played(bench, hidden, rivals, seconds)
            counts.setdefault(pair, Counter())[end] += 1
            print(f"{pair}, {kind}: {end}: {'; '.join(how)}", flush=True)
    counts["all"] = sum(counts.values(), Counter())
    for pair, each in counts.items():
        ties = each.total() - each["no tie"]
        print(f"{pair}: {ties} ties, {ties - each['no experiment']} asked, {each['told']} told by the first experiment, "
              f"{each['told later']} by a later one, {each['not told']} not, {each['wrong']} wrong")  # fmt: skip
    print(f"CPU time of a choice: median {np.median(seconds):.2g} s, at most {max(seconds):.2g} s")


if __name__ == "__main__":
    main()
