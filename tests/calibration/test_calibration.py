"""Calibration: heights and voltages to a line, in three modes that agree where they should and say where they do not."""

import copy
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import xarray as xr
import yaml
from scipy.optimize import approx_fprime

from swingdown import dataset
from swingdown.calibration import MODES, calibrate, modes
from swingdown.calibration.chain import lengths, measurement
from swingdown.calibration.deviation import deviation_lines, extreme_lines
from swingdown.calibration.geometry import arm_angle, printed_bound
from swingdown.errors import InputError
from swingdown.measurement.apparatus import read_apparatus
from swingdown.measurement.recording import ingest
from swingdown.measurement.sheet import read_sheet
from swingdown.measurement.straight_line import fit_line
from swingdown.measurement.uncertainty import Mean

DRAWS = 50_000
LENGTHS = np.array([0.24635, 0.0127, 0.0254, 0.208])  # over_shaft, shaft_diameter, bob_diameter, arm


@cache
def shipped():
    rest = ingest(read_sheet("config/recordings.csv").loc["rest"])
    apparatus = read_apparatus("config/apparatus.yaml")
    return apparatus, rest, *calibrate(apparatus, rest, draws=DRAWS)


@pytest.fixture
def bench():
    apparatus, rest, calibration, budget = shipped()
    return copy.deepcopy(apparatus), rest, calibration, budget


@pytest.fixture
def truth(root):
    return yaml.safe_load((root / "resources/bench/truth.yaml").read_text())


def steps(apparatus, heights):
    """The apparatus with the towers at other heights, and the voltages a perfect encoder would read there."""
    apparatus["points"] = [{**apparatus["points"][0], "height": float(h)} for h in heights]
    inputs, angles = lengths(apparatus)
    volts = 5 + angles(np.array([i.value for i in inputs])) / 0.1257
    return apparatus, [Mean(float(v), 0.002, 1e-4, 299.0, 0.0, 300.0) for v in volts]


def test_the_angle_of_known_triangles():
    # drop = arm cos(angle): 60 degrees when the bob's centre is half an arm below the shaft's
    over_shaft, shaft, bob, arm = LENGTHS
    height = over_shaft - shaft / 2 - bob / 2 - arm / 2
    assert arm_angle(*LENGTHS, height) == pytest.approx(np.pi / 3)
    assert np.isnan(arm_angle(*LENGTHS, height - 0.6 * arm))  # never clipped to 0


def test_the_printed_bound_is_the_differential_of_the_angle():
    height, limits, height_limit = 0.045, [4e-5, 2e-6, 5e-6, 4e-5], 3e-5
    slopes = approx_fprime([*LENGTHS, height], lambda x: arm_angle(*x), 1e-8)
    sizes = np.abs(slopes) * [*limits, height_limit]
    assert printed_bound(LENGTHS, limits, height, height_limit, signed=False) == pytest.approx(
        sizes.sum(), rel=1e-5
    )
    signed = abs(sizes[[0, 1, 2, 4]].sum() - sizes[3])
    assert printed_bound(LENGTHS, limits, height, height_limit) == pytest.approx(signed, rel=1e-5)


def test_the_line_finds_the_truth_within_its_uncertainty(bench, truth):
    calibration = bench[2]
    for mode in MODES:
        one = calibration.sel(mode=mode)
        slope = float(one["line"].sel(coefficient="slope"))
        u = float(one["line_covariance"].sel(coefficient="slope", coefficient_2="slope")) ** 0.5
        assert abs(slope - truth["encoder"]["slope_rad_per_V"]) < 2 * u
        assert abs(float(one["rest_voltage"]) - truth["encoder"]["zero_V"]) < 2 * float(
            one["rest_voltage_uncertainty"]
        )
    for k, angle in enumerate(calibration["angle"].values, 1):
        true = np.radians(truth["records"][f"tower_{k}"]["angle_deg"])
        assert abs(angle - true) < 2 * float(calibration["angle_uncertainty"].sel(mode="gum")[k - 1])


def test_first_order_and_monte_carlo_agree_away_from_the_vertical(bench):
    calibration = bench[2]
    gum, drawn = calibration.sel(mode="gum"), calibration.sel(mode="monte-carlo")
    assert drawn["angle_uncertainty"].values[1:] == pytest.approx(
        gum["angle_uncertainty"].values[1:], rel=0.02
    )
    u = np.sqrt(gum["line_covariance"].values.diagonal())
    assert drawn["line_covariance"].values == pytest.approx(gum["line_covariance"].values, rel=0.05)
    assert np.all(np.abs(drawn["line"].values - gum["line"].values) < 0.1 * u)
    assert np.all(calibration["disagreement"].values[1:] < 0.05)


def test_the_point_near_the_vertical_is_flagged_with_a_reason(bench):
    calibration = bench[2]
    assert list(calibration["flagged"].values) == [True, False, False, False]
    assert "differ by" in str(calibration["flag_reason"].values[0]) and not str(
        calibration["flag_reason"].values[1]
    )
    assert np.all(calibration["used"].values)


def test_the_paper_mode_is_labelled_and_is_made_of_limits(bench):
    apparatus, _, calibration, _ = bench
    paper = calibration.sel(mode="paper")
    assert paper["voltage_uncertainty"].values == pytest.approx([0.025] * 4)
    limits = [4e-5, 2e-6, 2e-6, 4e-5]
    bounds = [printed_bound(LENGTHS, limits, p["height"], p["limit"]) for p in apparatus["points"]]
    assert paper["angle_uncertainty"].values == pytest.approx(bounds)
    assert np.all(calibration["angle_worst_case"].values > 2 * np.array(bounds))  # the signs cancel in part
    assert float(paper["coverage_factor"]) == 1


def test_the_points_angles_are_correlated_and_what_ignoring_it_costs(bench):
    """Shared lengths correlate the angles by about 0.65; a line that ignores it has standard errors within 6 %."""
    apparatus, _, calibration, _ = bench
    correlation = calibration["angle_correlation"].values
    assert np.all((correlation[~np.eye(4, dtype=bool)] > 0.6) & (correlation[~np.eye(4, dtype=bool)] < 0.7))
    gum = calibration.sel(mode="gum")
    ignoring = fit_line(
        gum["voltage"].values,
        gum["angle"].values,
        gum["voltage_uncertainty"].values,
        gum["angle_uncertainty"].values,
    )
    right = np.sqrt(gum["line_covariance"].values.diagonal())
    assert ignoring.uncertainties == pytest.approx(right, rel=0.06)


def test_the_chain_has_the_covariance_of_the_line(bench):
    """Two roads: the analytic covariance of generalised least squares, and the propagation through the whole chain."""
    apparatus, _, calibration, _ = bench
    means = [Mean(float(v), 0.002, 1.2e-4, 299.0, 0.0, 300.0) for v in calibration["voltage"].values]
    line = measurement(apparatus, means).line
    assert calibration["line_covariance"].sel(mode="gum").values == pytest.approx(line.covariance, rel=0.03)


def test_the_budget_adds_up(bench):
    _, _, calibration, budget = bench
    shares = budget.groupby("quantity")["share"].sum()
    assert shares.values == pytest.approx(1)
    slope = budget[budget.quantity == "slope"]
    u = (
        float(calibration["line_covariance"].sel(mode="gum", coefficient="slope", coefficient_2="slope"))
        ** 0.5
    )
    assert np.sqrt((slope.contribution**2).sum()) == pytest.approx(u, rel=1e-9)
    stated = budget[budget.limit.notna()]
    assert (stated.limit / stated.divisor).values == pytest.approx(stated.standard_uncertainty.values)
    assert (budget.sensitivity * budget.standard_uncertainty).values == pytest.approx(
        budget.contribution.values
    )
    assert set(budget.kind) == {"random", "systematic"}
    assert (budget.contribution != 0).all()
    named = {f"{of}_{k}" for of in ("mean_voltage", "encoder_error") for k in range(1, 5)}
    assert named < {*slope.source}
    told = budget[budget.quantity.isin(["slope", "rest_voltage"])]
    assert sorted(calibration["source"].values) == sorted(set(told.source))
    assert {"source", "limit", "divisor", "standard_uncertainty", "sensitivity", "contribution", "share"} <= {
        *budget
    }


def test_without_a_record_at_rest_the_line_gives_the_zero(bench):
    apparatus, _, calibration, _ = bench
    alone, _ = calibrate(apparatus, None, draws=5000)
    assert alone["rest_voltage"].values == pytest.approx(alone["line_rest_voltage"].values, abs=2e-3)
    assert np.all(
        alone["rest_voltage_uncertainty"].sel(mode="gum")
        > 10 * calibration["rest_voltage_uncertainty"].sel(mode="gum")
    )
    assert alone.attrs["rest_voltage_from"] == "the line"
    assert float(calibration.attrs["zero_difference_over_u"]) < 2


def test_the_same_seed_gives_the_same_calibration_and_it_can_be_written(bench, tmp_path):
    apparatus, rest, calibration, _ = bench
    again, _ = calibrate(apparatus, rest, draws=DRAWS)
    xr.testing.assert_identical(again, calibration)
    back = dataset.read(dataset.write(calibration, tmp_path / "calibration.nc"))
    xr.testing.assert_equal(back, calibration)
    assert back.attrs["emulated"] == "yes"
    other, _ = calibrate(apparatus, rest, draws=DRAWS, seed=151)
    assert not np.array_equal(other["grid_angle"], calibration["grid_angle"])


def test_draws_with_the_drop_longer_than_the_arm_are_told_not_clipped(bench):
    """A tower at 1.6 degrees: the arm can then be too short, in some draws but few."""
    apparatus = bench[0]
    low = 0.24 - 0.208 * np.cos(np.radians(1.6)) - 0.0127
    apparatus, _ = steps(apparatus, [low, 0.02385, 0.03445, 0.0509])
    found = modes.judge(apparatus, DRAWS, 1)
    assert 0 < found.impossible[0] < 0.1 and np.all(found.impossible[1:] == 0)
    assert "longer than the arm" in found.reasons[0] and not any(found.reasons[1:])


@pytest.mark.parametrize("degrees", [0.3, 1.0])
def test_a_point_at_the_vertical_is_left_out_of_the_line(bench, degrees):
    apparatus, rest, calibration, _ = bench
    apparatus["points"][0]["height"] = float(0.24 - 0.208 * np.cos(np.radians(degrees)) - 0.0127)
    found, _ = calibrate(apparatus, rest, draws=5000)
    assert list(found["used"].values) == [False, True, True, True]
    assert "left out" in str(found["flag_reason"].values[0])
    assert np.isnan(found["residual"].sel(mode="gum")[0]) and np.all(np.isfinite(found["line"]))
    assert found.attrs["dof"] == 1


def test_too_few_points_left_is_told(bench):
    apparatus, rest, _, _ = bench
    for k, degrees in ((0, 0.3), (1, 0.4)):
        apparatus["points"][k]["height"] = float(0.24 - 0.208 * np.cos(np.radians(degrees)) - 0.0127)
    with pytest.raises(InputError, match=r"apparatus\.yaml, key points: 2 of 4 points can be used.*left out"):
        calibrate(apparatus, rest, draws=5000)


def test_a_tower_record_with_another_checksum_is_refused(bench):
    apparatus, rest, _, _ = bench
    apparatus["points"][1]["sha256"] = "0" * 64
    with pytest.raises(InputError, match=r"tower_2\.csv.*points\[2\].*checksum"):
        calibrate(apparatus, rest, draws=5000)


def test_a_rest_record_that_is_not_in_volts_is_refused(bench):
    apparatus, rest, _, _ = bench
    rest = rest.copy(deep=True)
    rest["signal"].attrs["units"] = "rad"
    with pytest.raises(InputError, match=r"rest\.csv: the pendulum at rest is recorded in rad"):
        calibrate(apparatus, rest, draws=5000)


def test_extreme_lines_pass_every_box_and_none_is_steeper():
    x, y = np.array([1.0, 2.0, 3.0, 4.0]), np.array([0.52, 0.98, 1.53, 1.99])
    half_x, half_y = np.full(4, 0.05), np.full(4, 0.03)
    (low, high), factor = extreme_lines(x, y, half_x, half_y)
    assert factor == 1 and low[1] < 0.49 < high[1]
    for intercept, slope in (low, high):
        assert np.all(np.abs(y - intercept - slope * x) <= half_y + slope * half_x + 1e-9)
    rng = np.random.default_rng(1)
    lines = np.column_stack([rng.uniform(-0.3, 0.3, 400_000), rng.uniform(0.3, 0.7, 400_000)])
    through = np.all(np.abs(y - lines[:, :1] - lines[:, 1:] * x) <= half_y + lines[:, 1:] * half_x, axis=1)
    assert low[1] <= lines[through, 1].min() < low[1] + 0.01
    assert high[1] >= lines[through, 1].max() > high[1] - 0.01


def test_boxes_that_no_line_passes_are_widened_and_it_says_so():
    x, y = np.array([1.0, 2.0, 3.0, 4.0]), np.array([0.5, 1.3, 1.2, 2.0])
    lines, factor = extreme_lines(x, y, np.full(4, 0.01), np.full(4, 0.02))
    assert factor == 16 and np.all(np.isfinite(lines))


def test_deviation_lines_lie_on_either_side_of_the_line():
    x, y = np.array([1.0, 2.0, 3.0, 4.0]), np.array([0.52, 0.98, 1.53, 1.99])
    line = fit_line(x, y, 0.05, 0.03)
    lines, _ = deviation_lines(line, x, y, np.full(4, 0.05), np.full(4, 0.03))
    assert np.all(lines[:, 0, 1] < line.slope) and np.all(lines[:, 1, 1] > line.slope)
    u_intercept, u_slope = line.uncertainties
    assert lines[1, 1] == pytest.approx([line.intercept - u_intercept, line.slope + u_slope])
    far = 1000.0  # far out the band of the covariance is as wide as its asymptotes
    assert lines[2, 1] @ [1, far] - line.predict(far)[0] == pytest.approx(line.predict(far)[1], rel=0.01)


def test_the_lines_of_the_covariance_cross_where_the_line_is_known_best():
    x, y = np.array([1.0, 2.0, 3.0, 6.0]), np.array([0.52, 0.98, 1.53, 2.99])
    line = fit_line(x, y, 0.05, 0.03)
    ((low, high),) = deviation_lines(line, x, y, np.full(4, 0.05), np.full(4, 0.03))[0][2:]
    crossing = (low[0] - high[0]) / (high[1] - low[1])
    at = np.linspace(0, 6, 6001)
    assert crossing == pytest.approx(at[np.argmin(line.predict(at)[1])], abs=2e-3)
    assert low[0] + low[1] * crossing == pytest.approx(line.predict(crossing)[0])


def test_a_sample_s_errors_are_turned_into_angles_by_the_slope(bench):
    """At rest and at 20 degrees, each with an encoder's error and noise of its own."""
    apparatus, _, calibration, _ = bench
    means = [Mean(float(v), 0.002, 1.2e-4, 299.0, 0.0, 300.0) for v in calibration["voltage"].values]
    chain = measurement(apparatus, means, Mean(5.0, 0.002, 1e-4, 299.0, 0.0, 300.0), noise=0.003)
    plain = chain(chain.values)
    assert plain[3:] == pytest.approx([0.0, np.radians(20)], abs=1e-9)
    away = chain.values.copy()
    away[chain.part("sample")] = [0.010, -0.002, 0.020, 0.005]
    assert chain(away)[3:] - plain[3:] == pytest.approx(plain[1] * np.array([0.008, 0.025]), rel=1e-9)
    # at rest up to 15 mV, above 25 mV, any as likely
    errors = [chain.inputs[k].standard_uncertainty for k in range(*chain.part("sample").indices(99))]
    assert errors == pytest.approx([0.015 / np.sqrt(3), 0.003, 0.025 / np.sqrt(3), 0.003])


def test_a_point_s_voltage_is_as_sure_as_its_mean_and_its_encoder(bench):
    calibration = bench[2]
    right = np.hypot(calibration["voltage_random_uncertainty"].values, 0.025 / np.sqrt(3))
    found = calibration["voltage_uncertainty"]
    assert found.sel(mode="gum").values == pytest.approx(right, rel=1e-9)
    assert found.sel(mode="monte-carlo").values == pytest.approx(right, rel=0.02)
    assert calibration["angle_uncertainty"].sel(mode="monte-carlo").values == pytest.approx(
        calibration["angle_uncertainty"].sel(mode="gum").values, rel=0.05
    )


def test_what_is_told_of_the_line_follows_from_its_values_and_covariance(bench):
    calibration, budget = bench[2:]
    for mode in MODES:
        one = calibration.sel(mode=mode)
        intercept, slope = one["line"].values
        covariance = one["line_covariance"].values
        x, y = calibration["voltage"].values, calibration["angle"].values
        assert one["residual"].values == pytest.approx(y - intercept - slope * x, abs=1e-12)
        zero = -intercept / slope
        by = np.array([-1 / slope, -zero / slope])
        assert float(one["line_rest_voltage"]) == pytest.approx(zero)
        assert float(one["line_rest_voltage_uncertainty"]) == pytest.approx(
            np.sqrt(by @ covariance @ by), rel=1e-3
        )
        if mode == "paper":
            boxes = one["angle_uncertainty"].values ** 2 + (slope * one["voltage_uncertainty"].values) ** 2
            assert float(one["chi2"]) == pytest.approx(np.sum(one["residual"].values ** 2 / boxes))
            assert float(one["rest_voltage_uncertainty"]) == pytest.approx(np.sqrt(by @ covariance @ by))
            assert float(one["slope_rest_covariance"]) == pytest.approx((covariance @ by)[1])
    both = budget.pivot(index="source", columns="quantity", values="contribution").fillna(0.0)
    gum, drawn = calibration.sel(mode="gum"), calibration.sel(mode="monte-carlo")
    shared = float(both["slope"] @ both["rest_voltage"])
    assert float(gum["slope_rest_covariance"]) == pytest.approx(shared)
    size = np.linalg.norm(both["slope"]) * np.linalg.norm(both["rest_voltage"])
    assert float(drawn["slope_rest_covariance"]) / size == pytest.approx(shared / size, abs=0.03)
    assert float(gum["rest_voltage_uncertainty"]) == pytest.approx(np.linalg.norm(both["rest_voltage"]))
    zeros = float(gum["line_rest_voltage"]), float(gum["rest_voltage"])
    over = abs(zeros[0] - zeros[1]) / float(gum["line_rest_voltage_uncertainty"])
    assert calibration.attrs["zero_difference_over_u"] == pytest.approx(over)
    assert calibration.attrs["dof"] == 2


def test_the_angle_of_a_sample_by_monte_carlo_is_that_of_first_order(bench):
    """slope (voltage + errors - rest) over the encoder's range, where the arm hangs in the middle of it."""
    apparatus, _, calibration, _ = bench
    slope = calibration["line"].sel(mode="gum", coefficient="slope").item()
    rest = calibration["rest_voltage"].sel(mode="gum").item()
    u_slope = calibration["line_covariance"].sel(mode="gum").values[1, 1] ** 0.5
    u_rest = calibration["rest_voltage_uncertainty"].sel(mode="gum").item()
    shared = calibration["slope_rest_covariance"].sel(mode="gum").item()
    volts = calibration["grid"].values
    assert volts[[0, -1]] == pytest.approx([0.0, 10.0])
    away, noise = volts - rest, calibration["noise_voltage"].item()
    limit = np.where(volts <= 5.0, 0.015, 0.025)
    variance = slope**2 * (limit**2 / 3 + noise**2 + u_rest**2) + away**2 * u_slope**2
    u = np.sqrt(variance - 2 * away * slope * shared)
    assert np.all(np.abs(calibration["grid_angle"].values - slope * away) < 0.1 * u)
    assert calibration["grid_uncertainty"].values == pytest.approx(u, rel=0.03)
    low, high = (calibration[f"grid_{side}"].values for side in ("low", "high"))
    half = (high - low) / 2
    # between the 95 % of a flat error, 0.95 sqrt 3 times its u, and of a normal one
    assert np.all((half / u > 0.95 * np.sqrt(3) * 0.97) & (half / u < 1.96 * 1.03))
    assert np.all(np.abs((high + low) / 2 - slope * away) < 0.1 * u)
    factor = calibration["coverage_factor"].sel(mode="monte-carlo").item()
    assert factor == pytest.approx(np.median(half / calibration["grid_uncertainty"].values))


def test_the_range_of_an_arm_that_hangs_at_no_voltage_is_on_both_sides(bench):
    apparatus, means = steps(bench[0], [0.02385, 0.03445, 0.0509, 0.07])
    chain = measurement(apparatus, [replace(one, value=one.value - 5) for one in means])
    found = modes.monte_carlo(chain, apparatus, 0.001, 2000, 1)
    assert found.grid_voltage[[0, -1]] == pytest.approx([-10.0, 10.0])
    assert found.left_out == 0


def test_lengths_of_which_most_draws_are_impossible_are_refused(bench):
    apparatus, means = steps(bench[0], [0.24 - 0.208 * np.cos(0.01) - 0.0127, 0.02385, 0.03445, 0.0509])
    chain = measurement(apparatus, means)
    assert 0 < modes.monte_carlo(chain, apparatus, 0.001, 2000, 1).left_out < 0.5
    shorter = replace(chain.inputs[3], value=chain.inputs[3].value - 3e-5)
    chain = replace(chain, inputs=(*chain.inputs[:3], shorter, *chain.inputs[4:]))
    with pytest.raises(InputError, match="most draws of the lengths are impossible"):
        modes.monte_carlo(chain, apparatus, 0.001, 2000, 1)


def test_extreme_lines_of_falling_points_are_the_mirror_image():
    x, y = np.array([1.0, 2.0, 3.0, 4.0]), np.array([0.52, 0.98, 1.53, 1.99])
    half_x, half_y = np.full(4, 0.05), np.full(4, 0.03)
    rising, falling = (extreme_lines(x, side * y, half_x, half_y)[0] for side in (1, -1))
    assert falling == pytest.approx(-rising[::-1])
