"""A rate without what its samples scatter: what is derived from angles has their noise, times its frequency."""

import numpy as np

from .arrays import Floats

DEGREE = 4  # of the polynomials: follows a swing through half of its period, to 0.04 % of its size
FEWEST = 9  # samples; fewer tell no polynomial from its noise


def calmed(times: Floats, rate: Floats, ends_quiet: bool = True) -> Floats:
    """The rate of a swing by the polynomials through half a period about each sample, of the shape and in the unit of ``rate``.

    A rate that somebody computed from angles is no second sensor. The difference of two angles has the noise of both over their
    interval, so that a swing passes its middle several times at once; over half a period it is none. An even weight moves no
    passage. The period is that of the largest line of the spectrum; ``times`` (s) rise, in any steps. Fewer than nine samples in half a
    period are left as they are. With ``ends_quiet`` the swing goes on beyond its ends as half a period away, on the other side; without, the
    polynomials nearest to the ends tell them, which keeps their size and more of their noise.
    """
    from scipy.signal import savgol_filter  # takes long to import, and few recordings are rates

    steps = round((times[-1] - times[0]) / float(np.median(np.diff(times))))
    grid = np.linspace(times[0], times[-1], steps + 1)
    even = np.interp(grid, times, rate)
    middle = even.mean()
    about = even - middle
    line = int(np.argmax(np.abs(np.fft.rfft(about * np.hanning(about.size)))))
    half = round(about.size / (2 * max(1, line)))
    if half < FEWEST:
        return rate
    side = half // 2
    if not ends_quiet:
        return np.asarray(middle + np.interp(times, grid, savgol_filter(about, 2 * side + 1, DEGREE)))
    longer = np.concatenate([-about[half - side : half], about, -about[-half:][:side]])
    smooth = savgol_filter(longer, 2 * side + 1, DEGREE)[side : longer.size - side]
    return np.asarray(middle + np.interp(times, grid, smooth))
