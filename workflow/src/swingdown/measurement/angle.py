"""From a recording to angles in radians, with the random and the systematic part of their uncertainty kept apart."""

from math import pi, sqrt
from typing import Any

import numpy as np
import xarray as xr

from ..arrays import Floats
from ..errors import InputError
from ..pendulum.half_swings import half_swings
from ..quantisation import quantisation_step
from .apparatus import limit_at
from .driven import carried
from .gyroscope import TO_RAD_PER_S
from .points import points_recording
from .slack import as_variables, of_calibration, of_tolerances, zero_is_fitted
from .swings.even import Even
from .swings.noise_level import SPECTRUM, Noise, noise_by_times, noise_of
from .swings.release import by_itself
from .swings.spikes import without

BOUND = "half width of the interval that holds the angle with 95 %"
PAPER_BOUND = "half width of the paper's bound, limits added: it holds some 90 % of angles (docs/trust.md)"
_RAD = {"rad": 1.0, "deg": pi / 180} | TO_RAD_PER_S
_PARTS = ("standard_uncertainty", "random_uncertainty", "systematic_uncertainty", "bound")
# from a recording to its angles: what each has, and what some have
_NAMED = ("recording", "campaign", "role", "file", "sha256", "source")
_CARRIED = (
    "columns_alike", "drive_beside", "label", "unit_told", "unit_stated", "scale", "own_unit", "own_step", "read_again",
    "time_standard_uncertainty_s",
)  # fmt: skip
UNSCALED = "unknown scale"  # the mode of angles that stand for readings whose scale nobody states: period and decay alone hold
UNIFORM_95 = 0.95 * sqrt(3)  # half width of the interval that holds 95 % of a uniform distribution, in its u


def to_angle(recording: xr.Dataset, calibration: xr.Dataset | None = None, mode: str = "gum") -> xr.Dataset:
    """The angle dataset of a recording: ``angle``, its uncertainties and its 95 % bound, in rad over ``time`` (s).

    Of an angular rate the variables are ``rate`` and so on, in rad/s (``dataset.series_of`` returns either). ``reading_slack``
    (nuisance, source) has the effect of each source on gain, zero and curvature, which fits leave open. Spikes are left out.

    Parameters
    ----------
    recording
        As ``recording.ingest`` returns it. Its random uncertainty is that of the resolution (step / sqrt 12), or else of the noise
        in the recording; its systematic one that of the sheet's tolerances, without that of a zero that is open.
    calibration
        The calibration dataset, for a recording in volts.
    mode
        ``paper``, ``gum`` or ``monte-carlo``: the uncertainty of a calibrated angle.

    Raises
    ------
    InputError
        For volts without a calibration, or with one of another campaign.
    """
    if points_recording.are_points(recording):
        return points_recording.to_angle(recording)
    recording, healed = without(by_itself(recording))
    signal = recording["signal"]
    unit = signal.attrs["units"]
    if unit == "V" and "rad_per_unit" not in recording.attrs:
        angle, random, systematic, bound, notes = _from_volts(recording, calibration, mode)
    else:
        angle, random, notes = _from_angle(recording, unit, healed)
        systematic = np.zeros_like(angle)
        bound = notes["coverage_factor"] * random
    stated = of_tolerances(recording)
    if stated.names:
        open_by = stated.deviations
        fitted = zero_is_fitted(recording)  # a fit tells it, better than this
        zero = 0.0 if fitted else open_by.get("sensor_zero", 0.0)
        by_sheet = np.hypot(open_by.get("sensor_gain", 0.0) * angle, zero)
        factor = bound / np.hypot(random, systematic)
        systematic = np.hypot(systematic, by_sheet)
        bound = factor * np.hypot(random, systematic)
        also = "without that of the zero, which fits tell" if fitted else "as the sample sheet states"
        notes["systematic"] = f"{notes['systematic']}; and {also}" if unit == "V" else also
    slack = of_calibration(calibration, stated) if unit == "V" and calibration is not None else stated
    total = np.hypot(random, systematic)
    turns = unit in TO_RAD_PER_S
    name, units = ("rate", "rad/s") if turns else ("angle", "rad")

    def variable(values: Floats, text: str, **more: str) -> tuple[str, Floats, dict[str, str]]:
        whole = np.broadcast_to(values, angle.shape).copy()
        return "time", whole, {"units": units, "long_name": text, **more}

    parts = " ".join(f"{name}_{part}" for part in _PARTS)
    what = "angular rate" if turns else "angle from the vertical"
    held = PAPER_BOUND if notes["mode"] == "paper" else BOUND.replace("angle", name)
    kept = {key: recording.attrs[key] for key in _NAMED}
    kept |= {key: recording.attrs[key] for key in _CARRIED if key in recording.attrs}
    emulated = recording.attrs["emulated"]
    if unit == "V" and calibration is not None and calibration.attrs["emulated"] == "yes":
        emulated = "yes"
    return xr.Dataset(
        {
            name: variable(angle, what, ancillary_variables=parts),
            f"{name}_standard_uncertainty": variable(total, f"standard uncertainty of the {name}"),
            f"{name}_random_uncertainty": variable(random, "part that differs from sample to sample"),
            f"{name}_systematic_uncertainty": variable(systematic, "part that all samples share"),
            f"{name}_bound": variable(bound, held),
            **as_variables(slack)[0],
            **carried(recording),
        },
        {"time": recording["time"], **as_variables(slack)[1]},
        {
            **kept,
            "emulated": emulated,
            "expected_samples": len(angle),
            "clock_uncertainty": slack.clock,
            "clock_limited": slack.limited,
            **notes,
        },
    )


def _from_volts(
    recording: xr.Dataset, calibration: xr.Dataset | None, mode: str
) -> tuple[Floats, Floats, Floats, Floats, dict[str, Any]]:
    """Eq. 11 in absolute form: angle = m (V - V0), u^2 = (V - V0)^2 u_m^2 + m^2 (u_V^2 + u_V0^2) + the covariance."""
    name, campaign = recording.attrs["recording"], recording.attrs["campaign"]
    if calibration is None:
        raise InputError(
            f"{recording.attrs['file']} ({name})",
            "the recording is in volts and there is no calibration",
            "an apparatus sheet that lists its campaign",
            "set the key `apparatus` of the config",
        )
    if campaign not in calibration.attrs["campaigns"].split(","):
        raise InputError(
            f"{recording.attrs['file']} ({name})",
            f"the recording is in volts and the apparatus does not serve its campaign {campaign!r}",
            f"one of {calibration.attrs['campaigns']}",
            "add the campaign to the apparatus sheet, or correct it in the sample sheet",
        )
    if mode not in calibration["mode"].values:
        known = ", ".join(map(str, calibration["mode"].values))
        raise InputError("calibration.mode", f"unknown mode {mode!r}", known, "use one of these")
    own = calibration.sel(mode=mode)
    volts = recording["signal"].values
    slope, zero = float(own["line"].sel(coefficient="slope")), float(own["rest_voltage"])
    variance = float(own["line_covariance"].sel(coefficient="slope", coefficient_2="slope"))
    covariance, u_zero = float(own["slope_rest_covariance"]), float(own["rest_voltage_uncertainty"])
    away = volts - zero
    line = away**2 * variance + slope**2 * u_zero**2 - 2 * slope * away * covariance
    up_to, limits = (calibration[key].values for key in ("encoder_up_to", "encoder_limit"))
    encoder = (slope * limit_at(volts, up_to, limits, "as the apparatus sheet says", name)) ** 2
    if mode != "paper":
        encoder = encoder / 3  # a uniform distribution
    noise = np.full_like(volts, (slope * float(calibration["noise_voltage"])) ** 2)
    if calibration.attrs["encoder_kind"] == "random":
        random, systematic, what = np.sqrt(noise + encoder), np.sqrt(line), "line and zero"
    else:
        random, systematic, what = np.sqrt(noise), np.sqrt(line + encoder), "line, zero and encoder"
    factor = float(own["coverage_factor"])
    if mode == "paper":  # limits: the encoder's holds a sample's noise as well
        bound = np.sqrt(line + encoder)
    elif mode == "monte-carlo":
        half = (calibration["grid_high"] - calibration["grid_low"]) / 2 / calibration["grid_uncertainty"]
        bound = np.interp(volts, calibration["grid"].values, half.values) * np.hypot(random, systematic)
    else:
        bound = factor * np.hypot(random, systematic)
    notes = {"mode": mode, "coverage_factor": factor, "systematic": what}
    return slope * away, random, systematic, bound, notes


def _noise(times: Floats, values: Floats, healed: Even) -> Noise:
    """The noise that a recording shows: by its spectrum, and where that is too coarse or samples are missing by the scatter about the swing."""
    if healed.kept and not healed.missing.any() and healed.signal.size >= SPECTRUM:
        return noise_of(np.linspace(healed.times[0], healed.times[-1], healed.signal.size), healed.signal)
    return Noise(noise_by_times(times, values, half_swings(values).period(times)), 0.0)


def _from_angle(recording: xr.Dataset, unit: str, healed: Even) -> tuple[Floats, Floats, dict[str, Any]]:
    """Angle, random uncertainty and notes; ``healed`` is the signal on an even grid, spikes healed."""
    values, times = recording["signal"].values, recording["time"].values
    scale = recording.attrs.get("rad_per_unit") or _RAD.get(unit)
    scale = scale or 2 * pi / recording.attrs["counts_per_revolution"]
    step = 1.0 if unit == "counts" else quantisation_step(values)
    colour: dict[str, float] = {}
    if step:
        u, mode, factor = step / sqrt(12), "resolution", UNIFORM_95
    else:
        noise = _noise(times, values, healed)
        u, mode, factor = noise.deviation, "residual noise", 1.96
        colour = {"noise_correlation": noise.correlation} if noise.correlation else {}
    if recording.attrs.get("scale") == "unknown":
        mode = UNSCALED
    notes: dict[str, Any] = {"mode": mode, "coverage_factor": factor}
    notes |= {"systematic": "not known: no calibration; set to 0", **colour}
    hangs = recording.attrs.get("zero_rad", 0.0)
    return scale * values - hangs, np.full(len(values), scale * u), notes
