"""What readings without a scale are worth, as far as their own period tells: the wider weight lets a pendulum swing, the slower it is."""

import numpy as np

from ..arrays import Floats
from ..pendulum.half_swings import LARGEST, half_swings, lengthening, passages
from .plausibility import ENOUGH, STEADY

# rad: what the largest swing stands for where no period tells more, as sine and angle are then one
RELATIVE = 0.01
# rad: of what a spring pulls back, about as wide as the searched shapes of torques are
ON_A_SPRING = 0.1
_WORTH = 10.0  # of BIC, by which the period has to be better told with the size of the swings than without
_ROUNDS = 8  # until the square of the swings is what it makes of the period


def apparent_scale(times: Floats, signal: Floats, restoring: str = "sine") -> float:
    """Rad per unit with which a pendulum's period goes with its swings as that of a signal does.

    A model of readings whose swings are taken for small ones would have one period for all of them, and its friction would make up for that.

    Parameters
    ----------
    times, signal
        In s and in any unit, of shape (sample,).
    restoring
        ``sine`` or ``linear``.

    Returns
    -------
    float
        That by which the largest swing is ``RELATIVE`` where the period does not evidently fall with the swings, and ``ON_A_SPRING`` where
        nothing but a spring pulls back.
    """
    small = 2 * (RELATIVE if restoring == "sine" else ON_A_SPRING) / float(np.ptp(signal))
    swings = half_swings(signal)
    passed = passages(times, signal, swings.centre())
    if restoring != "sine" or not len(passed) == len(swings.starts) - 1 > ENOUGH:
        return small
    periods, sizes = passed[2:] - passed[:-2], np.abs(np.diff(swings.turns[1:-1])) / 2
    usual = float(np.median(periods))
    near = np.abs(periods - usual) < STEADY * usual
    periods, sizes = periods[near], sizes[near]
    if periods.size < ENOUGH or not np.ptp(sizes) > 0:
        return small
    # noise moves a passage the more, the smaller the swing
    weight = sizes**2 / np.sum(sizes**2)
    late = periods - weight @ periods
    # as BIC has it beside one period for all swings
    scale, evident = small, np.sqrt(_WORTH + np.log(periods.size))
    for _ in range(_ROUNDS):
        slower = lengthening(scale * sizes) - 1
        from_mean = slower - weight @ slower
        spread = weight @ from_mean**2
        slope = weight @ (from_mean * late) / spread
        # each half-swing is in two periods
        error = np.sqrt(2 * (weight @ (late - slope * from_mean) ** 2) / (periods.size - 2) / spread)
        if not slope > evident * error:
            return small
        period = weight @ periods - slope * (weight @ slower)
        scale = min(scale * float(np.sqrt(slope / period)), LARGEST / float(sizes.max()))
    return scale
