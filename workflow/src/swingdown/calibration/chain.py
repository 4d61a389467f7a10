"""The whole measurement as one function of its inputs: lengths and voltages, to angles, to the line, to an angle."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import Floats
from ..measurement.apparatus import Apparatus, encoder_limit, length_inputs
from ..measurement.straight_line import Line, fit_line_correlated, solve_lines
from ..measurement.uncertainty import Input, Mean, from_limit, propagate_gum
from .geometry import arm_angle

REFERENCE_DEG = 20.0  # the angle whose budget is told
_ROUNDS = 8  # adjustments of the points to the line; each shrinks what is left a hundredfold or more
OUTPUTS = ("intercept", "slope", "rest_voltage", "angle_at_rest", f"angle_at_{REFERENCE_DEG:g}_deg")


@dataclass(frozen=True)
class Chain:
    """The measurement: ``inputs`` in order, and ``__call__`` from an array of them to ``OUTPUTS``.

    The inputs are the four shared lengths, the n heights, the n mean voltages, the n encoder errors at the
    points, then the rest voltage and the angle of rest (both only if the pendulum was recorded at rest), and
    the encoder's error and the noise of the one sample whose angle is asked for. The encoder's error at rest
    is what the other errors are counted from: a fixed offset shifts all readings alike and is no error of an
    angle.
    """

    inputs: tuple
    points: int
    has_rest: bool
    sample_voltages: tuple  # at rest and at the reference angle

    def part(self, name: str) -> slice:
        """The slice of the inputs that ``name`` (voltages, encoder, rest, sample) covers."""
        n, start = self.points, 4 + 3 * self.points
        after = start + (2 if self.has_rest else 0)
        return {
            "voltages": slice(4 + n, 4 + 2 * n),
            "encoder": slice(4 + 2 * n, start),
            "rest": slice(start, after),
            "sample": slice(after, after + 2 * len(self.sample_voltages)),
        }[name]

    def angles(self, x: Floats) -> Floats:
        """The angles (rad) of the points, points first, for inputs ``x`` (inputs first)."""
        return _angles(x[: 4 + self.points])

    def voltages(self, x: Floats) -> Floats:
        """The voltages (V) of the points."""
        return x[self.part("voltages")] + x[self.part("encoder")]

    @cached_property
    def values(self) -> Floats:
        """The best values of the inputs."""
        return np.array([i.value for i in self.inputs])

    @cached_property
    def covariance_of_points(self) -> tuple[Floats, Floats]:
        """Covariances of the points' voltages (V^2, diagonal) and of their angles (rad^2, from the shared lengths)."""
        geometry = propagate_gum(_angles, self.inputs[: 4 + self.points])
        u = np.array([i.standard_uncertainty for i in self.inputs])
        return np.diag(u[self.part("voltages")] ** 2 + u[self.part("encoder")] ** 2), geometry.covariance

    @cached_property
    def line(self) -> Line:
        """The line through the points, by generalised least squares."""
        volts, angles = self.voltages(self.values), self.angles(self.values)
        return fit_line_correlated(volts, angles, *self.covariance_of_points)

    def __call__(self, x: Floats) -> Floats:
        """``OUTPUTS`` along the first axis: rad, rad/V, V, rad, rad. The line's weights are the same for every draw."""
        cov_voltage, cov_angle = self.covariance_of_points
        weight = np.linalg.inv(cov_angle + self.line.slope**2 * cov_voltage)
        volts, angles = np.moveaxis(self.voltages(x), 0, -1), np.moveaxis(self.angles(x), 0, -1)
        intercept, slope, _ = solve_lines(volts, angles, cov_voltage, weight, self.line.slope, _ROUNDS)
        if self.has_rest:
            voltage, angle = x[self.part("rest")]
            rest = voltage - angle / slope
        else:
            rest = -intercept / slope
        errors = x[self.part("sample")]
        pairs = zip(self.sample_voltages, errors[::2], errors[1::2], strict=True)
        at = [slope * (volts + encoder + noise - rest) for volts, encoder, noise in pairs]
        return np.stack(np.broadcast_arrays(intercept, slope, rest, *at))


def lengths(apparatus: Apparatus) -> tuple[list[Input], Callable[[Floats], Floats]]:
    """The Inputs (shared lengths, then heights) and the function from an array of them to the points' angles (rad)."""
    shared, heights = length_inputs(apparatus)
    return [*shared, *heights], _angles


def _angles(x: Floats) -> Floats:
    over_shaft, shaft_diameter, bob_diameter, arm = x[:4]
    return arm_angle(over_shaft, shaft_diameter, bob_diameter, arm, x[4:])


def measurement(
    apparatus: Apparatus, towers: Sequence[Mean], rest: Mean | None = None, noise: float = 0.0
) -> Chain:
    """The chain from the lengths and voltages of an apparatus to its line.

    Parameters
    ----------
    apparatus
        As ``read_apparatus`` returns it.
    towers
        The mean voltages (V) of its points, in their order.
    rest
        That of the pendulum at rest, in V; None where it was not recorded.
    noise
        Standard deviation of a single sample, in V.
    """
    kind = apparatus["encoder"]["kind"]

    def encoder(name: str, voltage: float) -> Input:
        return from_limit(name, 0.0, float(encoder_limit(apparatus, voltage, name)), unit="V", kind=kind)

    def mean(name: str, found: Mean) -> Input:
        return Input(name, found.value, found.standard_uncertainty, dof=found.dof, unit="V")

    n = len(towers)
    inputs, _ = lengths(apparatus)
    inputs += [mean(f"mean_voltage_{k}", found) for k, found in enumerate(towers, 1)]
    inputs += [encoder(f"encoder_error_{k}", found.value) for k, found in enumerate(towers, 1)]
    if rest is not None:
        inputs += [mean("rest_voltage", rest)]
        inputs += [from_limit("angle_of_rest", 0.0, apparatus["rest"]["limit"], unit="rad")]
    bare = Chain(tuple(inputs), n, rest is not None, ())
    slope = bare.line.slope
    zero = rest.value if rest is not None else -bare.line.intercept / slope
    samples = (zero, zero + np.radians(REFERENCE_DEG) / slope)
    # 20 degrees may lie beyond it; the budget is told all the same
    top = apparatus["encoder"]["limits"][-1]["up_to"]
    for name, voltage in zip(("at_rest", f"at_{REFERENCE_DEG:g}_deg"), samples, strict=True):
        inputs += [encoder(f"sample_encoder_error_{name}", np.clip(voltage, -top, top))]
        inputs += [Input(f"sample_noise_{name}", 0.0, noise, unit="V", kind="random")]
    return Chain(tuple(inputs), n, rest is not None, samples)
