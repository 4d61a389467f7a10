"""Torques that the place alone decides: weight, springs, magnets, a steady push."""

from math import inf, pi

from ..effect import Contained, Effect, Parameter
from .sources import MECHANICS, PAPER

GRAVITY = {
    "sine": Effect(
        "gravity",
        "-omega_n**2*sin(theta)",
        (),
        "Weight pulls back with the sine of the angle.",
        f"{PAPER}, Eq. 2",
    ),
    "linear": Effect("gravity_linear", "-omega_n**2*theta", (), "Small-angle weight.", f"{PAPER}, Eq. 3"),
}
RESTORING = (
    Effect(
        "constant_torque",
        "tau_0",
        (Parameter("constant_torque", "tau_0", "rad/s^2", -inf, inf, "steady torque over inertia", 0.3),),
        "A steady push to one side: the swing's middle is not where the pendulum would hang. Dry friction that is larger one way "
        "than the other is this torque beside the mean of both.",
        MECHANICS,
        told_apart={
            "sensor_zero": "Read the angle at rest, turn the pendulum's mount end for end, and read it again: a torque stays, a wrong zero turns.",
            "steady_wind": "Repeat with the pendulum shielded from the air: a torque stays.",
        },
    ),
    Effect(
        "torsion_spring",
        "-k_t*theta",
        (Parameter("torsion_stiffness", "k_t", "1/s^2", 0.0, inf, "spring torque per radian over inertia", 2.0),),
        "A wire or clamp at the pivot pulls back in proportion to the angle.",
        MECHANICS,
        told_apart={
            "sensor_gain": "Read the sensor at rest at two known angles: only a wrong gain shows there."
        },
    ),
    Effect(
        "quadratic_stiffness",
        "-k_2*theta*abs(theta)",
        (Parameter("quadratic_stiffness", "k_2", "1/s^2", -inf, inf, "quadratic restoring torque over inertia, odd in the angle", 1.0),),
        "A spring that stiffens, or softens, from the smallest angles on, as a wound or bent one does: the period changes in "
        "proportion to the amplitude.",
        MECHANICS,
        told_apart={
            "cubic_stiffness": "Release from a quarter, from half and from the whole of the largest angle: the period changes with the amplitude, or with its square.",
            "presliding": "Sample swings of less than 1°, and let one die out: friction that winds up shortens the period there as it takes energy, a spring takes none.",
        },
    ),
    Effect(
        "cubic_stiffness",
        "-k_3*theta**3",
        (Parameter("cubic_stiffness", "k_3", "1/s^2", -inf, inf, "cubic restoring torque over inertia", 1.0),),
        "A spring that stiffens (or softens) with angle: the period changes with amplitude.",
        MECHANICS,
        told_apart={
            "torsion_spring": "Release from below 5° and from as far as the apparatus allows: a spring shifts the period of both, a cubic one only of the large swing.",
            "sensor_gain": "Read the sensor at rest at two known angles: only a wrong gain shows there.",
        },
    ),
    Effect(
        "detent",
        "k_d*sin(n_d*theta + phi_d)",
        (
            Parameter("detent_torque", "k_d", "rad/s^2", 0.0, inf, "amplitude over inertia", 0.2),
            Parameter(
                "detent_order", "n_d", "1", 4.0, inf, "teeth or magnet poles a turn", 12.0,
                role="shape", starts=(4.0, 5.0, 6.0, 8.0, 12.0, 16.0, 24.0), drawn=(4, 5, 6, 8, 12, 16),
            ),
            Parameter("detent_phase", "phi_d", "rad", -2 * pi, 2 * pi, "at the bottom", 0.5, role="phase"),
        ),
        "Magnets or gear teeth at the shaft pull toward evenly spaced angles.",
        "Hanselman, Brushless Permanent Magnet Motor Design (2003), on cogging",
        # within a fraction of a tooth, and beside the natural frequency, which takes up what is linear
        contains=(
            Contained("constant_torque", {"detent_phase": pi / 2}),
            Contained("cubic_stiffness", {"detent_phase": 0.0}),
            Contained("torsion_spring", {"detent_phase": pi}),
        ),
        headline=("detent_torque", "detent_order"),
    ),
    Effect(
        "magnet",
        # by its depth: swings that rush past feel this alone, and leave pull and width open
        "-2*u_m*theta/w_m**2*exp(-(theta/w_m)**2)",
        (
            Parameter("magnet_depth", "u_m", "1/s^2", -inf, inf, "energy it holds the bob with over inertia; below 0 it repels", 0.1),
            Parameter(
                "magnet_width", "w_m", "rad", 0.02, inf, "angle over which the magnet reaches", 0.15,
                role="shape", starts=(0.05, 0.1, 0.2, 0.4), drawn=(0.06, 0.3),
            ),
        ),
        "A magnet near the bottom pulls the bob toward it, or pushes it away, and only there: small swings run early, or late, "
        "and a strong one that repels leaves the bob at rest on one side.",
        "Moon and Holmes, J. Sound Vib. 65, 275 (1979)",
        contains=(Contained("torsion_spring", {"magnet_width": inf}),),
        told_apart={
            "torsion_spring": "Release from below 5° and from as far as the apparatus allows: a spring shifts the period of both, a magnet only that of the small swing.",
            "cubic_stiffness": "Release from below 5° and from as far as the apparatus allows: a magnet shifts the period of the small swing, a cubic spring that of the large one.",
            "quadratic_stiffness": "Release from a quarter, from half and from the whole of the largest angle: beyond a magnet's reach the period comes back to that of the weight alone.",
            "detent": "Turn the pendulum by a right angle at its mount: a magnet below stays at the bottom, poles and teeth turn along.",
        },
        headline=("magnet_depth", "magnet_width"),
    ),
    Effect(
        "finite_amplitude",
        "-omega_n**2*(sin(theta) - theta)",
        (),
        "The weight pulls back with the sine of the angle, not with the angle: large swings take longer.",
        f"{PAPER}, Eq. 2 against Eq. 3; for models with linear restoring torque only",
        beside="linear",
    ),
)  # fmt: skip
