"""Which recordings a study fits and searches, and what in its sheet cannot be one."""

import pytest

from swingdown.errors import InputError
from swingdown.planning.plan import plan
from swingdown.planning.settings import complete

HEAD = "recording,campaign,file,signal_unit,signal_kind,role,changed,changed_value"
SWINGS = ["a,one,a.csv,,,,,", "rest,one,a.csv,,,static,,", "b,one,a.csv,,,,,", "c,two,a.csv,,,,,"]


@pytest.fixture
def planned(tmp_path, monkeypatch):
    """A function that plans the study of a sheet with these lines and settings."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.csv").write_text("time_s,angle_rad\n0,0\n")

    def made(*lines, **settings):
        (tmp_path / "sheet.csv").write_text("\n".join([HEAD, *lines]) + "\n")
        return plan(complete({"recordings": "sheet.csv"} | settings))

    return made


def test_all_campaigns_are_fitted_and_searched_where_none_is_named(planned):
    found = planned(*SWINGS)
    assert found.campaigns == found.searched == ("one", "two")
    assert found.swings() == found.moving == ["a", "b", "c"] and found.swings("one") == ["a", "b"]
    assert found.statics() == found.still == ["rest"] and found.statics("two") == []
    assert found.measured == ["a", "rest", "b", "c"] and found.in_volts == []
    assert plan(complete({})).rows == {}


def test_campaigns_that_are_named_are_the_ones_and_what_is_only_searched_is_measured_too(planned):
    chosen = {"experiment": {"campaigns": ["two"]}, "discovery": {"campaigns": ["one"]}}
    found = planned(*SWINGS, **chosen)
    assert (found.campaigns, found.searched) == (("two",), ("one",))
    assert found.swings() == ["c"] and found.statics() == [] and found.still == ["rest"]
    assert found.moving == ["a", "b", "c"] and found.measured == ["a", "rest", "b", "c"]
    fitted = planned(*SWINGS, experiment={"campaigns": ["two"]})
    assert fitted.searched == ("two",)  # what is fitted is searched, unless another is named


def test_what_was_changed_is_told_with_its_values(planned):
    sheet = ["a,one,a.csv,,,,current_A,0.5", "b,one,a.csv,,,,current_A,1", "rest,one,a.csv,,,static,,"]
    assert planned(*sheet).changed("one") == ("current_A", {"a": 0.5, "b": 1.0})
    words = planned("a,one,a.csv,,,,string,nylon", "b,one,a.csv,,,,string,steel")
    assert words.changed("one") == ("string", {"a": "nylon", "b": "steel"})
    assert planned(*SWINGS).changed("one") is None


@pytest.mark.parametrize(
    ("lines", "settings", "where", "problem", "mend"),
    [
        (["a,one,a.csv,,,static,,"], {}, "campaign one", "every recording is static", "add a swing"),
        (["a,one,a.csv,,,,current_A,0.5", "b,one,a.csv,,,,,"], {}, "recording b", "as changed", "fill in both cells"),
        (["a,one,a.csv,,,,current_A,0.5", "b,one,a.csv,,,,area_m2,1"], {}, "recording b", "'area_m2' as changed", "two campaigns"),
        (["a,one,a.csv,,,,current_A,0.5", "b,one,a.csv,,,,current_A,"], {}, "recording b", "'' as changed_value", "0 where there was none"),
        (SWINGS, {"experiment": {"campaigns": ["tow"]}}, "experiment.campaigns", "campaign 'tow'", "write 'two'"),
        (["a,one,a.csv,V,,,,"], {"apparatus": "config/apparatus.yaml"}, "key campaigns", "'one' of recording 'a' (in volts) is not listed", "add 'one'"),
        (SWINGS, {"discovery": {"campaigns": ["zzzz"]}}, "discovery.campaigns", "campaign 'zzzz'", "none for all"),
    ],
)  # fmt: skip
def test_what_cannot_be_a_study_is_told_with_its_place(planned, lines, settings, where, problem, mend):
    with pytest.raises(InputError) as refused:
        planned(*lines, **settings)
    assert where in refused.value.where and problem in refused.value.problem and mend in refused.value.mend
