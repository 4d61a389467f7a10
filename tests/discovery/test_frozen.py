"""Thirty verdicts are what they were: a number that changes anywhere in fits and search is seen here within a minute.

The second pendulum makes the swings, so a change of the engine is seen as well. ``frozen.json`` holds the verdicts; after a change
that is meant, ``FROZEN_WRITE=1 make quick TESTS=tests/discovery/test_frozen.py`` writes them anew, and the diff shows what it did.
"""

from pathlib import Path

import numpy as np
import pytest
from frozen import held, unrounded

import swingdown
from swingdown_trials.second_pendulum import BELOW_NOISE, trajectory

FROZEN = Path(__file__).with_name("frozen.json")
NOISE, DURATION, RATE = 1.5e-3, 12, 50  # rad (rad/s of rates), s, samples a second
VALUES = {"natural_frequency": 7.0, "viscous_ratio": 0.008, "load_friction": 0.002, "constant_friction": 0.08}
TWO, THREE, FOUR = (0.7, -0.5), (0.7, -0.5, 0.3), (0.8, -0.6, 0.45, -0.3)  # rad, the releases
DRAG, WEAK_DRAG = {"quadratic_coefficient": 0.02}, {"quadratic_coefficient": 0.0012}
VIBRATION = {"vibration_acceleration": 0.3, "vibration_frequency": 2.3, "vibration_phase": 0.3}
STOP = {"stop_stiffness": 1.0, "stop_from": 0.25}
PATCH = {"patch_friction": 0.1, "patch_from": 0.05, "patch_to": 0.2}
SIDE = {"one_sided_drag": 0.05}
DETENT = {"detent_torque": 0.3, "detent_order": 12, "detent_phase": 0.4}

# By name: what is hidden, its values, the releases, and what else is particular about the campaign.
CAMPAIGNS = {
    "nothing hidden, three swings": ((), {}, THREE, {}),
    "nothing hidden, one swing": ((), {}, (0.7,), {}),
    "nothing hidden, two small swings": ((), {}, (0.15, -0.1), {"rate": 100}),
    "quadratic drag": (("quadratic_drag",), DRAG, THREE, {}),
    "quadratic drag, hardly seen": (("quadratic_drag",), WEAK_DRAG, THREE, {}),
    "presliding": (("presliding",), {"presliding_friction": 0.15, "presliding_angle": 0.03}, THREE, {}),
    "Stribeck": (("stribeck",), {"stribeck_friction": 0.3, "stribeck_velocity": 0.3}, THREE, {}),
    "eddy brake": (("eddy_brake",), {"eddy_coefficient": 0.3, "eddy_width": 0.2}, THREE, {}),
    "steady wind": (("steady_wind",), {"wind_speed": 0.7, "wind_coefficient": 0.01}, THREE, {}),
    "cubic stiffness, one swing": (("cubic_stiffness",), {"cubic_stiffness": 1.5}, (0.7,), {}),
    "magnet": (("magnet",), {"magnet_depth": 0.05, "magnet_width": 0.15}, THREE, {}),
    "constant torque, hardly seen": (("constant_torque",), {"constant_torque": 0.03}, THREE, {}),
    "vibration, two swings": (("base_vibration",), VIBRATION, TWO, {}),
    "damping that drifts": (("damping_drift",), {"damping_drift": 0.006}, THREE, {}),
    "added mass": (("added_mass",), {"added_mass": 0.01}, THREE, {}),
    "sensor lag": (("sensor_lag",), {"lag_time": 0.02}, THREE, {}),
    "backlash": (("backlash",), {"backlash_width": 0.01}, THREE, {}),
    "drag and a stiffer spring": (("quadratic_drag", "cubic_stiffness"), DRAG | {"cubic_stiffness": 1.5}, THREE, {}),
    "drift and detent": (("damping_drift", "detent"), DETENT | {"damping_drift": 0.006}, THREE, {}),
    "drag, torque and a clock that drifts": (
        ("quadratic_drag", "constant_torque", "clock_drift"), DRAG | {"constant_torque": 0.3, "clock_drift": 0.002}, FOUR, {},
    ),
    "a stop that no catalogue has": (("soft_stop",), STOP, THREE, {}),
    "a stop that no catalogue has, one swing": (("soft_stop",), STOP, (0.7,), {}),
    "a patch that no catalogue has": (("friction_patch",), PATCH, FOUR, {"rounds": 2}),
    "one-sided drag that no catalogue has": (("one_sided_drag",), SIDE, THREE, {"rounds": 2}),
    "a stop beside vibration": (("soft_stop", "base_vibration"), STOP | VIBRATION, FOUR, {"rounds": 2}),
    "a patch beside drag": (("friction_patch", "quadratic_drag"), PATCH | DRAG, FOUR, {"rounds": 2}),
    "a spring pulls back, drag": (("quadratic_drag",), DRAG, (2.5, -1.8, 1.0), {"restoring": "linear"}),
    "a gyroscope, quadratic drag": (("quadratic_drag",), DRAG, THREE, {"reading": "rate"}),
    "quadratic drag, a fifth of the samples missing": (("quadratic_drag",), DRAG, THREE, {"missing": 0.2}),
    "quadratic drag, late stamps": (("quadratic_drag",), DRAG, THREE, {"late": 2e-3}),
}  # fmt: skip


def swings(
    hidden, values, releases, reading="angle", restoring="sine", rate=RATE, missing=0.0, late=0.0, **_
):
    """Lists of times (s) and readings (rad, rad/s): a share of the samples ``missing``, each stamp ``late`` by so much (s) on average."""
    draws = np.random.default_rng(27)
    base = ("viscous", "load_coulomb" if restoring == "sine" else "constant_coulomb")
    true = np.arange(DURATION * rate + 1) / rate
    times, readings = [], []
    for release in releases:
        motion = trajectory(
            (*base, *hidden),
            VALUES | values,
            true,
            release,
            restoring=restoring,
            reading=reading,
            accuracy=BELOW_NOISE,
        )
        kept = draws.random(true.size) >= missing
        times.append((true + late * draws.standard_exponential(true.size))[kept])
        readings.append((motion.reading + NOISE * draws.standard_normal(true.size))[kept])
    return times, readings


def found(hidden, values, releases, special):
    """What is frozen of a campaign's verdict, its numbers not yet rounded."""
    times, readings = swings(hidden, values, releases, **special)
    answer = swingdown.explain(
        times,
        readings,
        unit="rad/s" if special.get("reading") == "rate" else "rad",
        restoring=special.get("restoring", "sine"),
        rounds=special.get("rounds", 4),
        fitted=("viscous", "quadratic_drag"),
        zero_tolerance=None if special.get("reading") == "rate" else 0.0,  # the angles are from the vertical
    )
    told, (period, error, _) = answer.verdict, answer.quantities["period"]
    return {
        "status": told["status"],
        "effects": {one["name"]: one["tied_with"] for one in told["effects"]},
        "stand_ins": [one["name"] for one in told["stand_ins"]],
        "gap": told["gap"]["holdout"][-1],
        "period_s": period,
        "period_s_u": error,
    }


def rounded(one):
    """Gaps to 0.01, periods to five digits, uncertainties to two."""
    digits = {"gap": ".2f", "period_s": "#.5g", "period_s_u": "#.2g"}
    return one | {key: f"{one[key]:{form}}" for key, form in digits.items()}


@pytest.mark.filterwarnings("ignore::swingdown.engine.trajectory.TrajectoryWarning")
@pytest.mark.parametrize("name", CAMPAIGNS)
def test_the_verdict_is_what_it_was(name):
    held(FROZEN, CAMPAIGNS, name, found(*CAMPAIGNS[name]), unrounded, rounded)
