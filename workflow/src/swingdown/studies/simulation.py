"""The simulation study: swings with a known damping term and noise, and how far each fitted model is from the truth.

The paper does not report several settings of its Table 2. They were inferred by fitting that table itself, so agreement
shows that one consistent reading exists and confirms nothing independently; ``INFERRED`` names them wherever shown.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from ..arrays import Floats
from ..dataset import variable
from ..engine.trajectory import simulate
from ..errors import InputError
from ..fitting.least_squares import fit_trajectory
from ..fitting.nelder_mead import fit_nelder_mead
from ..fitting.nested import fit_nested
from ..fitting.result import Fit
from ..pendulum.model import Model, models
from .noise import STREAMS, RStream, add_noise, numpy_stream
from .norms import Variable, labelled, model_coords, spread

INFERRED = (
    "quadratic_coefficient",
    "load_friction",
    "release_angle_deg",
    "duration_s",
    "start (at rest, at the first noisy sample)",
    "the fit's coefficients unbounded",
    "the norm (RMS of fit minus noise-free series, in degrees)",
    "the order of the draws (viscous, quadratic, Coulomb)",
)
INFERRED_NOTE = (
    f"Not reported in the paper, inferred from its Table 2 itself: {'; '.join(INFERRED)}. "
    "Agreement shows one consistent reading and is no independent confirmation."
)


def realizations(simulated: Sequence[str], copies: int, settings: Mapping[str, Any]) -> xr.Dataset:
    """A Dataset with ``truth`` (simulated, time) and ``noisy`` (simulated, realization, time), both in rad; the settings are its attributes.

    Parameters
    ----------
    simulated, copies
        Labels of the models to simulate, and the number of noisy copies of each swing.
    settings
        The models' values by parameter, ``restoring`` and ``form``; the release from rest ``release_angle_deg``; ``sampling_rate_hz`` and
        ``duration_s``, both ends included; ``snr`` and ``noise`` (``noise.add_noise``), the ``seed``, and the ``stream``: ``R``, drawn
        through all realisations as in one R session, or ``numpy``, in which each depends on seed, model and index alone.

    Raises
    ------
    InputError
        For a setting that cannot be used.
    """
    if copies < 1:
        raise InputError("simulation.realizations", f"{copies}", "1 or more")
    rate, release = settings["sampling_rate_hz"], np.radians(settings["release_angle_deg"])
    times = np.arange(round(settings["duration_s"] * rate) + 1) / rate
    draws = _draws(settings["stream"], settings["seed"], times.size)
    noise, snr = settings["noise"], settings["snr"]
    truth, noisy = [], []
    for label in simulated:
        model = Model(tuple(label.split("+")), restoring=settings["restoring"], form=settings["form"])
        known = {name: settings[name] for name in model.parameters if name in settings}
        truth.append(simulate(model.with_values(known), times, release))
        noisy.append([add_noise(noise, truth[-1], snr, draws(label, k)) for k in range(copies)])
    data = xr.Dataset(
        {
            "truth": (("simulated", "time"), np.array(truth)),
            "noisy": (("simulated", "realization", "time"), np.array(noisy)),
        },
        {
            "simulated": variable("simulated", list(simulated), "simulated model"),
            "realization": variable("realization", np.arange(1, copies + 1), "noisy copy"),
            "time": ("time", times),
        },
        dict(settings) | {"source": "simulated", "emulated": "no", "inferred": INFERRED_NOTE},
    )
    return labelled(data)


def _draws(stream: str, seed: int, size: int) -> Callable[[str, int], Floats]:
    if stream == "R":
        drawn = RStream(seed)
        return lambda label, index: drawn.standard_normal(size)
    if stream == "numpy":
        return lambda label, index: numpy_stream(seed, label, index).standard_normal(size)
    raise InputError("simulation.stream", f"unknown stream {stream!r}", " or ".join(STREAMS))


def simulation_norms(
    realizations: xr.Dataset,
    simulated: str,
    fitted: Sequence[str],
    start: str = "rest",
    own: Mapping[str, Any] | None = None,
) -> xr.Dataset:
    """A Dataset (simulated, fitted, realization, parameter) of the distance of each fitted model from one simulated truth.

    ``norm`` (degrees) is the RMS of fit minus noise-free truth, ``residual_norm`` that of noisy data minus fit. Plain names are of
    the paper's Nelder-Mead, those with the prefix ``least_squares_`` of trajectory least squares.

    ``realizations`` is as the function of that name returns it, ``simulated`` one of its models; ``fitted`` are labels of the models to fit,
    ``start`` is ``rest`` or ``free``, and ``own`` the settings' key ``effects``.
    """
    if simulated not in realizations["simulated"].values:
        known = ", ".join(realizations["simulated"].values)
        raise InputError("simulation.simulated", f"{simulated!r} was not simulated", known)
    chosen = realizations.sel(simulated=simulated)
    times, truth, swings = (chosen[name].values for name in ("time", "truth", "noisy"))
    family = models(fitted, own, realizations.attrs["restoring"], realizations.attrs["form"])
    coords = model_coords(family)
    names = coords["parameter"][1]
    shape = (1, len(fitted), len(swings))
    variables: dict[str, Variable] = {}

    def rows_of(method: Callable[..., Fit], swing: Floats) -> dict[str, list[Any]]:
        fits = fit_nested(family, lambda model, guess: method(model, times, swing, guess=guess, start=start))
        return {
            "norm": [_rms_degrees(fit.angle - truth) for fit in fits],
            "residual_norm": [_rms_degrees(fit.angle - swing) for fit in fits],
            "value": [spread(fit.model.values, names) for fit in fits],
            "standard_error": [spread(fit.model.standard_errors, names) for fit in fits],
            "converged": [fit.converged for fit in fits],
            "evaluations": [fit.evaluations for fit in fits],
        }

    for prefix, method in (("", fit_nelder_mead), ("least_squares_", fit_trajectory)):
        rows = [rows_of(method, swing) for swing in swings]
        for name in rows[0]:
            stacked = np.array([row[name] for row in rows]).swapaxes(0, 1)
            dims = ("simulated", "fitted", "realization", "parameter")[: stacked.ndim + 1]
            variables[prefix + name] = (dims, stacked.reshape(*shape, *stacked.shape[2:]))
    coords |= {
        "simulated": variable("simulated", [simulated], "simulated model"),
        "realization": ("realization", chosen["realization"].values, dict(chosen["realization"].attrs)),
    }
    data = xr.Dataset(variables, coords, realizations.attrs | {"start": start})
    meaning = "RMS of fit minus noise-free truth"
    return labelled(data, norm=meaning, least_squares_norm=meaning)


def _rms_degrees(series: Floats) -> float:
    return float(np.degrees(np.sqrt(np.mean(np.square(series)))))
