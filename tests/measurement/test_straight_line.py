"""Straight lines with errors in both coordinates, against published cases and the symmetries they must have."""

import json

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from swingdown.errors import InputError
from swingdown.measurement.straight_line import fit_line, fit_line_correlated


@pytest.fixture
def pearson(certified):
    table = pd.read_csv(certified / "york_pearson/pearson_york.csv")
    return table.x, table.y, table.weight_x**-0.5, table.weight_y**-0.5


def test_pearsons_data_with_yorks_weights(pearson):
    """Standard errors are those of York et al. 2004 (at the adjusted points), not of Kalantar 1992."""
    line = fit_line(*pearson)
    assert line.slope == pytest.approx(-0.480533407, abs=5e-10)
    assert line.intercept == pytest.approx(5.47991022, abs=5e-9)
    assert line.uncertainties == pytest.approx([0.294970735, 0.0579850], abs=5e-8)
    assert line.covariance[0, 1] == pytest.approx(-0.0164725, abs=1e-6)
    assert line.chi2 / line.dof == pytest.approx(1.483294149, abs=5e-9)


def test_mathioulakis(certified):
    table = pd.read_csv(certified / "york_pearson/mathioulakis.csv")
    line = fit_line(table.x, table.y, table.u_x, table.u_y)
    assert line.intercept == pytest.approx(0.0990342, abs=5e-8)
    assert line.slope == pytest.approx(0.9783964, abs=5e-8)
    assert line.uncertainties == pytest.approx([0.0123072, 0.00023664], rel=1e-4)
    assert line.covariance[0, 1] == pytest.approx(-2.415e-6, abs=1e-9)
    assert line.chi2 == pytest.approx(23.549, abs=1e-3)


@pytest.mark.parametrize("case", ["wls1", "wls2", "gdr1"])
def test_iso_28037(certified, case):
    folder = certified / "iso_ts_28037"
    table, expected = (
        pd.read_csv(folder / f"{case}.csv"),
        json.loads((folder / "expected.json").read_text())[case],
    )
    line = fit_line(table.x, table.y, table.get("u_x", 0.0), table.u_y)
    digits = 5e-5 if case != "wls1" else 5e-7
    assert line.intercept == pytest.approx(expected["a"], abs=digits)
    assert line.slope == pytest.approx(expected["b"], abs=digits)
    assert line.uncertainties == pytest.approx([expected["u_a"], expected["u_b"]], abs=5e-5)
    assert line.covariance[0, 1] == pytest.approx(expected["cov_ab"], abs=5e-5)
    assert line.chi2 == pytest.approx(expected["chi2"], abs=5e-4)
    if "inverse" in expected:
        x, u = line.inverse(expected["inverse"]["y0"], expected["inverse"]["u_y0"])
        assert x == pytest.approx(expected["inverse"]["x0"], abs=5e-4)
        assert u == pytest.approx(expected["inverse"]["u_x0"], abs=5e-4)


def test_gum_h3_calibration_of_a_thermometer(certified):
    """The GUM takes the scatter about the line as the points' uncertainty, so the fit is scaled by it."""
    folder = certified / "gum_h"
    table, expected = (
        pd.read_csv(folder / "h3_data.csv"),
        json.loads((folder / "expected.json").read_text())["H3"],
    )
    t = table.t_degC - expected["t0"]
    s = np.sqrt(fit_line(t, table.b_degC, 0.0, 1.0).chi2 / 9)
    assert s == pytest.approx(expected["s"], abs=5e-5)
    line = fit_line(t, table.b_degC, 0.0, s)
    assert line.intercept == pytest.approx(expected["y1"], abs=5e-5)
    assert line.slope == pytest.approx(expected["y2"], abs=5e-6)
    assert line.uncertainties == pytest.approx([expected["u_y1"], expected["u_y2"]], abs=5e-5)
    assert line.covariance[0, 1] / line.uncertainties.prod() == pytest.approx(expected["r"], abs=5e-4)
    b30, u30 = line.predict(10.0)
    assert b30 == pytest.approx(expected["b30"], abs=5e-5)
    assert u30 == pytest.approx(expected["u_b30"], abs=5e-5)


def test_swapping_the_axes_inverts_the_line(pearson):
    x, y, sx, sy = pearson
    line, swapped = fit_line(x, y, sx, sy), fit_line(y, x, sy, sx)
    assert swapped.slope == pytest.approx(1 / line.slope, rel=1e-9)
    assert swapped.intercept == pytest.approx(-line.intercept / line.slope, rel=1e-9)
    assert swapped.chi2 == pytest.approx(line.chi2, rel=1e-9)


def test_without_errors_in_x_it_is_weighted_least_squares(pearson):
    x, y, _, sy = pearson
    line = fit_line(x, y, 0.0, sy)
    (slope, intercept), covariance = np.polyfit(x, y, 1, w=1 / sy, cov="unscaled")
    assert [line.slope, line.intercept] == pytest.approx([slope, intercept], rel=1e-9)
    assert line.covariance == pytest.approx(covariance[::-1, ::-1], rel=1e-9)


def test_with_one_ratio_of_errors_it_is_demings_line(pearson):
    x, y, _, _ = pearson
    line = fit_line(x, y, 0.3, 0.6)
    sxx, syy, sxy = np.var(x), np.var(y), np.mean((x - x.mean()) * (y - y.mean()))
    delta = 4.0
    slope = (syy - delta * sxx + np.sqrt((syy - delta * sxx) ** 2 + 4 * delta * sxy**2)) / (2 * sxy)
    assert line.slope == pytest.approx(slope, rel=1e-9)


@settings(max_examples=50, deadline=None)
@given(arrays(float, 6, elements=st.floats(-0.5, 0.5)), st.floats(-3, 3), st.floats(-2, 2))
def test_points_on_a_line_give_that_line(shift, slope, intercept):
    x = np.arange(6.0) + shift
    x[-1] = 6.0
    line = fit_line(x, intercept + slope * x, 0.1, 0.2)
    assert [line.slope, line.intercept] == pytest.approx([slope, intercept], abs=1e-9)
    assert line.chi2 == pytest.approx(0, abs=1e-12)


def test_correlated_errors_reduce_to_york(pearson):
    x, y, sx, sy = pearson
    york, general = fit_line(x, y, sx, sy), fit_line_correlated(x, y, np.diag(sx**2), np.diag(sy**2))
    assert [general.intercept, general.slope] == pytest.approx([york.intercept, york.slope], rel=1e-9)
    assert general.covariance == pytest.approx(york.covariance, rel=1e-8)
    assert general.chi2 == pytest.approx(york.chi2, rel=1e-9)


def test_correlated_errors_cover_what_repeated_experiments_scatter():
    """The line's covariance is the scatter of 4000 repeated experiments with a shared error in y."""
    x, truth = np.array([1.0, 2.0, 3.5, 5.0]), np.array([0.5, 2.0])
    cov_x, cov_y = np.diag([0.02] * 4) ** 2, 0.03**2 * np.eye(4) + 0.04**2
    line = fit_line_correlated(x, truth[0] + truth[1] * x, cov_x, cov_y)
    rng = np.random.default_rng(5)
    lines = [
        fit_line_correlated(
            x + rng.multivariate_normal(np.zeros(4), cov_x),
            truth[0] + truth[1] * x + rng.multivariate_normal(np.zeros(4), cov_y),
            cov_x,
            cov_y,
        )
        for _ in range(4000)
    ]
    scatter = np.cov([[one.intercept, one.slope] for one in lines], rowvar=False)
    assert np.diag(scatter) == pytest.approx(np.diag(line.covariance), rel=0.08)  # sd of a variance: 2.2 %
    assert np.mean([one.chi2 for one in lines]) == pytest.approx(2.0, rel=0.08)


@pytest.mark.parametrize(
    ("x", "sd", "told"),
    [
        ([1.0, 2.0], 0.1, "at least 3 points"),
        ([2.0, 2.0, 2.0], 0.1, "every point has x = 2"),
        ([1.0, 2.0, 3.0], 0.0, "no uncertainty"),
        ([1.0, 2.0, 3.0], -0.1, "no uncertainty"),
    ],
)
def test_points_without_a_line_are_refused(x, sd, told):
    with pytest.raises(InputError, match=told):
        fit_line(x, x, sd, sd)
