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
    width = 2 * side + 1
    # an orthonormal basis of the polynomials (scipy.signal has such a filter and takes a second to load)
    basis = np.linalg.qr(np.vander(np.linspace(-1, 1, width), DEGREE + 1))[0]
    if ends_quiet:
        longer = np.concatenate([-about[half - side : half], about, -about[-half:][:side]])
        smooth = np.correlate(longer, basis @ basis[side], "valid")
    else:
        inner = np.correlate(about, basis @ basis[side], "valid")
        ends = basis[:side] @ (about[:width] @ basis), basis[-side:] @ (about[-width:] @ basis)
        smooth = np.concatenate([ends[0], inner, ends[1]])
    return np.asarray(middle + np.interp(times, grid, smooth))
