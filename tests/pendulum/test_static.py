"""What a model does at rest, and where it hangs."""

import numpy as np
import pytest
from scipy.optimize import brentq

from swingdown.pendulum.model import Model
from swingdown.pendulum.static import drag, resting, static

FREQUENCY = 5.0  # rad/s
SPEED = np.array([0.0, 0.3, 2.0])  # rad/s


def model(label, restoring="sine", **values):
    return Model(label, {"natural_frequency": FREQUENCY, **values}, restoring=restoring)


def test_the_static_torque_is_weight_and_spring_and_friction_has_no_part_in_it():
    angle = np.array([-1.0, 0.0, 0.4])
    torque = static(model("viscous+torsion_spring+constant_coulomb", viscous_ratio=0.1, torsion_stiffness=3.0, constant_friction=0.2))  # fmt: skip
    assert torque(angle) == pytest.approx(-(FREQUENCY**2) * np.sin(angle) - 3.0 * angle)


@pytest.mark.parametrize("exponent", [0.3, 1.0, 2.5])
def test_a_power_of_the_speed_has_no_part_in_it_either(exponent):
    power = {"power_law_coefficient": 0.1, "power_law_exponent": exponent}
    angle = np.array([-1.0, 0.0, 0.4])
    bare = -(FREQUENCY**2) * np.sin(angle)
    assert static(model("power_law_drag", **power))(angle) == pytest.approx(bare, abs=1e-12)
    assert resting(model("power_law_drag", **power)) == 0.0


def test_the_drag_is_the_friction_of_speed_alone():
    both = model("viscous+constant_coulomb", viscous_ratio=0.1, constant_friction=0.2)
    assert drag(both)(SPEED) == pytest.approx(2 * 0.1 * FREQUENCY * SPEED + 0.2)
    beside = model("viscous+torsion_spring", viscous_ratio=0.1, torsion_stiffness=3.0)
    assert drag(beside)(SPEED) == pytest.approx(2 * 0.1 * FREQUENCY * SPEED, abs=1e-8)


@pytest.mark.parametrize(
    "label, values",
    [
        ("load_coulomb", {"load_friction": 0.01}),
        ("structural_damping", {"structural_coefficient": 0.1}),
        ("presliding", {"presliding_friction": 0.2, "presliding_angle": 0.05}),
    ],
)
def test_a_friction_of_angle_or_state_is_no_drag(label, values):
    assert np.array_equal(drag(model(label, **values))(SPEED), np.zeros(3))


@pytest.mark.parametrize("torque", [-6.0, 0.25, 12.0])
def test_a_pendulum_hangs_where_its_torques_are_even(torque):
    pulled = {"constant_torque": torque, "constant_friction": 0.3}
    assert resting(model("constant_torque+constant_coulomb", **pulled)) == pytest.approx(
        np.arcsin(torque / FREQUENCY**2), abs=1e-12
    )
    sprung = model("constant_torque+torsion_spring", constant_torque=torque, torsion_stiffness=2.0)
    even = brentq(lambda angle: torque - FREQUENCY**2 * np.sin(angle) - 2.0 * angle, -1.5, 1.5, xtol=1e-14)
    assert resting(sprung) == pytest.approx(even, abs=1e-12)


def test_what_hangs_nowhere_near_is_taken_to_hang_straight_down():
    assert resting(model("constant_torque", constant_torque=30.0)) == 0.0  # it turns for ever
