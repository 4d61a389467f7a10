"""A number in the report shows as many digits as its uncertainty bears."""

import math

import pytest

from swingdown.report import numbers


@pytest.mark.parametrize(
    ("value", "deviation", "shown"),
    [
        (0.13102, 0.00998, "0.131 ± 0.010"),
        (0.82469, 0.03612, "0.825 ± 0.036"),
        (12.3456, 1.2, "12.3 ± 1.2"),
        (1234.5, 56.7, "1234 ± 57"),
        (0.5, 0.0996, "0.50 ± 0.10"),
        (1.2e-7, 3.4e-9, "(1.200 ± 0.034) × 10⁻⁷"),
        (0.5, 0.0, "0.500"),
        (0.5, math.nan, "0.500"),
        (math.nan, 0.1, "–"),
        (-0.0004, 0.12, "0.00 ± 0.12"),
    ],
)
def test_a_mean_and_its_spread(value, deviation, shown):
    assert numbers.spread(value, deviation) == shown


@pytest.mark.parametrize(
    ("value", "uncertainty", "shown"),
    [
        (0.05123, 0.00134, "0.0512(13)"),
        (7.25, 0.00995, "7.250(10)"),
        (-0.0106, 0.0007, "−0.01060(70)"),
        (1234.5, 56.7, "1234(57)"),
        (1.2e-7, 3.4e-9, "1.200(34) × 10⁻⁷"),
        (7.25, math.nan, "7.25"),
        (math.nan, 1.0, "–"),
    ],
)
def test_a_value_with_its_standard_uncertainty(value, uncertainty, shown):
    assert numbers.brief(value, uncertainty) == shown


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (0, "0"),
        (0.0123456, "0.0123"),
        (1234.56, "1235"),
        (123456.0, "123456"),
        (1234567.0, "1.23 × 10⁶"),
        (0.000123456, "0.000123"),
        (0.0000123456, "1.23 × 10⁻⁵"),
        (-2.5e-7, "−2.50 × 10⁻⁷"),
        (math.inf, "–"),
        ("x", "–"),
    ],
)
def test_a_plain_number(value, shown):
    assert numbers.plain(value) == shown
