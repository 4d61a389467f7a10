"""A refusal tells people in four parts, as they say it, and programs by class and code."""

import pytest

from swingdown.errors import SHEET, Audience, EngineError, InputError, Refusal, as_told, told_to

CALL = Audience({"signal_unit": "unit", "restoring": "restoring"}, inside="as {}", pair="{}={}", quoted=True)
COMMAND = Audience({"signal_unit": "--unit"})


@pytest.mark.parametrize(
    ("audience", "text", "said"),
    [
        (SHEET, "write deg ⟨in signal_unit⟩", "write deg in the cell signal_unit of the sheet"),
        (SHEET, "correct ⟨sheet⟩ or ⟨signal_unit⟩", "correct `sheet` or signal_unit"),
        (SHEET, "write ⟨restoring=linear⟩", "write restoring: linear"),
        (CALL, "write ⟨in signal_unit⟩", "write as unit"),
        (CALL, "write ⟨restoring=linear⟩ or ⟨signal_unit=-1.5e3⟩", "write restoring='linear' or unit=-1.5e3"),
        (COMMAND, "write deg ⟨in signal_unit⟩ or ⟨signal_unit=deg⟩", "write deg with --unit or --unit deg"),
        (COMMAND, "⟨signal_unit⟩ says otherwise", "--unit says otherwise"),
        # of what only a sheet can say, its cell is told
        (COMMAND, "write it ⟨in role⟩, ⟨role=static⟩ or ⟨sheet⟩", "write it in the cell role of the sheet, role: static or `sheet`"),
    ],
)  # fmt: skip
def test_a_setting_is_told_as_those_say_it_who_are_told(audience, text, said):
    assert audience.said(text) == said
    with told_to(audience):
        assert as_told(text) == said and InputError("here", "wrong", mend=text).mend == said
    assert as_told(text) == SHEET.said(text)


def test_the_audience_is_the_former_one_after_an_error():
    with pytest.raises(InputError), told_to(COMMAND):
        raise InputError("here", "wrong")
    assert as_told("⟨signal_unit⟩") == "signal_unit"


def test_a_refusal_has_its_parts_and_the_settings_of_its_mend():
    error = InputError("a.csv", "it is empty", "rows", "state ⟨in start_s⟩ or ⟨restoring=linear⟩", "empty")
    assert str(error) == (
        "a.csv: it is empty. Expected: rows. Mend: state in the cell start_s of the sheet or restoring: linear."
    )
    assert error.settings == {"start_s": "", "restoring": "linear"} and error.code == "empty"
    assert isinstance(error, ValueError) and error.heading == "This input cannot be used."
    bare = EngineError("engine", "there is none")
    assert str(bare) == "engine: there is none." and isinstance(bare, RuntimeError) and bare.settings == {}
    assert list(bare.labels) == ["where", "problem", "expected", "mend"]


def test_words_may_be_of_another_language_and_the_exception_stays():
    error = Refusal("a.csv", "it is empty", "rows", "add some")
    before = str(error)
    told = error.told_by(str.upper)
    assert told is error and (told.problem, told.expected, told.mend) == ("IT IS EMPTY", "ROWS", "ADD SOME")
    assert told.heading == "THIS CANNOT BE DONE." and told.labels["where"] == "WHERE"
    assert (str(error), error.where) == (before, "a.csv")
