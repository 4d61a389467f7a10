"""What is computed in a cell: hard cells of identification, and discovery's word on an effect hidden from it."""

import numpy as np
import pytest

from swingdown.engine.trajectory import sensitivities, simulate
from swingdown.fitting.batch import Search, fit_batch
from swingdown.fitting.problem import RELEASE
from swingdown.pendulum.model import Model
from swingdown.planning.settings import complete
from swingdown.sweep import detection, identification, noise_free
from swingdown.sweep.cost import seconds
from swingdown.sweep.summary import DETECTION, IDENTIFICATION
from swingdown.sweep.table import sweeps


def cell(computes, **settings):
    """The settings of one cell."""
    first = {"identification": "simulation.simulated", "detection": "detection.effect"}[computes]
    axes = {
        first: [settings.pop(first, "load_coulomb" if computes == "identification" else "quadratic_drag")]
    }
    chosen = sweeps(
        complete({"sweeps": {"one": {"computes": computes, "axes": axes, "settings": settings}}})
    )["one"]
    return chosen.cell(next(iter(chosen)))


def test_the_curvature_at_a_models_closest_fit_is_that_of_its_sum_of_squares():
    """By second differences of it; what J'J lacks of them is so small beside it that a wrong factor shows in that alone."""
    times, truth, begins = noise_free.noise_free(cell("identification", **{"simulation.start": "free"}))
    begin = begins["viscous"]
    point = np.array([*begin.model.vector(), begin.release_angle, begin.release_velocity])
    names, steps = begin.model.parameters, 1e-4 * np.maximum(np.abs(point), 0.1)

    def slopes(at):
        model = begin.model.with_values(dict(zip(names, map(float, at[:-2]), strict=True)))
        angle, each = sensitivities(model, times, *at[-2:], [*names, *RELEASE])
        return each, each @ (angle - truth)

    whole = np.array(
        [(slopes(point + one)[1] - slopes(point - one)[1]) / (2 * one.max()) for one in np.diag(steps)]
    )
    each = slopes(point)[0]
    assert begin.curvature == pytest.approx(
        whole - each @ each.T, rel=1e-2, abs=1e-3 * np.abs(begin.curvature).max()
    )


@pytest.mark.parametrize(("share", "least"), [(0.5, True), (0.42, False), (-1.0, False)])
def test_a_curvature_that_is_no_least_one_is_not_used(share, least):
    """Of a swing so many times as large the model's own is the farther from a least sum of squares the less it is like it."""
    model, times = Model("viscous", {"natural_frequency": 7.25, "viscous_ratio": 0.03}), np.arange(500) / 100
    truth, free = share * simulate(model, times, 0.35), [*model.parameters, *RELEASE]
    assert (noise_free._curvature(model, times, truth, [0.35, 0.0], free) is not None) == least


def test_where_fits_start_at_rest_each_begins_at_rest():
    _, truth, begins = noise_free.noise_free(cell("identification", **{"simulation.start": "rest"}))
    found = {(begin.release_angle, begin.release_velocity) for begin in begins.values()}
    assert found == {(truth[0], 0.0)} and not all(begin.exact for begin in begins.values())


def test_where_friction_stops_the_pendulum_no_larger_model_leaves_more_and_nearly_all_fits_are_stationary():
    hard = cell(
        "identification",
        **{"simulation.release_angle_deg": 5, "simulation.duration_s": 10, "simulation.snr": 5},
    )
    found, _ = identification.results(hard, 0, 12)
    labels = hard["simulation.fitted"]
    for i, larger in enumerate(labels):
        for j, smaller in enumerate(labels):
            if set(smaller.split("+")) < set(larger.split("+")):
                assert np.all(found["residual_norm"][:, i] <= found["residual_norm"][:, j] * (1 + 1e-8)), (
                    larger,
                    smaller,
                )
    assert found["converged"].mean() > 0.9


def test_a_model_that_cannot_be_fitted_has_no_numbers_and_stops_nothing():
    stuck = cell("identification", **{"simulation.release_angle_deg": 0.5, "simulation.duration_s": 5})
    found, _ = identification.results(stuck, 0, 2)
    without = np.isnan(found["norm"])
    assert without.any() and not found["converged"][without].any()
    assert not without[:, stuck["simulation.fitted"].index("load_coulomb")].any()


WRONG = {"simulation.simulated": "viscous", "simulation.start": "rest", "simulation.duration_s": 20, "simulation.release_angle_deg": 10,
         "simulation.snr": 100, "simulation.sampling_rate_hz": 50}  # fmt: skip


def test_a_model_that_does_not_fit_ends_in_the_best_of_many_minima():
    """Friction that stops the pendulum, fitted to a swing that never stops: it may stop after any of the half-swings."""
    wrong = cell("identification", **WRONG)
    found, _ = identification.results(wrong, 0, 4)
    made = identification.make(wrong)
    begin, noisy = made.begin["load_coulomb"], np.array([made.noisy(k) for k in range(4)])
    best = np.full(4, np.inf)
    for factor in np.linspace(0.6, 1.6, 21):
        row = [begin.model.vector()[0], factor * begin.model.vector()[1], float(made.truth[0]), 0.0]
        fit = fit_batch(
            begin.model, made.times, noisy, row[2:], start="rest", search=Search(starts=np.tile(row, (4, 1)))
        )
        best = np.fmin(best, np.degrees(np.sqrt(fit.rss / made.times.size)))
    reached = found["residual_norm"][:, wrong["simulation.fitted"].index("load_coulomb")]
    assert np.all(reached <= best * (1 + 1e-6))


def test_cells_that_share_a_swing_without_noise_have_the_numbers_that_each_has_alone():
    settings = {"simulation.start": "rest", "simulation.duration_s": 2.5}
    one, other = (cell("identification", **settings, **{"simulation.snr": snr}) for snr in (20, 200))
    identification.results(one, 0, 2)
    after, _ = identification.results(other, 0, 2)
    for kept in (noise_free._free, noise_free._begun):
        kept.cache_clear()
    alone, _ = identification.results(other, 0, 2)
    assert all(np.array_equal(after[name], alone[name]) for name in alone)
    both, _ = identification.results(other, 1, 1)
    assert both["norm"][0] == pytest.approx(after["norm"][1], rel=0, abs=0)


@pytest.mark.parametrize(
    ("effect", "size"), [("quadratic_drag", 0.5), ("sensor_zero", 2.0), ("presliding", 0.2)]
)
def test_a_hidden_effect_leaves_what_was_asked_for(effect, size):
    small = cell(
        "detection",
        **{
            "detection.effect": effect,
            "detection.size": size,
            "simulation.duration_s": 5,
            "simulation.viscous_ratio": 0.01,
        },
    )
    hidden = detection.make(small)
    assert hidden.left == pytest.approx(size, rel=0.011)
    assert hidden.coefficient > 0


@pytest.mark.parametrize(("effect", "size"), [("quadratic_drag", 5.0), ("eddy_brake", 2.0)])
def test_what_the_base_leaves_is_of_its_best_fit(effect, size):
    """Where friction stops some of the swings: from the data alone the base's fit ends in a worse optimum for some coefficients,
    which leaves 5.42 or 4.31 in place of 5, and 2.29 or 1.49 in place of 2.
    """
    settings = {"detection.release_angles_deg": [15, 30, 45, 60, 30], "simulation.duration_s": 20, "simulation.viscous_ratio": 0.008,
                "simulation.load_friction": 0.004, "detection.noise_rad": 0.0005}  # fmt: skip
    hidden = detection.make(
        cell("detection", **settings, **{"detection.effect": effect, "detection.size": size})
    )
    assert hidden.left == pytest.approx(size, rel=0.011)


def test_discovery_names_a_large_effect_and_finds_nothing_where_nothing_is_hidden():
    settings = {"detection.release_angles_deg": [15, 30, 60], "simulation.duration_s": 8, "simulation.viscous_ratio": 0.008,
                "simulation.load_friction": 0.004}  # fmt: skip
    large, _ = detection.results(cell("detection", **settings, **{"detection.size": 2}), 0, 1)
    assert detection.OUTCOMES[large["outcome"][0]] == "named"
    assert detection.ANSWERS[large["answer"][0]] == "quadratic_drag"
    assert large["gap"][0] > 1.5
    none, _ = detection.results(cell("detection", **settings, **{"detection.size": 0}), 0, 3)
    assert [detection.OUTCOMES[word] for word in none["outcome"]] == ["nothing"] * 3
    assert np.all(np.abs(none["gap"] - 1) < 0.1)
    again, _ = detection.results(cell("detection", **settings, **{"detection.size": 0}), 2, 1)
    assert again["gap"][0] == none["gap"][2]  # a draw does not depend on those computed with it


@pytest.mark.parametrize(
    ("status", "effects", "word"),
    [
        ("consistent", [], "nothing"),
        ("named", [("hidden", [])], "named"),
        ("ambiguous", [("hidden", ["other"])], "among_others"),
        ("ambiguous", [("other", ["hidden"])], "among_others"),
        ("named", [("hidden", []), ("other", [])], "among_others"),
        ("unknown", [("hidden", [])], "among_others"),
        ("unknown", [], "unknown"),
        ("unknown", [("other", [])], "unknown"),
        ("named", [("other", [])], "wrong"),
        ("ambiguous", [("other", ["another"])], "wrong"),
    ],
)
def test_a_verdict_counts_as_what_a_reader_would_take_from_it(status, effects, word):
    found = {"status": status, "effects": [{"name": name, "tied_with": ties} for name, ties in effects]}
    assert detection._outcome(found, "hidden") == word
    assert detection._outcome(found, None) in ("nothing", "unknown", "wrong")


SHORT = {"detection.release_angles_deg": [20, 40], "simulation.duration_s": 5, "simulation.viscous_ratio": 0.008,
         "simulation.load_friction": 0.004}  # fmt: skip


def test_a_campaign_that_cannot_be_made_is_an_outcome_with_its_reason():
    stuck = cell("detection", **SHORT | {"simulation.load_friction": 0.6})
    found, why = detection.results(stuck, 0, 3)
    assert [detection.OUTCOMES[word] for word in found["outcome"]] == ["not_made"] * 3
    assert why == "the angle crosses its middle fewer than twice"
    assert np.isnan(found["left"]).all() and np.isnan(found["gap"]).all()


def test_a_campaign_in_which_discovery_cannot_search_has_failed_with_its_reason():
    """A single swing too short to be cut into parts to fit and parts to hold out."""
    found, why = detection.results(
        cell("detection", **SHORT | {"detection.release_angles_deg": [40], "simulation.duration_s": 2}), 0, 2
    )
    assert [detection.OUTCOMES[word] for word in found["outcome"]] == ["failed"] * 2
    assert "half-swings" in why


def test_a_single_release_angle_is_searched():
    alone = cell(
        "detection",
        **SHORT | {"detection.release_angles_deg": [40], "simulation.duration_s": 12, "detection.size": 0},
    )
    found, why = detection.results(alone, 0, 1)
    assert why == "" and detection.OUTCOMES[found["outcome"][0]] in ("nothing", "unknown")


def test_where_no_size_leaves_what_was_asked_for_the_nearest_is_told():
    hidden = detection.make(
        cell("detection", **SHORT | {"detection.effect": "flexible_pivot", "detection.size": 200})
    )
    assert np.isfinite(hidden.left) and hidden.left < 190


@pytest.mark.parametrize("size", [0.05, 0.5, 5])
def test_an_effect_that_grows_with_the_square_of_its_coefficient_is_sized_too(size):
    hidden = detection.make(
        cell(
            "detection",
            **SHORT
            | {"detection.effect": "sensor_lag", "detection.size": size, "detection.noise_rad": 0.0005},
        )
    )
    assert hidden.left == pytest.approx(size, rel=0.011)


@pytest.mark.parametrize("kind", ["additive", "proportional", "quantisation"])
def test_noise_on_a_campaign_is_of_the_kind_and_strength_asked_for(kind):
    quiet = cell("detection", **SHORT | {"detection.size": 0, "detection.snr": 40.0, "detection.noise": kind})
    hidden = detection.make(quiet)
    swings = np.concatenate(list(hidden.swings.values()))
    assert hidden.noise == pytest.approx(np.sqrt(np.mean(swings**2)) / 40)
    angle = hidden.swings["40 degrees"]
    drawn = np.random.default_rng(1)
    noise = np.array(
        [
            detection._noisy(quiet, angle, hidden.noise, drawn.standard_normal(angle.size)) - angle
            for _ in range(50)
        ]
    )
    assert np.sqrt(np.mean(noise**2)) == pytest.approx(hidden.noise, rel=0.05)
    still = np.abs(angle) < 0.02 * np.abs(angle).max()
    assert (np.abs(noise[:, still]).max() < 0.2 * hidden.noise) == (kind == "proportional")


def test_two_terms_and_an_effect_of_ones_own_can_be_the_truth():
    pair = cell(
        "identification",
        **{
            "simulation.simulated": "viscous+load_coulomb",
            "simulation.snr": 500,
            "simulation.start": "free",
            "simulation.noise": "additive",
        },
    )
    found, _ = identification.results(pair, 0, 4)
    fitted = pair["simulation.fitted"]
    assert (found["bic"].argmin(axis=1) == fitted.index("viscous+load_coulomb")).sum() >= 3
    brake = {"torque": "-k*thetadot*abs(theta)", "parameters": {"k": {"unit": "1/s", "typical": 0.5}}}
    entry = {"computes": "identification", "axes": {"parameters.brake_k": [0.3, 5.0]},
             "settings": {"simulation.simulated": ["brake"], "simulation.fitted": ["viscous", "brake"], "simulation.start": "free"}}  # fmt: skip
    try:
        sweep = sweeps(complete({"effects": {"brake": brake}, "sweeps": {"one": entry}}))["one"]
        weak, strong = (identification.make(sweep.cell(values)).truth for values in sweep)
        assert np.abs(strong[-100:]).max() < 0.8 * np.abs(weak[-100:]).max()
        found, why = identification.results(sweep.cell((5.0,)), 0, 3)
        assert why == "" and (found["bic"].argmin(axis=1) == 1).all()
    finally:
        complete({})


def test_quantised_draws_are_all_the_first_one():
    alike = cell("identification", **{"simulation.noise": "quantisation", "simulation.duration_s": 2.5})
    few, _ = identification.results(alike, 0, 1)
    many, _ = identification.results(alike, 40, 3)
    assert np.array_equal(many["norm"], np.repeat(few["norm"], 3, axis=0))


def test_the_cost_is_timed_in_seconds_of_cpu():
    entry = {
        "computes": "identification",
        "axes": {"simulation.simulated": ["viscous"], "simulation.duration_s": [2.5]},
    }
    per_cell, per_draw = seconds(sweeps(complete({"sweeps": {"one": entry}}))["one"], identification)
    assert 1e-4 < per_draw < 0.2 and 0 <= per_cell < 1


def test_every_probability_has_a_unit_and_a_meaning():
    for _, units, meaning in (*IDENTIFICATION.values(), *DETECTION.values()):
        assert units and meaning
