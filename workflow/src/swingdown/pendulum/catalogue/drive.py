"""What the surroundings do to the swing: a stand that gives way, a table that shakes, air that moves, and time."""

from math import inf, pi

from ..effect import Contained, Effect, Parameter, StandIn, State
from .sources import MECHANICS

DRIVE = (
    Effect(
        "flexible_pivot",
        "-cos(theta)*(mu*thetadot**2*sin(theta) - 2*zeta_2*omega_2*w - omega_2**2*q)",
        (
            Parameter("pivot_mass_ratio", "mu", "1", 0.0, 0.9, "bob over bob and support", 0.02, largest=0.4),
            Parameter(
                "pivot_frequency", "omega_2", "rad/s", 0.1, inf, "of the support on its own", 30.0,
                role="shape", starts=(1.7, 2.7, 4.0, 6.5), relative=True, drawn=(14.0, 45.0),
            ),
            Parameter(
                "pivot_damping_ratio", "zeta_2", "1", 0.0, 1.0, "of the support", 0.05,
                role="shape", starts=(0.02, 0.2), drawn=(0.02, 0.2),
            ),
        ),
        "The stand gives way and swings along: it carries energy off and shifts the period.",
        "Bacon and Nguyen, Am. J. Phys. 73 (2005); Nayfeh and Mook (1979)",
        inertia="-mu*cos(theta)**2",
        states=(
            State("q", "1", "0", "w", "displacement of the pivot over the length"),
            State(
                "w",
                "1/s",
                "0",
                "mu*thetadot**2*sin(theta) - 2*zeta_2*omega_2*w - omega_2**2*q - mu*cos(theta)*thetaddot",
                "its velocity over the length",
            ),
        ),
        headline=("pivot_mass_ratio", "pivot_frequency"),
    ),
    Effect(
        "base_vibration",
        "A*cos(theta)*cos(2*pi*f*t + phi)",
        (
            Parameter("vibration_acceleration", "A", "rad/s^2", 0.0, inf, "amplitude of pivot acceleration over length", 0.3),
            Parameter(
                "vibration_frequency", "f", "Hz", 0.0, inf, "of the pivot's motion", 3.0,
                role="shape", at_line=True,
                # A drive so near resonance, with a phase for each recording, takes up any error of the pendulum's own
                # motion; large swings are slower.
                apart_from_swing=(0.75, 1.2),
                drawn=((0.3, 0.55), (1.8, 6.0)),
            ),
            Parameter("vibration_phase", "phi", "rad", -2 * pi, 2 * pi, "at the first sample", 0.5, role="phase", each=True),
        ),
        "The table shakes sideways at one frequency.",
        MECHANICS,
        headline=("vibration_acceleration", "vibration_frequency"),
    ),
    Effect(
        "damping_drift",
        "-2*zeta_d*omega_n*thetadot*t/duration",
        (Parameter("damping_drift", "zeta_d", "1", -inf, inf, "change of the viscous ratio over the longest record", 0.003),),
        "The damping changes while the pendulum swings: a bearing warms up, a draught sets in.",
        MECHANICS,
    ),
    Effect(
        "steady_wind",
        "-omega_n*zeta_w*abs(thetadot - u)*(thetadot - u)",
        (
            Parameter("wind_coefficient", "zeta_w", "s", 0.0, inf, "drag over inertia, divided by omega_n", 0.02),
            Parameter(
                "wind_speed", "u", "rad/s", -inf, inf, "of the air at the bob, over the length", 0.5,
                role="shape", starts=(-2.0, -0.5, -0.1, 0.1, 0.5, 2.0), drawn=((-1.5, -0.2), (0.2, 1.5)),
            ),
        ),
        "Air that moves past the pendulum drags one way harder than the other.",
        MECHANICS,
        # in a storm, beside a steady push
        contains=(Contained("quadratic_drag", {"wind_speed": 0.0}), Contained("viscous", {"wind_speed": inf})),
        replaces=(
            StandIn("quadratic_drag", tuple(
                {"wind_coefficient": "abs(zeta_q) + 1e-4", "wind_speed": speed} for speed in ("-0.3", "0.3")
            )),
        ),
        headline=("wind_coefficient", "wind_speed"),
    ),
)  # fmt: skip
