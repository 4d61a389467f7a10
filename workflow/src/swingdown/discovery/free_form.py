"""Torques without a name: smooth curves over angle, speed and time, as columns to test with, as fits, and as tables to draw."""

import numpy as np
import pandas as pd

from ..pendulum import catalogue as effects
from ..pendulum import formula
from .linear import columns_of, each_model
from .refit import refit

_POINTS = 41  # of a curve
_IMITATED = 0.05  # of the best determined curve: one whose share beyond the fit is smaller is the fit's own
# where on a curve over time each of its parts is seen: a drag at the largest speed, a stiffness at the largest angle, a push
_TIME_PARTS = ("drag", "stiffness", "push")


def ranges(frame):
    """The largest angle (rad) and speed (rad/s) that the fit reaches, by the free form that spans it."""
    speed = max(
        float(np.max(np.abs(np.gradient(s, w.times))))
        for s, w in zip(frame.fit.angle, frame.swings, strict=True)
    )
    return {
        "unnamed_position": max(float(np.max(np.abs(series))) for series in frame.fit.angle),
        "unnamed_velocity": speed,
    }


def coefficients(name):
    """The names of a free form's coefficients."""
    return [parameter.name for parameter in effects.effect(name).parameters if not parameter.grid]


def _fixed(frame, name):
    """The range that a free form spans, as a value of the model; empty for the one over time."""
    reach = frame.fit.model.values.get(f"{name}_range", ranges(frame).get(name))
    return {} if reach is None else {f"{name}_range": reach}


def free_columns(frame, name):
    """What each coefficient of a free form does to the angles: an array (samples, coefficients)."""
    free = coefficients(name)
    return columns_of(frame, effects.effect(name), dict.fromkeys(free, 0.0) | _fixed(frame, name), free)


def fit_free_form(frame, name):
    """The ``Fit`` with a free form beside the effects that the model has; TrajectoryError where there is none."""
    fit, added = frame.fit, dict.fromkeys(coefficients(name), 0.0) | _fixed(frame, name)
    values = tuple(model.values | added for model in each_model(fit))
    return refit((*fit.model.effects, name), values, fit, frame.swings)


def missing(frame, noise):
    """The missing torque over angle, speed and time, each as if it alone were missing: a table.

    Columns ``over`` (position, velocity, time), ``part`` (torque; over time: drag, stiffness, push), ``x`` (rad, rad/s,
    share of the record), ``torque`` and ``band`` (its standard error, both in rad/s^2; for drag and stiffness the torque
    at the largest speed and angle).
    """
    tables = []
    for name in effects.FREE_FORM:
        estimate, covariance = _estimate(frame, free_columns(frame, name), noise)
        tables.append(_curve(frame, name, estimate, covariance))
    return pd.concat(tables, ignore_index=True)


def kept(frame, noise):
    """The torques without a name that the model has, as it has them: a table as ``missing`` gives it, empty where there are none.

    The band knows how closely the fit holds each curve, the noise's colour, and not what else may be missing.
    """
    fit, tables = frame.fit, []
    for name in effects.FREE_FORM:
        if name in fit.model.effects:
            at = [fit.free.index(one) for one in coefficients(name)]
            covariance = fit.covariance[np.ix_(at, at)] * noise.inflation
            tables.append(_curve(frame, name, fit.values[at], covariance))
    return (
        pd.concat(tables, ignore_index=True)
        if tables
        else pd.DataFrame(columns=["over", "part", "x", "torque", "band"])
    )


def _curve(frame, name, estimate, covariance):
    """The table of one free form with these coefficients (rad/s^2) and their covariance."""
    tables = []
    for part, (x, shapes) in _shapes(frame, name).items():
        spread = np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", shapes, covariance, shapes), 0.0))
        over = name.removeprefix("unnamed_")
        tables.append(
            pd.DataFrame({"over": over, "part": part, "x": x, "torque": shapes @ estimate, "band": spread})
        )
    return pd.concat(tables, ignore_index=True)


def _shapes(frame, name):
    """By part of a free form: the places (rad, rad/s, share of the record) and what each coefficient gives there."""
    reach, frequency = ranges(frame), frame.fit.model.values["natural_frequency"]
    at = {
        "theta": 0.0,
        "thetadot": 0.0,
        "t": 0.0,
        "duration": 1.0,
        "omega_n": frequency,
        "s_u": _fixed(frame, name).get(f"{name}_range", 1.0),
    }
    side, since = np.linspace(0, 1, _POINTS), np.linspace(0, 1, _POINTS)
    if name == "unnamed_position":
        x = np.linspace(-1, 1, _POINTS) * at["s_u"]
        return {"torque": (x, _pieces(name, at | {"theta": x}))}
    if name == "unnamed_velocity":
        side[0] = 1e-9  # just above rest: at rest friction has no side
        return {"torque": (side * at["s_u"], _pieces(name, at | {"thetadot": side * at["s_u"]}))}
    found, third = {}, len(coefficients(name)) // len(_TIME_PARTS)
    seen = {"theta": reach["unnamed_position"], "thetadot": reach["unnamed_velocity"]}
    for k, part in enumerate(_TIME_PARTS):
        shapes = _pieces(name, at | seen | {"t": since})
        shapes[:, np.arange(shapes.shape[1]) // third != k] = 0.0
        found[part] = since, shapes
    return found


def _pieces(name, at):
    """What each coefficient of a free form, at 1 and alone, gives at these places: an array (places, coefficients)."""
    effect = effects.effect(name)
    symbols = [parameter.symbol for parameter in effect.parameters if not parameter.grid]
    return np.column_stack([
        np.broadcast_to(formula.evaluate(effect.term, **at, **dict.fromkeys(symbols, 0.0) | {one: 1.0}), _POINTS) for one in symbols
    ])  # fmt: skip


def _estimate(frame, columns, noise):
    """Coefficients of the columns beyond the fit, and their covariance under the noise.

    A curve that the fit's own terms could imitate stays at nothing: any amount of it would leave the residual as it is.
    """
    size = np.linalg.norm(columns, axis=0)
    size[size == 0] = 1.0
    left, singular, right = np.linalg.svd(frame.outside(columns) / size, full_matrices=False)
    determined = singular > _IMITATED * max(
        singular[0], _IMITATED
    )  # of a form that the model has, nothing is left over
    inverse = (right[determined].T / singular[determined]) / size[:, None]
    return inverse @ (left[:, determined].T @ frame.residual), inverse @ inverse.T * noise.slow_variance
