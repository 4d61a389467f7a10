"""Noise on a clean series (in proportion as in the paper's Eq. 5, additive, quantised), and what draws it.

A noise model is a function ``(angle, snr, normals) -> noisy angle`` with an entry in ``NOISES``; a stream is
anything with ``standard_normal(n)``. The config names both (``simulation.noise``, ``simulation.stream``).
"""

from zlib import crc32

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Floats
from ..errors import InputError


def proportional(angle: Floats, snr: float, normals: Floats) -> Floats:
    """The angle (rad) with noise in proportion to its size, ``y + |y|/snr * normal`` (Eq. 5).

    There is none at a zero crossing, which no real sensor achieves: it is the paper's choice. ``angle`` is in rad and of any shape, ``snr``
    signal over noise, ``normals`` are standard normal deviates of the angle's shape.
    """
    return angle + np.abs(angle) / snr * normals


def additive(angle: Floats, snr: float, normals: Floats) -> Floats:
    """The angle (rad) with noise of one size throughout: its standard deviation is the RMS over ``snr``; arguments as of ``proportional``."""
    return angle + _rms(angle) / snr * normals


def quantisation(angle: Floats, snr: float, normals: Floats) -> Floats:
    """The angle (rad) rounded to steps whose standard deviation (step/sqrt 12) is the RMS over ``snr``; arguments as of ``proportional``.

    ``normals`` are not used; all kinds of noise are called alike. Realisations of a series are the same.
    """
    step = np.sqrt(12) * _rms(angle) / snr
    return step * np.round(angle / step)


NOISES = {"proportional": proportional, "additive": additive, "quantisation": quantisation}
STREAMS = ("R", "numpy")


def add_noise(kind: str, angle: ArrayLike, snr: float, normals: Floats) -> Floats:
    """The angle (rad) with noise of a kind (``proportional``, ``additive`` or ``quantisation``), of its shape.

    ``snr`` is signal over noise, ``normals`` are standard normal draws of the same shape. InputError for an unknown kind, or an ``snr`` that is
    not above 0.
    """
    if kind not in NOISES:
        raise InputError("simulation.noise", f"unknown noise {kind!r}", " or ".join(NOISES))
    if not snr > 0:
        raise InputError("simulation.snr", f"signal-to-noise ratio {snr!r}", "a number above 0")
    return NOISES[kind](np.asarray(angle, float), snr, normals)


def numpy_stream(seed: int, label: str, index: int) -> np.random.Generator:
    """A numpy Generator that depends on the study's seed, the label of the simulated model and the realisation's index alone.

    So a realisation is the same whatever other models are simulated beside it, in whatever order or process.
    """
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(crc32(label.encode()), index)))


class RStream:
    """The stream that R draws after ``set.seed(seed)`` with its default kinds (Mersenne Twister, inversion).

    Source: R's ``src/main/RNG.c`` and ``src/nmath/snorm.c``. Draws of ``uniform`` and ``standard_normal`` may be
    mixed; they advance one state, as ``runif`` and ``rnorm`` do. InputError unless ``seed`` is a 32-bit integer.
    """

    def __init__(self, seed: int) -> None:
        if not isinstance(seed, (int, np.integer)) or not -(2**31) < seed < 2**31:
            expected = "an integer between -2147483647 and 2147483647"
            raise InputError("seed", f"{seed!r} cannot seed R's stream", expected)
        scrambled = int(seed) % 2**32
        words = []
        for step in range(50 + 625):
            scrambled = (69069 * scrambled + 1) % 2**32
            if step >= 50:
                words.append(scrambled)
        self._twister = np.random.MT19937()
        # R keeps its position in word 0 and sets it to "all used", so the twist comes before the first draw.
        key = np.array(words[1:], dtype=np.uint32)
        self._twister.state = {"bit_generator": "MT19937", "state": {"key": key, "pos": 624}}

    def uniform(self, size: int) -> Floats:
        """``size`` uniforms in the open interval (0, 1), as ``runif(size)``."""
        smallest = 0.5 * 2.328306437080797e-10
        raw = self._twister.random_raw(size).astype(float) * 2.3283064365386963e-10
        return np.clip(raw, smallest, 1 - smallest)

    def standard_normal(self, size: int) -> Floats:
        """``size`` standard normals, as ``rnorm(size)``: each the quantile of two uniforms joined into one."""
        # takes half a second to load, which those who draw from numpy need not wait for
        from scipy.special import ndtri

        big = 2.0**27
        first, second = self.uniform(2 * size).reshape(size, 2).T
        return ndtri((np.floor(big * first) + second) / big)


def _rms(series: Floats) -> float:
    return float(np.sqrt(np.mean(np.square(series))))
