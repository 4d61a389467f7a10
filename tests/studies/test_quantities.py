"""Period, quality and decay time: of pendulums for which they can be worked out by hand, and with uncertainties that hold."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import ellipk

from swingdown.engine.trajectory import simulate
from swingdown.fitting.least_squares import fit_trajectory
from swingdown.pendulum.model import Model
from swingdown.studies.quantities import (
    Quantity,
    about,
    cycle,
    in_its_middle,
    over_models,
    quantities,
    steady,
)

OMEGA = 7.25


def pendulum(label, restoring="linear", **values):
    return Model(label, {"natural_frequency": OMEGA, **values}, restoring=restoring)


@pytest.mark.parametrize("ratio", [1e-4, 0.01, 0.2])
def test_a_viscous_pendulum_of_small_angles_has_its_textbook_quantities(ratio):
    """Exact: decrement 2 pi zeta / sqrt(1 - zeta^2), period 2 pi / (omega sqrt(1 - zeta^2)), decay 1/(omega zeta)."""
    root = np.sqrt(1 - ratio**2)
    found = quantities(pendulum("viscous", viscous_ratio=ratio), 0.3)
    assert found["period"].value == pytest.approx(2 * np.pi / (OMEGA * root), rel=1e-6)
    assert found["quality"].value == pytest.approx(root / (2 * ratio), rel=1e-4)
    assert found["decay_time"].value == pytest.approx(1 / (OMEGA * ratio), rel=1e-4)
    assert found["natural_frequency"].value == OMEGA


def test_the_period_of_a_large_swing_is_the_elliptic_one():
    almost_free = pendulum("viscous", "sine", viscous_ratio=1e-9)
    expected = 4 / OMEGA * ellipk(np.sin(1.0 / 2) ** 2)
    assert cycle(almost_free, 1.0).period == pytest.approx(expected, rel=1e-7)


@pytest.mark.parametrize(
    ("label", "values"),
    [
        ("viscous", {"viscous_ratio": 0.002}),
        ("viscous", {"viscous_ratio": 0.05}),
        ("constant_coulomb", {"constant_friction": 2.0}),
        ("quadratic_drag", {"quadratic_coefficient": 0.1}),
    ],
)
def test_the_period_is_what_a_stop_watch_shows_of_the_first_whole_swing(label, values):
    """It belongs to the amplitude in the middle of that swing, also where much is lost: the elliptic one there, not that of the release."""
    model, release = pendulum(label, "sine", **values), 1.4
    found = quantities(model, release)
    times = np.arange(0, 3, 1e-4)
    angle = simulate(model, times, release)
    back = times[1 + np.flatnonzero((angle[1:-1] > angle[:-2]) & (angle[1:-1] >= angle[2:]))[0]]
    turns = release, -float(angle.min()), float(np.interp(back, times, angle))
    middle = in_its_middle(release, found)
    assert found["period"].value == pytest.approx(back, abs=2e-4)
    lost = 1 - turns[2] / turns[0]
    assert middle == pytest.approx((turns[0] + 2 * turns[1] + turns[2]) / 4, rel=0.5 * lost**2)
    damped = 1 / np.sqrt(1 - values.get("viscous_ratio", 0.0) ** 2)
    elliptic = 4 / OMEGA * ellipk(np.sin(middle / 2) ** 2) * damped
    assert found["period"].value == pytest.approx(elliptic, rel=0.3 * lost**2 + 1e-6)


@pytest.mark.parametrize(("release", "ratio"), [(2.2, 0.008), (2.97, 0.008), (1.2, 0.3)])
def test_a_wide_or_heavy_swings_decay_time_is_when_its_turning_points_have_fallen(release, ratio):
    """By scipy's integration: each swing is far from the next."""
    model = pendulum("viscous", "sine", viscous_ratio=ratio)
    found = solve_ivp(
        lambda t, y: [y[1], -(OMEGA**2) * np.sin(y[0]) - 2 * ratio * OMEGA * y[1]],
        (0, 40), [release, 0.0], rtol=1e-10, atol=1e-12, events=lambda t, y: y[1],
    )  # fmt: skip
    fallen = np.log(release / np.abs(found.y_events[0][1:, 0]))
    right = np.interp(1.0, [0, *fallen], [0, *found.t_events[0][1:]])
    assert quantities(model, release)["decay_time"].value == pytest.approx(right, rel=3e-4)


@pytest.mark.parametrize("torque", [-9.0, 4.0])
def test_what_pulls_to_one_side_moves_the_middle_and_no_quantity(torque):
    """Amplitudes are counted from where it hangs. Exact for linear restoring; a weight hangs askew, and swings as slowly as there."""
    plain = pendulum("viscous", viscous_ratio=0.01)
    pulled = pendulum("viscous+constant_torque", viscous_ratio=0.01, constant_torque=torque)
    one, other = quantities(plain, 0.3), quantities(pulled, 0.3)
    for name in ("period", "quality", "decay_time"):
        assert other[name].value == pytest.approx(one[name].value, rel=1e-6)
    heavy = pendulum("viscous+constant_torque", "sine", viscous_ratio=1e-6, constant_torque=torque)
    slower = (1 - (torque / OMEGA**2) ** 2) ** 0.25
    assert cycle(heavy, 0.02).period == pytest.approx(2 * np.pi / OMEGA / slower, rel=1e-4)


def test_dry_friction_takes_the_same_angle_each_half_swing():
    """Exact for linear restoring: each half-swing 2 c/omega^2, so that the time to the e-th part is proportional to the angle."""
    friction, amplitude = 0.05, 0.4
    model = pendulum("constant_coulomb", constant_friction=friction)
    loss = 4 * friction / OMEGA**2  # a period
    assert quantities(model, amplitude)["decay_time"].value == pytest.approx(
        amplitude * (1 - np.exp(-1)) / loss * 2 * np.pi / OMEGA, rel=2e-3
    )
    first, second = amplitude - loss / 4, amplitude - 3 * loss / 4  # half of what lies between turning points
    assert quantities(model, amplitude)["quality"].value == pytest.approx(
        np.pi / (2 * np.log(first / second)), rel=1e-5
    )


def test_where_the_swing_hangs_does_not_matter():
    leaning = pendulum("viscous+constant_torque", viscous_ratio=0.01, constant_torque=1.0)
    middle = 1.0 / OMEGA**2
    assert cycle(leaning, 0.3 + middle).decrement == pytest.approx(
        cycle(pendulum("viscous", viscous_ratio=0.01), 0.3).decrement, rel=1e-5
    )


@pytest.mark.parametrize("ratio", [0.7, 0.75])
def test_a_pendulum_that_friction_stops_after_a_swing_has_no_decay_time(ratio):
    """Neither one below 0, nor an error of the program."""
    wound = {"presliding_friction": 0.05, "presliding_angle": 0.01}
    found = quantities(pendulum("viscous+presliding", viscous_ratio=ratio, **wound), 0.3)
    assert np.isnan(found["decay_time"].value)


def test_a_pendulum_that_does_not_come_back_has_no_quality():
    found = quantities(pendulum("viscous", viscous_ratio=1.2), 0.3)
    assert np.isnan([found[name].value for name in ("period", "quality", "decay_time")]).all()
    stopped = quantities(pendulum("constant_coulomb", constant_friction=10.0), 0.2)
    assert np.isnan(stopped["decay_time"].value)


def test_uncertainties_are_as_large_as_the_scatter_of_repeated_measurements():
    times, truth = (
        np.arange(801) / 100,
        pendulum("viscous+load_coulomb", "sine", viscous_ratio=0.006, load_friction=0.003),
    )
    clean, draws = simulate(truth, times, 0.4), np.random.default_rng(5)
    expected, away = quantities(truth, 0.4), []
    for _ in range(60):
        fit = fit_trajectory(truth, times, clean + 0.003 * draws.standard_normal(times.size), guess=truth)
        size = len(truth.parameters)
        found = quantities(fit.model, 0.4, fit.covariance[:size, :size])
        away.append(
            [(found[name].value - expected[name].value) / found[name].uncertainty for name in expected]
        )
    scatter = np.sqrt(np.mean(np.square(away), axis=0))
    assert np.all((scatter > 0.75) & (scatter < 1.3)), dict(zip(expected, scatter, strict=True))


def test_what_a_sensor_makes_of_it_is_no_part_of_a_pendulum():
    plain = pendulum("viscous", "sine", viscous_ratio=0.01)
    seen = pendulum("viscous+sensor_gain+sensor_zero", "sine", viscous_ratio=0.01, sensor_gain=0.3, sensor_zero=0.1)  # fmt: skip
    assert cycle(seen, 0.5) == cycle(plain, 0.5)


def test_what_changes_over_a_record_is_left_out():
    drifting = pendulum("viscous+damping_drift", viscous_ratio=0.01, damping_drift=0.01)
    assert steady(drifting) == pendulum("viscous", viscous_ratio=0.01)


@pytest.mark.parametrize(
    ("label", "values", "unsure"),
    [
        ("viscous", {"viscous_ratio": 0.01}, "natural_frequency"),
        (
            "viscous+magnet",
            {"viscous_ratio": 0.01, "magnet_depth": 0.1, "magnet_width": 0.15},
            "magnet_width",
        ),
    ],
)
def test_a_value_that_is_hardly_known_ends_no_answer(label, values, unsure):
    """A tenth of its error leads to a frequency below nothing, or to a magnet of no width."""
    model = pendulum(label, restoring="sine", **values)
    covariance = np.diag([1e-8] * len(model.parameters))
    at = model.parameters.index(unsure)
    covariance[at, at] = (30 * model.values[unsure]) ** 2
    found = quantities(model, 0.3, covariance)
    assert np.isfinite(found["period"].value)
    if unsure == "natural_frequency":
        assert found["period"].uncertainty > 10 * found["period"].value
    assert found[unsure].uncertainty == pytest.approx(30 * model.values[unsure])


def test_a_value_of_several_models_is_their_mean_and_knows_how_far_they_are_apart():
    one, other = Quantity(10.0, 0.3, "s"), Quantity(12.0, 0.4, "s")
    told = over_models([(0.75, {"period": one}), (0.25, {"period": other})], ["period", "quality"])
    assert list(told) == ["period"]
    assert told["period"].value == pytest.approx(10.5)
    assert told["period"].u == pytest.approx(np.sqrt(0.75 * (0.3**2 + 0.5**2) + 0.25 * (0.4**2 + 1.5**2)))


def test_a_value_of_one_model_knows_how_far_the_others_are_from_it():
    one, other = Quantity(10.0, 0.3, "1/s"), Quantity(12.0, 0.4, "1/s")
    told = about({"drag": one}, [(0.75, {"drag": one}), (0.25, {"drag": other, "wind": other})])
    assert told["drag"].value == 10.0
    assert told["drag"].u == pytest.approx(np.sqrt(0.75 * 0.3**2 + 0.25 * (0.4**2 + 2.0**2)))
    held = {"drag": Quantity(10.0, np.nan, "1/s")}
    assert about(held, [(1.0, {"drag": other})]) == held


def test_a_model_that_tells_no_value_does_not_count():
    told = over_models(
        [(0.5, {"period": Quantity(10.0, np.nan, "s")}), (0.1, {"period": Quantity(12.0, 0.4, "s")})],
        ["period"],
    )
    assert told["period"] == Quantity(12.0, 0.4, "s")


def test_friction_that_winds_up_takes_as_long_as_the_swing_itself():
    values = {"presliding_friction": 0.02, "presliding_angle": 0.02, "viscous_ratio": 0.003}
    model = Model("viscous+presliding", {"natural_frequency": 6.0} | values)
    times = np.arange(0, 40, 1e-3)
    angle = simulate(model, times, 0.4)
    tops = np.flatnonzero((angle[1:-1] > angle[:-2]) & (angle[1:-1] >= angle[2:])) + 1
    fallen = np.interp(1.0, np.log(0.4 / angle[tops]), times[tops])
    assert quantities(model, 0.4)["decay_time"].value == pytest.approx(fallen, rel=2e-4)


def test_a_value_near_its_bound_leaves_the_period_known():
    """The least angle of presliding is 1e-5 rad: a tenth of this error below the value there is no model."""
    values = {"presliding_friction": 0.058, "presliding_angle": 1.2e-5, "viscous_ratio": 4e-6}
    model = Model("viscous+presliding", {"natural_frequency": 8.2} | values)
    errors = {
        "natural_frequency": 1e-5,
        "presliding_friction": 5e-4,
        "presliding_angle": 1e-4,
        "viscous_ratio": 1e-5,
    }
    covariance = np.diag([errors[name] ** 2 for name in model.parameters])
    at_its_bound = quantities(model, 0.5, covariance)
    within = quantities(model.with_values(model.values | {"presliding_angle": 2.5e-5}), 0.5, covariance)
    assert at_its_bound["period"].u == pytest.approx(within["period"].u, rel=0.5)
    assert at_its_bound["quality"].u == pytest.approx(within["quality"].u, rel=0.1)


def test_a_loss_that_nothing_tells_is_no_number_without_a_warning():
    """Free courses that would move the decay time by a thousand powers of ten: no value, and nothing that a user would have to read."""
    model = pendulum("viscous", viscous_ratio=1e-6)
    whole = np.diag([1e-8, 1e-12, 1e-8, 1e-8, 1e-2, 1e-2])
    beside = SimpleNamespace(covariance=whole, shift=np.array([0.0, 0.0, 0.0, 0.0, 2e3, 2e3]))
    found = quantities(model, 0.3, whole[:2, :2], beside)
    assert not np.isfinite(found["decay_time"].value) and np.isnan(found["decay_time"].uncertainty)
    assert found["period"].value == pytest.approx(2 * np.pi / OMEGA, rel=1e-6)
