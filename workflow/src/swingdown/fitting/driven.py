"""A first guess of a driven swing: its equation of motion, weighed with bumps in time, is linear in frequency, loss and gain."""

from collections.abc import Iterator

import numpy as np

from ..arrays import Floats
from ..errors import InputError
from ..pendulum.catalogue import RATE
from ..pendulum.drive import Drive
from ..pendulum.effect import NATURAL_FREQUENCY
from ..pendulum.formula import evaluate
from ..pendulum.model import Model
from .guess import Guess, at_first

# samples of a bump's half width, from one to the next, and of the record
_NARROWEST, _WIDER, _WIDEST = 4, 2.0, 0.125
_POWER = 6  # of a bump (1 - x^2)^n: its first two derivatives vanish at its ends, and so does what sampling them leaves


def driven_release(times: Floats, angle: Floats) -> tuple[float, float]:
    """Angle (rad) and velocity (rad/s) at the first sample (times in s), of a parabola through a few."""
    return at_first(times, angle, 8 * float(times[min(2 * _NARROWEST, times.size - 1)] - times[0]))


def driven_guesses(model: Model, times: Floats, angle: Floats, drive: Drive) -> list[dict[str, float]]:
    """The values by parameter that a swing under a measured drive shows, for bumps of several widths.

    theta'' = -c theta' - omega^2 s(theta) + b f(theta, u) + d, times a bump and integrated by parts, holds no derivative of what was
    measured; its values solve a linear least squares problem (the modulating functions of Shinbrot, Trans. ASME 79, 1957).

    Parameters
    ----------
    model
        What is fitted.
    times, angle
        In s and rad, both of shape (sample,).
    drive
        What was measured of the drive.

    Raises
    ------
    InputError
        If angular rates are given, of which the angle is not known, or no width gives a frequency.
    """
    if model.reading == RATE:
        raise InputError(
            f"fit of {model.label}", "its drive was measured, and angular rates do not show the angle at which it acts", "angles",
        )  # fmt: skip
    gains = [one.name for effect in model.effects if effect.takes_input for one in effect.with_role("size")]
    amplitude, found = float(np.ptp(angle) / 2), []
    for frequency, loss, size in _solved(model, times, angle, drive):
        a_half_swing = amplitude * -np.expm1(-0.5 * np.pi * loss / frequency)
        seen = Guess(frequency, 0.0, 0.0, amplitude, float(a_half_swing))
        gain = size if drive.kind == "torque" else size / frequency**2
        values = {NATURAL_FREQUENCY.name: frequency}
        found.append(seen.damping(model) | dict.fromkeys(gains[:1], gain) | values)
    if not found:
        raise InputError(
            f"fit of {model.label}", "its response to the drive shows no natural frequency", "the angle of a pendulum, and the drive that moves it",
            "check the columns of angle and input, their units, and what the input is (⟨input_kind⟩)",
        )  # fmt: skip
    return found


def _solved(model: Model, times: Floats, angle: Floats, drive: Drive) -> Iterator[tuple[float, float, float]]:
    """Frequency (rad/s), loss (1/s) and the drive's size, for each width of the bumps."""
    clock = np.linspace(times[0], times[-1], times.size)
    theta = np.interp(clock, times, angle)
    bare = model.driven_by(drive)
    effect = next(one for one in bare.effects if one.takes_input)
    at = dict.fromkeys((one.symbol for one in effect.parameters), 0.0) | {
        one.symbol: 1.0 for one in effect.with_role("size")
    }
    u, _, curve = drive.derivatives(clock)
    forced = evaluate(effect.term, theta=theta, input=u, input_curve=curve, omega_n=1.0, **at)
    pull = -evaluate(model.gravity.term, theta=theta, omega_n=1.0)
    centred, width = theta - theta.mean(), _NARROWEST
    while width < _WIDEST * times.size:
        scale = width * float(clock[1] - clock[0])
        columns = [
            _weighed(centred, width, scale, 1),
            -_weighed(pull, width, scale),
            _weighed(forced, width, scale),
            _weighed(np.ones_like(theta), width, scale),
        ]
        wanted = _weighed(centred, width, scale, 2)
        c, square, b, _ = np.linalg.lstsq(np.array(columns).T, wanted, rcond=None)[0]
        if square > 0 and np.isfinite([c, square, b]).all():
            yield float(np.sqrt(square)), max(float(c), 0.0), float(b)
        width = int(np.ceil(_WIDER * width))


def _weighed(values: Floats, width: int, scale: float, order: int = 0) -> Floats:
    """Sums of the values times a bump, or its derivative of that ``order``, so many samples to each side (``scale`` s), at one place after another."""
    x = np.linspace(-1.0, 1.0, 2 * width + 1)
    bump = np.polynomial.Polynomial([1.0, 0.0, -1.0]) ** _POWER
    kernel = bump.deriv(order)(-x) / scale**order if order else bump(x)
    return np.convolve(values, kernel, "valid")[:: max(1, width // 4)]
