"""The verdict's status and sentence follow from what the rounds say, ties and nameless remainders included."""

import pytest

from swingdown.discovery.verdict import verdict

UNIT = {"constant_torque": "rad/s^2", "natural_frequency": "rad/s"}


def state(
    number,
    *,
    missing,
    found=(),
    chosen=None,
    holdout=1.0,
    ranking=(),
    rivals=None,
    effects=("viscous",),
    parameters=None,
):
    """What round.json holds of one round."""
    groups = [{"name": "position", "chi_square": 900.0, "freedom": 7, "p": 0.0, "share": 0.9}]
    return {
        "round": number, "campaign": "rig", "split": "held out by amplitude: c", "effects": list(effects), "found": list(found),
        "parameters": parameters or {}, "systematic_rad": 2e-3, "largest_angle_rad": 0.5, "noise_rms_rad": 1e-3, "noise_correlation": 0.0, "gap": {"fit": holdout, "holdout": holdout},
        "missing": missing, "kind": "position" if missing else None, "seen": "the pendulum runs early" if missing else "",
        "groups": groups, "ranking": list(ranking), "rivals": rivals or {}, "reason": "",
        "chosen": chosen and {"move": f"add {chosen}", "added": chosen, "dropped": None, "gain_bic": 500.0},
    }  # fmt: skip


def row(name, tied=True):
    return {
        "move": f"add {name}",
        "added": name,
        "tied": tied,
        "correlation": 0.99,
        "delta_bic": 0.0,
        "refused": "",
    }


def test_nothing_missing_is_consistent():
    found = verdict([state(0, missing=False)])
    assert found["status"] == "consistent"
    assert found["effects"] == []
    assert found["sentence"].startswith("Nothing is missing")


def named(*ties, missing_at_the_end=False):
    values = {"constant_torque": {"value": 0.31, "standard_error": 0.02, "unit": "rad/s^2"}}
    first = state(
        0,
        missing=True,
        chosen="constant_torque",
        holdout=3.0,
        ranking=[row("constant_torque"), *map(row, ties)],
    )
    last = state(
        1,
        missing=missing_at_the_end,
        found=["constant_torque"],
        effects=("viscous", "constant_torque"),
        parameters=values,
        holdout=1.01,
    )
    return verdict([first, last])


def test_an_effect_that_stands_alone_is_named_with_its_value_and_the_gap():
    found = named()
    assert found["status"] == "named"
    assert "0.31 ± 0.02 rad/s^2" in found["sentence"]
    assert "3 → 1.01 times the noise" in found["sentence"]
    assert found["effects"][0]["round"] == 1


def test_a_tie_is_ambiguous_and_tells_the_measurement_that_splits_it():
    found = named("sensor_zero")
    assert found["status"] == "ambiguous"
    assert found["effects"][0]["tied_with"] == ["sensor_zero"]
    assert found["effects"][0]["correlation"] == {"sensor_zero": 0.99}
    assert "rest" in found["next_measurement"]


@pytest.mark.parametrize("ties", [(), ("sensor_zero",)])
def test_what_remains_makes_it_unknown_whatever_was_added(ties):
    found = named(*ties, missing_at_the_end=True)
    assert found["status"] == "unknown"
    assert "has no name" in found["sentence"]


def test_a_torque_without_a_name_stays_unknown_although_nothing_more_is_missing():
    first = state(
        0, missing=True, chosen="unnamed_position", holdout=3.0, ranking=[row("detent"), row("eccentricity")]
    )
    last = state(
        1, missing=False, found=["unnamed_position"], effects=("viscous", "unnamed_position"), holdout=1.0
    )
    found = verdict([first, last])
    assert found["status"] == "unknown"
    assert found["effects"][0]["tied_with"] == []
    assert found["gap"]["holdout"] == [3.0, 1.0]
    assert found["where"]["remaining_kind"] == "restoring"
    assert "unnamed_position" in found["sentence"]


def test_named_effects_keep_the_values_they_had_before_torques_without_a_name_could_do_their_work():
    before = {"constant_torque": {"value": 0.31, "standard_error": 0.02, "unit": "rad/s^2"}}
    after = {"constant_torque": {"value": 0.01, "standard_error": 2.0, "unit": "rad/s^2"}}
    rounds = [
        state(0, missing=True, chosen="constant_torque", holdout=9.0, ranking=[row("constant_torque")]),
        state(
            1,
            missing=True,
            found=["constant_torque"],
            chosen="unnamed_velocity",
            parameters=before,
            holdout=5.0,
        ),
        state(
            2,
            missing=True,
            found=["constant_torque", "unnamed_velocity"],
            chosen="unnamed_position",
            parameters=after,
            holdout=3.0,
        ),
        state(
            3,
            missing=True,
            found=["constant_torque", "unnamed_velocity", "unnamed_position"],
            parameters=after,
            holdout=2.0,
        ),
    ]
    found = verdict(rounds)
    assert found["effects"][0]["parameters"]["constant_torque"]["value"] == 0.31
    assert "What remains, 5 times the noise" in found["sentence"]
    assert "kept as unnamed_velocity and unnamed_position" in found["sentence"]
    assert "9 → 2 times" in found["sentence"]


def test_a_dissipation_that_would_be_negative_is_told():
    values = {"viscous_ratio": {"value": 0.0, "standard_error": None, "unit": "1"}}
    found = verdict([state(0, missing=False, parameters=values)])
    assert found["misspecified"] == ["viscous_ratio"]
    assert "negative" in found["sentence"]


@pytest.mark.parametrize(("gain", "within"), [(0.006, True), (0.02, False)])
def test_a_wrong_gain_that_the_calibration_allows_is_told_as_that(gain, within):
    values = {"sensor_gain": {"value": gain, "standard_error": 1e-4, "unit": "1"}}
    first = state(0, missing=True, chosen="sensor_gain", holdout=3.0)
    found = verdict(
        [
            first,
            state(
                1, missing=False, found=["sensor_gain"], effects=("viscous", "sensor_gain"), parameters=values
            ),
        ]
    )
    assert found["effects"][0]["within_calibration"] is within
    assert ("calibration leaves open" in found["sentence"]) is within
