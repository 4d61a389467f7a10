"""Norm tables as labelled datasets: what each variable means, and one dataset out of many."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from ..arrays import Floats
from ..dataset import Labelled, variable
from ..errors import InputError
from ..pendulum.model import Model, as_model, symbol

# value and standard errors hold parameters of different units side by side, so plain numbers
_EACH = "number of the unit that parameter_unit names"
LABELS: dict[str, tuple[str | None, str]] = {
    "time": ("s", "time"),
    "truth": ("rad", "noise-free simulated angle"),
    "noisy": ("rad", "simulated angle with noise"),
    "norm": ("degrees", "RMS of data minus fit"),
    "residual_norm": ("degrees", "RMS of noisy data minus fit"),
    "error_bound_norm": ("degrees", "RMS of the expanded (95 %) uncertainty of the angle"),
    "value": (_EACH, "fitted value"),
    "standard_error": (_EACH, "standard uncertainty of the fitted value"),
    "random_standard_error": (_EACH, "its random part: noise and what the model misses, with their colour"),
    "systematic_standard_error": (_EACH, "its systematic part: calibration and clock"),
    "coverage_factor": (
        "1",
        "k of an interval value ± k standard uncertainties that holds the value with 95 %",
    ),
    "systematic": (_EACH, "what a standard uncertainty of a source does to the fitted value"),
    "nuisance_value": (_EACH, "fitted value of what the measurement leaves open"),
    "nuisance_standard_error": (_EACH, "its standard uncertainty after the fit"),
    "zero": ("rad", "reading at rest, as fitted, where the measurement leaves it open"),
    "zero_u": ("rad", "its standard uncertainty"),
    "nuisance_prior": (_EACH, "its standard uncertainty before the fit, about zero"),
    "correlation": ("1", "correlation of two fitted values"),
    "covariance": (
        _EACH,
        "covariance of two fitted values, in their units, the wider of both kinds of standard error",
    ),
    "largest_angle": ("rad", "largest fitted angle"),
    "evidence_norm": (
        "degrees",
        "RMS of data minus fit that stands for the evidence with free courses beside the law",
    ),
    "evidence_inflation": ("1", "variance_inflation of what the free courses leave"),
    "course_shift": (_EACH, "what the free courses change of values, and of logarithms of quantities"),
    "course_covariance": (_EACH, "covariance of these with the free courses beside the law"),
    "condition_number": ("1", "condition number of the correlation matrix of all free values"),
    "release_angle": ("rad", "fitted angle at the first sample"),
    "release_velocity": ("rad/s", "fitted angular velocity at the first sample"),
    "reduced_chi2": ("1", "chi-squared with the random uncertainty of the angle, over degrees of freedom"),
    "bic": ("1", "Bayesian information criterion, residuals taken for independent"),
    "aicc": ("1", "Akaike information criterion for small samples, residuals taken for independent"),
    "variance_inflation": (
        "1",
        "variance of the fitted values for autocorrelated over that for independent residuals",
    ),
    "fit": ("rad", "fitted angle"),
    "residual": ("rad", "angle minus fitted angle"),
    "rms": ("rad", "RMS of data minus fit"),
    "share_left": ("1", "RMS of data minus fit over that of the data, both of means over a part of a period"),
    "time_residual": ("s", "time of a turning point minus that of the fit"),
    "time_scatter": ("s", "standard deviation of the times of turning points"),
    "angle_scatter": ("rad", "standard deviation of the angles of turning points"),
    "amplitude_share": ("1", "how the period depends on the amplitude, over what weight makes of it"),
    "amplitude_share_u": ("1", "its standard uncertainty"),
    "period_first": ("s", "first period between passages"),
    "period_first_u": ("s", "its standard uncertainty"),
    "period_first_scatter": ("s", "the part of that which the scatter of the periods has"),
    "steady": ("1", "1 of even swings that keep their size"),
    "narrowing": ("1", "how wide the last third of the swings is over the first"),
    "period_change": ("s", "change of the period from the first one to the last"),
    "period_change_u": ("s", "its standard uncertainty"),
    "points_scale": ("1", "number of the unit that points_unit names which 1 rad stands for"),
    "converged": (None, "whether the fit ended at a stationary point"),
    "evaluations": (None, "trajectories computed by the fit"),
    "samples": (None, "number of samples"),
    "record_s": ("s", "length of the record"),
}
Variable = tuple[str | tuple[str, ...], Any]  # what xarray makes a variable of: dimensions, values ...
METHODS = {"": "Nelder-Mead", "least_squares_": "trajectory least squares"}


def labelled(dataset: xr.Dataset, **long_names: str) -> xr.Dataset:
    """The dataset with units and long_name on every variable that ``LABELS`` knows (``long_names`` override).

    A prefix of ``METHODS`` is read off the name and told in the long name.
    """
    for key, one in dataset.variables.items():
        name = str(key)
        prefix = next((p for p in METHODS if p and name.startswith(p)), "")
        units, text = LABELS.get(name.removeprefix(prefix), (None, ""))
        if text:
            one.attrs["long_name"] = long_names.get(name, text) + (f" ({METHODS[prefix]})" if prefix else "")
        if units:
            one.attrs |= {"units": "1", "comment": units} if units == _EACH else {"units": units}
        if name.removeprefix(prefix) == "value":
            errors = [f"{prefix}{kind}standard_error" for kind in ("", "random_", "systematic_")]
            one.attrs["ancillary_variables"] = " ".join(error for error in errors if error in dataset)
    return dataset


def model_coords(fitted: Iterable[Model | str]) -> dict[str, Labelled]:
    """Coordinates for datasets over models and parameters: ``fitted`` with symbols, ``parameter`` with units.

    ``parameter`` holds the parameters of all models together, the natural frequency first, in the catalogue's order.
    """
    models = [as_model(one) for one in fitted]
    labels = [model.label for model in models]
    wanted = {name for model in models for name in model.parameters}
    chosen = [p for p in models[0].catalogue.parameters.values() if p.name in wanted]
    return {
        "fitted": variable("fitted", labels, "fitted model"),
        "symbol": variable("fitted", [symbol(label) for label in labels], "symbol of the fitted model"),
        "parameter": variable("parameter", [p.name for p in chosen], "parameter"),
        "parameter_unit": variable("parameter", [p.unit for p in chosen], "unit of the parameter"),
    }


def as_text(variable: xr.DataArray) -> list[str]:
    """A list of str: the values of a text coordinate, however the file kept them."""
    return [str(value) for value in np.atleast_1d(variable.values)]


def over(dataset: xr.Dataset, name: str, *dims: str) -> Floats:
    """The values of a variable, these dimensions first: without its coordinates, which take a hundred times as long to look up."""
    return np.asarray(dataset.variables[name].transpose(*dims, ...).values)


def spread(model_values: Mapping[str, float], names: Sequence[str]) -> Floats:
    """An array over ``names`` with the numbers of a mapping by name, NaN where it has none."""
    return np.array([model_values.get(name, np.nan) for name in names], dtype=float)


def combine_simulated(datasets: Iterable[xr.Dataset]) -> xr.Dataset:
    """The fits of ``simulation.simulation_norms`` in one dataset, over simulated, fitted, realization and parameter.

    InputError where there are none, or they were not fitted with the same models.
    """
    return _combined(list(datasets), "simulated", "simulation/norms")


def combine_recordings(datasets: Iterable[xr.Dataset]) -> xr.Dataset:
    """The fits of ``experiment.fit_recording`` in one dataset, without the series.

    It is over fitted, recording and parameter, with the coordinates ``campaign``, ``emulated`` and ``uncertainty`` (what it is from).
    InputError where there are none, a name occurs twice, or they were not fitted with the same models.
    """
    of_one = ("time", "source", "nuisance")  # what recordings of different pendulums do not share
    datasets = [dataset.drop_dims(of_one, errors="ignore") for dataset in datasets]
    names = [str(dataset["recording"].item()) for dataset in datasets]
    if twice := sorted(name for name in names if names.count(name) > 1):
        raise InputError("experiment/norms", f"recording {twice[0]!r} is there twice", "each recording once")
    parts = [_with_recording(dataset) for dataset in datasets]
    combined = parts[0].copy() if len(parts) == 1 else _combined(parts, "recording", "experiment/norms")
    emulated = "yes" if "yes" in combined["emulated"].values else "no"
    for name, (units, text) in LABELS.items():  # of angles and of rates, side by side
        if units and name in combined and "units" not in combined[name].attrs:
            comment = f"{units}/s of recordings whose reading is rate"
            combined[name].attrs |= {"units": units, "long_name": text, "comment": comment}
    order = ("fitted", "recording", "parameter", "parameter_2", "course", "course_2")
    return combined.transpose(*order, missing_dims="ignore").assign_attrs(emulated=emulated)


def _with_recording(dataset: xr.Dataset) -> xr.Dataset:
    names = ("campaign", "emulated", "label", "reading", "uncertainty", "points", "points_unit")
    known = [dataset[name] for name in names if name in dataset.coords]
    own = {one.name: ("recording", [str(one.item())], one.attrs) for one in known}
    return dataset.expand_dims("recording").assign_coords(own)


def _combined(datasets: Sequence[xr.Dataset], dimension: str, where: str) -> xr.Dataset:
    if not datasets:
        raise InputError(where, "there is no swing to fit", "at least one", "add swings to the sample sheet")
    for dataset in datasets[1:]:
        if list(dataset["fitted"].values) != list(datasets[0]["fitted"].values):
            problem = "the parts were fitted with different models"
            raise InputError(where, problem, "the same models throughout", "delete the parts and run again")
    return xr.concat(datasets, dimension, data_vars="all", coords="different", compat="equals", join="exact",
                     combine_attrs="drop_conflicts")  # fmt: skip
