"""How often an effect that is hidden in swings with holes is named, beside the same swings without holes.

    .venv/bin/python tests/benchmarks/holes.py [SEEDS]

Prints a table in Markdown: campaigns of ``tests/discovery/test_frozen.py`` in which an effect of the
catalogue is hidden, each drawn with SEEDS noises. The second pendulum makes the swings; what is lost is left out of the same readings.
An effect is found where the verdict asserts it, or one tied with it, and nothing else beside it.
"""

import sys
import warnings
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "discovery"))
from test_frozen import CAMPAIGNS, DURATION, NOISE, RATE, VALUES

import swingdown
from swingdown.engine.trajectory import TrajectoryWarning
from swingdown_trials.second_pendulum import BELOW_NOISE, trajectory

BURST = 40  # samples: 0.8 s, most of a period
WAYS = {  # share that is missing, samples of a hole, noise over that of the campaigns
    "without holes": (0.0, 1, 1.0),
    "without holes, noise 12 % larger": (0.0, 1, 0.8**-0.5),  # tells as much as with a fifth missing
    "5 % missing at random": (0.05, 1, 1.0),
    "20 % missing at random": (0.2, 1, 1.0),
    f"20 % missing in bursts of {BURST}": (0.2, BURST, 1.0),
}
NAMED = [
    name for name, (hidden, _, releases, special) in CAMPAIGNS.items() if hidden and len(releases) > 1 and not special and "no catalogue" not in name and "hardly" not in name
]  # fmt: skip


def kept(draws, size, share, burst):
    """Which samples are there: the first and the last, and all but a share lost in bursts."""
    found = np.ones(size, dtype=bool)
    while np.count_nonzero(~found) < share * size:
        at = draws.integers(1, size - burst - 1)
        found[at : at + burst] = False
    return found


def found(name, motions, seed, share, burst, larger):
    """Whether the effects hidden in a campaign are found, and whether each is so alone, tied with none."""
    hidden = set(CAMPAIGNS[name][0])
    times = np.arange(DURATION * RATE + 1) / RATE
    noise, holes = np.random.default_rng((28, seed)), np.random.default_rng((29, seed))
    swings = [motion + larger * NOISE * noise.standard_normal(times.size) for motion in motions]
    there = [kept(holes, times.size, share, burst) for _ in swings]
    told = swingdown.explain(
        [times[one] for one in there], [swing[one] for swing, one in zip(swings, there, strict=True)],
        unit="rad", fitted=("viscous", "quadratic_drag"),
    ).verdict  # fmt: skip
    named = [{one["name"], *one["tied_with"]} for one in told["effects"]]
    right = (
        len(named) == len(hidden)
        and all(one & hidden for one in named)
        and hidden <= set().union(*named)
        and told["status"] in ("named", "ambiguous")
    )
    return right, right and told["status"] == "named"


def main(seeds):
    """The table."""
    warnings.simplefilter("ignore", TrajectoryWarning)
    right = {way: [] for way in WAYS}
    for name in NAMED:
        hidden, values, releases, _ = CAMPAIGNS[name]
        times = np.arange(DURATION * RATE + 1) / RATE
        motions = [
            trajectory(("viscous", "load_coulomb", *hidden), VALUES | values, times, one, restoring="sine", reading="angle", accuracy=BELOW_NOISE).reading
            for one in releases
        ]  # fmt: skip
        for seed in range(seeds):
            for way, settings in WAYS.items():
                right[way].append(found(name, motions, seed, *settings))
            print(f"    {name} {seed}: {[one[-1] for one in right.values()]}", file=sys.stderr, flush=True)
    print("| holes | campaigns | found | … each alone |\n|---|---|---|---|")
    for way, each in right.items():
        whole, alone = np.sum(each, axis=0)
        print(f"| {way} | {len(each)} | {whole} | {alone} |")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 5)
