"""The verdict's status and sentence follow from what the rounds say, ties and nameless remainders included."""

import pytest

from swingdown.discovery.sentence import NEARLY
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
    established=None,
    spent=False,
    noise=1e-3,
):
    """What round.json holds of one round."""
    groups = [{"name": "position", "chi_square": 900.0, "freedom": 7, "p": 0.0, "share": 0.9}]
    return {
        "round": number, "campaign": "rig", "split": "held out by amplitude: c", "effects": list(effects), "found": list(found),
        "parameters": parameters or {}, "systematic_rad": 2e-3, "largest_angle_rad": 0.5, "noise_rms_rad": noise, "noise_correlation": 0.0, "gap": {"fit": holdout, "holdout": holdout},
        "missing": missing, "kind": "position" if missing else None, "seen": "the pendulum runs early" if missing else "",
        "groups": groups, "ranking": list(ranking), "rivals": rivals or {}, "reason": "", "established": established, "established_in": None if established is None else number, "spent": spent,
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
    assert f"({1e3 * found['noise_rms_rad']:.3g} mrad) on fitted" in found["sentence"]


def named(*ties, missing_at_the_end=False, established=None, spent=False):
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
        established=established,
        spent=spent,
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
    assert found["effects"] == []


def test_what_is_not_established_is_told_as_an_imitation_with_its_size_and_what_remains_in_both_units():
    found = named(
        missing_at_the_end=True, established={"constant_torque": "sensor_zero does as well in its place"}
    )
    (one,) = found["stand_ins"]
    assert (one["name"], one["doubt"]) == ("constant_torque", "sensor_zero does as well in its place")
    assert set(one) >= {"name", "round", "parameters", "delta_bic", "tied_with", "replaces"}
    assert "imitated by constant torque (0.31 ± 0.02 rad/s^2)" in found["sentence"]
    assert "constant torque (0.31 ± 0.02 rad/s^2) is missing" not in found["sentence"]
    assert "1.01 times the noise (1.01 mrad)" in found["sentence"]
    assert "or something much like it" not in found["sentence"]
    nearly = named(missing_at_the_end=True, established={"constant_torque": NEARLY})
    assert (nearly["status"], nearly["effects"]) == ("unknown", [])
    assert "It is constant torque, or something much like it" in nearly["sentence"]


def test_of_many_effects_that_leave_nothing_only_those_established_are_asserted():
    many = ["constant_torque", "cubic_stiffness", "detent"]
    values = {name: {"value": 0.3, "standard_error": 0.01, "unit": "1"} for name in ("constant_torque", "cubic_stiffness", "detent_torque")}  # fmt: skip
    states = [
        state(k, missing=True, found=many[:k], chosen=many[k], holdout=5.0 - k, ranking=[row(many[k])])
        for k in range(3)
    ]
    doubts = dict.fromkeys(many, "swings left out do not miss it")
    last = state(3, missing=False, found=many, effects=("viscous", *many), parameters=values)
    assert verdict([*states, last])["status"] == "named"  # they were not judged
    found = verdict([*states, last | {"established": doubts, "established_in": 3}])
    assert (found["status"], found["effects"]) == ("unknown", [])
    assert [one["name"] for one in found["stand_ins"]] == many
    assert "Nothing more is missing, but what is was imitated by" in found["sentence"]
    sure = doubts | {"cubic_stiffness": ""}
    found = verdict([*states, last | {"established": sure, "established_in": 3}])
    assert found["status"] == "partial"
    assert [one["name"] for one in found["effects"]] == ["cubic_stiffness"]


@pytest.mark.parametrize(("separation", "told"), [(12.0, "Release from 40°"), (3.0, "rest")])
def test_a_swing_that_tells_a_tie_apart_is_asked_for_where_one_does(separation, told):
    swing = {
        "release_angle": 0.7,
        "duration": 30.0,
        "separation": separation,
        "between": ["a", "b"],
        "text": "Release from 40°.",
    }
    first = state(
        0, missing=True, chosen="constant_torque", ranking=[row("constant_torque"), row("sensor_zero")]
    )
    values = {"constant_torque": {"value": 0.31, "standard_error": 0.02, "unit": "rad/s^2"}}
    last = state(
        1, missing=False, found=["constant_torque"], effects=("viscous", "constant_torque"), parameters=values
    )
    found = verdict(
        [
            first,
            last
            | {
                "next_swing": swing,
                "probabilities": {"constant_torque": 0.6, "sensor_zero": 0.4, "detent": 1e-9},
            },
        ]
    )
    assert told in found["next_measurement"]
    assert found["effects"][0]["probability"] == 0.6
    assert found["probabilities"] == {"constant_torque": 0.6, "sensor_zero": 0.4}


def test_a_tie_that_nothing_at_hand_tells_apart_is_told_as_such():
    told = "None of the swings and readings that were computed tells them apart."
    first = state(0, missing=True, chosen="constant_torque", ranking=[row("constant_torque"), row("detent")])
    values = {"constant_torque": {"value": 0.31, "standard_error": 0.02, "unit": "rad/s^2"}}
    last = state(
        1, missing=False, found=["constant_torque"], effects=("viscous", "constant_torque"), parameters=values
    )
    found = verdict([first, last | {"next_swing": {"separation": 0.4, "text": told}}])
    assert found["effects"][0]["tied_with"] == ["detent"]
    assert found["next_measurement"] == told


def test_what_is_established_is_asserted_although_something_remains():
    found = named("sensor_zero", missing_at_the_end=True, established={"constant_torque": ""})
    assert found["status"] == "partial"
    assert [one["name"] for one in found["effects"]] == ["constant_torque"]
    assert found["stand_ins"] == []
    assert found["effects"][0]["tied_with"] == []  # it was held against its rivals on swings left out
    assert "0.31 ± 0.02 rad/s^2) is missing" in found["sentence"]
    assert "has no name" in found["sentence"]


def test_what_is_established_has_the_values_of_the_round_that_tells_it():
    value = {"value": 0.31, "standard_error": 0.02, "unit": "rad/s^2"}
    rounds = [
        state(0, missing=True, chosen="constant_torque", holdout=9.0, ranking=[row("constant_torque")]),
        state(
            1,
            missing=True,
            found=["constant_torque"],
            chosen="detent",
            holdout=3.0,
            parameters={"constant_torque": value},
            ranking=[row("detent")],
        ),
        state(
            2,
            missing=True,
            found=["constant_torque", "detent"],
            holdout=2.5,
            parameters={"constant_torque": value | {"value": 0.02}},
            established={"constant_torque": "", "detent": "detent_torque is not determined"},
        )
        | {"established_in": 1},
    ]
    found = verdict(rounds)
    assert [one["name"] for one in found["effects"]] == ["constant_torque"]
    assert [one["name"] for one in found["stand_ins"]] == ["detent"]
    assert found["effects"][0]["parameters"]["constant_torque"]["value"] == 0.31


def test_the_share_of_the_excess_that_is_explained_is_told_in_the_same_noise():
    """A first round that took misfit for noise is held against the noise of the last."""
    rounds = [
        state(0, missing=True, chosen="constant_torque", holdout=2.0, noise=5e-3),
        state(
            1, missing=False, found=["constant_torque"], effects=("viscous", "constant_torque"), holdout=2.0
        ),
    ]
    found = verdict(rounds)
    assert found["gap"]["explained"] == pytest.approx(1 - 3 / 99)
    assert found["gap"]["holdout_rad"] == pytest.approx([10e-3, 2e-3])
    assert "97 % of the excess explained" in found["sentence"]


@pytest.mark.parametrize("spent", [True, False])
def test_a_search_whose_time_was_spent_says_so(spent):
    found = named(missing_at_the_end=True, spent=spent)
    assert found["stopped"] is spent
    assert ("stopped where its time was spent" in found["sentence"]) is spent


def test_both_of_two_effects_that_were_added_at_once_have_the_round_and_share_no_tie():
    both = {
        "move": "add viscous and cubic_stiffness",
        "added": "viscous",
        "also": ["cubic_stiffness"],
        "dropped": None,
    }
    rows = [
        both | {"tied": True, "correlation": 1.0},
        row("presliding") | {"also": []},
        row("detent", tied=False) | {"also": []},
    ]
    first = state(0, missing=True, chosen="viscous", holdout=3.0, ranking=rows, effects=("constant_coulomb",))
    first["chosen"] = both | {"gain_bic": 500.0}
    last = state(
        1,
        missing=False,
        found=["viscous", "cubic_stiffness"],
        effects=("viscous", "constant_coulomb", "cubic_stiffness"),
    )
    found = verdict([first, last])
    assert found["status"] == "ambiguous"
    assert [(one["name"], one["round"], one["tied_with"]) for one in found["effects"]] == [
        ("viscous", 1, ["presliding"]),
        ("cubic_stiffness", 1, ["presliding"]),
    ]


def test_a_torque_without_a_name_stays_unknown_although_nothing_more_is_missing():
    first = state(
        0, missing=True, chosen="unnamed_position", holdout=3.0, ranking=[row("detent"), row("eccentricity")]
    )
    last = state(
        1, missing=False, found=["unnamed_position"], effects=("viscous", "unnamed_position"), holdout=1.0
    )
    found = verdict([first, last])
    assert found["status"] == "unknown"
    assert found["effects"] == []
    assert found["stand_ins"][0]["tied_with"] == []
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
    assert found["stand_ins"][0]["parameters"]["constant_torque"]["value"] == 0.31
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
