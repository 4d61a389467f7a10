"""The curves of a pendulum as one labelled dataset and as a tidy table: free of a model and of the model, with bands of 95 %."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr
from scipy.special import stdtrit

from ..arrays import Floats
from ..errors import InputError
from ..measurement.slack import of_angles
from ..pendulum.model import Model
from ..studies.quantities import steady
from .amplitudes import HalfSwings, half_swings_of
from .free import Free, free
from .modelled import Course, course_of, static, with_band
from .regression import kernel
from .torques import losses

SOURCES = ("free", "model")
COLUMNS = ["campaign", "quantity", "source", "against", "at", "at_unit", "value", "u", "low", "high", "unit"]
_POINTS = 41  # of each curve
_MANY = 1e9  # degrees of freedom of what is known as well as it can be
_SMOOTH = 1.8  # of the logarithm of the speed: what such a friction changes over
_ROUGH = 1e-3  # of the loss: how closely a friction of speed alone has to take what a model takes


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
_ARGUMENTS = {
    "amplitude": ("rad", "amplitude"),
    "angle": ("rad", "angle from the middle"),
    "speed": ("rad/s", "speed"),
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
    factor: float

    def through(self, function: Callable[[Floats], Floats]) -> tuple[Floats, Floats, Floats, Floats]:
        """Value, standard uncertainty, and lower and upper end of the band of a function of it that rises or falls."""
        with np.errstate(divide="ignore", invalid="ignore"):
            value = function(self.value)
            ends = np.sort([function(self.value + sign * self.factor * self.u) for sign in (1, -1)], axis=0)
            u = np.abs(function(self.value + self.u / 10) - function(self.value - self.u / 10)) * 5
        # where a loss may be none at all, a quality may be as high as one likes
        crossed = (
            (self.value - self.factor * self.u <= 0)
            & (ends[0] < 0)
            & (value > 0)
            & (function(np.array([1e-9]))[0] > 1)
        )
        ends = np.where(crossed, [np.where(ends[1] > 0, ends[1], ends[0]), np.full(value.size, np.inf)], ends)
        return value, u, ends[0], ends[1]


def curves(
    angles: Sequence[xr.Dataset],
    model: Model | None = None,
    covariance: Floats | None = None,
    restoring: str = "sine",
    told: Mapping[str, Any] | None = None,
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
    told
        The pendulum's row of ``studies.pendulums``. What its period and quality leave open beyond the covariance, as where the model is
        wrong, is in the bands of the model.

    Returns
    -------
    xarray.Dataset
        By ``source``, ``free`` of a model and ``model``: ``period`` (s), ``frequency`` (Hz), ``loss`` (share of the amplitude, a
        swing), ``damping_ratio``, ``quality``, ``restoring`` and ``friction`` (rad/s²), each with standard uncertainty (``_u``) and
        95 % band (``_low``, ``_high``). ``swing_period`` and ``swing_loss`` are single swings, over ``swing``. NaN where the readings
        have no unit of angles or no times.

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
    clock = of_angles(angles).clock
    bands = [
        _of_free(found, clock, amplitude, angle, speed),
        _as_told(_of_model(found, model, covariance, amplitude, angle, speed), amplitude, told or {}),
    ]
    variables = _by_source(bands, scaled)
    variables |= _single(swings, scale)
    coordinates = {
        "source": ("source", list(SOURCES)),
        "amplitude": ("amplitude", amplitude * scale, {"units": unit, "long_name": "amplitude"}),
        "angle": ("angle", angle, {"units": "rad", "long_name": "angle from the middle"}),
        "speed": ("speed", speed, {"units": "rad/s", "long_name": "speed"}),
    }
    about = angles[0].attrs
    emulated = any(str(one.attrs.get("emulated", "no")) == "yes" for one in angles)
    attrs = {
        "campaign": str(about.get("campaign", "")),
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


def _of_free(found: Free, clock: float, amplitude: Floats, angle: Floats, speed: Floats) -> dict[str, Band]:
    loss = found.loss.factor
    period = found.period.factor if found.period else np.nan
    inside = np.maximum(
        angle, 1e-3 * found.high
    )  # at the middle a torque's share of the ideal one is asked beside it
    restoring = Band(*found.restoring_at(inside), period)
    zero = angle / inside
    return {
        "period": _with_share(Band(*found.period_at(amplitude), period), clock),
        "loss": Band(*found.loss_at(amplitude), loss),
        "restoring": _with_share(Band(restoring.value * zero, restoring.u * zero, period), 2 * clock),
        "friction": _with_share(Band(*found.friction_at(speed), loss), 2 * clock),
    }


def _with_share(band: Band, share: float) -> Band:
    """The band with one more standard uncertainty that is a share of the value, as of a clock's rate."""
    return band._replace(u=np.hypot(band.u, share * band.value))


def _of_model(
    found: Free,
    model: Model | None,
    covariance: Floats | None,
    amplitude: Floats,
    angle: Floats,
    speed: Floats,
) -> dict[str, Band]:
    sizes = {
        "period": amplitude.size,
        "loss": amplitude.size,
        "restoring": angle.size,
        "friction": speed.size,
    }
    if model is None:
        return {
            name: Band(np.full(size, np.nan), np.full(size, np.nan), np.nan) for name, size in sizes.items()
        }
    inverse = _friction_of(found, amplitude)
    beyond = found.beyond.table.at(amplitude)[:, 0]
    rows = found.friction.at(speed / found.scale) * found.scale**2
    passages = found.passages

    def derived(one: Model) -> Floats:
        own: Course = course_of(one, found.low, found.high, passages)
        loss, period = own.at(amplitude)
        torque = static(one)
        whole = np.where(np.isfinite(loss), loss, np.interp(amplitude, amplitude[np.isfinite(loss)], loss[np.isfinite(loss)]) if np.isfinite(loss).any() else np.nan)  # fmt: skip
        return np.concatenate(
            [period, loss, (torque(-angle) - torque(angle)) / 2, rows @ (inverse @ (whole - beyond))]
        )

    bare = steady(model.motion)
    at = [model.parameters.index(name) for name in bare.parameters]
    known = np.zeros((len(at), len(at))) if covariance is None else covariance[np.ix_(at, at)]
    whole, variance = with_band(bare, known, derived)
    u = np.sqrt(np.maximum(np.diag(variance), 0.0))
    if covariance is None:
        u = np.full(whole.size, np.nan)
    edges = np.cumsum([0, *sizes.values()])
    factor = float(stdtrit(_MANY, 0.975))
    return {
        name: Band(whole[a:b], u[a:b], factor) for name, a, b in zip(sizes, edges, edges[1:], strict=False)
    }


def _as_told(bands: dict[str, Band], amplitude: Floats, told: Mapping[str, Any]) -> dict[str, Band]:
    """The bands of a model, of which period and loss are at least as uncertain as the period and quality that are told of its first swing.

    What these leave open beyond the parameters is a share of the value that is the same at all amplitudes, as free courses beside a model are.
    """
    size, period, u_period, quality, u_quality = (
        float(told.get(name, np.nan)) for name in ("amplitude_rad", "period_s", "period_s_u", "quality", "quality_u")
    )  # fmt: skip
    middle = size * np.exp(-np.pi / (2 * quality)) if quality > 0 else size

    def lacking(band: Band, share: float) -> float:
        known = np.isfinite(band.u)
        if not (known.any() and np.isfinite([middle, share]).all()):
            return 0.0
        own = float(np.interp(middle, amplitude[known], np.abs(band.u / band.value)[known]))
        return float(np.sqrt(max(share**2 - own**2, 0.0)))

    of_period, of_loss = (
        lacking(bands["period"], u_period / period),
        lacking(bands["loss"], u_quality / quality),
    )
    shares = {"period": of_period, "loss": of_loss, "restoring": 2 * of_period, "friction": of_loss}
    return {name: _with_share(band, shares[name]) for name, band in bands.items()}


def _friction_of(found: Free, amplitude: Floats) -> Floats:
    """The matrix from a loss at these amplitudes (rad) to the coefficients of a friction of speed alone that takes it: the smoothest."""
    rows = losses(found.ideal, found.friction, amplitude)
    typical = float(np.mean(np.abs(found.loss_at(amplitude)[0])))
    laws, nodes = len(found.friction.powers), found.friction.nodes
    usual = np.eye(rows.shape[1])
    usual[laws:, laws:] = kernel(nodes, _SMOOTH)
    spread = usual @ rows.T * found.friction.scale**2
    return spread @ np.linalg.inv(rows @ spread + (_ROUGH * typical) ** 2 * np.eye(amplitude.size))


def _by_source(bands: Sequence[Mapping[str, Band]], scaled: bool) -> dict[str, Any]:
    columns: dict[str, list[tuple[Floats, ...]]] = {name: [] for name in CURVES}
    for one in bands:
        plain = {name: one[name].through(lambda value: value) for name in ("period", "restoring", "friction")}
        columns["period"].append(plain["period"])
        columns["frequency"].append(one["period"].through(lambda value: 1 / value))
        for name, function in _OF_LOSS.items():
            columns[name].append(one["loss"].through(function))
        for name in ("restoring", "friction"):
            columns[name].append(
                plain[name] if scaled else tuple(np.full_like(part, np.nan) for part in plain[name])
            )
    variables: dict[str, Any] = {}
    for name, (against, unit, words) in CURVES.items():
        for k, (ending, more) in enumerate(_ENDINGS.items()):
            values = np.array([one[k] for one in columns[name]])
            variables[name + ending] = (
                ("source", against),
                values,
                {"units": unit, "long_name": more.format(words)},
            )
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
    names = np.concatenate(
        [np.full(len(one), swing.recording) for one, swing in zip(parts, swings, strict=True)]
    )
    table = np.vstack(parts)
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
    """The curves of a dataset as rows.

    Parameters
    ----------
    found
        As ``curves`` returns it.

    Returns
    -------
    pandas.DataFrame
        Columns campaign, quantity, source, against, at, at_unit, value, u, low, high (of the 95 % band), unit. Single swings are rows of the
        source ``swing``, without a band. What is not known (nan) has no row.
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
