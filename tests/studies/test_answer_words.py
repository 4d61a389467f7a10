"""What is said of a pendulum whose row is known: the sentence, the lines below it, and which quantities hold where."""

import pytest

from swingdown.pendulum.catalogue import catalogue
from swingdown.studies.pendulums import NOT_DYING, SEARCH
from swingdown.studies.turning_points import NOT_DAMPED
from swingdown.studies.words import details, headline, lines, notes, or_models, quantity_rows

ROW = {
    "model": "viscous", "amplitude_rad": 0.5, "period_s": 0.87148, "period_s_u": 0.00026, "quality": 58.8, "quality_u": 1.9,
    "residual_rad": 0.002, "remark": "", "emulated": "no",
}  # fmt: skip
NUMBERS = "T = 0.87148(26) s, Q = 58.8(1.9)"
VERDICT = {"status": "consistent", "sentence": "Nothing is missing: all fits."}


@pytest.mark.parametrize(
    ("model", "restoring", "told"),
    [
        ("viscous", "sine", "Air drag (viscous) stops it"),
        ("viscous", "linear", "Viscous drag stops it"),
        ("viscous+load_coulomb", "sine", "Air drag (viscous) and bearing friction stop it"),
        ("viscous+sensor_zero+cubic_stiffness", "sine", "Air drag (viscous) stops it"),
        ("cubic_stiffness", "sine", "What stops it is not established"),
    ],
)
def test_the_sentence_names_what_takes_energy_and_nothing_else(model, restoring, told):
    assert headline(ROW | {"model": model}, restoring=restoring) == f"{told}: {NUMBERS}."


@pytest.mark.parametrize(
    ("friction", "error", "told"),
    [
        (0.0, float("nan"), "Air drag (viscous) stops it"),
        (0.003, 0.008, "Air drag (viscous) stops it"),
        (0.009, 0.002, "Air drag (viscous) and bearing friction stop it"),
        (0.009, float("nan"), "Air drag (viscous) and bearing friction stop it"),
    ],
)
def test_what_is_within_its_uncertainty_of_nothing_stops_no_pendulum(friction, error, told):
    row = ROW | {"model": "viscous+load_coulomb", "load_friction": friction, "load_friction_u": error}
    assert headline(row).startswith(told)


def test_of_effects_of_ones_own_those_that_brake_stop_it():
    own = {
        "wet_felt": {"torque": "-k*thetadot*abs(theta)", "parameters": {"k": {}}},
        "soft_stop": {"torque": "-k*theta**5", "parameters": {"k": {}}},
    }
    known = catalogue(own)
    assert headline(ROW | {"model": "wet_felt"}, catalogue=known) == f"Wet felt stops it: {NUMBERS}."
    assert headline(ROW | {"model": "soft_stop"}, catalogue=known).startswith(
        "What stops it is not established"
    )


def test_models_that_describe_it_as_well_are_named_and_none_where_there_is_none():
    two = ROW | {"or_model": "quadratic_drag; viscous+load_coulomb"}
    assert or_models(two) == ["quadratic_drag", "viscous+load_coulomb"]
    assert or_models(ROW) == or_models(ROW | {"or_model": ""}) == []
    assert headline(two).startswith(
        "Air drag (viscous) or air drag (quadratic) or air drag (viscous) and bearing"
    )


@pytest.mark.parametrize(
    ("more", "status", "told"),
    [
        ({}, "consistent", f"Air drag (viscous) stops it: {NUMBERS}. Nothing else is needed."),
        ({}, "unknown", f"What stops it is not established; air drag (viscous) comes nearest: {NUMBERS}."),
        ({"share_left": 0.9}, "", f"What stops it is not established; air drag (viscous) comes nearest: {NUMBERS}."),
        ({"model": NOT_DYING}, "", f"What stops it cannot be told: it does not die away. {NUMBERS}."),
        ({"model": NOT_DAMPED}, "", f"What stops it is not in the data. {NUMBERS}."),
    ],
)  # fmt: skip
def test_a_sentence_claims_no_more_than_is_known(more, status, told):
    assert headline(ROW | more, {"status": status} if status else None) == told


def test_in_a_unit_in_doubt_nothing_is_said_to_remain():
    assert headline(ROW, {"status": "partial"}).endswith("Something remains that has no name here.")
    assert headline(ROW, {"status": "partial", "unit_doubt": "the unit is in doubt"}).endswith(f"{NUMBERS}.")


def test_the_verdicts_sentence_is_the_last_line_and_is_not_said_twice():
    alone, searched = lines(ROW), lines(ROW, VERDICT)
    assert len(searched) == len(alone) + 1 and searched[-1] == "Nothing is missing. All fits."
    assert alone[-1] == "damping            viscous; it leaves 2 mrad RMS"


def test_lines_say_what_holds_where_and_what_is_to_be_known():
    told = details(ROW | {"remark": "it beats", "emulated": "yes", "note": "one; two", "model_of": SEARCH})
    assert told[0] == "Beware: it beats"
    assert told[1] == "period             0.87148(26) s   at 27.9°"
    assert told[3].startswith("model ") and told[4:6] == ["one", "two"] and told[6].startswith("emulated")


def test_a_decay_longer_than_the_record_is_said_to_be_extrapolated():
    def condition(record):
        row = ROW | {"decay_time_s": 30.0, "decay_time_s_u": 1.0, "record_s": record}
        return next(one.condition for one in quantity_rows(row) if one.name == "decay_time")

    assert (
        condition(40.0) == "from 28.6°" and condition(20.0) == "from 28.6°, extrapolated: the record has 20 s"
    )


def test_an_empty_note_is_none():
    """Of several recordings some may have one."""
    assert notes({"note": ""}) == notes({}) == notes({"note": float("nan")}) == []
    assert notes({"note": "one; two"}) == ["one", "two"]
