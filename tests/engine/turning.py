"""Turning points of pendulums with known laws, by scipy from one half-swing to the next: nothing of the engine is in them."""

import numpy as np
from scipy.integrate import solve_ivp


def turning_points(values, amplitude, count):
    """Times (s) and angles (rad) of the release at rest and the turning points after it, ``count`` in all; fewer where it stops.

    ``values``: natural_frequency, and any of viscous_ratio, quadratic_coefficient, load_friction.
    """
    omega = values["natural_frequency"]
    viscous, drag, load = (
        values.get(name, 0.0) for name in ("viscous_ratio", "quadratic_coefficient", "load_friction")
    )

    def half_swing(_, state):  # from the positive side down; the other way it is the mirror image
        angle, speed = state
        friction = load * (speed**2 + omega**2 * np.cos(angle))
        return speed, -(omega**2) * np.sin(
            angle
        ) - 2 * viscous * omega * speed + omega * drag * speed**2 + friction

    def turns(_, state):
        return state[1]

    turns.terminal, turns.direction = True, 1
    times, angles = [0.0], [amplitude]
    for _ in range(count - 1):
        size = abs(angles[-1])
        if load * np.cos(size) >= np.sin(size):
            break
        start = (size, -1e-12 * omega)
        done = solve_ivp(half_swing, (0, 40 / omega), start, "DOP853", events=turns, rtol=1e-10, atol=1e-12)
        end = done.y_events[0][-1][0]
        times.append(times[-1] + done.t_events[0][-1])
        angles.append(-np.sign(angles[-1]) * abs(end))
    return np.array(times), np.array(angles)


def drawn(draws):
    """A pendulum's values, its turning points (times, angles), and the standard deviations (s, rad) to read them with."""
    law = draws.choice(
        ["viscous_ratio", "quadratic_coefficient", "load_friction", "viscous_ratio load_friction"]
    ).split()
    omega, amplitude, count = draws.uniform(2, 10), draws.uniform(0.1, 1.2), int(draws.integers(14, 60))
    lost = amplitude * draws.uniform(0.3, 0.8) / count / len(law)
    middle = 0.75 * amplitude
    sizes = {
        "viscous_ratio": lost / (np.pi * middle),
        "quadratic_coefficient": 3 * lost / (4 * middle**2 * omega),
        "load_friction": lost / 2,
    }
    values = {"natural_frequency": omega} | {name: sizes[name] for name in law}
    deviations = 2 * np.pi / omega * 10 ** draws.uniform(-3, -1.7), amplitude * 10 ** draws.uniform(-3, -1.7)
    return values, turning_points(values, amplitude, count), deviations
