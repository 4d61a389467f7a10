"""Which effect follows what was changed between recordings, and how: on swings that the second pendulum makes."""

from dataclasses import replace

import numpy as np
import pytest

from swingdown.discovery.change import Difference, difference
from swingdown.discovery.data.campaign import Swing, campaign
from swingdown.discovery.search import discover
from swingdown.discovery.tell.sentence import follows
from swingdown.pendulum.model import Model
from swingdown_trials.second_pendulum import trajectory

TIMES = np.arange(0, 15, 0.02)  # s
NOISE = 1e-3  # rad
CHANGED = [1.0, 2.0, 3.0, 4.0]
PATCH = {"patch_friction": 0.1, "patch_from": -0.05, "patch_to": 0.1}  # in no catalogue


def followed(swings, changed, base, **options):
    """What follows the change between these recordings, a value for each."""
    values = dict(zip([one.name for one in swings], changed, strict=True))
    return difference(campaign("pendulum", swings), values, base, **options)


def recordings(effects, common, each, frequencies=(6.0, 6.02, 6.01, 6.03), seed=5, noise=NOISE):
    """A recording for each of these values, beside the common ones."""
    draws, made = np.random.default_rng(seed), []
    for name, frequency, own in zip("abcd", frequencies, each, strict=True):
        values = {"natural_frequency": frequency, **common, **own}
        angle = draws.uniform(0.4, 0.9) * draws.choice([-1, 1])
        reading = trajectory(effects, values, TIMES, angle).reading
        made.append(Swing(name, TIMES, reading + noise * draws.standard_normal(TIMES.size)))
    return made


def sails(*more):
    return recordings(
        ("viscous", "quadratic_drag", *(["friction_patch"] if more else [])),
        {"viscous_ratio": 0.004, **{key: value for one in more for key, value in one.items()}},
        [{"quadratic_coefficient": 0.004 * area} for area in CHANGED],
    )


def test_the_drag_that_goes_with_a_sail_is_told_with_its_power():
    found = followed(sails(), CHANGED, Model("viscous+quadratic_drag"))
    assert (found.effect, found.tied_with) == ("quadratic_drag", ())
    assert found.law.exponent == pytest.approx(1, abs=3 * found.law.u_exponent)
    assert found.law.u_exponent < 0.02
    assert found.sizes.values == pytest.approx(0.004 * np.array(CHANGED), rel=0.02)
    assert found.frequency.values == pytest.approx([6.0, 6.02, 6.01, 6.03], rel=1e-3)


def test_what_all_recordings_lack_alike_cancels():
    """A part of the shaft that rubs is in no catalogue, and leaves several times the noise in each."""
    found = followed(sails(PATCH), CHANGED, Model("viscous+quadratic_drag"))
    assert found.effect == "quadratic_drag"
    assert found.law.exponent == pytest.approx(1, abs=3 * found.law.u_exponent)
    assert found.law.u_exponent < 0.2


def test_what_differs_between_recordings_is_nothing_that_all_lack_alike():
    """A change so small that a drag of each recording, which changes in time, would be as probable."""
    small = recordings(
        ("viscous", "constant_coulomb"),
        {"constant_friction": 0.02},
        [{"viscous_ratio": 0.004 + 2e-5 * current} for current in CHANGED],
    )
    found = followed(small, CHANGED, Model("viscous+constant_coulomb"), allowed=[])
    assert found.effect == "viscous"


def test_an_effect_that_the_model_has_not_is_found_as_well():
    brake = recordings(
        ("viscous", "constant_coulomb"),
        {"constant_friction": 0.02},
        [{"viscous_ratio": 0.001 * current**2} for current in CHANGED],
    )
    found = followed(
        brake, CHANGED, Model("constant_coulomb"), allowed=["viscous", "quadratic_drag", "detent"]
    )
    assert found.effect == "viscous"
    assert found.law.exponent == pytest.approx(2, abs=3 * found.law.u_exponent)


def test_what_is_there_anyway_gives_way_to_what_leaves_nothing():
    """A viscous drag of each recording would take away most of what a sail does, and leave three times the noise."""
    found = followed(sails(), CHANGED, Model("viscous+load_coulomb"))
    assert found.effect == "quadratic_drag" and "viscous" not in found.tied_with
    assert found.law.exponent == pytest.approx(1, abs=3 * found.law.u_exponent)


def test_a_search_beside_frequencies_of_each_recording_comes_to_its_end():
    """That each has its own is no effect of the model, which a search might take away or bring back."""
    swings = recordings(
        ("viscous", "constant_coulomb"), {"viscous_ratio": 0.004, "constant_friction": 0.05}, [{}] * 4
    )
    rounds = discover(campaign("pendulum", swings), replace(Model("viscous"), own_frequency=True), rounds=1)
    assert not rounds[-1].failed and rounds[-1].fit.model.names == ("viscous", "constant_coulomb")


def test_what_is_there_without_the_change_stays_beside_the_power():
    brake = recordings(
        ("viscous", "constant_coulomb"),
        {"constant_friction": 0.02},
        [{"viscous_ratio": 0.003 + 0.001 * current**2} for current in CHANGED],
    )
    found = followed(brake, CHANGED, Model("viscous+constant_coulomb"))
    assert found.effect == "viscous"
    assert found.law.exponent == pytest.approx(2, abs=3 * found.law.u_exponent)
    assert found.law.offset == pytest.approx(0.003, abs=3 * found.law.u_offset)
    told = follows(found.to_dict("current_A"))
    assert told.startswith("Viscous follows the current (P > 0.999): it goes as its power 2.0")
    assert "plus a constant" in told


def test_a_length_changes_the_frequency_and_nothing_else():
    lengths = recordings(("viscous",), {"viscous_ratio": 0.004}, [{}] * 4, frequencies=6 / np.sqrt(CHANGED))
    found = followed(lengths, CHANGED, Model("viscous"), allowed=["quadratic_drag", "constant_coulomb"])
    assert found.effect == "natural_frequency"
    assert found.law.exponent == pytest.approx(-0.5, abs=3 * found.law.u_exponent)


@pytest.mark.parametrize("more", [{}, PATCH])
def test_where_nothing_follows_nothing_is_told(more):
    effects = ("viscous", *(["friction_patch"] if more else []))
    same = recordings(effects, {"viscous_ratio": 0.004, **more}, [{}] * 4, frequencies=[6.0] * 4)
    found = followed(
        same, CHANGED, Model("viscous"), allowed=["quadratic_drag", "constant_coulomb", "stribeck"]
    )
    assert found.effect is None
    assert found.sizes is None
    assert follows(found.to_dict("side")) == "No effect follows the side."


def test_sides_have_sizes_and_no_power():
    sides = ["left", "right", "left", "right"]
    wind = recordings(
        ("viscous", "quadratic_drag"),
        {"viscous_ratio": 0.004},
        [{"quadratic_coefficient": 0.004 if side == "left" else 0.012} for side in sides],
    )
    found = followed(wind, sides, Model("viscous+quadratic_drag"))
    assert found.effect == "quadratic_drag"
    assert found.law is None
    assert follows(found.to_dict("side")) == "Quadratic drag follows the side (P > 0.999)."


def test_one_value_is_no_change():
    assert followed(sails(), [1.0] * 4, Model("viscous")) is None


def test_recordings_without_a_value_take_no_part():
    found = difference(
        campaign("pendulum", sails()),
        {"a": 1.0, "b": 2.0, "d": 4.0},
        Model("viscous+quadratic_drag"),
        allowed=[],
    )
    assert list(found.changed) == ["a", "b", "d"]
    assert found.effect == "quadratic_drag"


def test_rates_tell_it_as_angles_do():
    """Of a gyroscope: the readings are angular velocities."""
    swings = [
        Swing(one.name, one.times, np.gradient(one.angle, one.times))
        for one in recordings(
            ("viscous", "constant_coulomb"),
            {"constant_friction": 0.02},
            [{"viscous_ratio": 0.001 * current**2} for current in CHANGED],
            noise=0.0,
        )
    ]
    draws = np.random.default_rng(6)
    swings = [replace(one, angle=one.angle + 5e-3 * draws.standard_normal(TIMES.size)) for one in swings]
    values = dict(zip("abcd", CHANGED, strict=True))
    made = replace(campaign("pendulum", swings), reading="rate")
    found = difference(made, values, Model("viscous+constant_coulomb"), allowed=[])
    assert found.effect == "viscous"
    assert found.law.exponent == pytest.approx(2, abs=3 * found.law.u_exponent)
    assert found.frequency.values == pytest.approx([6.0, 6.02, 6.01, 6.03], rel=1e-3)


def test_where_the_time_is_spent_it_is_said():
    found = followed(sails(), CHANGED, Model("viscous+quadratic_drag"), budget_s=0.0)
    assert found.effect is None
    told = follows(found.to_dict("area_m2"))
    assert told == "No effect was seen to follow the area (not all were asked: the time for it is spent)."


def test_the_base_has_its_own_values_only_where_something_differs():
    base = Model("viscous")
    assert Difference({"a": 1.0, "b": 2.0}).beside(base) == base
