"""The catalogue of effects: one entry in one place gives an effect its equation, parameters, units and reference.

A formula is written in ``theta`` (rad, 0 hanging straight down), ``thetadot`` (rad/s), ``t`` (s since the first
sample), ``duration`` (s, of the record), ``omega_n`` (rad/s) and the effect's own symbols. What it acts on decides
what it means:

- ``torque``: the term is added to the angular acceleration (rad/s^2);
- ``sensor``: the formula is the reading, with ``theta`` the angle (or the reading of the effect before it);
- ``clock``: the formula is the true time of a sample stamped ``t``.
"""

from dataclasses import dataclass
from math import inf, pi

from .errors import InputError

VARIABLES = {"theta": "1", "thetadot": "1/s", "t": "s", "duration": "s", "omega_n": "1/s"}
ACTS_ON = {"torque": "1/s**2", "sensor": "1", "clock": "s"}


@dataclass(frozen=True)
class Parameter:
    """A number an effect has: its name in files, its symbol in formulas, unit, admissible bounds, and typical size."""

    name: str
    symbol: str
    unit: str
    lower: float = -inf
    upper: float = inf
    text: str = ""
    typical: float = 0.01


@dataclass(frozen=True)
class Effect:
    """One physical effect: its term, where it acts, its parameters, and where it comes from.

    ``printed`` is the term as the paper prints it, where that differs from the dimensionally consistent form.
    """

    name: str
    term: str
    parameters: tuple[Parameter, ...]
    explanation: str
    reference: str
    acts_on: str = "torque"
    printed: str | None = None
    symbol: str = ""

    def expression(self, form="consistent"):
        """The term as a sympy expression in the chosen form (``consistent`` or ``printed``)."""
        from . import formula  # here, because sympy takes half a second and only a changed catalogue needs it

        text = self.printed if form == "printed" and self.printed else self.term
        names = (*VARIABLES, *(parameter.symbol for parameter in self.parameters))
        return formula.parse(text, names, where=f"effect {self.name}")


NATURAL_FREQUENCY = Parameter(
    "natural_frequency", "omega_n", "rad/s", 0.0, inf, "of small undamped swings, sqrt(m g r / I)"
)

_PAPER = "Petrushenko and Khasawneh, IMECE 2017"

GRAVITY = {
    "sine": Effect("gravity", "-omega_n**2*sin(theta)", (), "Weight pulls back with the sine of the angle.", f"{_PAPER}, Eq. 2"),
    "linear": Effect("gravity_linear", "-omega_n**2*theta", (), "Small-angle weight.", f"{_PAPER}, Eq. 3"),
}

_ENTRIES = (
    Effect(
        "viscous",
        "-2*zeta_v*omega_n*thetadot",
        (Parameter("viscous_ratio", "zeta_v", "1", 0.0, inf, "fraction of critical damping"),),
        "A drag that grows with speed, as in a slow fluid: each swing loses the same share of its amplitude.",
        f"{_PAPER}, Table 1",
        symbol="v",
    ),
    Effect(
        "quadratic_drag",
        "-omega_n*zeta_q*thetadot*abs(thetadot)",
        (Parameter("quadratic_coefficient", "zeta_q", "s", 0.0, inf, "drag over inertia, divided by omega_n"),),
        "Air drag at speed: it grows with the square of the velocity, so large swings die faster than small ones.",
        f"{_PAPER}, Table 1",
        symbol="q",
    ),
    Effect(
        "load_coulomb",
        "-gamma*(thetadot**2 + omega_n**2*cos(theta))*sign(thetadot)",
        (Parameter("load_friction", "gamma", "1", 0.0, inf, "friction coefficient times bearing radius over length"),),
        "Dry bearing friction in proportion to the pull of the rod, which is largest at the bottom of a fast swing.",
        f"{_PAPER}, Table 1, with the powers of omega_n that its units need",
        printed="-omega_n*gamma*(thetadot**2 + cos(theta))*sign(thetadot)",
        symbol="c",
    ),
    Effect(
        "constant_coulomb",
        "-c*sign(thetadot)",
        (Parameter("constant_friction", "c", "rad/s^2", 0.0, inf, "friction torque over inertia"),),
        "Dry friction of one size whatever the load: the amplitude falls by the same angle each swing.",
        "Squire, Am. J. Phys. 54, 984 (1986)",
        symbol="k",
    ),
    Effect(
        "structural_damping",
        "-h*abs(theta)*sign(thetadot)",
        (Parameter("structural_coefficient", "h", "1/s^2", 0.0, inf, "loss torque per radian over inertia"),),
        "Material that is bent loses the same share of its energy each cycle, however slow the cycle.",
        "Crandall, J. Sound Vib. 11, 3 (1970)",
    ),
    Effect(
        "constant_torque",
        "tau_0",
        (Parameter("constant_torque", "tau_0", "rad/s^2", -inf, inf, "steady torque over inertia"),),
        "A steady push to one side: the swing's middle is not where the pendulum would hang.",
        "any mechanics text",
    ),
    Effect(
        "cubic_stiffness",
        "-k_3*theta**3",
        (Parameter("cubic_stiffness", "k_3", "1/s^2", -inf, inf, "cubic restoring torque over inertia"),),
        "A spring that stiffens (or softens) with angle: the period changes with amplitude.",
        "Nayfeh and Mook, Nonlinear Oscillations (1979)",
    ),
    Effect(
        "base_vibration",
        "A*cos(theta)*cos(2*pi*f*t + phi)",
        (
            Parameter("vibration_acceleration", "A", "rad/s^2", 0.0, inf, "amplitude of pivot acceleration over length"),
            Parameter("vibration_frequency", "f", "Hz", 0.0, inf, "of the pivot's motion"),
            Parameter("vibration_phase", "phi", "rad", -pi, pi, "at the first sample"),
        ),
        "The table shakes sideways at one frequency.",
        "any mechanics text",
    ),
    Effect(
        "sensor_zero",
        "theta + b",
        (Parameter("sensor_zero", "b", "rad", -inf, inf, "reading at rest"),),
        "The sensor does not read zero when the pendulum hangs straight down.",
        "JCGM 200:2012, 4.20",
        acts_on="sensor",
    ),
    Effect(
        "clock_drift",
        "t + d*t**2/duration",
        (Parameter("clock_drift", "d", "1", -0.2, 0.2, "relative change of the clock's rate over half the record"),),
        "The recorder's clock runs faster and faster (or slower and slower).",
        "any metrology text",
        acts_on="clock",
    ),
)
CATALOGUE = {effect.name: effect for effect in _ENTRIES}


def effect(name):
    """The catalogue's entry of that name; InputError with the known names otherwise."""
    if name not in CATALOGUE:
        raise InputError(f"effect {name!r}", "no such effect in the catalogue", ", ".join(CATALOGUE))
    return CATALOGUE[name]
