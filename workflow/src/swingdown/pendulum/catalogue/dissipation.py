"""What takes energy from the swing: fluids, dry friction, material, magnets, and the air that is dragged along."""

from math import inf

from ..effect import Contained, Effect, Parameter, StandIn, State
from .sources import PAPER, SQUIRE

DISSIPATION = (
    Effect(
        "viscous",
        "-2*zeta_v*omega_n*thetadot",
        (Parameter("viscous_ratio", "zeta_v", "1", 0.0, inf, "fraction of critical damping"),),
        "A drag that grows with speed, as in a slow fluid: each swing loses the same share of its amplitude.",
        f"{PAPER}, Table 1",
        spoken="air drag (viscous)",
        spoken_of_wheel="viscous drag",
        symbol="v",
        damping="loss/(pi*amplitude)",
    ),
    Effect(
        "quadratic_drag",
        "-omega_n*zeta_q*thetadot*abs(thetadot)",
        (
            Parameter(
                "quadratic_coefficient", "zeta_q", "s", 0.0, inf, "drag over inertia, divided by omega_n", 0.02
            ),
        ),
        "Air drag at speed: it grows with the square of the velocity, so large swings die faster than small ones.",
        f"{PAPER}, Table 1",
        spoken="air drag (quadratic)",
        symbol="q",
        damping="3*loss/(4*amplitude**2*omega_n)",
        told_apart={
            "damping_drift": "Release from half and from twice the angle, in both orders: drag follows the angle, a drift the clock.",
            "power_law_drag": "Release from twice the angle: the exponent shows in the first swings.",
            "steady_wind": "Release from both sides with the draught shut off.",
        },
    ),
    Effect(
        "load_coulomb",
        "-gamma*(thetadot**2 + omega_n**2*cos(theta))*sign(thetadot)",
        (
            Parameter(
                "load_friction", "gamma", "1", 0.0, inf, "friction coefficient times bearing radius over length", 0.005
            ),
        ),
        "Dry bearing friction in proportion to the pull of the rod, which is largest at the bottom of a fast swing.",
        f"{PAPER}, Table 1, with the powers of omega_n that its units need",
        spoken="bearing friction",
        printed="-omega_n*gamma*(thetadot**2 + cos(theta))*sign(thetadot)",
        symbol="c",
        beside="sine",  # the pull of a rod: a wheel on a spring has none that changes
        damping="loss/2",
        replaces=(StandIn("constant_coulomb", ({"load_friction": "c/omega_n**2"},)),),
    ),
    Effect(
        "constant_coulomb",
        "-c*sign(thetadot)",
        (Parameter("constant_friction", "c", "rad/s^2", 0.0, inf, "friction torque over inertia", 0.2),),
        "Dry friction of one size whatever the load: the amplitude falls by the same angle each swing.",
        SQUIRE,
        spoken="dry friction",
        symbol="k",
        damping="loss*omega_n**2/2",
        replaces=(
            StandIn("load_coulomb", ({"constant_friction": "gamma*omega_n**2"},)),
            StandIn("presliding", ({"constant_friction": "F_c"},)),
        ),
        told_apart={
            "presliding": "Sample swings of less than 1°, and let one die out: only friction that winds up shortens the period there."
        },
    ),
    Effect(
        "stribeck",
        "-s*exp(-abs(thetadot)/v_s)*sign(thetadot)",
        (
            Parameter("stribeck_friction", "s", "rad/s^2", 0.0, inf, "extra friction at the slowest motion", 0.2),
            Parameter(
                "stribeck_velocity", "v_s", "rad/s", 1e-3, inf, "velocity at which it has fallen to 1/e", 0.3,
                role="shape", starts=(0.03, 0.1, 0.3, 1.0), drawn=(0.05, 0.5),
            ),
        ),
        "A lubricated bearing holds harder when it turns slowly: extra friction near each turning point.",
        "Armstrong-Helouvry et al., Automatica 30, 1083 (1994)",
        spoken="friction that is largest in slow motion (Stribeck)",
        contains=(Contained("constant_coulomb", {"stribeck_velocity": inf}),),
    ),
    Effect(
        "presliding",
        "-F",
        (
            Parameter("presliding_friction", "F_c", "rad/s^2", 0.0, inf, "friction once it slides, over inertia", 0.2),
            Parameter(
                "presliding_angle", "x_c", "rad", 1e-5, inf, "angle over which friction builds up", 0.01,
                role="shape", starts=(0.001, 0.003, 0.01, 0.03), drawn=(0.002, 0.02),
            ),
        ),
        "Dry friction that first bends like a spring: near each turning point the bearing winds up before it slides, "
        "so small swings run early. A cable that bends does the same over tenths of a radian (Bouc and Wen's hysteresis at its simplest).",
        "Dahl, Aerospace Corporation TOR-0158 (1968); Wen, J. Eng. Mech. Div. ASCE 102, 249 (1976)",
        spoken="friction that winds up before it slips (presliding)",
        states=(State("F", "rad/s^2", "0", "(F_c - F*sign(thetadot))*thetadot/x_c", "friction torque over inertia"),),
        contains=(Contained("constant_coulomb", {"presliding_angle": 0.0}),),
        replaces=(
            StandIn("load_coulomb", tuple(
                {"presliding_friction": "abs(gamma*omega_n**2) + 1e-4", "presliding_angle": angle}
                for angle in ("0.001", "0.003", "0.01", "0.03")
            )),
            StandIn("constant_coulomb", tuple(
                {"presliding_friction": "abs(c) + 1e-4", "presliding_angle": angle}
                for angle in ("0.001", "0.003", "0.01", "0.03")
            )),
        ),
        headline=("presliding_angle",),
    ),
    Effect(
        "power_law_drag",
        "-d*abs(thetadot)**n*sign(thetadot)",
        (
            Parameter("power_law_coefficient", "d", "rad/s^2", 0.0, inf, "drag over inertia at 1 rad/s", 0.1),
            Parameter(
                "power_law_exponent", "n", "1", 0.2, 4.0, "1 is viscous, 2 quadratic", 1.5,
                role="shape", starts=(0.5, 1.5, 2.5, 3.0), drawn=((1.3, 1.7), (2.4, 3.2)),
            ),
        ),
        "A drag between slow-fluid and fast-fluid, with its own exponent.",
        SQUIRE,
        spoken="drag by a power of the speed",
        contains=(
            Contained("viscous", {"power_law_exponent": 1.0}),
            Contained("quadratic_drag", {"power_law_exponent": 2.0}),
            Contained("constant_coulomb", {"power_law_exponent": 0.0}),
        ),
        replaces=(
            StandIn("viscous", ({"power_law_coefficient": "abs(2*zeta_v*omega_n) + 1e-4", "power_law_exponent": "1.2"},)),
            StandIn("quadratic_drag", ({"power_law_coefficient": "abs(zeta_q*omega_n) + 1e-4", "power_law_exponent": "1.8"},)),
        ),
        headline=("power_law_coefficient", "power_law_exponent"),
    ),
    Effect(
        "structural_damping",
        "-h*abs(theta)*sign(thetadot)",
        (Parameter("structural_coefficient", "h", "1/s^2", 0.0, inf, "loss torque per radian over inertia", 0.5),),
        "Material that is bent loses the same share of its energy each cycle, however slow the cycle.",
        "Crandall, J. Sound Vib. 11, 3 (1970)",
        spoken="losses in the material (structural)",
        damping="loss*omega_n**2/amplitude",
        told_apart={
            "viscous": "Repeat with a larger inertia on the same spring or length: bent material takes the same share a swing, drag less of it.",
        },
    ),
    Effect(
        "added_mass",
        "0",
        (Parameter("added_mass", "m_a", "1", 0.0, inf, "fraction of the inertia, at a velocity of omega_n", 0.02),),
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
                "eddy_width", "w_b", "rad", 0.01, inf, "angle over which the magnet reaches", 0.2,
                role="shape", starts=(0.05, 0.1, 0.2, 0.4), drawn=(0.06, 0.3),
            ),
        ),
        "A magnet near the bottom brakes the metal bob, and only there.",
        "Wiederick et al., Am. J. Phys. 55, 500 (1987)",
        spoken="a magnet's brake (eddy currents)",
        contains=(Contained("viscous", {"eddy_width": inf}),),
        headline=("eddy_coefficient", "eddy_width"),
    ),
)  # fmt: skip
