"""Effects that do nearly the same as one of a model's own, to first order: with another value of all else, the data hardly tell them apart."""

from collections.abc import Collection

import numpy as np

from ...engine.trajectory import TrajectoryError
from ..see.linear import Frame, columns_of, orthonormal
from .candidates import additions
from .pairs import plain

_ALIKE = 0.95  # correlation of what two effects do beyond all else that the fit can do


def mimics(here: Frame, name: str, allowed: Collection[str] | None = None) -> dict[str, float]:
    """The size of each effect without a shape that is nearly the like of an effect of the fit, by name.

    ``allowed`` limits the effects. Empty for an effect without a size, or with one for each recording.
    """
    model = here.fit.model
    size = model.catalogue[name].size
    if size is None or size.name not in here.names or here.of[here.names.index(size.name)] >= 0:
        return {}
    at = here.names.index(size.name)
    others = orthonormal(np.delete(here.slopes, at, axis=1))
    own = here.slopes[:, at] - others @ (others.T @ here.slopes[:, at])
    found = {}
    for other in additions(model, allowed):
        effect = model.catalogue[other]
        if not plain(effect):
            continue
        (one,) = effect.parameters
        try:
            column = here.padded(columns_of(here, effect, {one.name: 0.0}, [one.name], rough=True))[:, 0]
        except TrajectoryError:
            continue
        column = column - others @ (others.T @ column)
        length = np.linalg.norm(own) * np.linalg.norm(column)
        if length > 0 and abs(own @ column) > _ALIKE * length:
            value = model.values[size.name] * float(own @ column / (column @ column))
            found[other] = float(np.clip(value, one.lower, one.upper))
    return found
