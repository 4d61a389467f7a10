"""The curves of a pendulum as one labelled dataset and as a tidy table: free of a model and of the model, with bands of 95 %."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from ..arrays import Floats
from ..dataset import variable
from ..errors import InputError
from ..fitting.uncertainty import half_widths
from ..measurement.slack import of_angles
from ..pendulum.model import Model
from ..pendulum.slack import Slack
from ..studies.amplitudes import HalfSwings, half_swings_of
from .free import free
from .misfit import with_discrepancy

SOURCES = ("free", "model", "alone")
COLUMNS = ["campaign", "quantity", "source", "against", "at", "at_unit", "value", "u", "low", "high", "unit"]
_POINTS = 41  # of each curve


class Curve(NamedTuple):
    """What a curve is: its argument, its unit, and its name in words."""

    against: str
    unit: str
    words: str


CURVES = {
    "period": Curve("amplitude", "s", "period"),
    "frequency": Curve("amplitude", "Hz", "frequency"),
    "loss": Curve("amplitude", "1", "share of the amplitude that a swing takes"),
    "damping_ratio": Curve("amplitude", "1", "equivalent damping ratio"),
    "quality": Curve("amplitude", "1", "quality"),
    "restoring": Curve("angle", "rad/s^2", "restoring torque over inertia"),
    "friction": Curve(
        "speed", "rad/s^2", "friction over inertia that takes as much as a function of speed alone"
    ),
}
# Each follows from the loss of the logarithm of the amplitude in a half-swing, which rises or falls all along.
_OF_LOSS: dict[str, Callable[[Floats], Floats]] = {
    "loss": lambda one: -np.expm1(-2 * one),
    "damping_ratio": lambda one: one / np.hypot(np.pi, one),
    "quality": lambda one: np.pi / (2 * one),
}


class Band(NamedTuple):
    """A curve with its standard uncertainty and the k of its band."""

    value: Floats
    u: Floats
    factor: Floats

    def through(self, function: Callable[[Floats], Floats]) -> tuple[Floats, Floats, Floats, Floats]:
        """Value, standard uncertainty, and lower and upper end of the band of a function of it that rises or falls."""
        with np.errstate(divide="ignore", invalid="ignore"):
            value = function(self.value)
            ends = np.sort([function(self.value + sign * self.factor * self.u) for sign in (1, -1)], axis=0)
            u = np.abs(function(self.value + self.u / 10) - function(self.value - self.u / 10)) * 5
        # where a loss may be none at all, a quality may be as high as one likes
        crossed = (self.value - self.factor * self.u <= 0) & (ends[0] < 0) & (value > 0)
        crossed &= function(np.array([1e-9]))[0] > 1
        ends = np.where(crossed, [np.where(ends[1] > 0, ends[1], ends[0]), np.full(value.size, np.inf)], ends)
        return value, u, ends[0], ends[1]


def curves(
    angles: Sequence[xr.Dataset],
    model: Model | None = None,
    covariance: Floats | None = None,
    restoring: str = "sine",
) -> xr.Dataset:
    """A Dataset of a pendulum's curves over ``amplitude`` and ``angle`` (rad) and ``speed`` (rad/s).

    Parameters
    ----------
    angles
        Angle datasets of its recordings, sampled or of turning points.
    model, covariance
        The model and the covariance of its parameters, for the curves of the model.
    restoring
        ``sine`` or ``linear``.

    Returns
    -------
    xarray.Dataset
        By ``source``, ``free`` of a model, ``model`` (with what it lacks), and that ``alone`` (without a band): ``period`` (s),
        ``frequency`` (Hz), ``loss`` (share of the amplitude, a swing), ``damping_ratio``, ``quality``, ``restoring`` and ``friction``
        (rad/s²), each with standard uncertainty (``_u``) and 95 % band (``_low``, ``_high``). ``swing_period`` and ``swing_loss`` are
        single swings, over ``swing``. NaN where the readings have no unit of angles or no times.

    Raises
    ------
    InputError
        For recordings with too few half-swings.
    """
    swings, problems = [], []
    for one in angles:
        try:
            swings.append(half_swings_of(one, restoring))
        except InputError as problem:
            problems.append(problem)
    if not swings:
        raise problems[0]
    found = free(swings, restoring)
    scaled = all(one.scaled for one in swings)
    scale, unit = (1.0, "rad") if scaled else _reading(angles[0])
    amplitude = np.linspace(found.low, found.high, _POINTS)
    angle = np.linspace(0.0, found.high, _POINTS)
    speed = np.linspace(0.0, found.scale * float(found.ideal.speed(np.array([found.high]))[0]), _POINTS)
    # at the middle a torque's share of the ideal one is asked beside it
    inside = np.maximum(angle, 1e-3 * found.high)
    own = {
        "period": Band(*found.period_at(amplitude)),
        "loss": Band(*found.loss_at(amplitude)),
        "restoring": Band(*found.restoring_at(inside)),
        "friction": Band(*found.friction_at(speed)),
    }
    beside = alone = {name: _bandless(np.full_like(one.value, np.nan)) for name, one in own.items()}
    if model is not None:
        known = with_discrepancy(found, model, covariance, amplitude, inside, speed)
        beside = {name: Band(one.value, one.u, one.factor) for name, one in known.items()}
        alone = {name: _bandless(one.alone) for name, one in known.items()}
    slack = of_angles(angles)
    bands = [_with_clock(one, slack, angle / inside) for one in (own, beside, alone)]
    variables = _by_source(bands, scaled)
    variables |= _single(swings, scale)
    coordinates = {
        "source": ("source", list(SOURCES)),
        "amplitude": variable("amplitude", amplitude * scale, "amplitude", unit),
        "angle": variable("angle", angle, "angle from the middle", "rad"),
        "speed": variable("speed", speed, "speed", "rad/s"),
    }
    emulated = any(str(one.attrs.get("emulated", "no")) == "yes" for one in angles)
    attrs = {
        "campaign": str(angles[0].attrs.get("campaign", "")),
        "emulated": "yes" if emulated else "no",
        "restoring": restoring,
        "model": model.label if model else "",
        "passages": "yes" if found.passages else "no",
    }
    whole = xr.Dataset(variables, coordinates, attrs)
    whole["swing_amplitude"].attrs["units"] = unit
    return whole


def _reading(angle: xr.Dataset) -> tuple[float, str]:
    """What 1 rad stands for in a dataset of readings without a unit of angles, and their unit."""
    return float(angle.attrs.get("points_scale", 1.0)), str(angle.attrs.get("points_unit", "1"))


def _bandless(value: Floats) -> Band:
    return Band(value, *[np.full_like(value, np.nan)] * 2)


def _with_clock(bands: Mapping[str, Band], slack: Slack, inside: Floats) -> dict[str, Band]:
    """The bands with what the clock's rate leaves open; those of the restoring torque as much smaller as the angle is."""
    pull = bands["restoring"]
    found = dict(bands) | {"restoring": pull._replace(value=pull.value * inside, u=pull.u * inside)}
    powers = {"period": 1, "loss": 0, "restoring": 2, "friction": 2}
    return {name: _with_share(one, powers[name] * slack.clock, slack.limited) for name, one in found.items()}


def _with_share(band: Band, share: float, limited: float) -> Band:
    """The band with one more standard uncertainty that is a share of the value, of an error within limits as far as it is ``limited``; the
    degrees of freedom are then more (JCGM 100, G.4), to first order of what they widen."""
    more = share * np.abs(band.value)
    u = np.hypot(band.u, more)
    with np.errstate(divide="ignore", invalid="ignore"):
        own, part = np.nan_to_num([band.u / u, limited * more / u])
    normal = half_widths(np.zeros(1))
    return Band(band.value, u, half_widths(part) * (1 + (band.factor / normal - 1) * own**4))


def _by_source(bands: Sequence[Mapping[str, Band]], scaled: bool) -> dict[str, Any]:
    columns: dict[str, list[tuple[Floats, ...]]] = {name: [] for name in CURVES}
    for one in bands:
        plain = {name: one[name].through(lambda value: value) for name in ("period", "restoring", "friction")}
        columns["period"].append(plain["period"])
        columns["frequency"].append(one["period"].through(lambda value: 1 / value))
        for name, function in _OF_LOSS.items():
            columns[name].append(one["loss"].through(function))
        for name in ("restoring", "friction"):
            unknown = tuple(np.full_like(part, np.nan) for part in plain[name])
            columns[name].append(plain[name] if scaled else unknown)
    variables: dict[str, Any] = {}
    for name, (against, unit, words) in CURVES.items():
        for k, (ending, more) in enumerate(_ENDINGS.items()):
            values = np.array([one[k] for one in columns[name]])
            variables[name + ending] = variable(("source", against), values, more.format(words), unit)
    return variables


_ENDINGS = {
    "": "{}",
    "_u": "standard uncertainty of the {}",
    "_low": "lower end of the 95 % band of the {}",
    "_high": "upper end of the 95 % band of the {}",
}


def _single(swings: Sequence[HalfSwings], scale: float) -> dict[str, Any]:
    """The swings as they were measured: recording, amplitude, period and loss, each with its standard uncertainty."""
    parts = [_measured(one) for one in swings]
    names, table = np.repeat([one.recording for one in swings], list(map(len, parts))), np.vstack(parts)
    words = {
        "swing_amplitude": ("rad", "amplitude of a swing"),
        "swing_period": ("s", "period of a swing"),
        "swing_period_u": ("s", "standard uncertainty of the period of a swing"),
        "swing_loss": ("1", "share of the amplitude that a swing takes"),
        "swing_loss_u": ("1", "standard uncertainty of the share of the amplitude that a swing takes"),
    }
    found: dict[str, Any] = {"swing_recording": ("swing", names.astype(str), {"long_name": "recording"})}
    for k, (name, (unit, text)) in enumerate(words.items()):
        values = table[:, k] * (scale if name == "swing_amplitude" else 1.0)
        found[name] = ("swing", values, {"units": unit, "long_name": text})
    return found


def _measured(one: HalfSwings) -> Floats:
    """Amplitude, period, loss of each swing and their errors (swing, column): from turning points a swing apart, and the marks beside them."""
    step = 1.0 if one.both else float(np.median(np.diff(one.number)))
    angle = dict(zip(one.number.tolist(), zip(one.angle, one.u_angle, strict=True), strict=True))
    marks = dict(zip(one.at.tolist(), zip(one.mark, one.u_mark, strict=True), strict=True))
    rows = []
    for number in one.number.tolist():
        around = [angle.get(number + k * step) for k in range(3 if one.both else 2)]
        if any(part is None for part in around):
            continue
        points = np.array(around, dtype=float)
        if one.both:
            sizes = np.abs(np.diff(points[:, 0])) / 2
            # the turn in the middle is in both sizes alike, so the outer two alone move their ratio
            u, swing = np.sqrt(0.5) * float(points[:, 1].mean()), 1.0
        else:
            sizes, u, swing = np.abs(points[:, 0]), np.sqrt(2) * float(points[:, 1].mean()), step / 2
        power = 2.0 if one.both else 1 / swing
        if not (sizes > 0).all():
            continue
        ratio = float(sizes[1] / sizes[0]) ** power
        amplitude = float(np.sqrt(sizes[0] * sizes[1]))
        begin = number + (0.5 if one.at.size and one.at[0] % 1 else 0.0)
        ends = marks.get(begin), marks.get(begin + max(2.0, step))
        period, u_period = np.nan, np.nan
        if ends[0] and ends[1]:
            swings = max(2.0, step) / 2
            period = float(ends[1][0] - ends[0][0]) / swings
            u_period = float(np.hypot(ends[0][1], ends[1][1])) / swings
        rows.append((amplitude, period, u_period, 1 - ratio, power * ratio * u / amplitude))
    return np.array(rows).reshape(-1, 5)


def table(found: xr.Dataset) -> pd.DataFrame:
    """A DataFrame of the ``curves`` of a dataset: campaign, quantity, source, against, at, at_unit, value, u, low, high (of the 95 % band), unit.

    Single swings are rows of the source ``swing``, without a band. What is not known (nan) has no row.
    """
    words: list[tuple[str, ...]] = []
    numbers: list[Floats] = []
    for name, (against, unit, _) in CURVES.items():
        at, at_unit = found[against].values, found[against].attrs["units"]
        values = [found[name + end].values for end in _ENDINGS]
        for k, source in enumerate(SOURCES):
            words += [(name, source, against, at_unit, unit)] * at.size
            numbers.append(np.column_stack([at, *(one[k] for one in values)]))
    at, at_unit = found["swing_amplitude"].values, found["swing_amplitude"].attrs["units"]
    for name in ("period", "loss"):
        words += [(name, "swing", "amplitude", at_unit, CURVES[name].unit)] * at.size
        single = found[f"swing_{name}"].values, found[f"swing_{name}_u"].values
        numbers.append(np.column_stack([at, *single, np.full((at.size, 2), np.nan)]))
    whole = pd.DataFrame(words, columns=["quantity", "source", "against", "at_unit", "unit"])
    whole[["at", *(end.strip("_") or "value" for end in _ENDINGS)]] = np.vstack(numbers)
    whole["campaign"] = found.attrs["campaign"]
    return whole.dropna(subset=["value"])[COLUMNS]
