"""How often the swing that a verdict asks for tells two effects apart: truths that small swings leave tied, in simulation.

    .venv/bin/python tests/benchmarks/next_swing.py [--draws 4]

Each draw takes two swings of 0.2 and 0.3 rad with white noise of 1 mrad, fits the true model and a rival, lets the rule choose a swing,
adds one such swing made by the second pendulum (which shares no code with the engine), and fits both again. Only draws whose
evidence differs by less than 10 before are ties, and only swings predicted to be worth five standard deviations are asked for (else a
verdict tells what the catalogue has); told is how many of these differ by more than 10 after, the right way round.
"""

import argparse

import numpy as np

from swingdown.discovery.campaign import Noise, Swing, campaign
from swingdown.discovery.next_swing import next_swing
from swingdown.discovery.ranking import TIE, evidence
from swingdown.fitting.least_squares import fit_jointly
from swingdown.pendulum.model import Model
from swingdown.trials.second_pendulum import trajectory

NOISE = Noise(1e-3)  # rad
TIMES = np.arange(0, 15, 0.02)  # s
APART = 5.0  # standard deviations, as in discovery/verdict.py
BASE = ("viscous", "load_coulomb")
COMMON = {"natural_frequency": 7.0, "viscous_ratio": 0.006, "load_friction": 0.002}
# hidden, its value, rival
PAIRS = [
    ("quadratic_drag", {"quadratic_coefficient": 0.003}, "damping_drift"),
    ("cubic_stiffness", {"cubic_stiffness": 1.0}, "quadratic_stiffness"),
    ("quadratic_stiffness", {"quadratic_stiffness": 0.3}, "cubic_stiffness"),
    ("structural_damping", {"structural_coefficient": 0.15}, "quadratic_drag"),
    ("torsion_spring", {"torsion_stiffness": 1.0}, "cubic_stiffness"),
]


def swing(rng, name, values, angle, times):
    """One swing of the second pendulum with noise."""
    reading = trajectory((*BASE, name), COMMON | values, times, angle).reading
    return Swing(f"{angle:.3g}", times, reading + NOISE.deviation * rng.standard_normal(times.size))


def fits(swings, *names):
    """The fits of the base with each of the effects."""
    return [fit_jointly(Model((*BASE, name)), [one.pair for one in swings], bounded=True) for name in names]


def main():
    """A line for each draw, and the share of ties that the swing asked for tells apart."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--draws", type=int, default=4)
    ties = told = 0
    for number in range(parser.parse_args().draws):
        for name, values, rival in PAIRS:
            rng = np.random.default_rng([number, *map(ord, name)])
            small = [swing(rng, name, values, angle, TIMES) for angle in (0.3, -0.2)]
            true, other = fits(small, name, rival)
            before = evidence(other, NOISE) - evidence(true, NOISE)
            if abs(before) >= TIE:
                print(f"{name} against {rival}: no tie ({before:.3g})", flush=True)
                continue
            asked = next_swing(true, other, campaign("tie", small), NOISE)
            if asked.separation < APART:
                print(f"{name} against {rival}: no swing tells ({asked.separation:.2g})", flush=True)
                continue
            times = np.arange(0, asked.duration, 0.02)
            more = [*small, swing(rng, name, values, asked.release_angle, times)]
            after = np.subtract(*[evidence(one, NOISE) for one in fits(more, rival, name)])
            ties, told = ties + 1, told + (after > TIE)
            print(f"{name} against {rival}: {before:.3g}; {asked} Then {after:.3g}", flush=True)
    print(f"{told} of {ties} ties told apart by the swing that was asked for")


if __name__ == "__main__":
    main()
