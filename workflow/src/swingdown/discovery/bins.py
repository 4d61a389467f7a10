"""Series in bins of time, and what is new in each bin where noise remembers the one before."""

import numpy as np

from ..arrays import Floats
from .campaign import Noise


class Means:
    """Means over bins of time, the first sample a bin of its own, since a motion begins there; and their ``news``.

    Of first-order autocorrelated noise the means over so many samples are about such noise as well.
    """

    def __init__(self, times: Floats, width: float, noise: Noise):
        label = np.r_[-1, np.floor((times[1:] - times[0]) / width)].astype(int)
        bins, self.label, self.count = np.unique(label, return_inverse=True, return_counts=True)
        self.times = self(times)
        self.weight = np.sqrt(self.count)
        rho, size = noise.correlation, float(np.median(self.count))
        forgotten = 1 - rho**size
        # of a mean's variance, in units of the noise's over (1 - rho)^2 size^2
        own = (1 - rho**2) * size - 2 * rho * forgotten
        self._memory = rho * forgotten**2 / own
        # what is slow is as large beside noise without memory as it was
        self._alone = np.sqrt((1 - rho**2) * size / own)
        self._next = self._alone / np.sqrt(1 - self._memory**2)
        self._first = np.sqrt(noise.inflation)
        # the first mean is of one sample; where bins are missing nothing is remembered
        self._goes_on = np.flatnonzero(np.diff(bins) == 1)[1:]

    def __call__(self, series: Floats) -> Floats:
        flat = series.reshape(series.shape[0], -1)
        sums = np.stack([np.bincount(self.label, one) for one in flat.T], axis=1) / self.count[:, None]
        return sums.reshape(-1, *series.shape[1:])

    @property
    def volume(self) -> float:
        """The logarithm of the determinant of the ``news`` by the means."""
        goes_on, alone = self._goes_on.size, self.count.size - 1 - self._goes_on.size
        return float(np.log(self._first) + goes_on * np.log(self._next) + alone * np.log(self._alone))

    def news(self, means: Floats) -> Floats:
        """Means (bin, any), weighed by their samples, without what noise remembers of the bin before."""
        weighed = means * self.weight[:, None]
        found = weighed * self._alone
        found[0] = weighed[0] * self._first
        found[self._goes_on + 1] = self._next * (
            weighed[self._goes_on + 1] - self._memory * weighed[self._goes_on]
        )
        return found
