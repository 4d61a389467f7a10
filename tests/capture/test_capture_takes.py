"""What is to be recorded in one go: names, counts and plans, and which of them are refused."""

import pytest

from swingdown.capture.takes import takes
from swingdown.errors import InputError


def names(**config):
    return [take["recording"] for take in takes(config)]


def test_names_come_between_commas_or_in_a_list():
    assert names(recording="a, b ,c") == names(recording=["a", "b", "c"]) == ["a", "b", "c"]
    assert names(recording=[1, 2]) == ["1", "2"]


def test_a_count_numbers_one_name_with_two_digits_or_more():
    assert names(recording="swing", count=2) == ["swing-01", "swing-02"]
    assert names(recording="swing", count=99)[-1] == "swing-99"
    hundred = names(recording="swing", count=100)
    assert hundred[0] == "swing-001" and hundred[-1] == "swing-100" and len(hundred) == 100
    assert names(recording="swing", count=None) == ["swing"]


def test_a_height_is_of_one_recording_and_a_role_of_all():
    assert takes({"recording": "tower", "height": 0.02}) == [{"recording": "tower", "height": 0.02}]
    assert [take["role"] for take in takes({"recording": "a,b", "role": "static"})] == ["static"] * 2
    for key in ("height", "count"):
        with pytest.raises(InputError, match="2 recordings are named") as refused:
            takes({"recording": "a,b", key: 2})
        assert refused.value.where == f"config, key {key}"


def test_a_session_takes_its_plan_in_order():
    plan = [
        {"recording": "tower", "height": 0.02, "role": None},
        {"recording": "swing", "count": 2, "role": "swing"},
    ]
    assert takes({"session": True, "capture": {"takes": plan}}) == [
        {"recording": "tower", "height": 0.02},
        {"recording": "swing-01", "role": "swing"},
        {"recording": "swing-02", "role": "swing"},
    ]


@pytest.mark.parametrize("capture", [None, {}, {"takes": []}])
def test_a_session_without_a_plan_shows_one(capture):
    with pytest.raises(InputError, match="the session has no plan") as refused:
        takes({"session": True, "capture": capture})
    assert refused.value.where == "config, key capture.takes"
    assert "takes: [{recording: tower-1" in refused.value.mend


def test_a_session_and_names_beside_it_are_one_too_many():
    with pytest.raises(InputError, match="recordings are named beside it"):
        takes({"session": True, "recording": "a", "capture": {"takes": [{"recording": "b"}]}})


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ("a,,b", "a name is empty"),
        ("../a", "'../a' cannot name a file"),
        ("-a", "cannot name a file"),
        ("a b", "cannot name a file"),
        ("a,b,a", "a is there twice"),
    ],
)
def test_each_name_can_name_a_file_and_is_there_once(asked, said):
    with pytest.raises(InputError, match=said) as refused:
        takes({"recording": asked})
    assert refused.value.where == "config, key recording"


def test_a_name_of_a_plan_is_told_in_the_plan():
    plan = [{"recording": "swing-01"}, {"recording": "swing", "count": 2}]
    with pytest.raises(InputError, match="swing-01 is there twice") as refused:
        takes({"session": True, "capture": {"takes": plan}})
    assert refused.value.where == "config, key capture.takes"
