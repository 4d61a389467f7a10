"""Whether a fit can be what it is called: residuals of the noise's size, sizes and shapes within their bounds and determined."""

from collections.abc import Iterable, Sequence

import numpy as np

from ...fitting.result import Fit
from ...pendulum.effect import NATURAL_FREQUENCY
from ..criterion import CLEAR
from ..data.campaign import Swing
from ..data.noise import Noise
from .refit import widest

_CHANCE = 5.0  # standard deviations of the size of a residual
_HOPELESS = 1.5  # times what the best leaves
_VAGUE = 1.0  # standard error over value, of a shape that is not determined


def leaves_noise(fit: Fit, noise: Noise) -> bool:
    """True if the residual's size is that of the noise, to five standard deviations of what the samples allow."""
    return bool(abs(fit.rms / noise.deviation - 1) < _by_chance(fit, noise))


def chance_of(fit: Fit, noise: Noise) -> float:
    """What further swings leave at most by chance (RMS, rad) with a fit that leaves nothing but noise."""
    return max(fit.rms, noise.deviation) * (1 + _by_chance(fit, noise))


def _by_chance(fit: Fit, noise: Noise) -> float:
    """What the size of a residual that is noise may be off by, as a share."""
    return float(_CHANCE / np.sqrt(2 * noise.effective(fit.n)) + 0.01)


def hopeless(best: Fit, swings: Sequence[Swing], noise: Noise) -> float:
    """What a model must leave (RMS, rad) of the widest of the swings alone to be no rival of a fit to all of them."""
    return _HOPELESS * max(best.swings[widest(swings)].rms, noise.deviation)


def inadmissible(fit: Fit, added: str | None, noise: Noise) -> str:
    """Why a fitted effect cannot be what it is called: empty, or the parameter that runs to a bound or is not determined."""
    if added is None:
        return ""
    effect = fit.model.catalogue[added]
    size, values = effect.size, fit.models[0].values
    if size is None:
        return ""
    if not is_there(fit, added):
        return f"{size.name} wants to be below {size.lower:g} {size.unit}"
    if not clear(fit, added):
        return f"{size.name} is not determined"
    for parameter in effect.parameters:
        if parameter.apart_from_swing:
            own = values[NATURAL_FREQUENCY.name] / (2 * np.pi)
            low, high = parameter.apart_from_swing
            if low < values[parameter.name] / own < high:
                return f"{parameter.name} is that of the pendulum's own swing"
    if bound := at_its_bound(fit, added):
        return bound
    for parameter in effect.with_role("shape"):
        if not parameter.each and _vague(fit, parameter.name, values[parameter.name], parameter.starts):
            return f"{parameter.name} is not determined"
    return ""


def at_its_bound(fit: Fit, name: str) -> str:
    """The parameter of an effect that a fit ends with at its bound, in words; empty where there is none but those at whose end it is
    another effect."""
    effect = fit.model.catalogue[name]
    ends = {parameter for simpler in effect.contains for parameter, at in simpler.at.items() if at == 0}
    for parameter in effect.parameters:
        if parameter.role in ("phase", "start") or parameter.name in ends:
            continue
        value = fit.models[0].values[parameter.name]
        if value >= parameter.upper * (1 - 1e-9):
            return f"{parameter.name} runs to its bound {parameter.upper:g} {parameter.unit}"
        # where a search may begin, a fit may end
        if value <= parameter.lower + 1e-9 * abs(parameter.lower) and parameter.lower not in parameter.starts:
            return f"{parameter.name} runs to its bound {parameter.lower:g} {parameter.unit}"
    return ""


def swings_by_itself(fit: Fit, names: Iterable[str]) -> bool:
    """False where the data leave the pendulum's own frequency anywhere beside one of these effects that has a shape: what has any shape does the
    whole of the restoring then, and is a pendulum in the place of this one."""
    catalogue = fit.model.catalogue
    shaped = any(catalogue[name].with_role("shape") and not catalogue.damps(name) for name in names)
    return not (shaped and _vague(fit, NATURAL_FREQUENCY.name, fit.model.values[NATURAL_FREQUENCY.name]))


def is_there(fit: Fit, name: str) -> bool:
    """True where the size of an effect did not end at the bound at which nothing of it is there."""
    size = fit.model.catalogue[name].size
    return size is None or fit.models[0].values[size.name] > size.lower + 1e-12


def clear(fit: Fit, name: str) -> bool:
    """True where the size of an effect is clear of nothing by its standard error (``clear``); of one without a size always."""
    size = fit.model.catalogue[name].size
    if size is None or not is_there(fit, name):
        return size is None
    return not CLEAR * fit.model.standard_errors.get(size.name, 0.0) > abs(fit.models[0].values[size.name])


def within(fit: Fit, name: str) -> bool:
    """True where no parameter of an effect ended at a bound, where it is another effect: presliding over no angle is dry friction."""
    values = fit.models[0].values
    return is_there(fit, name) and all(
        one.lower * (1 + 1e-9) < values[one.name] < one.upper * (1 - 1e-9)
        for one in fit.model.catalogue[name].parameters
        if one.role == "shape"
    )


def determined(fit: Fit) -> bool:
    """True where the data tell each shape of a fit's effects: of drag in a power of the speed beside viscous drag they may tell the sum
    alone, and to first order all values of both are open then."""
    return not any(
        _vague(fit, one.name, fit.models[0].values[one.name], one.starts)
        for name in fit.model.names
        for one in fit.model.catalogue[name].with_role("shape")
        if not one.each and fit.model.standard_errors.get(one.name) is not None
    )


def _vague(fit: Fit, name: str, value: float, ends: Sequence[float] = ()) -> bool:
    """True for a shape that the data leave anywhere: its standard error is beyond its own size. At a bound it has none, and is told where it
    may end there (``ends``)."""
    error = fit.model.standard_errors.get(name, 0.0)
    return not (np.isfinite(error) or value in ends) or error > _VAGUE * abs(value)
