"""What a figure of fits draws is what the datasets hold: curves in degrees from the first sample, means, deviations and the paper's values."""

import numpy as np
import pytest
from drawing import bars, drawn, said

from swingdown.pendulum.model import PAPER_MODELS
from swingdown.plots import style
from swingdown.plots.experiment import fig15, fit_of, fit_of_pair

LABEL = "viscous+load_coulomb"


def test_a_fit_and_its_residual_are_drawn_in_degrees_from_the_first_sample(fits, angles):
    figure = fit_of(LABEL, fits, angles)
    whole, strip, early, late = figure.axes
    one, time = fits.sel(fitted=LABEL), fits["time"].values - 0.5
    for axes in (whole, early, late):
        samples, fit = drawn(axes)[:2]
        np.testing.assert_allclose(samples, np.column_stack([time, np.degrees(angles["angle"])]))
        np.testing.assert_allclose(fit, np.column_stack([time, np.degrees(one["fit"])]))
    np.testing.assert_allclose(drawn(strip)[-1], np.column_stack([time, np.degrees(one["residual"])]))
    assert whole.get_xlim() == strip.get_xlim() == (0, 15)
    assert early.get_xlim() == (0, 3) and late.get_xlim() == (12, 15)
    assert early.get_title("left") == "(a) first 3 s" and late.get_title("left") == "(b) last 3 s"
    assert "norm 0.132° (RMS)" in figure.legends[0].get_title().get_text()


@pytest.mark.parametrize(("seconds", "shown"), [(5.0, 2.0), (7.5, 3.0), (10.0, 3.0)])
def test_of_a_short_swing_two_fifths_are_enlarged_at_each_end(fits, angles, seconds, shown):
    part = slice(0, round(100 * seconds) + 1)
    _, _, early, late = fit_of(LABEL, fits.isel(time=part), angles.isel(time=part)).axes
    assert early.get_xlim() == pytest.approx((0, shown)) and late.get_xlim() == pytest.approx((seconds - shown, seconds))  # fmt: skip
    for axes, inside in ((early, slice(0, round(100 * shown))), (late, slice(-round(100 * shown), None))):
        largest = np.abs(np.degrees(angles["angle"].isel(time=part).values[inside])).max()
        low, high = axes.get_ylim()
        assert low == -high and largest < high < 1.3 * largest


def band(collection):
    return collection.get_paths()[0].vertices[:, 1]


def test_the_bands_behind_a_residual_are_the_bound_and_twice_the_noise(fits, angles):
    strip = fit_of("viscous", fits, angles).axes[1]
    bound, noise = strip.collections
    assert band(bound).max() == pytest.approx(float(np.degrees(angles["angle_bound"]).max()))
    assert band(bound).min() == -band(bound).max()
    assert band(noise).max() == pytest.approx(0.1) and band(noise).min() == pytest.approx(-0.1)
    assert strip.get_title("left") == "(c) residual" and strip.get_ylim()[1] > 1.1
    unsure = angles.assign(angle_random_uncertainty=0 * angles["angle_random_uncertainty"])
    assert len(fit_of("viscous", fits, unsure).axes[1].collections) == 1


def test_a_rate_is_drawn_in_degrees_a_second(fits, angles):
    rates = angles.rename({name: name.replace("angle", "rate") for name in angles.data_vars})
    whole, strip, *_ = fit_of(LABEL, fits, rates).axes
    assert whole.get_ylabel() == "angular rate (°/s)" and strip.get_ylabel() == "data − fit (°/s)"


@pytest.mark.parametrize(("rank", "label"), [(0, "quadratic_drag+load_coulomb"), (1, LABEL)])
def test_of_pairs_those_with_the_lowest_mean_norm_are_drawn(fits, angles, run_norms, rank, label):
    """A mean over the swing's own campaign; singles and triples are none."""
    lower = run_norms["norm"].where(run_norms["fitted"] != "viscous", 0.01)
    figure = fit_of_pair(rank, fits, angles, run_norms.assign(norm=lower))
    title = figure.legends[0].get_title().get_text()
    assert style.name(label) in title and (title.endswith("— best pair of effects") is (rank == 0))
    few = run_norms.sel(fitted=["viscous", *[one for one in PAPER_MODELS if one.count("+") == 1][:rank]])
    assert "fits too few models with two effects" in said(fit_of_pair(rank, fits, angles, few))


def test_norms_of_all_runs_have_their_mean_deviation_and_the_papers_beside(run_norms, table3):
    """The error bounds first, then the models; a quarter of a place to the left what the paper has."""
    figure = fig15(run_norms, table3)
    (axes,) = figure.axes
    found, table = bars(axes), table3.set_index("fitted")
    for place, label in enumerate(["error_bounds", *PAPER_MODELS]):
        own = run_norms["error_bound_norm"] if place == 0 else run_norms["norm"].sel(fitted=label)
        mean, below, above = found[place]
        assert mean == pytest.approx(float(own.mean())) and below == pytest.approx(float(own.std(ddof=1)))
        assert above == pytest.approx(below)
        paper = found[round(place - 0.24, 3)]
        assert paper[0] == pytest.approx(table.loc[label, "published_mean"])
        assert paper[1] == pytest.approx(table.loc[label, "published_std"])
    dashed = next(
        line for line in axes.get_lines() if line.get_linestyle() == "--" and len(set(line.get_ydata())) == 1
    )
    assert dashed.get_ydata()[0] == pytest.approx(table.loc["error_bounds", "mean"])
    assert axes.get_yscale() == "log"
    assert "each of 10 runs" in said(figure)


def test_runs_of_another_campaign_and_values_that_are_not_there_are_not_drawn(run_norms, table3):
    mixed = run_norms.assign_coords(campaign=("recording", ["bench"] * 7 + ["other"] * 3))
    bare = table3[table3["fitted"] != "error_bounds"].assign(published_mean=np.nan)
    (axes,) = fig15(mixed, bare).axes
    found = bars(axes)
    assert sorted(found) == list(range(len(PAPER_MODELS) + 1))
    own = mixed["norm"].sel(fitted="viscous").values[:7]
    assert found[1 + list(PAPER_MODELS).index("viscous")][0] == pytest.approx(own.mean())
    assert not [line for line in axes.get_lines() if line.get_linestyle() == "--"]
