"""The catalogue of effects: one entry in one place gives an effect its equation, parameters, units and reference.

A formula is written in ``theta`` (rad, 0 hanging straight down), ``thetadot`` (rad/s), ``t`` (s since the first
sample), ``duration`` (s, of the record), ``omega_n`` (rad/s), the effect's own symbols and its own states. What it
acts on decides what its term means:

- ``torque``: added to the angular acceleration (rad/s^2);
- ``sensor``: the reading, with ``theta`` the angle (or the reading of the sensor effect before it in the catalogue);
- ``play``: the width of a dead band between angle and reading (rad);
- ``clock``: the true time of a sample stamped ``t`` (s).

``inertia`` is a fraction added to the pendulum's own: theta'' = sum of torques / (1 + sum of inertias). A state has a
first-order equation of motion of its own, which may also use ``thetaddot``.
"""

from dataclasses import dataclass
from math import inf, pi
from typing import NamedTuple

from ..errors import InputError

VARIABLES = {"theta": "1", "thetadot": "1/s", "t": "s", "duration": "s", "omega_n": "1/s"}
TERM_UNITS = {"torque": "1/s**2", "sensor": "1", "play": "1", "clock": "s"}


class Parameter(NamedTuple):
    """A number an effect has: its name in files, its symbol in formulas, unit, admissible bounds, and typical size.

    ``grid`` holds values to start a fit from where the effect's shape depends on the parameter (empty for those in
    which it is linear); ``phase`` marks an angle that turns a sine into a cosine; ``own`` one that each recording has
    for itself, such as a phase at its first sample.
    """

    name: str
    symbol: str
    unit: str
    lower: float = -inf
    upper: float = inf
    text: str = ""
    typical: float = 0.01
    grid: tuple = ()
    phase: bool = False
    own: bool = False

    @property
    def least(self):
        """The value below which there is no such effect, or none the engine can follow: a lower bound above zero."""
        return self.lower if self.lower > 0 else -inf


class State(NamedTuple):
    """A quantity with a memory: symbol, unit, its value at the release and its rate of change, as formulas."""

    symbol: str
    unit: str
    initial: str
    rate: str
    text: str = ""


class Formulas(NamedTuple):
    """An effect's formulas as sympy expressions: torque and inertia, rates and initial values of states, the reading."""

    motion: dict
    rates: tuple
    initial: tuple
    reading: object


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
    inertia: str | None = None
    states: tuple[State, ...] = ()
    symbol: str = ""

    def expressions(self, form="consistent"):
        """The ``Formulas`` in the chosen form (``consistent`` or ``printed``); InputError where one cannot be read."""
        from . import formula  # here, because sympy takes half a second and only a changed catalogue needs it

        names = (*VARIABLES, *(p.symbol for p in self.parameters), *(state.symbol for state in self.states))

        def read(text, *more):
            return formula.parse(text, (*names, *more), where=f"effect {self.name}")

        term = read(self.printed if form == "printed" and self.printed else self.term)
        motion = {"torque": term} if self.acts_on == "torque" else {}
        if self.inertia:
            motion["inertia"] = read(self.inertia)
        rates = tuple(read(state.rate, "thetaddot") for state in self.states)
        initial = tuple(read(state.initial) for state in self.states)
        return Formulas(motion, rates, initial, term if self.acts_on in ("sensor", "clock") else None)


NATURAL_FREQUENCY = Parameter(
    "natural_frequency", "omega_n", "rad/s", 0.0, inf, "of small undamped swings, sqrt(m g r / I)", 7.0
)

_PAPER = "Petrushenko and Khasawneh, IMECE 2017"
_COULOMB = "Squire, Am. J. Phys. 54, 984 (1986)"
_MECHANICS = "Nayfeh and Mook, Nonlinear Oscillations (1979)"
_METROLOGY = "JCGM 200:2012 (International vocabulary of metrology)"

GRAVITY = {
    "sine": Effect(
        "gravity",
        "-omega_n**2*sin(theta)",
        (),
        "Weight pulls back with the sine of the angle.",
        f"{_PAPER}, Eq. 2",
    ),
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
        (
            Parameter(
                "quadratic_coefficient",
                "zeta_q",
                "s",
                0.0,
                inf,
                "drag over inertia, divided by omega_n",
                0.02,
            ),
        ),
        "Air drag at speed: it grows with the square of the velocity, so large swings die faster than small ones.",
        f"{_PAPER}, Table 1",
        symbol="q",
    ),
    Effect(
        "load_coulomb",
        "-gamma*(thetadot**2 + omega_n**2*cos(theta))*sign(thetadot)",
        (
            Parameter(
                "load_friction",
                "gamma",
                "1",
                0.0,
                inf,
                "friction coefficient times bearing radius over length",
                0.005,
            ),
        ),
        "Dry bearing friction in proportion to the pull of the rod, which is largest at the bottom of a fast swing.",
        f"{_PAPER}, Table 1, with the powers of omega_n that its units need",
        printed="-omega_n*gamma*(thetadot**2 + cos(theta))*sign(thetadot)",
        symbol="c",
    ),
    Effect(
        "constant_coulomb",
        "-c*sign(thetadot)",
        (Parameter("constant_friction", "c", "rad/s^2", 0.0, inf, "friction torque over inertia", 0.2),),
        "Dry friction of one size whatever the load: the amplitude falls by the same angle each swing.",
        _COULOMB,
        symbol="k",
    ),
    Effect(
        "stribeck",
        "-s*exp(-abs(thetadot)/v_s)*sign(thetadot)",
        (
            Parameter(
                "stribeck_friction", "s", "rad/s^2", 0.0, inf, "extra friction at the slowest motion", 0.2
            ),
            Parameter(
                "stribeck_velocity",
                "v_s",
                "rad/s",
                1e-3,
                inf,
                "velocity at which it has fallen to 1/e",
                0.3,
                grid=(0.03, 0.1, 0.3, 1.0),
            ),
        ),
        "A lubricated bearing holds harder when it turns slowly: extra friction near each turning point.",
        "Armstrong-Helouvry et al., Automatica 30, 1083 (1994)",
    ),
    Effect(
        "presliding",
        "-F",
        (
            Parameter(
                "presliding_friction",
                "F_c",
                "rad/s^2",
                0.0,
                inf,
                "friction once it slides, over inertia",
                0.2,
            ),
            Parameter(
                "presliding_angle",
                "x_c",
                "rad",
                1e-5,
                inf,
                "angle over which friction builds up",
                0.01,
                grid=(0.001, 0.003, 0.01, 0.03),
            ),
        ),
        "Dry friction that first bends like a spring: near each turning point the bearing winds up before it slides, "
        "so small swings run early.",
        "Dahl, Aerospace Corporation TOR-0158 (1968)",
        states=(
            State(
                "F", "rad/s^2", "0", "(F_c - F*sign(thetadot))*thetadot/x_c", "friction torque over inertia"
            ),
        ),
    ),
    Effect(
        "power_law_drag",
        "-d*abs(thetadot)**n*sign(thetadot)",
        (
            Parameter("power_law_coefficient", "d", "rad/s^2", 0.0, inf, "drag over inertia at 1 rad/s", 0.1),
            Parameter(
                "power_law_exponent",
                "n",
                "1",
                0.2,
                4.0,
                "1 is viscous, 2 quadratic",
                1.5,
                grid=(0.5, 1.5, 2.5, 3.0),
            ),
        ),
        "A drag between slow-fluid and fast-fluid, with its own exponent.",
        "Squire, Am. J. Phys. 54, 984 (1986)",
    ),
    Effect(
        "structural_damping",
        "-h*abs(theta)*sign(thetadot)",
        (
            Parameter(
                "structural_coefficient", "h", "1/s^2", 0.0, inf, "loss torque per radian over inertia", 0.5
            ),
        ),
        "Material that is bent loses the same share of its energy each cycle, however slow the cycle.",
        "Crandall, J. Sound Vib. 11, 3 (1970)",
    ),
    Effect(
        "added_mass",
        "0",
        (
            Parameter(
                "added_mass", "m_a", "1", 0.0, inf, "fraction of the inertia, at a velocity of omega_n", 0.02
            ),
        ),
        "The bob drags air along, more of it in a fast swing: it seems heavier than it is.",
        "Morison et al., Petroleum Trans. AIME 189, 149 (1950)",
        inertia="m_a*abs(thetadot)/omega_n",
    ),
    Effect(
        "eddy_brake",
        "-b*exp(-(theta/w_b)**2)*thetadot",
        (
            Parameter("eddy_coefficient", "b", "1/s", 0.0, inf, "braking rate at the magnet", 0.2),
            Parameter(
                "eddy_width",
                "w_b",
                "rad",
                0.01,
                inf,
                "angle over which the magnet reaches",
                0.2,
                grid=(0.05, 0.1, 0.2, 0.4),
            ),
        ),
        "A magnet near the bottom brakes the metal bob, and only there.",
        "Wiederick et al., Am. J. Phys. 55, 500 (1987)",
    ),
    Effect(
        "constant_torque",
        "tau_0",
        (Parameter("constant_torque", "tau_0", "rad/s^2", -inf, inf, "steady torque over inertia", 0.3),),
        "A steady push to one side: the swing's middle is not where the pendulum would hang.",
        _MECHANICS,
    ),
    Effect(
        "torsion_spring",
        "-k_t*theta",
        (
            Parameter(
                "torsion_stiffness", "k_t", "1/s^2", 0.0, inf, "spring torque per radian over inertia", 2.0
            ),
        ),
        "A wire or clamp at the pivot pulls back in proportion to the angle.",
        _MECHANICS,
    ),
    Effect(
        "cubic_stiffness",
        "-k_3*theta**3",
        (
            Parameter(
                "cubic_stiffness", "k_3", "1/s^2", -inf, inf, "cubic restoring torque over inertia", 1.0
            ),
        ),
        "A spring that stiffens (or softens) with angle: the period changes with amplitude.",
        _MECHANICS,
    ),
    Effect(
        "detent",
        "k_d*sin(n_d*theta + phi_d)",
        (
            Parameter("detent_torque", "k_d", "rad/s^2", 0.0, inf, "amplitude over inertia", 0.2),
            Parameter(
                "detent_order",
                "n_d",
                "1",
                4.0,
                inf,
                "teeth or magnet poles a turn",
                12.0,
                grid=(4.0, 5.0, 6.0, 8.0, 12.0, 16.0, 24.0),
            ),
            Parameter("detent_phase", "phi_d", "rad", -2 * pi, 2 * pi, "at the bottom", 0.5, phase=True),
        ),
        "Magnets or gear teeth at the shaft pull toward evenly spaced angles.",
        "Hanselman, Brushless Permanent Magnet Motor Design (2003), on cogging",
    ),
    Effect(
        "flexible_pivot",
        "-cos(theta)*(mu*thetadot**2*sin(theta) - 2*zeta_2*omega_2*w - omega_2**2*q)",
        (
            Parameter("pivot_mass_ratio", "mu", "1", 0.0, 0.9, "bob over bob and support", 0.02),
            Parameter(
                "pivot_frequency",
                "omega_2",
                "rad/s",
                0.1,
                inf,
                "of the support on its own",
                30.0,
                grid=(12.0, 20.0, 30.0, 45.0),
            ),
            Parameter(
                "pivot_damping_ratio", "zeta_2", "1", 0.0, 1.0, "of the support", 0.05, grid=(0.02, 0.2)
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
    ),
    Effect(
        "base_vibration",
        "A*cos(theta)*cos(2*pi*f*t + phi)",
        (
            Parameter(
                "vibration_acceleration",
                "A",
                "rad/s^2",
                0.0,
                inf,
                "amplitude of pivot acceleration over length",
                0.3,
            ),
            Parameter("vibration_frequency", "f", "Hz", 0.0, inf, "of the pivot's motion", 3.0),
            Parameter(
                "vibration_phase",
                "phi",
                "rad",
                -2 * pi,
                2 * pi,
                "at the first sample",
                0.5,
                phase=True,
                own=True,
            ),
        ),
        "The table shakes sideways at one frequency.",
        _MECHANICS,
    ),
    Effect(
        "damping_drift",
        "-2*zeta_d*omega_n*thetadot*t/duration",
        (
            Parameter(
                "damping_drift",
                "zeta_d",
                "1",
                -inf,
                inf,
                "change of the viscous ratio over the record",
                0.003,
            ),
        ),
        "The damping changes while the pendulum swings: a bearing warms up, a draught sets in.",
        _MECHANICS,
    ),
    Effect(
        "steady_wind",
        "-omega_n*zeta_w*abs(thetadot - u)*(thetadot - u)",
        (
            Parameter(
                "wind_coefficient", "zeta_w", "s", 0.0, inf, "drag over inertia, divided by omega_n", 0.02
            ),
            Parameter(
                "wind_speed",
                "u",
                "rad/s",
                -inf,
                inf,
                "of the air at the bob, over the length",
                0.5,
                grid=(-2.0, -0.5, -0.1, 0.1, 0.5, 2.0),
            ),
        ),
        "Air that moves past the pendulum drags one way harder than the other.",
        _MECHANICS,
    ),
    Effect(
        "finite_amplitude",
        "-omega_n**2*(sin(theta) - theta)",
        (),
        "The weight pulls back with the sine of the angle, not with the angle: large swings take longer.",
        f"{_PAPER}, Eq. 2 against Eq. 3; for models with linear restoring torque only",
    ),
    Effect(
        "backlash",
        "w_p",
        (Parameter("backlash_width", "w_p", "rad", 0.0, inf, "of the dead band", 0.005),),
        "The sensor's coupling has play: at each turning point it waits before it follows.",
        "Visintin, Differential Models of Hysteresis (1994), the play operator",
        acts_on="play",
    ),
    Effect(
        "sensor_lag",
        "y_l",
        (Parameter("lag_time", "tau_l", "s", 1e-5, inf, "time constant", 0.01),),
        "The sensor answers late, as through a filter.",
        _METROLOGY,
        acts_on="sensor",
        states=(
            State(
                "y_l", "rad", "theta - tau_l*thetadot", "(theta - y_l)/tau_l", "reading of the slow sensor"
            ),
        ),
    ),
    Effect(
        "eccentricity",
        "theta + a_e*sin(theta + phi_e)",
        (
            Parameter("eccentricity", "a_e", "rad", 0.0, inf, "amplitude of the error a turn", 0.01),
            Parameter(
                "eccentricity_phase", "phi_e", "rad", -2 * pi, 2 * pi, "at the bottom", 0.8, phase=True
            ),
        ),
        "The encoder's disc is off centre: it reads ahead on one side and behind on the other.",
        _METROLOGY,
        acts_on="sensor",
    ),
    Effect(
        "sensor_gain",
        "(1 + g_s)*theta",
        (Parameter("sensor_gain", "g_s", "1", -0.5, 0.5, "relative error of the sensitivity"),),
        "The sensor reads every angle too large, or too small, by the same share.",
        _METROLOGY,
        acts_on="sensor",
    ),
    Effect(
        "sensor_zero",
        "theta + b_s",
        (Parameter("sensor_zero", "b_s", "rad", -inf, inf, "reading at rest"),),
        "The sensor does not read zero when the pendulum hangs straight down.",
        _METROLOGY,
        acts_on="sensor",
    ),
    Effect(
        "clock_drift",
        "t + d_c*t**2/duration",
        (
            Parameter(
                "clock_drift", "d_c", "1", -0.2, 0.2, "relative gain of the clock over the record", 0.002
            ),
        ),
        "The recorder's clock runs faster and faster, or slower and slower.",
        _METROLOGY,
        acts_on="clock",
    ),
)
CATALOGUE = {effect.name: effect for effect in _ENTRIES}
_OWN = {}  # one study's own entries, put there by ``use_own``


def _free_form(name, pieces, unit, scale, explanation, times="1"):
    """An effect without a name: a sum of ``pieces`` (formulas) with a coefficient each, over a range that is given."""
    letters = [f"c_{k}" for k in range(len(pieces))]
    term = (
        f"{times}*("
        + " + ".join(f"{letter}*{piece}" for letter, piece in zip(letters, pieces, strict=True))
        + ")"
    )
    own = tuple(Parameter(f"{name}_{k}", letter, "rad/s^2", typical=0.1) for k, letter in enumerate(letters))
    own += (Parameter(f"{name}_range", "s_u", unit, 1e-6, inf, scale, 1.0, grid=(1.0,)),) if scale else ()
    return Effect(
        name,
        term,
        own,
        explanation,
        "a smooth curve; what the catalogue does not explain is drawn, not named",
    )


FREE_FORM = {
    effect.name: effect
    for effect in (
        _free_form(
            "unnamed_position",
            ["1", *(f"(theta/s_u)**{k}" for k in range(2, 8))],
            "rad",
            "largest angle of the recordings",
            "A torque that depends on where the pendulum is, of a form that no entry of the catalogue has.",
        ),
        # bumps side by side rather than powers: friction changes most where it is slow, and powers have no room there
        _free_form(
            "unnamed_velocity",
            [f"exp(-(6*abs(thetadot)/s_u - {k})**2)" for k in range(7)],
            "rad/s",
            "largest velocity of the recordings",
            "A torque that depends on how fast the pendulum moves, of a form that no entry of the catalogue has.",
            times="sign(thetadot)",
        ),
        _free_form(
            "unnamed_time",
            [f"{of}*(t/duration)**{k}" for of in ("thetadot/omega_n", "theta", "1") for k in (1, 2, 3)],
            "",
            "",
            "A torque that changes over the record, of a form that no entry of the catalogue has.",
        ),
    )
}


def effect(name):
    """The catalogue's entry of that name; InputError with the known names otherwise."""
    if name not in known():
        raise InputError(f"effect {name!r}", "no such effect in the catalogue", ", ".join(catalogue()))
    return known()[name]


def catalogue():
    """The effects that have a name, by name: the catalogue's, then those that a study has of its own."""
    return CATALOGUE | _OWN


def known():
    """Every effect a model may have, by name: ``catalogue`` and the free forms, in the order in which models list them."""
    return CATALOGUE | _OWN | FREE_FORM


def use_own(entries):
    """The effects that a study has of its own (``own_effects.read``), from now on in ``catalogue`` and ``known``."""
    _OWN.clear()
    _OWN.update({entry.name: entry for entry in entries})
    return dict(_OWN)
