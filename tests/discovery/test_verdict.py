"""The verdict's status and sentence follow from what the rounds say, ties and what has no name included."""

import pytest

from swingdown.discovery.tell.verdict import verdict
from swingdown.language import language

UNIT = {"constant_torque": "rad/s^2", "natural_frequency": "rad/s"}


def state(
    number,
    *,
    missing,
    found=(),
    chosen=None,
    holdout=1.0,
    effects=("viscous",),
    parameters=None,
    judged=None,
    spent=False,
    noise=1e-3,
):
    """What round.json holds of one round."""
    groups = [{"name": "position", "chi_square": 900.0, "freedom": 7, "p": 0.0, "share": 0.9}]
    return {
        "round": number, "campaign": "rig", "split": "held out by amplitude: c", "effects": list(effects), "found": list(found),
        "parameters": parameters or {}, "systematic_rad": 2e-3, "largest_angle_rad": 0.5, "noise_rms_rad": noise, "noise_correlation": 0.0, "gap": {"fit": holdout, "holdout": holdout},
        "missing": missing, "kind": "position" if missing else None, "seen": "the swing runs early" if missing else "",
        "groups": groups, "ranking": [], "reason": "", "findings": {name: finding() for name in found} | (judged or {}), "spent": spent,
        "chosen": chosen and {"move": f"add {chosen}", "added": chosen, "dropped": None, "gain_bic": 500.0},
    }  # fmt: skip


def finding(doubt="", ties=(), probability=0.9999, without=3.0, law_open=False, idle=False, **more):
    """What round.json holds of what is judged of an effect."""
    return {"probability": probability, "ties": list(ties), "share": 0.01, "held_out": 0.0, "without": without, "doubt": doubt, "law_open": law_open, "idle": idle, "of_amplitudes": False, "any_unit": False} | more  # fmt: skip


def test_nothing_missing_is_consistent():
    found = verdict([state(0, missing=False)])
    assert found["status"] == "consistent"
    assert found["effects"] == []
    assert found["sentence"].startswith("Nothing is missing")
    assert f"({1e3 * found['noise_rms_rad']:.3g} mrad) on fitted" in found["sentence"]


TORQUE = {"constant_torque": {"value": 0.31, "standard_error": 0.02, "unit": "rad/s^2"}}


def named(*ties, missing=False, spent=False, **judged):
    """The verdict of a campaign in which a constant torque was found."""
    first = state(0, missing=True, chosen="constant_torque", holdout=3.0)
    last = state(1, missing=missing, found=["constant_torque"], effects=("viscous", "constant_torque"), parameters=TORQUE,
                 holdout=1.01, judged={"constant_torque": finding(ties=ties, **judged)}, spent=spent)  # fmt: skip
    return verdict([first, last])


def test_without_what_is_idle_nothing_is_missing():
    found = named(doubt="without it nothing is missing", idle=True)
    assert found["status"] == "consistent" and not found["effects"]
    assert "Nothing is missing" in found["sentence"] and "may be" not in found["sentence"]
    # its value stands among those that are reported
    said = (
        "The model also has constant torque (0.31 ± 0.02 rad/s^2): without it nothing rises above the noise."
    )
    assert said in found["sentence"]


def test_an_idle_effect_beside_what_remains_leaves_it_unknown():
    found = named(doubt="without it nothing is missing", idle=True, missing=True)
    assert found["status"] == "unknown"


def test_nothing_is_missing_with_the_zero_that_the_swings_tell():
    at = {"sensor_zero": {"value": 0.0019, "standard_error": 0.0001, "unit": "rad", "before": 0.058}}
    told = verdict([state(0, missing=False) | {"nuisance": at}])["sentence"]
    assert told.startswith("Nothing is missing with a zero of 1.9 ± 0.1 mrad: the model leaves"), told
    at["sensor_zero"]["standard_error"] = 0.002
    assert "zero" not in verdict([state(0, missing=False) | {"nuisance": at}])["sentence"]


def test_an_effect_that_stands_alone_is_named_with_its_value_and_what_remains_without_it():
    found = named()
    assert found["status"] == "named"
    assert "0.31 ± 0.02 rad/s^2" in found["sentence"]
    assert "is missing (P > 0.999): without it 3 times the noise remains, with it 1.01." in found["sentence"]
    (one,) = found["effects"]
    assert set(one) >= {"name", "round", "parameters", "delta_bic", "tied_with", "replaces"}
    assert (one["round"], one["gap_without"]) == (1, 3.0)


def test_a_probability_that_is_not_near_one_is_told_as_it_is():
    assert "is missing (P 0.993)" in named(probability=0.993)["sentence"]


def test_a_tie_is_ambiguous_and_tells_the_measurement_that_splits_it():
    found = named("sensor_zero")
    assert found["status"] == "ambiguous"
    assert found["effects"][0]["tied_with"] == ["sensor_zero"]
    assert "or sensor zero, which the data do not distinguish" in found["sentence"]
    assert "rest" in found["next_measurement"]


@pytest.mark.parametrize("ties", [(), ("sensor_zero",)])
def test_what_is_sure_is_asserted_although_something_remains(ties):
    found = named(*ties, missing=True)
    assert found["status"] == "partial"
    assert [one["name"] for one in found["effects"]] == ["constant_torque"]
    assert found["stand_ins"] == []
    assert "The rest, 1.01 times the noise (1.01 mrad), mostly restoring, has no name" in found["sentence"]


@pytest.mark.parametrize("doubt", ["", "its probability is only 0.87"])
def test_of_what_the_fitted_swings_alone_lack_it_is_said_that_it_is_theirs(doubt):
    first = state(0, missing=True, chosen="constant_torque", holdout=5.0)
    last = state(1, missing=True, found=["constant_torque"], parameters=TORQUE, holdout=0.98,
                 judged={"constant_torque": finding(doubt)})  # fmt: skip
    last["gap"] = {"fit": 2.3, "holdout": 0.98}
    told = verdict([first, last])["sentence"]
    what = "What remains" if doubt else "The rest"
    assert (
        f"{what} of the fitted swings, 2.3 times the noise (2.3 mrad), mostly restoring, has no name" in told
    )
    assert "0.98 times the noise (" not in told
    for code in ("de", "fr", "es", "it", "pt"):
        assert "has no name" not in language(code).text(told)


@pytest.mark.parametrize("missing", [True, False])
def test_what_is_not_sure_enough_is_told_as_that_with_its_reason(missing):
    found = named(missing=missing, doubt="swings that were held out do not confirm it")
    assert (found["status"], found["effects"]) == ("unknown", [])
    (one,) = found["stand_ins"]
    assert (one["name"], one["doubt"]) == ("constant_torque", "swings that were held out do not confirm it")
    assert (
        "be constant torque (0.31 ± 0.02 rad/s^2): not sure enough to be named (swings" in found["sentence"]
    )
    assert "is missing" not in found["sentence"].replace("more is missing", "")
    assert ("has no name in the catalogue" in found["sentence"]) is missing
    assert ("Nothing more is missing" in found["sentence"]) is not missing


def test_of_many_effects_only_those_that_are_sure_are_asserted():
    many = ["constant_torque", "cubic_stiffness", "detent"]
    values = {name: {"value": 0.3, "standard_error": 0.01, "unit": "1"} for name in ("constant_torque", "cubic_stiffness", "detent_torque")}  # fmt: skip
    states = [state(k, missing=True, found=many[:k], chosen=many[k], holdout=5.0 - k) for k in range(3)]
    doubts = {name: finding("swings that were held out do not confirm it") for name in many}
    last = state(3, missing=False, found=many, effects=("viscous", *many), parameters=values)
    found = verdict([*states, last])
    assert found["status"] == "named"
    assert "with them 1 times the noise remains, without constant torque 3 (P > 0.999), without cubic" in found["sentence"]  # fmt: skip
    found = verdict([*states, last | {"findings": doubts}])
    assert (found["status"], found["effects"]) == ("unknown", [])
    assert [one["name"] for one in found["stand_ins"]] == many
    found = verdict([*states, last | {"findings": doubts | {"cubic_stiffness": finding()}}])
    assert found["status"] == "partial"
    assert [one["name"] for one in found["effects"]] == ["cubic_stiffness"]


@pytest.mark.parametrize(("separation", "told"), [(12.0, "Release from 40°"), (3.0, "rest")])
def test_a_swing_that_tells_a_tie_apart_is_asked_for_where_one_does(separation, told):
    swing = {"release_angle": 0.7, "duration": 30.0, "separation": separation, "between": ["a", "b"], "text": "Release from 40°."}  # fmt: skip
    first = state(0, missing=True, chosen="constant_torque")
    last = state(1, missing=False, found=["constant_torque"], effects=("viscous", "constant_torque"), parameters=TORQUE,
                 judged={"constant_torque": finding(ties=["sensor_zero"])})  # fmt: skip
    chances = {"constant_torque": 0.6, "sensor_zero": 0.4, "detent": 1e-9}
    found = verdict([first, last | {"next_swing": swing, "probabilities": chances}])
    assert told in found["next_measurement"]
    assert found["probabilities"] == {"constant_torque": 0.6, "sensor_zero": 0.4}


def test_a_tie_that_nothing_at_hand_tells_apart_is_told_as_such():
    told = "None of the swings and readings that were computed tells them apart."
    first = state(0, missing=True, chosen="constant_torque")
    last = state(1, missing=False, found=["constant_torque"], effects=("viscous", "constant_torque"), parameters=TORQUE,
                 judged={"constant_torque": finding(ties=["detent"])})  # fmt: skip
    found = verdict([first, last | {"next_swing": {"separation": 0.4, "text": told}}])
    assert found["effects"][0]["tied_with"] == ["detent"]
    assert found["next_measurement"] == told


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


@pytest.mark.parametrize("spent", [True, False])
def test_a_search_whose_time_was_spent_says_so(spent):
    found = named(missing=True, spent=spent)
    assert found["stopped"] is spent
    assert ("stopped: its time was used up" in found["sentence"]) is spent


def test_both_of_two_effects_that_were_added_at_once_have_the_round():
    both = {"move": "add viscous and cubic_stiffness", "added": "viscous", "also": ["cubic_stiffness"], "dropped": None}  # fmt: skip
    first = state(0, missing=True, holdout=3.0, effects=("constant_coulomb",)) | {"chosen": both | {"gain_bic": 500.0}}  # fmt: skip
    last = state(1, missing=False, found=["viscous", "cubic_stiffness"], effects=("viscous", "constant_coulomb", "cubic_stiffness"),
                 judged={"viscous": finding(ties=["presliding"])})  # fmt: skip
    found = verdict([first, last])
    assert found["status"] == "ambiguous"
    assert [(one["name"], one["round"], one["tied_with"]) for one in found["effects"]] == [
        ("viscous", 1, ["presliding"]),
        ("cubic_stiffness", 1, []),
    ]


@pytest.mark.parametrize("missing", [True, False])
def test_a_dissipation_that_would_be_negative_is_told_and_where_nothing_is_missing_it_is_not_there(missing):
    values = {"viscous_ratio": {"value": 0.0, "standard_error": None, "unit": "1"}}
    found = verdict([state(0, missing=missing, parameters=values)])
    assert found["misspecified"] == ["viscous_ratio"]
    assert ("Viscous ratio would be negative" in found["sentence"]) is missing
    assert ("Not needed: viscous ratio." in found["sentence"]) is not missing


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


@pytest.mark.parametrize(
    ("frequency", "doubt"),
    [(0.03, "vibration_frequency is less than one in the longest recording"), (0.06, "")],
)
def test_a_vibration_that_is_slower_than_the_recording_is_no_finding(frequency, doubt):
    name, values = "base_vibration", {"vibration_acceleration": (0.3, 0.01, "rad/s^2"), "vibration_frequency": (frequency, 0.001, "Hz")}  # fmt: skip
    parameters = {key: dict(zip(("value", "standard_error", "unit"), one, strict=True)) for key, one in values.items()}  # fmt: skip
    first = state(0, missing=True, chosen=name, holdout=3.0)
    last = state(
        1, missing=False, found=[name], effects=("viscous", name), parameters=parameters, holdout=1.01
    )
    found = verdict([first, last | {"duration_s": 20.0}])
    assert found["status"] == ("unknown" if doubt else "named")
    assert [one["name"] for one in found["stand_ins" if doubt else "effects"]] == [name]
    assert not doubt or found["stand_ins"][0]["doubt"].startswith(doubt)


def test_of_several_that_are_not_sure_enough_the_names_are_told():
    """Their values, and why each is not asserted, are the table's."""
    names = ["constant_torque", "detent", "damping_drift"]
    judged = {name: finding(doubt="swings that were held out do not confirm it") for name in names}
    rounds = [state(0, missing=True, chosen="constant_torque", holdout=3.0)]
    rounds += [state(k, missing=True, found=names[:k], chosen=names[k], holdout=2.0) for k in (1, 2)]
    rounds.append(
        state(3, missing=True, found=names, effects=("viscous", *names), holdout=2.0, judged=judged)
    )
    said = verdict(rounds)["sentence"]
    assert "be constant torque, detent and damping drift: not sure enough to be named." in said
    german = language("de").text(said)
    assert "nicht sicher genug" in german and "sure enough" not in german


@pytest.mark.parametrize(
    ("name", "kind", "german"),
    [("presliding", "friction", "Reibung"), ("quadratic_drag", "drag", "Widerstand")],
)
def test_a_damping_whose_law_is_open_is_told_as_a_tie_with_another(name, kind, german):
    first = state(0, missing=True, chosen=name, holdout=3.0)
    judged = {name: finding(law_open=True)}
    found = verdict([first, state(1, missing=False, found=[name], effects=("viscous", name), holdout=1.01, judged=judged)])  # fmt: skip
    assert found["status"] == "ambiguous" and found["effects"][0]["damping"] == kind
    assert f"or {kind} of another law, which the data do not distinguish" in found["sentence"]
    assert f"{german} nach einem anderen Gesetz" in language("de").text(found["sentence"])


@pytest.mark.parametrize(("share", "said"), [(0.034, "3.4 %"), (0.0, "1 %")])
def test_a_damping_that_amplitudes_show_is_told_by_what_they_show(share, said):
    """What held-out swings leave without it may be a spring's, and says nothing of it."""
    first = state(0, missing=True, chosen="quadratic_drag", holdout=9.8)
    judged = {"quadratic_drag": finding(law_open=True, without=None, share=share, of_amplitudes=True)}
    found = verdict([first, state(1, missing=True, found=["quadratic_drag"], effects=("viscous", "quadratic_drag"), holdout=9.7, judged=judged)])  # fmt: skip
    assert found["effects"][0]["of_amplitudes"]
    assert f"without it the amplitudes would decay otherwise, with it {said} of that difference remains. Held-out residual 9.8 → 9.7" in found["sentence"]  # fmt: skip
    assert f"damit bleiben {said.replace('.', ',')} dieses Unterschieds" in language("de").text(
        found["sentence"]
    )


def test_a_size_that_a_discrepancy_may_do_as_well_is_asserted_by_its_probability_and_not_told():
    """4 ± 28, beside what has no name: that something of the kind is there is what the probability tells, and no more is known."""
    first = state(0, missing=True, chosen="constant_torque", holdout=3.0)
    size = {"constant_torque": {"value": 4.0, "standard_error": 28.0, "unit": "rad/s^2"}}
    last = state(
        1, missing=True, found=["constant_torque"], effects=("viscous", "constant_torque"), parameters=size
    )
    found = verdict([first, last])
    assert [one["name"] for one in found["effects"]] == ["constant_torque"]
    assert "Constant torque is missing" in found["sentence"] and "28" not in found["sentence"]


def test_a_value_that_is_not_known_to_its_own_size_is_not_told():
    """The width of a magnet that may as well be as wide as a spring reaches."""
    known = {"magnet_depth": (0.1, 0.01, "1/s^2"), "magnet_width": (32318.9, 3.8e11, "rad")}
    parameters = {key: dict(zip(("value", "standard_error", "unit"), one, strict=True)) for key, one in known.items()}  # fmt: skip
    first = state(0, missing=True, chosen="magnet", holdout=3.0)
    last = state(1, missing=False, found=["magnet"], effects=("viscous", "magnet"), parameters=parameters)
    assert "Magnet (depth 0.10 ± 0.01 1/s^2) is missing" in verdict([first, last])["sentence"]


@pytest.mark.parametrize(
    ("leaves", "told"),
    [
        (6.41, "Fitted to the whole recordings the model leaves 6.41 times the noise: its values are those of the fitted swings."),
        (None, "The model cannot be fitted to the whole recordings: its values are those of the fitted swings."),
    ],
)  # fmt: skip
def test_the_values_told_are_those_that_the_search_concludes_with_and_it_is_said_what_they_are_of(
    leaves, told
):
    first = state(0, missing=True, chosen="constant_torque", holdout=3.0)
    last = state(1, missing=False, found=["constant_torque"], effects=("viscous", "constant_torque"), parameters=TORQUE)  # fmt: skip
    size = {"value": 0.42, "standard_error": 0.01, "unit": "rad/s^2"}
    concluded = {"quantities": {}, "values": {"constant_torque": size}, "of_the_whole": False, "whole_leaves": leaves}  # fmt: skip
    found = verdict([first, last | {"conclusion": concluded}])
    assert found["effects"][0]["parameters"]["constant_torque"] == found["model"]["constant_torque"] == size
    assert "0.42 ± 0.01 rad/s^2" in found["sentence"] and told in found["sentence"]
    spoken = [language(code).text(told) for code in ("de", "fr", "es", "it", "pt")]
    assert all("whole" not in text for text in spoken)
    assert "Fitted" not in verdict([first, last | {"conclusion": concluded | {"of_the_whole": True}}])["sentence"]  # fmt: skip


def test_nothing_is_named_where_another_unit_would_do_its_work():
    first = state(0, missing=True, chosen="constant_torque", holdout=3.0)
    doubt = "the unit is in doubt (degrees taken for rad?): damping leaves 30 mrad"
    last = state(1, missing=False, found=["constant_torque"], effects=("viscous", "constant_torque")) | {
        "unit_doubt": doubt,
        "next_swing": {"separation": 50.0, "text": "Release from 85°."},
    }
    found = verdict([first, last])
    assert found["status"] == "unknown" and not found["effects"]
    assert found["sentence"].startswith("The unit is in doubt (degrees taken for rad?)")
    assert found["next_measurement"] == "Compare a reading with the angle there: its unit is in doubt."
    assert found["next_swing"] is None


def test_a_drag_that_amplitudes_show_is_there_in_any_unit_and_has_no_size():
    drag = {"quadratic_coefficient": {"value": 0.01, "standard_error": 0.001, "unit": "1"}}
    judged = {"quadratic_drag": finding(any_unit=True), "constant_torque": finding()}
    first = state(0, missing=True, chosen="quadratic_drag", holdout=3.0)
    second = state(1, missing=True, chosen="constant_torque", found=["quadratic_drag"], parameters=drag)
    concluded = {"quantities": {}, "values": drag, "of_the_whole": True, "model": "quadratic_drag"}
    last = state(2, missing=False, effects=("viscous", *judged), parameters=TORQUE | drag)
    last |= {"findings": judged, "unit_doubt": "the unit is in doubt", "conclusion": concluded}
    found = verdict([first, second, last])
    (told,) = found["effects"]
    assert found["status"] == "partial" and told["name"] == "quadratic_drag"
    assert told["parameters"]["quadratic_coefficient"]["value"] is None and found["conclusion"] is None
    sentence = "The unit is in doubt. Quadratic drag is missing (P > 0.999). No other effect is named: another unit would explain the swings as well."
    assert found["sentence"] == sentence
    spoken = [language(code).text(sentence) for code in ("de", "fr", "es", "it", "pt")]
    assert all("another unit" not in text and "missing" not in text for text in spoken)


@pytest.mark.parametrize(
    ("quality", "told"), [((900.0, 250.0), True), ((None, None), False), ((900.0, 400.0), False)]
)
def test_what_does_not_die_away_has_no_effect_of_a_pendulum_unless_its_drive_was_measured(quality, told):
    """A loss within three standard errors of none, or none at all, may be kept up by a motor."""
    value, error = quality
    quantities = {
        "period": {"value": 1.0, "standard_uncertainty": 1e-5, "unit": "s"},
        "quality": {"value": value, "standard_uncertainty": error, "unit": "1"},
    }
    first = state(0, missing=True, chosen="constant_torque", holdout=3.0)
    last = state(1, missing=False, found=["constant_torque"], effects=("constant_torque",), parameters=TORQUE)
    last |= {"conclusion": {"quantities": quantities, "of_the_whole": True}, "unit_doubt": ""}
    found = verdict([first, last])
    assert found["dies_away"] == told and found["status"] == ("named" if told else "unknown")
    cannot = "What stops it cannot be told: it does not die away"
    assert found["sentence"].startswith(cannot) != told
    assert (found["next_measurement"] or "").startswith("Switch off what drives it") != told
    assert verdict([first, last | {"driven": True}])["status"] == "named"
    fades = {"decay_time": {"value": 30.0, "standard_uncertainty": 1.0, "unit": "s"}}
    kept_up = {"quantities": quantities | fades, "of_the_whole": True}
    # what fades within the record would be seen to narrow, unless few swings are left; what fades by less than has no name is not seen
    cases = [
        (20.0, False, 0.01, told),
        (60.0, False, 0.01, False),
        (60.0, None, 0.01, told),
        (60.0, True, 0.01, True),
    ]
    for duration, narrows, unnamed, dies in (*cases, (3.0, False, 0.01, told), (3.0, False, 0.05, False)):
        concluded = kept_up | {"narrows": narrows, "amplitude_rad": 0.3}
        there = last | {"conclusion": concluded, "duration_s": duration, "unnamed_rad": unnamed}
        assert verdict([first, there])["dies_away"] == dies


@pytest.mark.parametrize(("other", "told"), [(4.52, "from 4.5 to 4.52 rad/s"), (4.500001, "")])
def test_frequencies_of_each_recording_are_told_where_they_differ_in_what_is_written(other, told):
    one = state(0, missing=False) | {"own_frequency": {"a": other, "b": 4.5}}
    sentence = verdict([one])["sentence"]
    assert told in sentence and ("differ in natural frequency" in sentence) == bool(told)
