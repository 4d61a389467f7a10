"""Which model of damping describes a pendulum, by its evidence, and the values that all of them tell."""

from collections.abc import Iterable, Mapping, Sequence
from itertools import compress

import numpy as np
import xarray as xr

from ..arrays import Bools, Floats
from ..pendulum.catalogue import ANGLE, SHIPPED, Catalogue
from ..pendulum.effect import NATURAL_FREQUENCY, Effect
from ..pendulum.model import Model
from .comparison import WORTH, aic_effective, bic_effective, terms_of
from .norms import as_text, over
from .quantities import UNITS, Beside, Quantity, about, over_models, quantities

_COUNTS = 0.01  # share of a model in a value, below which it is left out
_EVIDENCE = ["norm", "variance_inflation", "samples", "value", "standard_error"]  # what evidence is told by


def described_by(norms: xr.Dataset, catalogue: Catalogue = SHIPPED) -> str:
    """The label of the model of damping that describes recordings (``norms.combine_recordings``): the smallest whose further terms are not
    worth it.

    By BIC, for as many samples as count as independent. A model whose effect has a size or a shape that it cannot have (a damper that
    gives energy, a drag by the 25th power), or one whose values ran away (no standard error, one above the frequency, or ``_ran_away``), is
    left out where there is another.
    """
    labels, evidence, usable = _evidence(norms, catalogue)
    terms = terms_of(norms).sum(axis=1)
    return simplest([(labels[k], float(evidence[k]), int(terms[k])) for k in usable], catalogue)


def simplest(models: Sequence[tuple[str, float, int]], catalogue: Catalogue = SHIPPED) -> str:
    """The label of the smallest of these models, each with its BIC and the number of its terms, whose further terms are not worth it."""
    lowest = min(bic for _, bic, _ in models)
    # of passages without speeds there is no evidence
    near = [one for one in models if one[1] - lowest <= WORTH] or models

    def seldom(label: str) -> int:
        """How many of its effects have no letter of their own: of laws that are as good, the usual one is named first."""
        return sum(name not in catalogue or not catalogue[name].symbol for name in label.split("+"))

    return min(near, key=lambda one: (one[2], seldom(one[0]), one[1]))[0]


def usable(fits: xr.Dataset, catalogue: Catalogue = SHIPPED) -> tuple[str, ...]:
    """The labels of the models that ``described_by`` chooses from, of one recording, by its ``fits`` of ``experiment.fit_recording``."""
    labels, _, kept = _evidence(fits[_EVIDENCE].expand_dims("recording"), catalogue)
    return tuple(labels[k] for k in kept)


def describes(fits: xr.Dataset, catalogue: Catalogue = SHIPPED) -> str:
    """The label of ``described_by`` of one recording, by its ``fits`` of ``experiment.fit_recording``."""
    return described_by(fits[_EVIDENCE].expand_dims("recording"), catalogue)


def _evidence(norms: xr.Dataset, catalogue: Catalogue) -> tuple[list[str], Floats, list[int]]:
    """The models' labels, their evidence, and which of them can be a pendulum's."""
    labels, evidence = as_text(norms["fitted"]), bic_effective(norms)
    effects = [catalogue[name] for name in dict.fromkeys("+".join(labels).split("+"))]
    size_of = {one.name: one.size.name for one in effects if one.size and one.one_sided}
    known, sized = as_text(norms["parameter"]), list(size_of)
    at, pace = [known.index(name) for name in size_of.values()], known.index(NATURAL_FREQUENCY.name)
    values, errors = (
        over(norms, key, "fitted", "parameter").reshape(len(labels), len(known), -1)
        for key in ("value", "standard_error")
    )
    sound = np.isfinite(evidence) & ~(values[:, at] < 0).any(axis=(1, 2))
    sound &= ~_beyond_bounds(values, known, effects)
    unsure = np.all(np.abs(values[:, at]) < errors[:, at], axis=2)
    sound &= [not _ran_away(k, compress(sized, unsure[k]), labels, evidence) for k in range(len(labels))]
    # of a frequency within its standard error of none no pendulum is seen, but a friction that winds up as a spring does
    sound &= ~(errors[:, pace] > values[:, pace]).any(axis=1)
    # without a standard error a parameter runs away, and tells nothing
    told = np.isfinite(errors).any(axis=(1, 2))
    sound &= told | ~told.any()
    # swings that keep their size have no sound law: a friction that winds up would follow their shape as a spring does
    winds_up = [any(catalogue[one].states for one in label.split("+")) for label in labels]
    plain = [k for k, one in enumerate(winds_up) if not one]
    return labels, evidence, np.flatnonzero(sound).tolist() or plain or list(range(len(labels)))


def _beyond_bounds(values: Floats, known: Sequence[str], effects: Iterable[Effect]) -> Bools:
    """Of each model, by its values (model, parameter, recording), whether one of its effects has a shape that it cannot have."""
    found = np.zeros(len(values), dtype=bool)
    for shape in (one for effect in effects for one in effect.with_role("shape")):
        own = values[:, known.index(shape.name)]
        found |= ((own < shape.lower) | (own > shape.upper)).any(axis=1)
    return found


def _ran_away(k: int, unsure: Iterable[str], labels: list[str], evidence: Floats) -> bool:
    """Whether the values of a model ran away: swings are far less probable without an effect whose size is ``unsure``, within its standard
    error of none (Hauck and Donner, J. Am. Stat. Assoc. 72, 851 (1977))."""
    simpler = ["+".join(name for name in labels[k].split("+") if name != one) for one in unsure]
    return any(one in labels and evidence[labels.index(one)] - evidence[k] > WORTH for one in simpler)


def probability(norms: xr.Dataset, label: str, catalogue: Catalogue = SHIPPED) -> float:
    """The probability of the model ``label`` if one of those that can be a pendulum's is right and all are as likely before: its BIC weight; NaN
    where there is no evidence."""
    labels, evidence, usable = _evidence(norms, catalogue)
    shares = np.exp(-(evidence[usable] - evidence[usable].min()) / 2)
    return float(shares[usable.index(labels.index(label))] / shares.sum())


def rivals(norms: xr.Dataset, label: str, catalogue: Catalogue = SHIPPED) -> list[str]:
    """The labels of the models that do not include the model ``label`` and whose evidence is as good as its within what is worth a word, those
    that include none of the others."""
    labels, evidence, usable = _evidence(norms, catalogue)
    chosen = evidence[labels.index(label)]
    near = [labels[k] for k in usable if evidence[k] - chosen <= WORTH]
    near = [one for one in near if not _includes(one, label, catalogue)]
    inside = {one for one in near for other in near if one != other and _includes(one, other, catalogue)}
    return [one for one in near if one not in inside]


def _includes(label: str, other: str, catalogue: Catalogue) -> bool:
    """True where the model ``label`` has each effect of another one, or an effect that becomes it: a drag by a power of the speed is viscous at the
    first power."""
    own = label.split("+")
    simpler = {one.name for name in own if name in catalogue for one in catalogue[name].contains}
    return set(other.split("+")) <= {*own, *simpler}


def weights(norms: xr.Dataset, catalogue: Catalogue = SHIPPED) -> dict[str, float]:
    """By label how much each model of damping that can be a pendulum's counts where a value is told, together 1: exp(-AIC / 2), with what
    counts less than a hundredth left out (Burnham & Anderson, Sociol. Methods Res. 33, 261 (2004)). BIC, which chooses the model that is
    named, leaves out terms that are too small to be seen and large enough to move a value by its uncertainty."""
    labels, _, usable = _evidence(norms, catalogue)
    misfit = aic_effective(norms)[usable]
    found = np.exp(-(misfit - misfit.min()) / 2)
    found[found < _COUNTS * found.sum()] = 0.0
    return {labels[k]: float(one) for k, one in zip(usable, found / found.sum(), strict=True) if one > 0}


def over_laws(
    norms: xr.Dataset,
    weight: Mapping[str, float],
    amplitude: float,
    catalogue: Catalogue = SHIPPED,
    known: Mapping[str, Mapping[str, Quantity]] | None = None,
) -> dict[str, Quantity]:
    """Natural frequency, period, quality and decay time by name, whichever law of damping holds, and the parameters of the ``known`` models.

    They are the means over the laws at an amplitude (rad); an uncertainty holds that of each law, and how far they are apart. A parameter keeps
    the value of its model. ``norms`` are over fitted, parameter and parameter_2, of one recording; ``weight`` is how much each law counts, by
    label (``weights``), ``known`` the quantities of models by label, where they are known already.
    """
    own = dict(known or {})
    told = {name: one for found in own.values() for name, one in found.items() if name not in UNITS}
    own |= {label: described(norms, label, catalogue, amplitude)[1] for label in weight if not own.get(label)}
    each = [(share, own[label]) for label, share in weight.items()]
    return about(told, each) | over_models(each, UNITS)


def described(
    norms: xr.Dataset, label: str, catalogue: Catalogue = SHIPPED, amplitude: float | None = None
) -> tuple[float, dict[str, Quantity]]:
    """The amplitude (rad) at which the quantities of one recording hold, by default the largest fitted angle, and these by name.

    ``norms`` are over fitted, parameter and parameter_2, of one recording or of several fitted together; ``label`` is that of the model,
    ``catalogue`` has the effects that it is made of.
    """
    model, covariance = values_of(norms, label, catalogue)
    if amplitude is None:
        amplitude = float(norms["largest_angle"].sel(fitted=label).max())
    return amplitude, quantities(model, amplitude, covariance, _beside(norms, label, model))


def _beside(norms: xr.Dataset, label: str, model: Model) -> Beside | None:
    """What the free courses beside the model ``label`` say; None where there are none."""
    if "course_shift" not in norms:
        return None
    known, own = as_text(norms["parameter"]), as_text(norms["fitted"]).index(label)
    at = [known.index(name) for name in model.parameters]
    shift, covariance = (
        over(norms, key, "fitted", *dims)[own]
        for key, dims in (("course_shift", ("course",)), ("course_covariance", ("course", "course_2")))
    )
    at += range(len(known), shift.size)
    return Beside(shift[at], covariance[np.ix_(at, at)]) if np.isfinite(shift[at]).all() else None


def values_of(norms: xr.Dataset, label: str, catalogue: Catalogue = SHIPPED) -> tuple[Model, Floats]:
    """The fitted model, and the covariance of its parameters in the order of ``Model.parameters``; arguments as of ``described``."""
    options = {key: str(norms.attrs[key]) for key in ("restoring", "form") if key in norms.attrs}
    model = Model(tuple(label.split("+")), catalogue=catalogue, **options).of(reading_of(norms))  # type: ignore[arg-type]
    # by position: a selection by name of a whole dataset takes longer than a fit
    known, own = as_text(norms["parameter"]), as_text(norms["fitted"]).index(label)
    at = [known.index(name) for name in model.parameters]
    values, covariance = (
        over(norms, key, "fitted", *dims)[own]
        for key, dims in (("value", ("parameter",)), ("covariance", ("parameter", "parameter_2")))
    )
    model = model.with_values(dict(zip(model.parameters, map(float, values[at]), strict=True)))
    return model, covariance[np.ix_(at, at)]


def reading_of(norms: xr.Dataset) -> str:
    """What the sensor of these recordings reads: ``angle`` or ``rate``."""
    return str(np.atleast_1d(norms["reading"].values)[0]) if "reading" in norms.coords else ANGLE
