"""The second pendulum's torques, written by hand: of the catalogue's effects, and of those that it lacks on purpose.

What the foreign ones leave must be called unknown.
"""

from dataclasses import dataclass, field
from math import cos, exp, pi, sin


@dataclass(frozen=True)
class Foreign:
    """An effect that no catalogue has: its parameters, the first one its size, where the others are drawn, its usual size.

    ``beyond`` gives a parameter as another one and a distance.
    """

    parameters: tuple
    drawn: dict
    typical: float = 0.1
    beyond: dict = field(default_factory=dict)


FOREIGN = {
    # 1; drag in the square of the speed on one side of the middle only
    "one_sided_drag": Foreign(("one_sided_drag",), {}),
    # rad/s^2, rad, rad; a dirty part of the shaft
    "friction_patch": Foreign(
        ("patch_friction", "patch_from", "patch_to"),
        {"patch_from": (-0.1, 0.1)},
        beyond={"patch_to": ("patch_from", 0.15)},
    ),
    # 1/s^2, rad; a buffer that large swings touch on one side
    "soft_stop": Foreign(("stop_stiffness", "stop_from"), {"stop_from": (0.15, 0.35)}, typical=5.0),
}


def _load_coulomb(one, t, th, v, s, kinks):
    p, w = one.p, one.p["natural_frequency"]
    if one.form == "printed":
        return -s * w * p["load_friction"] * (v * v + cos(th))
    return -s * p["load_friction"] * (v * v + w * w * cos(th))


def _stribeck(one, t, th, v, s, kinks):
    return -s * one.p["stribeck_friction"] * exp(min(-s * v / one.p["stribeck_velocity"], 30.0))


def _power_law(one, t, th, v, s, kinks):
    return -s * one.p["power_law_coefficient"] * max(s * v, 0.0) ** one.p["power_law_exponent"]


def _vibration(one, t, th, v, s, kinks):
    p = one.p
    drive = cos(2 * pi * p["vibration_frequency"] * t + p["vibration_phase"])
    return p["vibration_acceleration"] * cos(th) * drive


def _wind(one, t, th, v, s, kinks):
    against = v - one.p["wind_speed"]
    return -one.p["natural_frequency"] * one.p["wind_coefficient"] * kinks["wind"] * against * against


def _detent(one, t, th, v, s, kinks):
    return one.p["detent_torque"] * sin(one.p["detent_order"] * th + one.p["detent_phase"])


def _magnet(one, t, th, v, s, kinks):
    reach = th / one.p["magnet_width"]
    return -2 * one.p["magnet_depth"] / one.p["magnet_width"] * reach * exp(-reach * reach)


def _eddy(one, t, th, v, s, kinks):
    return -one.p["eddy_coefficient"] * exp(-((th / one.p["eddy_width"]) ** 2)) * v


def _drift(one, t, th, v, s, kinks):
    return -2 * one.p["damping_drift"] * one.p["natural_frequency"] * v * t / one.duration


def _patch(one, t, th, v, s, kinks):
    return -s * one.p["patch_friction"] if kinks["patch_from"] * kinks["patch_to"] < 0 else 0.0


def _stop(one, t, th, v, s, kinks):
    return -one.p["stop_stiffness"] * (th - one.p["stop_from"]) if kinks["stop"] > 0 else 0.0


# The torque of each effect by name: of the pendulum, time, angle, velocity, its frozen sign, and the frozen kinks. Effects that
# act on inertia, support, sensor or clock are in ``Pendulum``, ``trajectory`` and ``_read``.
TORQUES = {
    "viscous": lambda one, t, th, v, s, kinks: -2 * one.p["viscous_ratio"] * one.p["natural_frequency"] * v,
    "quadratic_drag": lambda one, t, th, v, s, kinks: (
        -s * one.p["natural_frequency"] * one.p["quadratic_coefficient"] * v * v
    ),
    "load_coulomb": _load_coulomb,
    "constant_coulomb": lambda one, t, th, v, s, kinks: -s * one.p["constant_friction"],
    "stribeck": _stribeck,
    "presliding": lambda one, t, th, v, s, kinks: -one.dahl(s, th),
    "power_law_drag": _power_law,
    "structural_damping": lambda one, t, th, v, s, kinks: (
        -s * one.p["structural_coefficient"] * kinks["angle"] * th
    ),
    "eddy_brake": _eddy,
    "constant_torque": lambda one, t, th, v, s, kinks: one.p["constant_torque"],
    "torsion_spring": lambda one, t, th, v, s, kinks: -one.p["torsion_stiffness"] * th,
    "quadratic_stiffness": lambda one, t, th, v, s, kinks: (
        -one.p["quadratic_stiffness"] * kinks["angle"] * th * th
    ),
    "cubic_stiffness": lambda one, t, th, v, s, kinks: -one.p["cubic_stiffness"] * th * th * th,
    "detent": _detent,
    "magnet": _magnet,
    "base_vibration": _vibration,
    "damping_drift": _drift,
    "steady_wind": _wind,
    "finite_amplitude": lambda one, t, th, v, s, kinks: one.p["natural_frequency"] ** 2 * (th - sin(th)),
    "one_sided_drag": lambda one, t, th, v, s, kinks: (
        -one.p["one_sided_drag"] * s * v * v if kinks["side"] > 0 else 0.0
    ),
    "friction_patch": _patch,
    "soft_stop": _stop,
}
KNOWN = frozenset(TORQUES) | {
    "added_mass", "flexible_pivot", "backlash", "sensor_lag", "eccentricity", "sensor_gain", "sensor_curvature", "sensor_zero", "clock_drift",
}  # fmt: skip


def of_twin(torque):
    """A catalogue entry's own twin, which knows nothing of a ``Pendulum``."""
    return lambda one, t, th, v, s, kinks: torque(t, th, v, s, one.p, one.duration)
