"""The torques that both alternatives try, as functions of angle, velocity and time, each with the effects that it may stand for.

Only torques that are linear in their coefficient are here, as is usual; effects of the sensor and those with a memory of
their own are out of such a library's reach. Where an effect of the sensor is, in its first order, a term of the library,
the term may stand for it as well: a zero that is off is a constant torque, a gain that is off a cubic one.
"""

from typing import NamedTuple

import numpy as np

from swingdown.pendulum.catalogue import SHIPPED


class Point(NamedTuple):
    """Where a torque is computed: arrays of angle (rad), velocity (rad/s) and time (s), the record's duration (s), omega_n (rad/s)."""

    theta: np.ndarray
    thetadot: np.ndarray
    t: np.ndarray
    duration: float
    omega: float

    @property
    def way(self):
        """The direction of motion; between two samples of opposite signs, by the share of the interval on either side."""
        half = np.maximum(np.abs(np.gradient(self.thetadot)) / 2, 1e-12)
        return np.clip(self.thetadot / half, -1, 1)


class Term(NamedTuple):
    """A torque: the effects it may stand for, its columns as a function of a ``Point``, and how many shape parameters were tried.

    ``sign`` is +1 where the catalogue admits only a positive coefficient of the (single) column, 0 where it admits both.
    """

    effects: tuple
    columns: object
    shapes: int = 0
    sign: int = 0


ALIASES = {
    "constant_torque": ("constant_torque", "sensor_zero"),
    "cubic_stiffness": ("cubic_stiffness", "sensor_gain"),
}


def _term(name, columns, shapes=0, sign=None):
    if sign is None:
        sign = int(SHIPPED[name].size.lower >= 0)
    return Term(ALIASES.get(name, (name,)), columns, shapes, sign)


def load_coulomb(p):
    """The base model's dry friction for a coefficient of one, rad/s^2."""
    return -(p.thetadot**2 + p.omega**2 * np.cos(p.theta)) * p.way


def plain():
    """The list of ``Term`` without a shape parameter."""
    return [
        _term("quadratic_drag", lambda p: -p.thetadot * np.abs(p.thetadot)),
        _term("constant_coulomb", lambda p: -p.way),
        _term("structural_damping", lambda p: -np.abs(p.theta) * p.way),
        _term("constant_torque", lambda p: np.ones_like(p.theta)),
        _term("torsion_spring", lambda p: -p.theta),
        _term("cubic_stiffness", lambda p: -(p.theta**3)),
        _term("damping_drift", lambda p: -p.thetadot * p.t / p.duration),
        # -m |thetadot| thetaddot, its acceleration that of the weight alone: the rest is of second order
        _term("added_mass", lambda p: np.abs(p.thetadot) * p.omega**2 * np.sin(p.theta)),
    ]


def shaped():
    """The list of ``Term`` on a grid of shape parameters, one for each value: the fits' own starting grids, a little denser.

    Exponents 1 and 2 and a wind of none are left out, for they are other effects.
    """
    found = [
        _term("stribeck", lambda p, v=v: -np.exp(-np.abs(p.thetadot) / v) * p.way, 1)
        for v in (0.03, 0.06, 0.1, 0.2, 0.3, 0.5, 1.0)
    ]
    found += [
        _term("power_law_drag", lambda p, n=n: -(np.abs(p.thetadot) ** n) * p.way, 1)
        for n in (0.5, 1.3, 1.5, 1.7, 2.5, 2.75, 3.0, 3.5)
    ]
    found += [
        _term("eddy_brake", lambda p, w=w: -np.exp(-((p.theta / w) ** 2)) * p.thetadot, 1)
        for w in (0.05, 0.08, 0.1, 0.15, 0.2, 0.3, 0.4)
    ]
    found += [
        _term("steady_wind", lambda p, u=u: -np.abs(p.thetadot - u) * (p.thetadot - u), 1)
        for u in (-2.0, -1.5, -1.0, -0.5, -0.25, -0.1, 0.1, 0.25, 0.5, 1.0, 1.5, 2.0)
    ]
    found += [
        _term("detent", lambda p, n=n: np.column_stack([np.sin(n * p.theta), np.cos(n * p.theta)]), 1, 0)
        for n in (4, 5, 6, 8, 10, 12, 16, 20, 24)
    ]
    return found
