"""What curves are drawn of: a campaign's recordings, their fits, and the model that describes them."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import pandas as pd
import xarray as xr

from ..arrays import Floats
from ..errors import InputError
from ..measurement.driven import CURVES, LAWS, check_free
from ..measurement.sharing import in_one_step, sharing
from ..pendulum.catalogue import Catalogue
from ..pendulum.model import Model
from ..studies.described import described_by, values_of
from ..studies.norms import combine_recordings
from ..studies.pendulums import NO_MODEL, TOGETHER
from . import dataset, laws
from .chosen import of_verdict
from .laws import Laws


@dataclass(frozen=True)
class Recorded:
    """A campaign's recordings that share a model, with their fits, a ``joint`` fit where there is one, its ``verdicts``, and its row of the
    table of pendulums."""

    angles: list[xr.Dataset]
    fits: list[xr.Dataset]
    joint: list[xr.Dataset]
    verdicts: Sequence[dict[str, Any]]
    row: dict[str, Any]
    known: Catalogue
    restoring: str

    @property
    def emulated(self) -> str:
        """What the table says of recordings that were computed; empty of measured ones."""
        return str(self.row["emulated"])

    def curves(self) -> xr.Dataset:
        """The dataset of the curves, with the model of the search, or else that of damping; InputError where the swings are driven."""
        check_free(self.angles, CURVES)
        found = [of_verdict(one, self.restoring, self.known) for one in self.verdicts]
        model, covariance = next(filter(None, found), None) or self._of_damping() or (None, None)
        return dataset.curves(in_one_step(self.angles), model, covariance, self.restoring)

    def laws(self) -> list[Laws]:
        """The ``Laws`` of each recording; InputError where the swings are driven, or tell none."""
        check_free(self.angles, LAWS)
        fits = self.fits if len(self.fits) == len(self.angles) else [None] * len(self.angles)
        pairs = zip(self.angles, fits, strict=True)
        return [laws.laws(angle, fit, self.restoring, self.known) for angle, fit in pairs]

    def _of_damping(self) -> tuple[Model, Floats] | None:
        """The model of damping that describes the recordings, and the covariance of its parameters; None where none follows them."""
        if not self.fits:
            return None
        described = described_by(combine_recordings(self.fits), self.known)
        return values_of(self.joint[0], described, self.known)


def recorded(
    campaign: str,
    pairs: Sequence[tuple[xr.Dataset | None, xr.Dataset | None]],
    joint: Sequence[xr.Dataset],
    verdicts: Sequence[dict[str, Any]],
    pendulums: pd.DataFrame,
    known: Catalogue,
    restoring: str,
) -> Recorded:
    """The ``Recorded`` campaign.

    ``pairs`` are each recording and its fit, None where it was refused; ``pendulums`` is the table of all campaigns. InputError where nothing
    can be used, or no model of damping follows the recordings.
    """
    free = [
        pair for pair in pairs if all(one is not None for one in pair)
    ]  # damping follows them; else a search may explain them
    usable = [(angle, fit) for angle, fit in free or pairs if angle is not None]
    shared = sharing([angle for angle, _ in usable])[0]
    usable = [usable[k] for k in shared] or usable[:1]  # of what shares no model the first
    angles, fits = [angle for angle, _ in usable], [fit for _, fit in usable if fit is not None]
    names = {TOGETHER, *(str(angle.attrs["recording"]) for angle in angles)}
    own = pendulums[
        (pendulums["campaign"].astype(str) == campaign) & pendulums["recording"].astype(str).isin(names)
    ]
    if own.empty or not angles:
        raise InputError(campaign, "no recording can be used")
    row = own.iloc[-1].to_dict()
    if str(row["model"]) in NO_MODEL:
        raise InputError(campaign, f"damping {row['model']}")
    return Recorded(angles, fits, [*joint] or fits[:1], verdicts, row, known, restoring)
