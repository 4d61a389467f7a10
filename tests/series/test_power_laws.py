"""Power laws, g from periods over lengths, groups: against what can be worked out by hand, and how often theory is inside two u."""

import numpy as np
import pytest

from swingdown.errors import InputError
from swingdown.series import compare, gravity_of_lengths, power_law
from swingdown.studies.power_laws import Scatter

LENGTHS = np.array([0.2, 0.3, 0.5, 0.8, 1.0])
PERIODS = 2 * np.pi * np.sqrt(LENGTHS / 9.81)


def test_exact_points_give_the_exponent_and_the_uncertainty_of_a_straight_line():
    """With the same relative error r of every point the exponent's is r over the root of the sum of squared logarithms."""
    law = power_law(LENGTHS, PERIODS, 0.0, 1e-3 * PERIODS, theory=0.5)
    logs = np.log(LENGTHS) - np.log(LENGTHS).mean()
    assert law.exponent == pytest.approx(0.5) and law.u_exponent == pytest.approx(1e-3 / np.sqrt(logs @ logs))
    assert law(1.0) == pytest.approx(2 * np.pi / np.sqrt(9.81)) == law.by_theory(1.0)
    assert np.isnan(law.u_offset) and law.scatter.sentence == ""


def test_theorys_law_goes_through_the_points_that_are_known_well():
    """The longest alone is known well, and the others 5 % off: theory's line goes through the longest."""
    known = np.where(LENGTHS.max() == LENGTHS, 1e-5, 0.05) * PERIODS
    periods = np.where(LENGTHS.max() == LENGTHS, 1.0, 1.05) * PERIODS
    law = power_law(LENGTHS, periods, 0.0, known, theory=0.5)
    assert law.by_theory(LENGTHS.max()) == pytest.approx(PERIODS.max(), rel=1e-4)


def test_an_error_of_the_length_counts_half_as_one_of_the_period():
    along, across = (
        power_law(LENGTHS, PERIODS, 0.0, 1e-3 * PERIODS),
        power_law(LENGTHS, PERIODS, 2e-3 * LENGTHS, 0.0),
    )
    assert across.u_exponent == pytest.approx(along.u_exponent, rel=1e-3)


def test_scatter_beyond_the_errors_widens_the_uncertainty():
    kicks = np.array([1, -1, 0, -1, 1]) * 0.003 * PERIODS
    law, calm = (power_law(LENGTHS, PERIODS + kicks, 0.0, u * PERIODS) for u in (0.0005, 0.005))
    assert law.scatter.birge == pytest.approx(10 * calm.scatter.birge, rel=1e-3)
    assert law.scatter.p < 0.05 and law.u_exponent / (calm.u_exponent / 10) > law.scatter.birge
    assert "scatter" in law.scatter.sentence and calm.scatter.widening == 1
    far = power_law(LENGTHS, PERIODS + kicks, 0.0, 1e-5 * PERIODS).scatter
    assert (
        far.birge > 100 and f"scatter {far.birge:.2g} times" not in far.sentence and "e+" not in far.sentence
    )


@pytest.mark.parametrize("u_x", [0.0, 1e-5])
def test_a_point_with_a_tiny_error_does_not_draw_a_law_that_all_points_scatter_about(u_x):
    """What differs between recordings is an error of each point, the best known among them."""
    kicks = np.array([1, -1, 1, -1, 0.5]) * 0.01
    boast = np.array([1e-3, 1e-3, 1e-6, 1e-3, 1e-3])
    found, fair = (power_law(LENGTHS, PERIODS * (1 + kicks), u_x, u * PERIODS, 0.5) for u in (boast, 1e-3))
    assert abs(found.exponent - fair.exponent) < 0.1 * fair.u_exponent
    assert 0.98 * fair.u_exponent < found.u_exponent < 1.5 * fair.u_exponent
    assert found.theory_factor == pytest.approx(fair.theory_factor, rel=1e-3)


@pytest.mark.parametrize("scatter", [0.003, 0.01])
def test_theory_is_inside_where_recordings_differ_by_more_than_they_state(scatter):
    """400 series of eleven lengths with stated errors, of periods whose stated errors differ a hundredfold and that scatter beside."""
    draw, law, slope = np.random.default_rng(5), 0, 0
    x = np.linspace(0.1, 0.6, 11)
    periods = 2 * np.pi * np.sqrt(x / 9.81)
    for _ in range(400):
        u_y = 2e-3 * 10 ** draw.uniform(-1, 1, x.size) * periods
        y = periods * (1 + scatter * draw.standard_normal(x.size)) + u_y * draw.standard_normal(x.size)
        lengths = x + 5e-4 * draw.standard_normal(x.size)
        law += power_law(lengths, y, 5e-4, u_y, 0.5).away <= 2
        found = gravity_of_lengths(lengths, y, 5e-4, u_y)
        slope += abs(found.g - 9.81) <= 2 * found.u_g
    assert 0.90 <= law / 400 <= 0.99 and 0.90 <= slope / 400 <= 0.99


def test_theory_is_inside_where_nobody_stated_the_errors_of_what_was_varied():
    """200 series of six lengths with errors of a per cent that are not stated, and periods whose stated errors differ tenfold."""
    draw, inside = np.random.default_rng(27), 0
    x = np.linspace(0.2, 1.0, 6)
    for _ in range(200):
        u_y = 1e-3 * 10 ** draw.uniform(-1, 0, x.size) * np.sqrt(x)
        y = np.sqrt(x) + u_y * draw.standard_normal(x.size)
        inside += power_law(x * (1 + 0.01 * draw.standard_normal(x.size)), y, 0.0, u_y, 0.5).away <= 2
    assert inside >= 184


def test_a_widening_is_the_birge_ratio_and_students_where_the_errors_are_refuted():
    assert Scatter(6.0, 4).widening == pytest.approx(np.sqrt(1.5))  # p = 0.2: the errors may be right
    assert Scatter(100.0, 4).widening == pytest.approx(
        5 * 2.87 / 2, rel=2e-3
    )  # two u hold 95 % of Student's t for 4


def test_a_point_without_what_was_varied_tells_the_rest():
    """Eddy currents brake as the square of the current, on top of the bearing."""
    current = np.array([0.0, 0.2, 0.4, 0.6, 0.8])
    law = power_law(current, 0.03 + 0.5 * current**2, 0.0, 1e-3, theory=2.0)
    assert law.offset == pytest.approx(0.03, abs=1e-9) and law.exponent == pytest.approx(2, abs=1e-7)
    assert law.theory_offset == pytest.approx(0.03, abs=1e-7)


@pytest.mark.parametrize(("x", "y"), [([1, 2], [1, 2]), ([1, 1, 2], [1, 1, 2]), ([-1, 1, 2, 3], [1, 1, 2, 3]), ([1, 2, 3], [1, 0, 3])])  # fmt: skip
def test_what_no_power_law_goes_through_is_refused(x, y):
    with pytest.raises(InputError, match="different values above 0"):
        power_law(x, y, 0.0, 0.1)


def test_g_by_the_slope_whatever_the_lengths_are_short_of():
    found = gravity_of_lengths(LENGTHS - 0.015, PERIODS, 0.001, 1e-4)
    assert found.g == pytest.approx(9.81) and found.short == pytest.approx(0.015)
    assert "g = 9.810 ± 0.0" in found.sentence and "too short by 15.00(95) mm" in found.sentence


def test_the_uncertainty_of_g_is_that_of_a_straight_line():
    """The squares of the periods have the same error, so the slope's is that over the root of the sum of squared lengths."""
    found = gravity_of_lengths(LENGTHS, PERIODS, 0.0, 1e-3 / (2 * PERIODS))
    away = LENGTHS - LENGTHS.mean()
    assert found.u_g == pytest.approx(9.81**2 / (4 * np.pi**2) * 1e-3 / np.sqrt(away @ away), rel=1e-6)


def test_lengths_that_are_all_off_by_one_amount_hold_theorys_exponent():
    """To a centimetre or two, as by measuring to the wrong place: the power of the lengths as stated is then off, that beside it is not."""
    draw, away = np.random.default_rng(8), []
    for _ in range(100):
        lengths = np.linspace(0.15, draw.uniform(0.5, 1.0), draw.integers(5, 12))
        scatter = draw.choice([1e-3, 3e-3, 1e-2]) * draw.standard_normal(lengths.size)
        periods = 2 * np.pi * np.sqrt((lengths + draw.uniform(-0.02, 0.03)) / 9.81) * np.exp(scatter)
        found = gravity_of_lengths(lengths, periods, 1e-6, 1e-3 * periods)
        away.append(
            [
                abs(found.shifted.exponent - 0.5) / found.shifted.u_exponent,
                power_law(lengths, periods, 1e-6, 1e-3 * periods, 0.5).away,
            ]
        )
    beside, alone = np.mean(np.array(away) <= 2, axis=0)
    assert 0.9 <= beside <= 0.98 and alone < 0.7
    three = gravity_of_lengths([0.2, 0.4, 0.8], [0.9, 1.27, 1.8], 1e-3, 1e-3)
    assert np.isnan(three.shifted.exponent) and three.to_dict()["exponent_of_lengths_so_off"] is None


def test_above_an_offset_an_error_along_the_line_counts_by_its_slope():
    y = 0.5 + 2 * LENGTHS
    along, across = (power_law(LENGTHS, y, *u, offset=True) for u in ((0.003, 1e-6), (0.0, 0.006)))
    assert along.offset == pytest.approx(0.5) and along.exponent == pytest.approx(1.0)
    assert [along.u_offset, along.u_exponent] == pytest.approx([across.u_offset, across.u_exponent], rel=1e-3)


@pytest.mark.parametrize(("exponent", "factor"), [(0.5, 2.006), (1.0, 12.0), (-1.0, 0.03)], ids=["T of L", "b of area", "γ of 1/m"])  # fmt: skip
@pytest.mark.parametrize("unstated", [1.0, 3.0])
def test_theory_is_inside_two_standard_uncertainties(exponent, factor, unstated):
    """200 series of six points with errors in both, as stated and three times as large: 95 % is meant, 90 % is asked."""
    draw, inside = np.random.default_rng(26), 0
    x = np.linspace(0.2, 1.0, 6)
    for _ in range(200):
        y = factor * x**exponent
        u_x, u_y = 0.003, 0.002 * y
        at = x + unstated * u_x * draw.standard_normal(x.size)
        law = power_law(at, y + unstated * u_y * draw.standard_normal(x.size), u_x, u_y, exponent)
        inside += law.away <= 2
    assert inside >= 184


def test_groups_that_agree_and_one_that_does_not():
    """Four values with one error u: chi2 is the sum of their squared distances from the mean, over u squared."""
    calm = compare(list("abcd"), [1.0, 1.01, 0.99, 1.0], [0.01] * 4)
    assert calm.chi2 == pytest.approx(2) and calm.dof == 3 and calm.p == pytest.approx(0.572, abs=1e-3)
    assert "the 4 groups agree" in calm.sentence and calm.apart == ()
    odd = compare(list("abcd"), [1.0, 1.01, 0.99, 1.1], [0.01] * 4)
    assert odd.apart == ("d",) and "d does not agree with the others" in odd.sentence
    assert "chi² 4221 for 3" in compare(list("abcd"), [1.0, 1.01, 0.99, 1.75], [0.01] * 4).sentence
    assert odd.table["pull"].iloc[3] == pytest.approx(0.1 / 0.01 / np.sqrt(1 + 1 / 3))


def test_left_and_right():
    assert "left and right agree" in compare(["left", "right"], [1.0, 1.01], [0.01, 0.01]).sentence
    assert "do not agree" in compare(["left", "right"], [1.0, 1.1], [0.01, 0.01]).sentence


def test_recordings_of_a_group_that_scatter_widen_its_mean():
    found = compare(["a"] * 3 + ["b"] * 3, [1.0, 1.1, 0.9, 1.2, 1.3, 1.1], [0.001] * 6)
    assert found.p > 0.05 and found.table["standard_uncertainty"].min() > 0.05


def test_equal_groups_are_said_to_differ_as_often_as_they_should():
    draw = np.random.default_rng(7)
    told = sum(
        compare(list("abcdef"), 1 + 0.01 * draw.standard_normal(6), [0.01] * 6).p < 0.05 for _ in range(400)
    )
    assert 8 <= told <= 34
