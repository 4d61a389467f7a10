"""The curves of the missing torque: with the sign and the size of what is missing, beyond what the fit's own values do."""

import numpy as np
import pytest

from swingdown.discovery.data.campaign import Swing, campaign
from swingdown.discovery.data.noise import Noise
from swingdown.discovery.rounds import first_fit
from swingdown.discovery.see.curves import forms, missing
from swingdown.discovery.see.linear import columns_of, frame
from swingdown.discovery.see.locate import groups
from swingdown.engine.trajectory import simulate
from swingdown.pendulum.model import Model

TIMES, NATURAL, NOISE = np.arange(1501) / 100, 6.0, 1e-4
BASE = {"natural_frequency": NATURAL, "viscous_ratio": 0.01}


def seen(label, **values):
    """The frame of a viscous pendulum fitted to swings of one that has more."""
    hidden, draws = Model(label, BASE | values), np.random.default_rng(8)
    swings = [
        Swing(
            f"{release}", TIMES, simulate(hidden, TIMES, release) + NOISE * draws.standard_normal(TIMES.size)
        )
        for release in (0.6, -0.4)
    ]
    one = campaign("one", swings)
    return frame(first_fit(one, Model("viscous")), one.fit)


def curve(here, over, part="torque"):
    table = missing(here, Noise(NOISE), forms(here))
    rows = table[(table["over"] == over) & (table["part"] == part)]
    return rows["x"].to_numpy(), rows["torque"].to_numpy(), rows["band"].to_numpy()


def test_over_the_angle_it_is_the_torque_that_no_spring_has():
    x, torque, band = curve(seen("viscous+cubic_stiffness", cubic_stiffness=0.4), "position")
    assert np.abs(x).max() == pytest.approx(0.6, rel=0.02)
    assert (np.abs(torque + 0.4 * x**3) < 4 * band).all()
    assert np.abs(torque).max() > 20 * band.max()


def test_over_the_speed_it_is_the_torque_against_the_motion():
    """Up to a drag in proportion to the speed, which the fit has."""
    x, torque, band = curve(seen("viscous+constant_coulomb", constant_friction=0.02), "velocity")
    own, apart = np.polyfit(x[1:], torque[1:], 1, w=1 / band[1:])
    assert own > 0
    assert apart == pytest.approx(-0.02, rel=0.15)


def test_over_the_time_it_is_a_drag_that_grows():
    here = seen("viscous+damping_drift", damping_drift=0.004)
    x, torque, band = curve(here, "time", "drag")
    fastest = max(np.abs(np.gradient(one.angle, TIMES)).max() for one in here.fit.swings)
    np.testing.assert_allclose(torque, -2 * NATURAL * 0.004 * fastest * x, atol=0.05 * np.abs(torque).max())
    for part in ("stiffness", "push"):
        _, other, _ = curve(here, "time", part)
        assert np.abs(other).max() < 0.05 * np.abs(torque).max()


def test_where_nothing_is_missing_the_curves_are_nothing():
    here = seen("viscous")
    for over, part in (("position", "torque"), ("velocity", "torque"), ("time", "drag"), ("time", "push")):
        _, torque, band = curve(here, over, part)
        assert (np.abs(torque) <= 3 * band).all()


def test_what_a_curve_does_to_the_readings_is_what_the_engine_says():
    """Of the angle's third power, and of the angle times the time, by the equations of variation."""
    here = seen("viscous+cubic_stiffness", cubic_stiffness=0.4)
    found, largest = forms(here), max(np.abs(one.angle).max() for one in here.fit.swings)
    cubic = here.fit.model.catalogue["cubic_stiffness"]
    engine = columns_of(here, cubic, {"cubic_stiffness": 0.0}, ["cubic_stiffness"])[:, 0]
    np.testing.assert_allclose(
        found["position"].columns[:, 2], -engine / largest**3, atol=0.01 * np.abs(engine).max() / largest**3
    )


def test_of_a_residual_below_the_noise_the_shares_are_its_own():
    """There is no excess that they could be shares of."""
    here = seen("viscous")
    shares = [one.share for one in groups(here, Noise(3 * NOISE), forms(here))]
    assert max(shares) < 0.2
