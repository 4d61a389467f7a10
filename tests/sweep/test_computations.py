"""What is computed in a cell: hard cells of identification, and discovery's word on an effect hidden from it."""

import numpy as np
import pytest

from swingdown.study.settings import complete
from swingdown.sweep import detection, identification
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
