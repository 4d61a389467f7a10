"""Effects without a name: smooth torques over place, speed or time, for what no entry of the catalogue explains."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

from .effect import Effect, Parameter

_SMOOTH = "a smooth curve; what the catalogue does not explain is drawn, not named"


@dataclass(frozen=True)
class FreeForm(Effect):
    """A torque of a general form: a sum of pieces with a coefficient (size) each, over a range that is given.

    ``over`` is what it depends on: ``position``, ``velocity`` or ``time``; ``parts`` names what the pieces make up, as many
    pieces for each.
    """

    over: str = ""
    parts: tuple[str, ...] = ("torque",)

    @property
    def coefficients(self) -> tuple[str, ...]:
        """The names of the coefficients."""
        return tuple(parameter.name for parameter in self.with_role("size"))


def _free_form(
    over: str,
    pieces: Sequence[str],
    explanation: str,
    unit: str = "",
    scale: str = "",
    times: str = "1",
    parts: tuple[str, ...] = ("torque",),
) -> FreeForm:
    name, letters = f"unnamed_{over}", [f"c_{k}" for k in range(len(pieces))]
    term = f"{times}*(" + " + ".join(f"{c}*{piece}" for c, piece in zip(letters, pieces, strict=True)) + ")"
    own = [Parameter(f"{name}_{k}", letter, "rad/s^2", typical=0.1) for k, letter in enumerate(letters)]
    if scale:
        own.append(Parameter(f"{name}_range", "s_u", unit, 1e-6, inf, scale, 1.0, role="range"))
    return FreeForm(name, term, tuple(own), explanation, _SMOOTH, over=over, parts=parts)


FREE_FORMS = (
    _free_form(
        "position",
        ["1", *(f"(theta/s_u)**{k}" for k in range(2, 8))],
        "A torque that depends on where the pendulum is, of a form that no entry of the catalogue has.",
        "rad",
        "largest angle of the recordings",
    ),
    # bumps side by side rather than powers: friction changes most where it is slow, and powers have no room there
    _free_form(
        "velocity",
        [f"exp(-(6*abs(thetadot)/s_u - {k})**2)" for k in range(7)],
        "A torque that depends on how fast the pendulum moves, of a form that no entry of the catalogue has.",
        "rad/s",
        "largest velocity of the recordings",
        times="sign(thetadot)",
    ),
    _free_form(
        "time",
        [f"{of}*(t/duration)**{k}" for of in ("thetadot/omega_n", "theta", "1") for k in (1, 2, 3)],
        "A torque that changes over the record, of a form that no entry of the catalogue has.",
        parts=("drag", "stiffness", "push"),
    ),
)
