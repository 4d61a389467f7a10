"""What a figure of simulations draws is what the datasets hold, in degrees, with the paper's values beside."""

import numpy as np
import pytest
from drawing import bars, drawn, said

from swingdown.pendulum.model import PAPER_MODELS
from swingdown.plots.simulation import fig02, norms_of


def test_the_first_noisy_swing_is_drawn_on_the_true_one_and_its_noise_below(realizations):
    upper, lower = fig02(realizations).axes
    one, time = realizations.sel(simulated="viscous"), realizations["time"].values
    truth, noisy = np.degrees(one["truth"].values), np.degrees(one["noisy"].values[0])
    line, dots = drawn(upper)[:2]
    np.testing.assert_allclose(line, np.column_stack([time, truth]))
    np.testing.assert_allclose(dots, np.column_stack([time, noisy]))
    segments = np.array(lower.collections[0].get_segments())
    np.testing.assert_allclose(segments[:, 0], np.column_stack([time, 0 * time]))
    np.testing.assert_allclose(segments[:, 1], np.column_stack([time, noisy - truth]))
    assert upper.get_xlim() == (time[0], time[-1])


@pytest.mark.parametrize("apart", [False, True])
def test_norms_have_mean_and_deviation_and_a_second_mark_where_least_squares_found_another(
    norms, table2, apart
):
    """Half a norm apart for one model; another figure's models share theirs to a hundredth."""
    other = norms["fitted"] == "load_coulomb"
    squares = norms["norm"] * (1 + other * (0.5 if apart else 0.005))
    figure = norms_of("viscous", norms.assign(least_squares_norm=squares), table2)
    (axes,) = figure.axes
    found, published = bars(axes), table2[table2["simulated"] == "viscous"].set_index("fitted")
    for place, label in enumerate(PAPER_MODELS):
        own = norms["norm"].sel(simulated="viscous", fitted=label).values
        mean, below, _ = found.pop(round(place - 0.05, 3))
        assert mean == pytest.approx(own.mean()) and below == pytest.approx(own.std(ddof=1))
        if label in published.index:
            paper = found.pop(round(place - 0.24, 3))
            assert paper[:2] == pytest.approx(
                tuple(published.loc[label, ["published_mean", "published_std"]])
            )
    second = list(PAPER_MODELS).index("load_coulomb") + 0.18
    assert list(found) == ([round(second, 3)] if apart else [])
    assert ("least squares, where it differs" in said(figure)) is apart
    assert ("Nelder–Mead and least squares alike" in said(figure)) is not apart
    assert "each of 10 realisations" in said(figure) and "SNR 50:1, seed 150" in said(figure)


def test_the_true_model_is_marked_where_it_is_fitted(norms, table2):
    (axes,) = norms_of("quadratic_drag", norms, table2).axes
    place = list(PAPER_MODELS).index("quadratic_drag")
    (pale,) = axes.patches
    assert pale.get_x() == pytest.approx(place - 0.5) and pale.get_width() == pytest.approx(1)
    others = norms.sel(fitted=["viscous", "load_coulomb"])
    figure = norms_of("quadratic_drag", others, table2)
    assert not figure.axes[0].patches and "the true model" not in said(figure)


def test_settings_are_told_where_they_are_known(norms, table2):
    bare = norms.drop_attrs()
    told = said(norms_of("viscous", bare, table2))
    assert "SNR" not in told and "seed" not in told and "inferred" not in told
    assert "does not simulate" in said(norms_of("viscous", norms.sel(simulated=["load_coulomb"]), table2))
