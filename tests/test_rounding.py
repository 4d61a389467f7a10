"""Value and uncertainty as printed, held to another package's."""

import csv
from math import inf, nan

import pytest

from swingdown.rounding import again, moment, plus_minus, probability, value_with_uncertainty


def test_two_digits_as_another_package_has_them(certified):
    text = (certified / "rounding/cases.csv").read_text()
    cases = list(csv.DictReader(text.splitlines()))
    assert len(cases) == 8
    for case in cases:
        value, uncertainty = float(case["value"]), float(case["std"])
        assert value_with_uncertainty(value, uncertainty) == case["two_digit_S"]
        number, _, digits = case["two_digit_S"].removesuffix(")").partition("(")
        decimals = len(number.partition(".")[2])
        beside = f"{number} ± {int(digits) / 10**decimals:.{decimals}f}"
        assert plus_minus(value, uncertainty) == beside


@pytest.mark.parametrize(
    ("value", "uncertainty", "text"),
    [
        (1234.0, 120.0, "1230(120)"),
        (12.34, 1.9, "12.3(1.9)"),
        (0.5, 0.0996, "0.50(10)"),
        (-1.88e-3, 2.9e-6, "-0.0018800(29)"),
        (3e-9, 1.2e-10, "3.00(12)e-9"),
        (1.23456e8, 1.2e5, "1.2346(12)e8"),
        (0.0, 0.01, "0.000(10)"),
        (-0.001, 0.12, "0.00(12)"),
        (2.6e-7, 6.0e-6, "0.3(6.0)e-6"),
        (7.25, 0.0, "7.25(?)"),
        (7.25, nan, "7.25(?)"),
        (7.25, inf, "7.25(?)"),
        (nan, 1.0, "nan"),
        (1.5e-4, 1e-6, "0.0001500(10)"),
        (1.5e-5, 1e-7, "1.500(10)e-5"),
        (12345.0, 999.6, "12300(1000)"),
        (123456.0, 12000.0, "1.23(12)e5"),
        (0.0, 2.5e-6, "0.0(2.5)e-6"),
        (99.96, 0.45, "99.96(45)"),
    ],
)
def test_two_digits_of_the_uncertainty(value, uncertainty, text):
    assert value_with_uncertainty(value, uncertainty) == text


@pytest.mark.parametrize(
    ("value", "known", "text"),
    [
        (9.914671, 0.0123, "9.91(?)"),
        (1234.0, 120.0, "1200(?)"),
        (3.456e-9, 1.2e-10, "3.5(?)e-9"),
        (9.914671, nan, "9.914671(?)"),
    ],
)
def test_an_uncertainty_known_in_part_cuts_there(value, known, text):
    assert value_with_uncertainty(value, nan, known) == text
    assert value_with_uncertainty(value, 0.5, known) == value_with_uncertainty(value, 0.5)


@pytest.mark.parametrize(
    ("value", "uncertainty", "rule", "text"),
    [
        (0.5, 0.0996, "two", "0.50 ± 0.10"),
        (0.5, 0.0994, "two", "0.500 ± 0.099"),
        (0.5, 0.0996, "one", "0.5 ± 0.1"),
        (5.94, 0.096, "one", "5.9 ± 0.1"),
        (0.31, 0.02, "one", "0.31 ± 0.02"),
        (1234.5, 567.0, "two", "1234 ± 567"),
        (1.2e-7, 3.4e-9, "two", "(1.200 ± 0.034)e-7"),
        (-0.0004, 0.12, "two", "0.00 ± 0.12"),
        (208.0, 0.5, "limit", "208.0 ± 0.5"),
        (50.9, 1e3 * 0.00004, "limit", "50.90 ± 0.04"),
        (300.0, 0.25, "limit", "300.00 ± 0.25"),
        (300.0, 20.0, "limit", "300 ± 20"),
        (7.25, nan, "two", "7.25 ± ?"),
        (nan, 1.0, "two", "nan"),
        (1290206, 480716, "two", "(1.29 ± 0.48)e6"),
        (12902, 9807, "two", "12902 ± 9807"),
        (3, 20000, "one", "(0 ± 2)e4"),
    ],
)
def test_a_value_and_its_uncertainty_side_by_side(value, uncertainty, rule, text):
    assert plus_minus(value, uncertainty, rule) == text


def test_an_unknown_rule_is_refused():
    with pytest.raises(ValueError, match="unknown rule"):
        plus_minus(1, 1, "three")


@pytest.mark.parametrize(
    ("time", "digits", "text"),
    [
        (12.345678, 6, "12.3457"),
        (12.345678, 9, "12.345678"),
        (1707683251.2345, 6, "1707683251.234"),
        (1707683251.0, 9, "1707683251"),
        (-0.5, 6, "-0.5"),
        (250000.25, 6, "250000.25"),
    ],
)
def test_a_moment_of_a_clock_since_1970_is_told_to_a_millisecond(time, digits, text):
    assert moment(time, digits) == text


def test_how_often_more_is_said_in_words():
    assert [again(times) for times in (0, 1, 2)] == ["", " and once more", " and 2 times more"]


@pytest.mark.parametrize(("chance", "text"), [(0.9526, "0.953"), (0.999, "0.999"), (0.99901, "> 0.999"), (0.0, "0.000")])  # fmt: skip
def test_a_probability_has_three_decimals_and_never_says_one(chance, text):
    assert probability(chance) == text
