"""Which effect follows what was changed between recordings, and how: on swings that the second pendulum makes."""

import numpy as np
import pytest

from swingdown.discovery.campaign import Swing
from swingdown.discovery.change import difference
from swingdown.discovery.sentence import follows
from swingdown.errors import InputError
from swingdown.pendulum.model import Model
from swingdown.trials.second_pendulum import trajectory

TIMES = np.arange(0, 15, 0.02)  # s
NOISE = 1e-3  # rad
CHANGED = [1.0, 2.0, 3.0, 4.0]
PATCH = {"patch_friction": 0.1, "patch_from": -0.05, "patch_to": 0.1}  # in no catalogue


def recordings(effects, common, each, frequencies=(6.0, 6.02, 6.01, 6.03), seed=5):
    """A recording for each of these values, beside the common ones."""
    draws, made = np.random.default_rng(seed), []
    for frequency, own in zip(frequencies, each, strict=True):
        values = {"natural_frequency": frequency, **common, **own}
        angle = draws.uniform(0.4, 0.9) * draws.choice([-1, 1])
        reading = trajectory(effects, values, TIMES, angle).reading
        made.append(Swing(f"{own}", TIMES, reading + NOISE * draws.standard_normal(TIMES.size)))
    return made


def sails(*more):
    return recordings(
        ("viscous", "quadratic_drag", *(["friction_patch"] if more else [])),
        {"viscous_ratio": 0.004, **{key: value for one in more for key, value in one.items()}},
        [{"quadratic_coefficient": 0.004 * area} for area in CHANGED],
    )


def test_the_drag_that_goes_with_a_sail_is_told_with_its_power():
    found = difference(sails(), CHANGED, Model("viscous+quadratic_drag"))
    assert (found.effect, found.tied_with) == ("quadratic_drag", ())
    assert found.law.exponent == pytest.approx(1, abs=3 * found.law.u_exponent)
    assert found.law.u_exponent < 0.02
    assert found.sizes.values == pytest.approx(0.004 * np.array(CHANGED), rel=0.02)
    assert found.frequency.values == pytest.approx([6.0, 6.02, 6.01, 6.03], rel=1e-3)


def test_what_all_recordings_lack_alike_cancels():
    """A part of the shaft that rubs is in no catalogue, and leaves several times the noise in each."""
    found = difference(sails(PATCH), CHANGED, Model("viscous+quadratic_drag"))
    assert found.effect == "quadratic_drag"
    assert found.law.exponent == pytest.approx(1, abs=3 * found.law.u_exponent)
    assert found.law.u_exponent < 0.2


def test_an_effect_that_the_model_has_not_is_found_as_well():
    brake = recordings(
        ("viscous", "constant_coulomb"),
        {"constant_friction": 0.02},
        [{"viscous_ratio": 0.001 * current**2} for current in CHANGED],
    )
    found = difference(
        brake, CHANGED, Model("constant_coulomb"), allowed=["viscous", "quadratic_drag", "detent"]
    )
    assert found.effect == "viscous"
    assert found.law.exponent == pytest.approx(2, abs=3 * found.law.u_exponent)


def test_what_is_there_without_the_change_stays_beside_the_power():
    brake = recordings(
        ("viscous", "constant_coulomb"),
        {"constant_friction": 0.02},
        [{"viscous_ratio": 0.003 + 0.001 * current**2} for current in CHANGED],
    )
    found = difference(brake, CHANGED, Model("viscous+constant_coulomb"))
    assert found.effect == "viscous"
    assert found.law.exponent == pytest.approx(2, abs=3 * found.law.u_exponent)
    assert found.law.offset == pytest.approx(0.003, abs=3 * found.law.u_offset)
    told = follows(found.to_dict("current_A", ["a", "b", "c", "d"]))
    assert told.startswith("Viscous follows the current (P > 0.999): it goes as its power 2.0")
    assert "that stay" in told


def test_a_length_changes_the_frequency_and_nothing_else():
    lengths = recordings(("viscous",), {"viscous_ratio": 0.004}, [{}] * 4, frequencies=6 / np.sqrt(CHANGED))
    found = difference(lengths, CHANGED, Model("viscous"), allowed=["quadratic_drag", "constant_coulomb"])
    assert found.effect == "natural_frequency"
    assert found.law.exponent == pytest.approx(-0.5, abs=3 * found.law.u_exponent)


@pytest.mark.parametrize("more", [{}, PATCH])
def test_where_nothing_follows_nothing_is_told(more):
    effects = ("viscous", *(["friction_patch"] if more else []))
    same = recordings(effects, {"viscous_ratio": 0.004, **more}, [{}] * 4, frequencies=[6.0] * 4)
    found = difference(
        same, CHANGED, Model("viscous"), allowed=["quadratic_drag", "constant_coulomb", "stribeck"]
    )
    assert found.effect is None
    assert found.sizes is None
    assert follows(found.to_dict("side", list("abcd"))) == "No effect follows the side."


def test_sides_have_sizes_and_no_power():
    sides = ["left", "right", "left", "right"]
    wind = recordings(
        ("viscous", "quadratic_drag"),
        {"viscous_ratio": 0.004},
        [{"quadratic_coefficient": 0.004 if side == "left" else 0.012} for side in sides],
    )
    found = difference(wind, sides, Model("viscous+quadratic_drag"))
    assert found.effect == "quadratic_drag"
    assert found.law is None
    assert follows(found.to_dict("side", list("abcd"))) == "Quadratic drag follows the side (P > 0.999)."


def test_one_value_is_no_change():
    with pytest.raises(InputError, match="at least 2"):
        difference(sails(), [1.0] * 4, Model("viscous"))
