"""A class's table as series: what is drawn against what was varied, between which groups, and in which words."""

from math import pi

import numpy as np
import pandas as pd
import pytest

from swingdown.errors import InputError
from swingdown.measurement.stated import Stated
from swingdown.rounding import value_with_uncertainty
from swingdown.series.groups import compare
from swingdown.series.table import as_laws, as_table, series_of

G = 9.81
LENGTHS = np.array([0.25, 0.5, 1.0, 2.0])


def pendulums(lengths=LENGTHS, **more):
    """The table of a study: exact periods of these lengths, known to 1e-4; all stop alike, after 20 s."""
    omega = np.sqrt(G / np.asarray(lengths))
    names = [f"r{k}" for k in range(omega.size)]
    table = {
        "recording": names, "label": names, "natural_frequency_rad_per_s": omega,
        "natural_frequency_rad_per_s_u": 1e-4 * omega, "period_s": 9.0, "period_s_u": 0.9,
        "quality": 10 * omega, "quality_u": 0.1, "decay_time_s": 20.0, "decay_time_s_u": 0.4,
    }  # fmt: skip
    return pd.DataFrame(table | more)


def varied(column, values, unit="m", uncertainty=0.0):
    return {f"r{k}": {column: Stated(float(one), uncertainty, unit)} for k, one in enumerate(values)}


def test_periods_go_as_the_root_of_the_length_and_tell_g():
    period, quality = series_of(pendulums(), varied("length", LENGTHS))
    assert (period.by, period.unit, period.quantity) == ("length", "m", "period")
    np.testing.assert_allclose(period.table["y"], 2 * pi * np.sqrt(LENGTHS / G))
    np.testing.assert_allclose(period.table["u_y"], 1e-4 * period.table["y"])
    assert period.law.exponent == pytest.approx(0.5, abs=1e-6) and period.law.theory == 0.5
    assert period.gravity.to_dict()["g_m_per_s2"] == pytest.approx(G, rel=1e-6)
    np.testing.assert_allclose(period.table["by_theory"], period.table["y"], rtol=1e-4)
    assert quality.quantity == "quality" and quality.gravity is None
    assert np.isnan(quality.law.theory) and quality.table["by_theory"].isna().all()
    assert "theory says 0.5, which agrees (0.0 standard uncertainties away)" in period.sentence
    assert "theory" not in quality.sentence
    assert period.sentence.startswith("T") and "goes as the power 0.5" in period.sentence
    assert period.sentence.endswith("the uncertainty of length was not given")


def test_a_power_that_theory_does_not_have_is_said_to_be_away():
    wrong = pendulums(natural_frequency_rad_per_s=2 * pi / LENGTHS**0.6)
    period = series_of(wrong, varied("length", LENGTHS, uncertainty=1e-6))[0]
    assert "which does not agree" in period.sentence
    assert "not given" not in period.sentence


@pytest.mark.parametrize(("exponent", "short", "shared"), [(0.5, 0.03, True), (0.5, 0.0, False), (0.6, 0.0, False), (0.4, 0.0, False)])  # fmt: skip
def test_lengths_that_are_all_short_are_no_disagreement_with_theory(exponent, short, shared):
    """Measured to the top of the bob, say: theory's line of T² over the length follows the points as well as a power law."""
    draw = np.random.default_rng(3)
    periods = (
        2 * pi / np.sqrt(G) * (LENGTHS + short) ** exponent * (1 + 5e-4 * draw.standard_normal(len(LENGTHS)))
    )
    table = pendulums(natural_frequency_rad_per_s=2 * pi / periods)
    period = series_of(table, varied("length", LENGTHS, uncertainty=1e-4))[0]
    found = period.to_dict()
    assert period.shared_error == found["theory_with_shared_error_of_lengths"] == shared
    told, alone = period.sentence.split("; without one the power is ")
    assert told.startswith(f"T goes as the power {value_with_uncertainty(found['exponent'], found['u_exponent'])} of length, beside an error that all lengths share")  # fmt: skip
    assert ("which agrees" in told) == (exponent == 0.5) and abs(found["exponent"] - exponent) < 3 * found[
        "u_exponent"
    ]
    assert alone.startswith(value_with_uncertainty(found["exponent_of_exact_lengths"], found["u_exponent_of_exact_lengths"]))  # fmt: skip
    assert found["exponent_of_exact_lengths"] == found["power_law"]["exponent"]
    assert (abs(found["exponent_of_exact_lengths"] - exponent) <= 2 * found["u_exponent_of_exact_lengths"]) == (not short)  # fmt: skip


def test_three_lengths_tell_no_error_that_they_share():
    few = pendulums(LENGTHS[:3])
    period = series_of(few, varied("length", LENGTHS[:3]))[0]
    assert period.told is period.law and "share" not in period.sentence


def test_what_is_drawn_depends_on_what_was_varied():
    def drawn(column):
        return [one.quantity for one in series_of(pendulums(), varied(column, LENGTHS))]

    assert drawn("length") == ["period", "quality"] and drawn("mass") == ["quality", "decay_rate", "period"]
    assert drawn("area") == drawn("current") == ["decay_rate"]
    assert drawn("temperature") == ["period", "quality", "decay_rate"]


def test_a_decay_rate_is_one_over_the_time_with_its_uncertainty():
    (rate,) = series_of(pendulums(), varied("area", LENGTHS))
    np.testing.assert_allclose(rate.table["y"], 1 / 20)
    np.testing.assert_allclose(rate.table["u_y"], 0.4 / 20**2)


def test_of_passages_alone_the_period_is_that_which_was_recorded():
    table = pendulums()
    table.loc[0, ["natural_frequency_rad_per_s", "natural_frequency_rad_per_s_u"]] = np.nan
    table.loc[0, ["period_s", "period_s_u"]] = 1.0, 0.01
    own = series_of(table, varied("length", LENGTHS))[0].table
    assert own["y"][0] == 1.0 and own["u_y"][0] == 0.01 and own["y"][1] != 9.0


def test_a_row_for_all_together_and_one_without_an_uncertainty_take_no_part():
    table = pendulums([*LENGTHS, 3.0, 4.0])
    table.loc[4, "recording"] = "(joint)"
    table.loc[5, "natural_frequency_rad_per_s_u"] = 0.0
    values = varied("length", [*LENGTHS, 3.0, 4.0]) | {"(joint)": {"length": Stated(3.0, 0.0, "m")}}
    assert list(series_of(table, values)[0].table["recording"]) == ["r0", "r1", "r2", "r3"]


@pytest.mark.parametrize(("lengths", "any_"), [([1, 2, 3], True), ([1, 2, 2], False), ([0, 1, 2], False), ([-1, 1, 2, 3], False)])  # fmt: skip
def test_a_law_needs_three_values_above_nothing_and_none_below(lengths, any_):
    assert bool(series_of(pendulums(LENGTHS[: len(lengths)]), varied("length", lengths))) == any_


def test_a_column_has_one_unit_and_one_that_is_asked_for_is_there():
    mixed = varied("length", LENGTHS) | varied("length", LENGTHS[:1], "s")
    with pytest.raises(InputError, match="column length: its units are m, s"):
        series_of(pendulums(), mixed)
    both = {name: own | {"mass": Stated(0.1, 0.0, "kg")} for name, own in varied("length", LENGTHS).items()}
    sides = {f"r{k}": {"side": "left" if k % 2 else "right"} for k in range(4)}
    assert {one.by for one in series_of(pendulums(), both, sides)} == {"length", "side"}
    assert {one.by for one in series_of(pendulums(), both, sides, by="side")} == {"side"}
    for by in ("mass", "colour"):
        with pytest.raises(InputError, match="the recordings have length, mass, side") as refused:
            series_of(pendulums(), both, sides, by=by)
        assert refused.value.where == f"--by {by}"
    with pytest.raises(InputError, match="the recordings have none"):
        series_of(pendulums(), {}, by="mass")


def test_one_group_is_compared_with_none():
    assert series_of(pendulums(), {}, {f"r{k}": {"side": "left"} for k in range(4)}) == []
    two = series_of(pendulums(), {}, {f"r{k}": {"side": "left" if k < 2 else "right"} for k in range(4)})
    assert [one.quantity for one in two] == ["period", "quality", "decay_rate"]
    assert two[0].sentence.startswith("period of small swings by side: ") and two[0].at_equal == ()


def test_groups_are_compared_at_values_that_every_one_has():
    lengths = [0.5, 1.0, 0.5, 1.0, 2.0]
    sides = {f"r{k}": {"side": "left" if k < 2 else "right"} for k in range(5)}
    values = varied("length", lengths)
    period = series_of(pendulums(lengths), values, sides, by="side")[0]
    assert period.at_equal == ("length",) and period.mixed == ()
    assert list(period.table["recording"]) == ["r0", "r1", "r2", "r3"]  # of 2 m there is but one side
    np.testing.assert_allclose(period.table["y_at_equal"], period.table["y"].mean())
    assert "by side, at equal length: " in period.sentence
    apart = series_of(pendulums(lengths), varied("length", [1, 2, 3, 4, 5]), sides, by="side")[0]
    assert apart.at_equal == () and apart.mixed == ("length",)
    assert apart.sentence.endswith("the recordings differ in length")


def test_all_points_and_all_laws_go_into_tables():
    sides = {f"r{k}": {"side": "left" if k < 2 else "right"} for k in range(4)}
    found = series_of(pendulums(), varied("length", LENGTHS), sides)
    points, laws = as_table(found), as_laws(found)
    assert len(points) == 5 * 4 and list(points.columns[2:6]) == ["by", "by_unit", "quantity", "unit"]
    assert set(points["unit"]) == {"s", "1", "1/s"} and list(points["by_unit"][:4]) == ["m"] * 4
    assert list(laws["by"]) == ["length"] * 2 + ["side"] * 3
    assert laws["exponent"].notna().tolist() == [True, True, False, False, False]
    assert laws["g_m_per_s2"].notna().tolist() == [True, False, False, False, False]
    assert laws["chi2"].notna().all() and list(laws["sentence"]) == [one.sentence for one in found]
    assert len(as_table([])) == 0 and list(as_table([]).columns[:3]) == ["recording", "label", "by"]


def test_a_series_is_told_in_plain_numbers():
    sides = {f"r{k}": {"side": "left" if k < 2 else "right"} for k in range(4)}
    law, _, groups, *_ = [one.to_dict() for one in series_of(pendulums(), varied("length", LENGTHS), sides)]
    assert law["gravity"]["g_m_per_s2"] == pytest.approx(G) and law["comparison"] is None
    assert law["power_law"]["exponent"] == pytest.approx(0.5) and law["unit"] == "m"
    assert groups["power_law"] is None and groups["gravity"] is None
    assert groups["comparison"]["chi2"] > 0 and groups["at_equal"] == []


def test_each_equal_value_but_one_takes_a_degree_of_freedom_of_the_scatter():
    lengths = [0.5, 0.5, 1.0, 1.0] * 2
    table = pendulums(lengths, quality=[40, 50, 30, 35, 44, 47, 28, 36])
    sides = {f"r{k}": {"side": "left" if k < 4 else "right"} for k in range(8)}
    alike = series_of(table, {}, sides)[1]
    held = series_of(table, varied("length", lengths), sides, by="side")[1]
    own = held.table
    share = own["y_at_equal"] / own["y"]
    expected = compare(list(own["group"]), own["y_at_equal"], own["u_y"] * share, taken=1)
    pd.testing.assert_frame_equal(held.comparison.table, expected.table)
    plain = compare(list(own["group"]), own["y"], own["u_y"])
    pd.testing.assert_frame_equal(alike.comparison.table, plain.table)
    less = compare(list(own["group"]), own["y_at_equal"], own["u_y"] * share, taken=0)
    assert not np.allclose(less.table["standard_uncertainty"], expected.table["standard_uncertainty"])
