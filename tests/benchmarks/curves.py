"""How often the bands of the curves hold the truth: simulated swings with known laws, some that a model of damping does not know.

    .venv/bin/python tests/benchmarks/curves.py [SWINGS [SEED]]

Prints the share of points inside the 95 % band, by curve and by law; the truth is that of the exact model's half-swings. Those of the
models that are fitted are told apart: where the law is among their effects (right), and where it is not (wrong). They are read by a clock
whose rate is wrong within its limits.
"""

import sys
import warnings
from collections import defaultdict

import numpy as np

import swingdown
from swingdown.curves.free import free
from swingdown.curves.modelled import course_of
from swingdown.engine.trajectory import simulate
from swingdown.errors import InputError
from swingdown.measurement.slack import CLOCK_TOLERANCE
from swingdown.pendulum.model import Model
from swingdown.studies.amplitudes import of_samples
from swingdown.studies.quantities import steady

SPEED_ALONE = {"viscous", "quadratic_drag", "constant_coulomb", "stribeck", "power_law_drag"}
LAWS = {
    "viscous": {"viscous_ratio": (0.002, 0.012)},
    "quadratic_drag": {"quadratic_coefficient": (0.005, 0.04)},
    "constant_coulomb": {"constant_friction": (0.02, 0.1)},
    "load_coulomb": {"load_friction": (0.0005, 0.002)},
    "viscous+quadratic_drag": {"viscous_ratio": (0.001, 0.006), "quadratic_coefficient": (0.002, 0.02)},
    "viscous+load_coulomb": {"viscous_ratio": (0.001, 0.006), "load_friction": (0.0002, 0.001)},
    "structural_damping": {"structural_coefficient": (0.2, 1.0)},
    "viscous+stribeck": {"viscous_ratio": (0.001, 0.004), "stribeck_friction": (0.02, 0.08), "stribeck_velocity": (0.3, 1.0)},
    "power_law_drag": {"power_law_coefficient": (0.02, 0.08), "power_law_exponent": (1.3, 2.6)},
    "viscous+eddy_brake": {"viscous_ratio": (0.001, 0.004), "eddy_coefficient": (0.05, 0.2), "eddy_width": (0.1, 0.3)},
    "viscous+torsion_spring": {"viscous_ratio": (0.002, 0.01), "torsion_stiffness": (1.0, 6.0)},
}  # fmt: skip


def draw(rng):
    """A model, times (s) and exact angles (rad) of a swing that is still above the noise at its end."""
    while True:
        label = str(rng.choice(list(LAWS)))
        values = {name: float(np.exp(rng.uniform(*np.log(ends)))) for name, ends in LAWS[label].items()}
        model = Model(label, {"natural_frequency": float(rng.uniform(4, 9)), **values})
        times = np.arange(0, rng.uniform(15, 60), 1 / rng.choice([50, 100, 200]))
        release = float(rng.uniform(0.2, 1.2))
        exact = simulate(model, times, release)
        if np.abs(exact[-200:]).max() > 0.02 * release:
            return model, times, exact


def main(count: int, seed: int) -> None:
    rng, rates = np.random.default_rng(seed), np.random.default_rng([seed, 1])
    held = defaultdict(list)
    for _ in range(count):
        model, times, exact = draw(rng)
        noise = float(np.exp(rng.uniform(np.log(1e-4), np.log(5e-3))))
        measured = exact + noise * rng.standard_normal(times.size)
        of_model(model, times * (1 + CLOCK_TOLERANCE * rates.uniform(-1, 1)), measured, held)
        found = free([of_samples("one", times, measured)])
        at = np.linspace(found.low, found.high, 21)
        loss, period = course_of(steady(model.motion), found.low, found.high).at(at)
        pairs = {"loss": (found.loss_at(at), loss), "period": (found.period_at(at), period)}
        angle = np.linspace(0.05, 1, 20) * found.high
        pairs["restoring"] = found.restoring_at(angle), pull(model, angle)
        if set(model.names) <= SPEED_ALONE:
            speed = (
                np.linspace(0.05, 1, 20) * found.scale * float(found.ideal.speed(np.array([found.high]))[0])
            )
            pairs["friction"] = found.friction_at(speed), drag(model, speed)
        for key, ((value, error, factor), truth) in pairs.items():
            inside = np.abs(value - truth) <= factor * error
            held[key, "all"] += list(inside)
            held[key, model.label] += list(inside)
    for key, inside in sorted(held.items()):
        print(f"{key[0]:14} {key[1]:26} {100 * np.mean(inside):5.1f} % of {len(inside)}")


def of_model(model, times, measured, held):
    """Adds whether the bands of the model that is fitted to a swing hold the truth."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            answer = swingdown.fit(times, measured, unit="rad")
        except InputError as problem:
            print(f"refused, {model.label}: {problem}")
            return
    found = answer.curves().sel(source="model")
    loss, period = course_of(steady(model.motion), *found["amplitude"].values[[0, -1]]).at(
        found["amplitude"].values
    )
    kind = "right" if set(model.names) <= set(answer.label.split("+")) else "wrong"
    truths = {"loss": -np.expm1(-2 * loss), "period": period, "restoring": pull(model, found["angle"].values)}
    truths |= {"damping_ratio": loss / np.hypot(np.pi, loss)}
    if set(model.names) <= SPEED_ALONE:
        truths["friction"] = drag(model, found["speed"].values)
    for name, truth in truths.items():
        inside = (found[f"{name}_low"].values <= truth) & (truth <= found[f"{name}_high"].values)
        first = 3 if name in ("restoring", "friction") else 0  # beside nothing both say nothing
        for of in (kind, "all"):
            held[f"{name}, model", of] += list(inside[first:][np.isfinite(truth[first:])])


def pull(model, angle):
    """The restoring torque (rad/s²)."""
    p = model.values
    return p["natural_frequency"] ** 2 * np.sin(angle) + p.get("torsion_stiffness", 0.0) * angle


def drag(model, speed):
    """The torque (rad/s²) of frictions of speed alone."""
    p, w = model.values, model.values["natural_frequency"]
    found = 2 * p.get("viscous_ratio", 0.0) * w * speed + w * p.get("quadratic_coefficient", 0.0) * speed**2
    found += p.get("constant_friction", 0.0)
    if "stribeck_friction" in p:
        found += p["stribeck_friction"] * np.exp(-speed / p["stribeck_velocity"])
    if "power_law_coefficient" in p:
        found += p["power_law_coefficient"] * speed ** p["power_law_exponent"]
    return found


if __name__ == "__main__":
    given = [int(one) for one in sys.argv[1:]]
    main(*(given + [300, 26][len(given) :]))
