"""How often the stated uncertainties of period, quality and decay time hold the truth where nobody knows the law of damping.

    .venv/bin/python tests/benchmarks/everyday.py [COUNT] [--seed SEED] [--truth NAME …] [--verdict | --parameters]

Prints a table in Markdown. Each recording is one swing of its own pendulum: sizes of damping, frequency, release, length of the record
(10 to 60 s), rate (30 to 100 a second), noise, clock and zero are drawn; ``--verdict`` asks ``explain``, not the first answer. A value is inside where
the truth is within 1.96 stated standard uncertainties; ``wide`` is the median of the stated uncertainty over the value, and ``pull`` the
RMS of what is off, in stated uncertainties. ``--parameters`` prints how often two standard uncertainties of a law's own parameters hold the truth, by
whether the law that is named is right, and how often it is where its probability is told as so much.
"""

import argparse
import warnings

import numpy as np

import swingdown
from swingdown.engine.trajectory import TrajectoryError, TrajectoryWarning, simulate
from swingdown.errors import InputError
from swingdown.pendulum.catalogue import catalogue
from swingdown.pendulum.model import Model
from swingdown.studies.quantities import quantities, steady

ASKED = ("natural_frequency", "period", "quality", "decay_time")
TRIO = ("viscous", "quadratic_drag", "load_coulomb")
# beside the trio, sizes drawn between these, uniform in the logarithm
SIZES = {
    "viscous_ratio": (5e-4, 1e-2),
    "quadratic_coefficient": (5e-4, 2e-2),
    "load_friction": (2e-5, 1e-3),
    "power_law_coefficient": (1e-2, 1e-1),
    "power_law_exponent": (1.2, 1.9),
    "structural_coefficient": (3e-2, 5e-1),
    "presliding_friction": (5e-3, 5e-2),
    "presliding_angle": (5e-3, 5e-2),
    "stribeck_friction": (2e-3, 3e-2),
    "stribeck_velocity": (5e-2, 5e-1),
    "eddy_coefficient": (2e-2, 2e-1),
    "eddy_width": (6e-2, 3e-1),
    "added_mass": (2e-3, 3e-2),
    "cubic_stiffness": (1e-1, 3e0),
    "quadratic_stiffness": (3e-2, 1e0),
    "magnet_depth": (3e-3, 1e-1),
    "magnet_width": (6e-2, 3e-1),
    "side_friction_c": (1e-2, 3e-1),
    "flap_c": (2e-2, 2e-1),
}
TRUTHS = {
    "one to three of the trio": TRIO,
    "a power law": ("power_law_drag",),
    "structural damping": ("structural_damping",),
    "viscous drag, and friction before sliding": ("viscous", "presliding"),
}
# of each a part that no law of the list has; the first four are those that the free course was made with
FOREIGN = {
    "quadratic, and friction before sliding": ("quadratic_drag", "presliding"),
    "structural and load Coulomb": ("structural_damping", "load_coulomb"),
    "viscous and Stribeck": ("viscous", "stribeck"),
    "viscous, load Coulomb and a spring that stiffens": ("viscous", "load_coulomb", "cubic_stiffness"),
    "a power law and load Coulomb": ("power_law_drag", "load_coulomb"),
    "viscous and a magnet's brake": ("viscous", "eddy_brake"),
    "viscous, quadratic and air that is dragged along": ("viscous", "quadratic_drag", "added_mass"),
    "viscous, quadratic and a wound spring": ("viscous", "quadratic_drag", "quadratic_stiffness"),
    "load Coulomb and a magnet that pulls": ("load_coulomb", "magnet"),
    "viscous, and friction that grows outward": ("viscous", "side_friction"),
    "load Coulomb, and a drag that grows outward": ("load_coulomb", "flap"),
}
OWN = {  # no effects of the catalogue
    "side_friction": {
        "torque": "-c*theta**2*sign(thetadot)",
        "parameters": {"c": {"unit": "1/s^2", "lower": 0.0}},
    },
    "flap": {"torque": "-c*abs(theta)*thetadot", "parameters": {"c": {"unit": "1/s", "lower": 0.0}}},
}
CLOCK = 5e-5  # share by which a recorder's seconds may be wrong
ZERO = 0.03  # rad; by so much the zero may be off


def drawn(draws, effects):
    """Return a model of the effects (of the trio one to three) with values, its times, release (rad) and noise (rad)."""
    if effects is TRIO:
        effects = draws.permutation(TRIO)[: draws.integers(1, 4)]
    known = catalogue(OWN)
    names = Model(tuple(effects), catalogue=known).parameters
    values = {"natural_frequency": draws.uniform(3, 8)}
    for name in names[1:]:
        low, high = np.log(SIZES[name])
        values[name] = float(np.exp(draws.uniform(low, high)))
    times = np.arange(0, draws.uniform(10, 60), 1 / draws.uniform(30, 100))
    return (
        Model(tuple(effects), values, catalogue=known),
        times,
        draws.uniform(0.15, 0.9),
        10 ** draws.uniform(-3.3, -2.3),
    )


def told(times, angle, verdict):
    """Return the quantities that are stated, by name, and the amplitude (rad) that they hold at."""
    if not verdict:
        answer = swingdown.fit(times, angle, unit="rad")
        return answer.quantities, float(answer.table["amplitude_rad"].iloc[0])
    answer = swingdown.explain(times, angle, unit="rad")
    found = answer.verdict["conclusion"]
    if found is None:
        raise TrajectoryError("no model follows the whole")
    return {
        name: swingdown.Quantity(one["value"], one["standard_uncertainty"], one["unit"])
        for name, one in found["quantities"].items()
    }, found["amplitude_rad"]


def pulls(truth, count, draws, verdict):
    """Return the pulls and the relative stated uncertainties of each quantity, (count, asked), and how many recordings gave no answer."""
    rows, silent = [], 0
    while len(rows) + silent < count:
        model, times, release, noise = drawn(draws, (TRUTHS | FOREIGN)[truth])
        angle = (
            simulate(model, times, release)
            + draws.uniform(-ZERO, ZERO)
            + noise * draws.standard_normal(times.size)
        )
        try:
            found, amplitude = told(times * (1 + draws.uniform(-CLOCK, CLOCK)), angle, verdict)
        except (InputError, TrajectoryError):
            silent += 1
            continue
        right = quantities(steady(model), amplitude, None)
        row = []
        for name in ASKED:
            one = found.get(name)
            value, u = (np.nan, np.nan) if one is None else (one.value, one.uncertainty)
            row.append(
                ((np.nan if value is None else value) - right[name].value, u or np.nan, right[name].value)
            )
        rows.append(row)
    off, u, value = np.moveaxis(np.array(rows, dtype=float), -1, 0)
    return off / u, u / value, silent


def of_parameters(truth, count, draws):
    """Prints what first answers say of the parameters of the law that they name, and how often that law is right."""
    chances, held = [], {True: [], False: []}
    for _ in range(count):
        model, times, release, noise = drawn(draws, (TRUTHS | FOREIGN)[truth])
        angle = simulate(model, times, release) + noise * draws.standard_normal(times.size)
        try:
            answer = swingdown.fit(times, angle, unit="rad")
        except (InputError, TrajectoryError):
            continue
        chance = float(answer.row.get("model_probability", np.nan))
        if not np.isfinite(chance):
            continue
        right = answer.label == model.label
        chances.append((chance, right))
        for name in set(answer.model.parameters[1:]) & set(answer.quantities):
            value, u, _ = answer.quantities[name]
            held[right].append(abs(value - model.values.get(name, 0.0)) <= 2 * u)
    for right, inside in held.items():
        print(f"{truth}, law {'right' if right else 'wrong'}: {100 * np.mean(inside):.1f} % of {len(inside)}")
    told, right = np.array(chances).T
    for low, high in ((0.0, 0.5), (0.5, 0.8), (0.8, 0.95), (0.95, 1.1)):
        of = (told >= low) & (told < high)
        print(
            f"P {low} to {min(high, 1.0)}: told {told[of].mean():.2f}, right {right[of].mean():.2f} of {of.sum()}"
        )


def main(argv=None):
    """The table printed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("count", nargs="?", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--truth", nargs="*", default=list(TRUTHS), choices=[*TRUTHS, *FOREIGN])
    parser.add_argument("--foreign", action="store_true", help="the kinds that no law of the list has")
    parser.add_argument("--verdict", action="store_true")
    parser.add_argument("--parameters", action="store_true")
    given = parser.parse_args(argv)
    if given.parameters:
        for k, truth in enumerate(given.truth):
            of_parameters(truth, given.count, np.random.default_rng([given.seed, k]))
        return
    print(
        "| damping | answered | "
        + " | ".join(f"{name.replace('_', ' ')}: inside, wide, pull" for name in ASKED)
        + " |"
    )
    print("|---" * (2 + len(ASKED)) + "|")
    for truth in FOREIGN if given.foreign else given.truth:
        pull, wide, silent = pulls(truth, given.count, np.random.default_rng(given.seed), given.verdict)
        cells = []
        for k in range(len(ASKED)):
            there = np.isfinite(pull[:, k])
            inside = 100 * np.mean(np.abs(pull[there, k]) <= 1.96)
            cells.append(
                f"{inside:.1f} %, {np.median(wide[there, k]):.1e}, {np.sqrt(np.mean(pull[there, k] ** 2)):.2g} ({there.sum()})"
            )
        print(f"| {truth} | {len(pull)} of {len(pull) + silent} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    warnings.simplefilter("ignore", TrajectoryWarning)
    main()
