"""Groups that measured the same: do they agree, and which does not?"""

import numpy as np
import pandas as pd
import pytest
from scipy.stats import t

from swingdown.errors import InputError
from swingdown.measurement.stated import Stated
from swingdown.series import series_of
from swingdown.series.groups import compare


def test_a_group_is_the_weighted_mean_of_its_recordings():
    found = compare(["a", "a", "b"], [1.0, 1.004, 1.01], [0.01, 0.02, 0.01]).table.set_index("group")
    weights = np.array([0.01, 0.02]) ** -2.0
    assert found.loc["a", "value"] == pytest.approx(np.average([1.0, 1.004], weights=weights))
    assert found.loc["a", "standard_uncertainty"] == pytest.approx(weights.sum() ** -0.5)
    assert list(found["recordings"]) == [2, 1]
    away = found.loc["a", "value"] - found.loc["b", "value"]
    whole = np.hypot(*found["standard_uncertainty"])
    assert found.loc["a", "pull"] == pytest.approx(away / whole) and found.loc["b", "pull"] == pytest.approx(
        -away / whole
    )


def test_groups_that_agree_say_so_with_their_chance():
    calm = compare(list("abcd"), [1.0, 1.01, 0.99, 1.0], [0.01] * 4)
    assert (calm.dof, calm.apart) == (3, ()) and calm.chi2 == pytest.approx(2.0)
    assert (
        calm.sentence == f"the 4 groups agree (chi² 2 for 3, p = {calm.p:.2g})"
        and calm.p == pytest.approx(0.572, abs=1e-3)
    )
    assert compare(["left", "right"], [1.0, 1.01], [0.01] * 2).sentence.startswith("left and right agree")


def test_one_that_stands_apart_is_named_and_two_are():
    odd = compare(list("abcde"), [1.0, 1.001, 0.999, 1.0, 1.2], [0.01] * 5)
    assert (
        odd.apart == ("e",)
        and "e does not agree with the others, which agree with each other" in odd.sentence
    )
    assert "p below 1e-9" in odd.sentence and "each has one recording" in odd.sentence
    two = compare(list("abcdefg"), [1.0, 1.001, 1.3, 0.999, 1.0, 1.002, 0.8], [0.01] * 7)
    assert two.apart == ("c", "g") and "c, g do not agree with the others" in two.sentence


def test_where_none_stands_out_none_is_named():
    torn = compare(list("abcd"), [1.0, 1.2, 1.4, 1.6], [0.01] * 4)
    assert torn.apart == () and "the 4 groups do not agree, and none stands out" in torn.sentence
    assert "left and right do not agree" in compare(["left", "right"], [1.0, 1.1], [0.01] * 2).sentence


def test_recordings_that_scatter_beyond_their_errors_widen_all():
    values = [1.0, 1.1, 0.9, 1.2, 1.3, 1.1]
    few = t.ppf(0.97725, 4) / 2  # of so few, two uncertainties are to hold 95 %
    found = compare(["a"] * 3 + ["b"] * 3, values, [0.001] * 6)
    assert found.table["standard_uncertainty"].to_numpy() == pytest.approx(
        [few * 0.1 / np.sqrt(3)] * 2, rel=0.01
    )
    assert (
        "agree" in found.sentence
        and "do not" not in found.sentence
        and "each has one recording" not in found.sentence
    )


def test_it_goes_into_a_dict_of_plain_numbers():
    found = compare(list("ab"), [1.0, 1.1], [0.01] * 2).to_dict()
    assert (
        found["dof"] == 1 and found["apart"] == [] and [one["group"] for one in found["groups"]] == ["a", "b"]
    )


@pytest.mark.parametrize("values, errors", [([1.0, 1.0], [0.1, 0.0]), ([1.0, np.nan], [0.1, 0.1])])
def test_a_value_without_an_uncertainty_is_refused(values, errors):
    with pytest.raises(InputError, match="a value has no uncertainty"):
        compare(["a", "b"], values, errors)


def test_one_group_is_none():
    with pytest.raises(InputError, match="1 group"):
        compare(["a", "a"], [1.0, 1.0], [0.1, 0.1])


def sides(lengths, apart=0.0, seed=1, scatter=1):
    """The comparison of periods of left and right, each at these lengths (m), right longer by ``apart`` of them."""
    noise = 2e-4
    rng = np.random.default_rng(seed)
    rows = [(side, at) for side in ("left", "right") for at in lengths[side]]
    period = [2.006 * at**0.5 * (1 + apart * (side == "right")) for side, at in rows]
    period = np.array(period) * (1 + scatter * noise * rng.standard_normal(len(rows)))
    names = [f"r{k}" for k in range(len(rows))]
    table = pd.DataFrame(
        {"recording": names, "label": names, "period_s": period, "period_s_u": noise * period}
    )
    values = {name: {"length": Stated(at, 0.0, "m")} for name, (_, at) in zip(names, rows, strict=True)}
    groups = {name: {"group": side} for name, (side, _) in zip(names, rows, strict=True)}
    return series_of(table, values, groups, by="group")[0]


MIXED = [0.2, 0.4, 0.6, 0.9]


def test_groups_over_mixed_lengths_are_compared_at_equal_ones():
    """Beside the spread of lengths a thousandth between sides is nothing; at equal lengths it is five standard uncertainties."""
    same, other = (sides({"left": MIXED, "right": [*MIXED, 0.5]}, apart) for apart in (0.0, 1e-3))
    assert same.sentence.startswith("period of small swings by group, at equal length: left and right agree")
    assert "left and right do not agree" in other.sentence and list(other.at_equal) == ["length"]
    table = other.comparison.table.set_index("group")
    assert list(table["recordings"]) == [4, 4]  # what only one has is no part of it
    assert table.loc["right", "value"] / table.loc["left", "value"] == pytest.approx(1.001, abs=3e-4)


@pytest.mark.parametrize("scatter", [1, 4])
def test_the_chance_of_sides_that_are_equal_is_what_it_says(scatter):
    """About one comparison in twenty has p below 0.05, also where recordings scatter four times as far as their errors say."""
    lengths = {"left": MIXED, "right": MIXED}
    seen = [sides(lengths, seed=seed, scatter=scatter).comparison.p < 0.05 for seed in range(300)]
    assert 0.01 < np.mean(seen) < 0.1


def test_groups_without_an_equal_length_say_that_they_differ_in_it():
    found = sides({"left": [0.2, 0.4, 0.6], "right": [0.3, 0.5, 0.9]})
    assert found.sentence.endswith("; the recordings differ in length") and not found.at_equal
    assert list(found.comparison.table["recordings"]) == [3, 3]
    alike = sides({"left": [0.4, 0.4], "right": [0.4, 0.4]})
    assert "length" not in alike.sentence


def test_what_one_group_alone_has_is_not_compared():
    names = ["r0", "r1", "r2", "r3"]
    table = pd.DataFrame({"recording": names, "label": names, "period_s": [1.0, 1.001, 1.002, 1.0], "period_s_u": 1e-3,
                          "quality": [50.0, 51.0, np.nan, np.nan], "quality_u": 1.0})  # fmt: skip
    groups = {
        name: {"group": side} for name, side in zip(names, ("left", "left", "right", "right"), strict=True)
    }
    assert [one.quantity for one in series_of(table, {}, groups, by="group")] == ["period"]
