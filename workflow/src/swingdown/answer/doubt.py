"""Whether the model that describes a swing is one of a pendulum that swings by itself; if not, no number of it is told."""

import warnings

import numpy as np
import xarray as xr

from ..arrays import Floats
from ..dataset import series_of
from ..errors import InputError
from ..pendulum.catalogue import SHIPPED, Catalogue

LEFT = 0.25  # of the swing (RMS of means over a part of a period): what a damping without a name leaves of a pendulum's is less
MUCH = 0.08  # of it: a model that leaves so much lacks something, and its values are less sure than they say
PART = 0.25  # of a period: means over it hold the motion, and little noise
SURE = 3.0  # standard errors below 0
MEND = (
    "leave out what a hand or a motor moves (start_s and stop_s), and check that the column is its angle and the unit right; of a wheel on "
    "a spring or a torsion pendulum say restoring: linear"
)


class DoubtfulFit(UserWarning):
    """A model that follows a swing badly: its values may be further from the truth than their uncertainties say."""


class NotFree(InputError):
    """No model of damping follows it, or only one that gains energy."""


def check_free(fits: xr.Dataset, given: xr.Dataset, label: str, catalogue: Catalogue = SHIPPED) -> None:
    """None where the model ``label`` follows a recording with friction that takes energy; NotFree where it does not, and a warning
    where it does so badly.

    ``fits`` are those of ``studies.experiment.fit_recording`` to the angles ``given``. What is moved by a hand or a motor, or is no
    angle at all, has a least squares fit like anything else, and its values are no pendulum's.
    """
    name, own = str(given.attrs["recording"]), fits.sel(fitted=label)
    series = series_of(given).values
    each = _samples(series)
    left, swing = (float(np.std(_means(one, each))) for one in (own["residual"].values, series))
    if not left <= LEFT * swing:
        raise NotFree(
            f"recording {name}",
            f"it does not move as a pendulum that swings by itself: the best model of damping leaves {100 * left / swing:.3g} % of it",
            f"at most {100 * LEFT:.0f} %",
            MEND,
        )
    if left > MUCH * swing:
        warnings.warn(
            f"the best model of damping leaves {100 * left / swing:.2g} % of {name}: it lacks something, or a hand is in the "
            "recording, and its values are less sure than they say",
            DoubtfulFit,
            stacklevel=2,
        )
    effects = [catalogue[one] for one in label.split("+")]
    for size in [one.size.name for one in effects if one.size and one.one_sided]:
        value, error = (float(own[key].sel(parameter=size)) for key in ("value", "standard_error"))
        if value < -SURE * error:
            raise NotFree(
                f"recording {name}",
                f"it gains energy: a fit needs {size.replace('_', ' ')} below 0, {value:.3g} ± {error:.2g}",
                "a pendulum that dies away by itself",
                MEND,
            )


def _samples(series: Floats) -> int:
    """How many samples a part of a period has, by the strongest line of the spectrum: noise moves no crossings there."""
    line = 1 + int(np.argmax(np.abs(np.fft.rfft(series - series.mean()))[1:]))
    return max(1, int(PART * series.size / line))


def _means(series: Floats, size: int) -> Floats:
    return series[: series.size // size * size].reshape(-1, size).mean(axis=1)
