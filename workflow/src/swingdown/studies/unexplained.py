"""How much of a swing a model leaves unexplained, noise aside."""

import numpy as np

from ..arrays import Floats

MUCH = 0.08  # of the swing: a model that leaves so much lacks something, and its values are less sure than they say
_PART = 0.25  # of a period: means over it hold the motion, and little noise


def doubt(left: float, name: str) -> str:
    """What is said of the swings ``name`` of which the best model of damping leaves this share; nothing where that is little."""
    if not left > MUCH:
        return ""
    return (
        f"the best model of damping leaves {100 * left:.2g} % of {name}: it lacks something, or a hand moved the pendulum, "
        "and its values are less certain than stated"
    )


def share_left(residual: Floats, series: Floats) -> float:
    """The share of a swing that a model leaves: the RMS of its ``residual`` over that of the ``series``, both of means over a part
    of a period."""
    each = _samples(series)
    return float(np.std(_means(residual, each)) / np.std(_means(series, each)))


def _samples(series: Floats) -> int:
    """How many samples a part of a period has, by the strongest line of the spectrum: noise moves no crossings there."""
    line = 1 + int(np.argmax(np.abs(np.fft.rfft(series))[1:]))
    return max(1, int(_PART * series.size / line))


def _means(series: Floats, size: int) -> Floats:
    return series[: series.size // size * size].reshape(-1, size).mean(axis=1)
