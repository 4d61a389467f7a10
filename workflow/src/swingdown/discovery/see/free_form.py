"""Torques without a name: smooth curves over angle, speed and time, as columns to test with, and as tables to draw."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from ...arrays import Floats
from ...pendulum.effect import NATURAL_FREQUENCY
from ...pendulum.formula import evaluate
from ...pendulum.free_form import FreeForm
from ..data.noise import Noise
from .linear import Frame, columns_of, motion

_POINTS = 41  # of a curve
_IMITATED = 0.05  # of the best determined curve: one whose share beyond the fit is smaller is the fit's own
COLUMNS = ["over", "part", "x", "torque", "band"]


def extents(frame: Frame) -> dict[str, float]:
    """The largest angle (rad) and speed (rad/s) that the fit reaches, by what a free form is over."""
    angle, speed = motion(frame.fit, frame.swings)
    return {"position": float(np.max(np.abs(angle))), "velocity": float(np.max(np.abs(speed)))}


def _range(frame: Frame, form: FreeForm) -> dict[str, float]:
    """The range that a free form spans, as a value of the model; empty for one that has none."""
    known = frame.fit.model.values
    return {name: known.get(name, extents(frame)[form.over]) for name in form.ranges}


def free_columns(frame: Frame, form: FreeForm) -> Floats:
    """What each coefficient of a free form does to the angles: an array (samples, coefficients)."""
    free = form.coefficients
    return columns_of(frame, form, dict.fromkeys(free, 0.0) | _range(frame, form), free)


def missing(frame: Frame, noise: Noise) -> pd.DataFrame:
    """The missing torque over angle, speed and time, each as if it alone were missing: a table.

    Columns ``over`` (position, velocity, time), ``part`` (torque; over time: drag, stiffness, push), ``x`` (rad, rad/s,
    share of the record), ``torque`` and ``band`` (its standard error, both in rad/s^2; for drag and stiffness the torque
    at the largest speed and angle).
    """
    forms = frame.fit.model.catalogue.free_forms
    tables = [_curve(frame, form, *_estimate(frame, free_columns(frame, form), noise)) for form in forms]
    return pd.concat(tables, ignore_index=True)


def _curve(frame: Frame, form: FreeForm, estimate: Floats, covariance: Floats) -> pd.DataFrame:
    """The table of one free form with these coefficients (rad/s^2) and their covariance."""
    tables = []
    for part, (x, shapes) in _shapes(frame, form).items():
        spread = np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", shapes, covariance, shapes), 0.0))
        columns = (form.over, part, x, shapes @ estimate, spread)
        tables.append(pd.DataFrame(dict(zip(COLUMNS, columns, strict=True))))
    return pd.concat(tables, ignore_index=True)


def _shapes(frame: Frame, form: FreeForm) -> dict[str, tuple[Floats, Floats]]:
    """By part of a free form: the places (rad, rad/s, share of the record) and what each coefficient gives there."""
    reached, since = extents(frame), np.linspace(0, 1, _POINTS)
    at: dict[str, Any] = {"theta": 0.0, "thetadot": 0.0, "t": 0.0, "duration": 1.0}
    at["omega_n"] = frame.fit.model.values[NATURAL_FREQUENCY.name]
    for parameter in form.with_role("range"):
        at[parameter.symbol] = span = _range(frame, form)[parameter.name]
    if form.over == "position":
        x = np.linspace(-1, 1, _POINTS) * span
        return {"torque": (x, _pieces(form, at | {"theta": x}))}
    if form.over == "velocity":
        x = np.linspace(0, 1, _POINTS)
        x[0] = 1e-9  # just above rest: at rest friction has no side
        return {"torque": (x * span, _pieces(form, at | {"thetadot": x * span}))}
    # each part where it is seen: a drag at the largest speed, a stiffness at the largest angle
    seen = {"theta": reached["position"], "thetadot": reached["velocity"], "t": since}
    pieces = _pieces(form, at | seen)
    found: dict[str, tuple[Floats, Floats]] = {}
    of = np.arange(pieces.shape[1]) // (pieces.shape[1] // len(form.parts))
    for k, part in enumerate(form.parts):
        found[part] = since, np.where(of == k, pieces, 0.0)
    return found


def _pieces(form: FreeForm, at: Mapping[str, Any]) -> Floats:
    """What each coefficient of a free form, at 1 and alone, gives at these places: an array (places, coefficients)."""
    symbols = [parameter.symbol for parameter in form.with_role("size")]
    nothing = dict.fromkeys(symbols, 0.0)
    alone = [evaluate(form.term, **at, **nothing | {one: 1.0}) for one in symbols]
    return np.column_stack([np.broadcast_to(one, _POINTS) for one in alone])


def _estimate(frame: Frame, columns: Floats, noise: Noise) -> tuple[Floats, Floats]:
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
