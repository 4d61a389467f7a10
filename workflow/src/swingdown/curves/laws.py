"""What each law of damping leaves of a recording: residual, what it makes of a part held out, and its evidence; is the decay exponential?"""

import warnings
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from ..arrays import Floats, Swing
from ..dataset import series_of, variable
from ..engine.trajectory import TrajectoryError, TrajectoryWarning, simulate
from ..errors import InputError
from ..fitting.least_squares import fit_jointly
from ..fitting.nested import fit_nested
from ..fitting.result import Begin, Fit, SwingStart
from ..fitting.uncertainty import uncertainty
from ..measurement.points.points_recording import PASSED, are_points
from ..pendulum.catalogue import RATE, SHIPPED, Catalogue
from ..pendulum.model import Model, everyday, model_words
from ..rounding import value_with_uncertainty
from ..studies.amplitudes import of_samples
from ..studies.comparison import WORTH
from ..studies.described import simplest, usable
from ..studies.norms import as_text
from ..studies.turning_points import fits_of

_SINGLE = ("viscous", "quadratic_drag", "load_coulomb", "constant_coulomb")
_CONSTANT = ("constant_coulomb", *(f"{one}+constant_coulomb" for one in _SINGLE[:-1]))
_EXPONENTIAL = ("viscous", "structural_damping")  # they take the same share of every swing
_HELD_OUT = 1 / 3  # of a recording, at its end
_FEWEST = 24  # samples of a part
COLUMNS = [
    "campaign", "recording", "law", "parameters", "residual_mrad", "residual_noise", "held_out_mrad", "held_out_noise",
    "delta_bic", "weight",
]  # fmt: skip


def labels(restoring: str = "sine") -> list[str]:
    """The labels of the laws that are compared: those that a first answer is chosen from, and constant friction alone and beside another."""
    return [*everyday(restoring), *(_CONSTANT if restoring == "sine" else ())]


class Law(NamedTuple):
    """What a law leaves of a recording: RMS (rad; of an angular rate rad/s) of all of it and of the part held out, BIC for the samples that count as
    independent, and the fitted series."""

    label: str
    parameters: int
    residual: float
    held_out: float
    bic: float
    fitted: Floats


@dataclass(frozen=True, repr=False)
class Laws:
    """The laws of damping on one recording: each ``Law``, the ``noise`` (rad or rad/s) of its readings, nan where it is not known, and the labels of
    the laws that the answer is chosen from."""

    recording: str
    laws: tuple[Law, ...]
    noise: float
    times: Floats = field(repr=False)
    series: Floats = field(repr=False)
    points: bool = False
    unit: str = "rad"
    chosen_from: tuple[str, ...] = ()

    def __repr__(self) -> str:
        shown = self.to_dataframe()[["residual_mrad", "held_out_mrad", "delta_bic", "weight"]]
        return f"{self.recording}: what each law of damping leaves\n{shown.to_string(float_format='{:.3g}'.format)}"

    def _repr_html_(self) -> str:
        return str(self.to_dataframe().to_html(float_format="{:.3g}".format))

    def to_dataframe(self) -> pd.DataFrame:
        """A DataFrame with a row for each law, the most probable first.

        Returns
        -------
        pandas.DataFrame
            The columns of ``table`` without the campaign and the recording, over ``law``.
        """
        return table([self], "").drop(columns=["campaign", "recording"]).set_index("law")

    @property
    def best(self) -> Law:
        """The law with the most evidence."""
        return min(self.laws, key=lambda one: one.bic)

    @property
    def weights(self) -> Floats:
        """The probability of each law if one of them is right and all are as likely before: its BIC weight."""
        bic = np.array([one.bic for one in self.laws])
        found = np.exp(-0.5 * (bic - bic.min()))
        return found / found.sum()


def exponential(found: Sequence[Laws]) -> tuple[str, float, str]:
    """Whether the decay of a pendulum's recordings is exponential (``yes``, ``no`` or ``open``), a law, and before it by how much BIC falls to
    that law from the best exponential one.

    It is the best of the laws that a first answer is chosen from; where the decay is not exponential, the one that it names.
    """
    asked = [[one for one in own.laws if one.label in (*own.chosen_from, *_EXPONENTIAL)] for own in found]
    each = [{one.label: one for one in own} for own in asked]
    everywhere = [label for label in each[0] if all(label in own for own in each)]
    bic = {label: sum(own[label].bic for own in each) for label in everywhere}
    best = min(bic, key=lambda label: bic[label])
    alike = min((label for label in _EXPONENTIAL if label in bic), key=lambda label: bic[label])
    named = simplest([(label, one, each[0][label].parameters) for label, one in bic.items()])
    if bic[alike] - bic[best] > WORTH:
        return "no", bic[alike] - bic[named], named
    if named not in _EXPONENTIAL:
        return "open", max(bic[alike] - bic[named], 0.0), named
    return ("yes" if alike == best else "open"), bic[alike] - bic[best], best


def laws(
    angle: xr.Dataset,
    known: xr.Dataset | None = None,
    restoring: str = "sine",
    catalogue: Catalogue = SHIPPED,
) -> Laws:
    """The ``Laws`` of an angle dataset, sampled or of turning points.

    They start from the ``known`` fits of ``studies.experiment.fit_recording`` to it (fitted, parameter); ``restoring`` is ``sine`` or
    ``linear``, ``catalogue`` has the effects. InputError for passages without speeds, and for a swing too short to fit.
    """
    asked = everyday(restoring) if known is None else as_text(known["fitted"])
    chosen_from = tuple(asked) if known is None else usable(known, catalogue)
    compared = [_model(label, restoring, catalogue) for label in dict.fromkeys([*asked, *labels(restoring)])]
    if are_points(angle):
        return _of_points(angle, compared, chosen_from)
    name, series = str(angle.attrs["recording"]), series_of(angle)
    times, zeros = angle["time"].values, _zeros(known, compared)
    swings = {label: (times, series.values - zero) for label, zero in zeros.items()}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", TrajectoryWarning)  # of laws that are only compared
        fits = _fits([one.of(str(series.name)) for one in compared], swings, known)
        held_out = [_held_out(fit, *swings[fit.model.label]) for fit in fits]
    best = min(fits, key=lambda fit: fit.bic)
    if known is None:
        inflation = max(1.0, uncertainty(best, [swings[best.model.label]]).inflation)
    else:  # as many samples count as independent as where the answer was chosen
        inflation = float(known["variance_inflation"][int(known["norm"].argmin("fitted"))])
    independent = max(times.size / inflation, 2.0) if np.isfinite(inflation) else times.size
    found = []
    for fit, held in zip(fits, held_out, strict=True):
        bic = independent * np.log(fit.rss / fit.n) + len(fit.free) * np.log(independent)
        fitted = fit.angle + zeros[label := fit.model.label] - zeros[best.model.label]
        found.append(Law(label, len(fit.free), fit.rms, held, bic, fitted))
    noise = _noise(angle)
    unit = str(series.attrs["units"])
    return Laws(name, tuple(found), noise, *swings[best.model.label], unit=unit, chosen_from=chosen_from)


def _model(label: str, restoring: str, catalogue: Catalogue) -> Model:
    return Model(tuple(label.split("+")), {}, {}, restoring, catalogue=catalogue)


def _noise(angle: xr.Dataset) -> float:
    """The standard deviation of the readings' random errors, nan where it is not known."""
    try:
        noise = float(np.median(series_of(angle, "random_uncertainty").values))
    except KeyError:
        return float("nan")
    return noise if noise > 0 else float("nan")


def _zeros(known: xr.Dataset | None, compared: Sequence[Model]) -> dict[str, float]:
    """The zero of the sensor by law, as it was fitted with each where it was left open; a law that was not fitted has that of the best."""
    if known is None or "zero" not in known:
        return dict.fromkeys((one.label for one in compared), 0.0)
    best = float(known["zero"][int(known["norm"].argmin("fitted"))])
    fitted = zip(as_text(known["fitted"]), map(float, known["zero"].values), strict=True)
    # a law that could not be fitted has none
    own = {label: zero for label, zero in fitted if np.isfinite(zero)}
    return dict.fromkeys((one.label for one in compared), best) | own


def _fits(models: Sequence[Model], swings: Mapping[str, Swing], known: xr.Dataset | None) -> list[Fit]:
    """The fits of these models: those that are known are where they begin, the others begin where the laws they contain ended. One that gives
    no trajectory from there either is left out."""
    begun = {} if known is None else _begun(known[["value", "release_angle", "release_velocity"]])

    def fit(model: Model, inside: list[Fit]) -> Fit | None:
        guesses: list[Begin | list[Fit] | None] = [inside or None]
        if (row := begun.get(model.label)) is not None:
            at = {name: row[name] for name in model.parameters}
            start = SwingStart(at, row["release_angle"], row["release_velocity"])
            guesses.insert(0, Begin(model, (start,)))
        for guess in guesses:  # within its bounds a law may have no trajectory where it ended without
            new, swing = guess is None, [swings[model.label]]
            with suppress(TrajectoryError):
                return fit_jointly(model, swing, guess=guess, seen=new, grown=new, bounded=True)
        return None

    return [one for one in fit_nested(models, fit) if one is not None]


def _begun(known: xr.Dataset) -> dict[str, dict[str, float]]:
    """By label the values of fits, and how the swing begins in them."""
    names = [*map(str, known["parameter"].values), "release_angle", "release_velocity"]
    release = [known[name].values[:, np.newaxis] for name in names[-2:]]
    rows = np.hstack([known["value"].transpose("fitted", "parameter").values, *release])
    return {
        str(label): dict(zip(names, row.tolist(), strict=True))
        for label, row in zip(known["fitted"].values, rows, strict=True)
        if np.isfinite(row[-2:]).all()  # a law that could not be fitted has none
    }


def _held_out(fit: Fit, times: Floats, values: Floats) -> float:
    """The RMS that a law leaves of the last third, fitted to what is before it, with a release of its own there; nan for a short recording."""
    at = int(times.size * (1 - _HELD_OUT))
    if times.size - at < _FEWEST:
        return float("nan")
    before, after = (times[:at], values[:at]), (times[at:], values[at:])
    try:
        first = fit_jointly(fit.model, [before], guess=fit, seen=False, grown=False, bounded=True)
        begin = Begin(fit.model, (SwingStart(first.model.values, *_motion(first, times[: at + 1])),))
        held = first.model.values
        last = fit_jointly(fit.model, [after], guess=begin, seen=False, grown=False, fixed=held)
    except (TrajectoryError, InputError, np.linalg.LinAlgError):
        return float("nan")
    return last.rms


def _motion(fit: Fit, times: Floats) -> tuple[float, float]:
    """The angle (rad) and the angular velocity (rad/s) of a fitted motion at the last of these times (s)."""
    one, model = fit.only, fit.model.motion
    release = one.release_angle, one.release_velocity
    return float(simulate(model, times, *release)[-1]), float(simulate(model.of(RATE), times, *release)[-1])


def _of_points(angle: xr.Dataset, models: Sequence[Model], chosen_from: tuple[str, ...]) -> Laws:
    name = str(angle.attrs["recording"])
    if angle.attrs["points"] == PASSED:
        told = "passages without speeds hold no damping", "amplitudes or samples of the motion"
        raise InputError(f"recording {name}", *told, "record the motion itself")
    fits, found = [fit for fit in fits_of(angle, models) if fit is not None], []
    for fit in fits:
        rms = float(np.sqrt(fit.rss[1] / fit.angles.size))
        found.append(Law(fit.model.label, len(fit.free), rms, np.nan, fit.bic, fit.angles))
    scatter = min(fits, key=lambda fit: fit.bic).scatter[1]
    series = angle["time"].values, angle["angle"].values
    return Laws(name, tuple(found), scatter, *series, points=True, chosen_from=chosen_from)


def table(found: Sequence[Laws], campaign: str) -> pd.DataFrame:
    """A DataFrame with a row for each recording (``laws``) of a pendulum and law, the most probable first, and the columns ``COLUMNS``.

    ``residual_mrad`` is the RMS that the law leaves (of angular rates in mrad/s), ``residual_noise`` that over the
    noise; ``held_out_mrad`` and ``held_out_noise`` are those of the last third, by a fit to what is before it. ``delta_bic`` is the BIC
    above that of the best law, for as many samples as count as independent, ``weight`` the probability that follows if one of the laws is
    right. Turning points have no part held out; their noise is how they scatter about the best law.
    """
    rows = []
    for one in found:
        weights = one.weights
        for k in np.argsort([law.bic for law in one.laws]):
            law = one.laws[k]
            rows.append(
                {
                    "campaign": campaign, "recording": one.recording, "law": law.label, "parameters": law.parameters,
                    "residual_mrad": 1e3 * law.residual, "residual_noise": law.residual / one.noise,
                    "held_out_mrad": 1e3 * law.held_out, "held_out_noise": law.held_out / one.noise,
                    "delta_bic": law.bic - one.best.bic, "weight": float(weights[k]),
                }
            )  # fmt: skip
    return pd.DataFrame(rows, columns=COLUMNS)


def exponential_words(found: Sequence[Laws], curves: xr.Dataset | None = None) -> str:
    """A sentence: whether the decay of a pendulum's recordings is exponential; with its ``curves`` (``curves.dataset.curves``) the damping
    ratio of the largest and the smallest swing stands in it."""
    answer, excess, label = exponential(found)
    best, together = model_words(label), "+" in label
    if answer == "yes":
        told = f"Exponential: yes, no law describes the decay better than {best}"
    elif answer == "open" and (shown := f"{excess:.1f}") == "0.0":
        told = (_AS_WELL_TOGETHER if together else _AS_WELL).format(law=best)
    elif answer == "open":
        told = (_OPEN_TOGETHER if together else _OPEN).format(law=best, value=shown, value_2=f"{WORTH:g}")
    else:
        told = (_NO_TOGETHER if together else _NO).format(law=best, value=_whole(excess))
    return f"{told}{_change(curves)}."


_NO = "Exponential: no, {law} describes the decay better (BIC falls by {value})"
_NO_TOGETHER = "Exponential: no, {law} describe the decay better (BIC falls by {value})"
_AS_WELL = "Exponential: not decided, {law} describes the decay as well"
_AS_WELL_TOGETHER = "Exponential: not decided, {law} describe the decay as well"
_OPEN = "Exponential: not decided, {law} describes the decay better by {value} of BIC, and {value_2} would be strong"
_OPEN_TOGETHER = "Exponential: not decided, {law} describe the decay better by {value} of BIC, and {value_2} would be strong"


def _whole(value: float) -> str:
    return f"{value:.1f}" if value < 100 else f"{value:.0f}"


def _change(curves: xr.Dataset | None) -> str:
    if curves is None:
        return ""
    free = curves.sel(source="free")
    ends = []
    for k, swing in ((-1, "the first swing"), (0, "the last swing")):
        amplitude, unit = float(free["amplitude"][k]), str(free["amplitude"].attrs["units"])
        size = f"{np.degrees(amplitude):.3g}°" if unit == "rad" else f"{amplitude:.3g} {unit}"
        # without a scale an amplitude is of no unit that anybody knows
        where = swing if unit == "1" else size
        ratio, u = float(free["damping_ratio"][k]), float(free["damping_ratio_u"][k])
        if not np.isfinite(ratio):
            return ""
        ends.append(f"{value_with_uncertainty(ratio, u)} at {where}")
    return f"; the damping ratio is {ends[0]} and {ends[1]}"


def envelopes(found: Sequence[Laws], curves: xr.Dataset | None = None, emulated: str = "no") -> xr.Dataset:
    """The amplitudes of the turning points of a pendulum's largest swing, what the laws make of them, and whether the decay is exponential.

    A Dataset of amplitudes (rad; of an angular rate rad/s) over ``time`` (s), and over ``law`` and ``time`` those of each single law and of
    that which the sentence names (``best``). ``found`` and ``curves`` are as of ``exponential_words``, ``emulated`` is ``yes`` or ``no``.
    InputError if there are too few turning points.
    """
    best, own = exponential(found)[2], max(found, key=lambda one: float(np.ptp(one.series)))
    shown = [one for one in own.laws if one.label in (*_SINGLE, best)]
    if own.points:
        when, size = own.times, np.abs(own.series)
        fitted = [np.abs(one.fitted) for one in shown]
    else:
        measured = of_samples(own.recording, own.times, own.series)
        when, size = measured.times, np.abs(measured.angle)
        fitted = [_envelope(own, one, when) for one in shown]
    about = {"best": best, "said": exponential_words(found, curves), "emulated": emulated, "recording": own.recording}  # fmt: skip
    variables = {
        "amplitude": variable("time", size, "measured amplitude", own.unit),
        "fitted": variable(("law", "time"), np.array(fitted), "amplitude of a law", own.unit),
    }
    coords = {"law": ("law", [one.label for one in shown]), "time": variable("time", when, "time", "s")}
    return xr.Dataset(variables, coords, about)


def _envelope(found: Laws, law: Law, when: Floats) -> Floats:
    """The amplitudes of a law's motion at these times (s); nan where it does not swing, as after a friction has stopped it."""
    try:
        turns = of_samples(found.recording, found.times, law.fitted)
    except InputError:
        return np.full(when.size, np.nan)
    if turns.times.size < 2:
        return np.full(when.size, np.nan)
    size = np.exp(np.interp(when, turns.times, np.log(np.abs(turns.angle))))
    # its last turning point is the measured one, if somewhat earlier
    return np.where(when < turns.times[-1] + np.diff(turns.times[-2:]) / 2, size, np.nan)
