"""What the sensor makes of the angle, in the order in which it acts: play, lag, eccentricity, gain, zero."""

from dataclasses import replace
from math import inf, pi

from ..effect import Contained, Effect, Parameter, State
from .sources import METROLOGY

# A pendulum that is let go was held, and the reading had come to the angle; one that swings already is followed steadily, at its
# natural frequency. Which of the two a recording begins with is told by its velocity. One that was let go a quarter of a swing before its
# first sample is not followed steadily yet.
_SETTLED = (
    "theta - (tau_l*thetadot + theta*tau_l**2*omega_n**2*thetadot**4/(thetadot**4 + (omega_n*theta/4)**4 + 1e-24*omega_n**4)"
    " + w_l*thetadot*tau_l**2*omega_n*exp(-pi/(2*omega_n*tau_l)))/(1 + tau_l**2*omega_n**2)"
)

SENSOR = (
    Effect(
        "backlash",
        "w_p",
        (Parameter("backlash_width", "w_p", "rad", 0.0, pi, "of the dead band", 0.005, largest=0.2),),
        "The sensor's coupling has play: at each turning point it waits before it follows.",
        "Visintin, Differential Models of Hysteresis (1994), the play operator",
        acts_on="play",
    ),
    Effect(
        "sensor_lag",
        "y_l",
        (
            Parameter("lag_time", "tau_l", "s", 1e-5, inf, "time constant", 0.01),
            Parameter(
                "lag_start", "w_l", "1", -3.0, 3.0, "of recordings: 0 begins in a steady swing, 1 a quarter of a swing after the release",
                0.5, role="start",
            ),
        ),
        "The sensor answers late, as through a filter.",
        METROLOGY,
        acts_on="sensor",
        states=(State("y_l", "rad", _SETTLED, "(theta - y_l)/tau_l", "reading of the slow sensor"),),
    ),
    Effect(
        "eccentricity",
        "theta + a_e*sin(theta + phi_e)",
        (
            Parameter(
                "eccentricity", "a_e", "rad", 0.0, 1.0, "amplitude of the error a turn; beyond 1 rad it would run back", 0.01,
                largest=0.3,
            ),
            Parameter("eccentricity_phase", "phi_e", "rad", -2 * pi, 2 * pi, "at the bottom", 0.8, role="phase"),
        ),
        "The encoder's disc is off centre: it reads ahead on one side and behind on the other.",
        METROLOGY,
        acts_on="sensor",
        contains=(
            Contained("sensor_zero", {"eccentricity_phase": pi / 2}),
            Contained("sensor_gain", {"eccentricity_phase": 0.0}),
        ),
        told_apart={
            "sensor_gain": "Read the sensor at rest at known angles on both sides.",
            "sensor_zero": "Read the sensor at rest at known angles on both sides.",
        },
        reading_error="abs(a_e)",
    ),
    Effect(
        "sensor_gain",
        "(1 + g_s)*theta",
        (Parameter("sensor_gain", "g_s", "1", -0.5, 0.5, "relative error of the sensitivity", largest=0.3),),
        "The sensor reads every angle too large, or too small, by the same share.",
        METROLOGY,
        acts_on="sensor",
        reading_error="abs(g_s)*largest_angle",
    ),
    Effect(
        "sensor_curvature",
        "theta + c_s*theta**2",
        (
            Parameter("sensor_curvature", "c_s", "1/rad", -0.3, 0.3, "relative change of the sensitivity with angle", largest=0.1),
        ),
        "The sensor's line is bent: it reads more a radian on one side than on the other.",
        METROLOGY,
        acts_on="sensor",
        told_apart={
            "sensor_zero": "Read the sensor at rest at known angles on both sides.",
            "constant_torque": "Read the sensor at rest at known angles on both sides.",
        },
        reading_error="abs(c_s)*largest_angle**2",
    ),
    Effect(
        "sensor_zero",
        "theta + b_s",
        (Parameter("sensor_zero", "b_s", "rad", -inf, inf, "reading at rest"),),
        "The sensor does not read zero when the pendulum hangs straight down.",
        METROLOGY,
        acts_on="sensor",
        reading_error="abs(b_s)",
    ),
)  # fmt: skip

_OF_ANGLES = {effect.name: effect for effect in SENSOR}
GYROSCOPE = (
    replace(
        _OF_ANGLES["sensor_gain"], explanation="The gyroscope reads every rate too large, or too small, by the same share."
    ),
    replace(
        _OF_ANGLES["sensor_zero"],
        parameters=(Parameter("sensor_zero", "b_s", "rad/s", -inf, inf, "reading at rest"),),
        explanation="The gyroscope does not read zero when the pendulum is at rest.",
    ),
)  # fmt: skip
"""What a gyroscope makes of the angular velocity: gain, then zero; play, lag, eccentricity and curvature are an angle sensor's."""
