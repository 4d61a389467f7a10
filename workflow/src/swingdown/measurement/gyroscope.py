"""What is known of a gyroscope before any fit: its limits of error, the axis that a pendulum turns about, and what it can read."""

from collections.abc import Sequence
from math import pi

import numpy as np

from ..arrays import Floats
from ..errors import InputError
from ..pendulum.half_swings import half_swings

# Limits that the maker states of one that telephones and boards have (MPU-6050, product specification 3.4, section 6.1).
GAIN_TOLERANCE = 0.03
ZERO_TOLERANCE = 0.35  # rad/s: 20°/s
TO_RAD_PER_S = {"rad/s": 1.0, "deg/s": pi / 180}
ASKEW = 0.1  # of the rate about the axis that turns most: so much about another tells that it lies askew
SAME = 0.05  # of the length of a vector: so even, it is gravity's
ONE_WAY = 0.75  # of the samples; of a pendulum's they are half
FASTEST = 6.0  # times 2 pi over the period; a pendulum that goes to 175° and back is slower at the bottom


def turning_most(names: Sequence[str], values: Sequence[Floats]) -> tuple[int, list[str]]:
    """Which of several axes turns most, by its place, and remarks on that; InputError where they are the parts of gravity."""
    length = np.sqrt(np.sum(np.square(values), axis=0))  # of a rate it is nothing where the pendulum turns
    if len(values) > 1 and np.std(length) < SAME * np.mean(length):
        problem = f"together they are always about {np.mean(length):.3g} long, as the parts of gravity are, and no rate is"
        expected = "a gyroscope's rates about its axes, or an angle"
        raise InputError(" ".join(names), problem, expected, "record the gyroscope")
    spread = [float(np.std(one)) for one in values]
    most = int(np.argmax(spread))
    if len(names) < 2:
        return most, []
    told = [f"of {len(names)} axes `{names[most]}` turns most and was taken (⟨signal_column⟩ says otherwise)"]
    others = [share / spread[most] for k, share in enumerate(spread) if k != most] if spread[most] > 0 else []
    if others and max(others) > ASKEW:
        told.append(
            f"another axis turns {100 * max(others):.0f} % as much: the gyroscope lies askew and reads too little, "
            f"by about {100 * (1 - 1 / np.hypot(1, max(others))):.1f} %"
        )
    return most, told


def rate_unit(times: Floats, signal: Floats) -> str:
    """``rad/s``, or ``deg/s`` where no pendulum turns so fast in its period: the unit of an angular rate that nobody states."""
    period = half_swings(signal).period(times)
    return "deg/s" if float(np.abs(signal).max()) * period > 2 * pi * FASTEST else "rad/s"


def check_rate(times: Floats, signal: Floats, unit: str, place: str) -> list[str]:
    """Remarks on an angular rate (``unit`` rad/s or deg/s), each one line; InputError where no pendulum turns so fast."""
    rate, swings = signal * TO_RAD_PER_S[unit], half_swings(signal)
    period, fastest = swings.period(times), float(np.abs(rate).max())
    if fastest * period > 2 * pi * FASTEST:
        problem = f"taken for {unit} it reaches {fastest:.4g} rad/s with a period of {period:.3g} s, which no pendulum does"
        mend = "write deg/s ⟨in signal_unit⟩ if these are degrees a second, or check the unit of the time"
        raise InputError(place, problem, f"at most {2 * pi * FASTEST / period:.3g} rad/s", mend)
    zero = swings.centre() * TO_RAD_PER_S[unit]
    if abs(zero) > ZERO_TOLERANCE and np.mean(rate * zero > 0) > ONE_WAY:
        problem = f"it turns one way all the time, at about {zero:.2g} rad/s"
        mend = "name the column of the axis that it swings about ⟨in signal_column⟩"
        raise InputError(place, problem, "a pendulum, which turns back after each half-swing", mend)
    if abs(zero) > ZERO_TOLERANCE:
        remark = f"it reads about {zero:.2g} rad/s at rest, more than gyroscopes usually do: state a limit in zero_tolerance_rad_per_s"
        return [remark]
    return []
