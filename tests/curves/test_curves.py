"""Curves against amplitude: what one can check by hand, and bands that hold the truth where the model is wrong."""

import numpy as np
import pytest
from scipy.special import ellipk, ndtr

import swingdown
from swingdown.answer.given import swings
from swingdown.curves.dataset import curves, table
from swingdown.curves.modelled import course_of
from swingdown.curves.regression import Posterior
from swingdown.engine.trajectory import simulate
from swingdown.errors import InputError
from swingdown.measurement.slack import CLOCK_TOLERANCE
from swingdown.pendulum.catalogue import RATE
from swingdown.pendulum.model import Model

FREQUENCY = 5.0  # rad/s
TIMES = np.arange(0, 40, 0.01)
NOISE = 1e-3


def recorded(label, values, release, restoring="sine", noise=NOISE, seed=1, times=TIMES):
    """The dataset of a simulated swing, and its model."""
    model = Model(label, {"natural_frequency": FREQUENCY, **values}, restoring=restoring)
    angle = simulate(model, times, release) + noise * np.random.default_rng(seed).standard_normal(times.size)
    return swings(times, angle, "rad", restoring=restoring), model


def inside(found, name, truth, source="free"):
    """The share of the points of a curve whose band holds the truth."""
    one = found.sel(source=source)
    return float(np.mean((one[f"{name}_low"].values <= truth) & (truth <= one[f"{name}_high"].values)))


def ratio(model, found):
    """The damping ratio of a model at the amplitudes of a dataset of curves."""
    loss, _ = course_of(model, *found["amplitude"].values[[0, -1]]).at(found["amplitude"].values)
    return loss / np.hypot(np.pi, loss)


def test_an_exponential_decay_has_one_damping_ratio_at_every_amplitude():
    angles, _ = recorded("viscous", {"viscous_ratio": 0.006}, 0.5, "linear")
    found = curves(angles, restoring="linear").sel(source="free")
    assert inside(curves(angles, restoring="linear"), "damping_ratio", np.full(41, 0.006)) > 0.9
    middle = found["damping_ratio"].values[5:-5]
    assert np.abs(middle / 0.006 - 1).max() < 0.01
    # a straight line through zero
    assert (
        inside(curves(angles, restoring="linear"), "friction", 2 * 0.006 * FREQUENCY * found["speed"].values)
        > 0.9
    )


def test_dry_friction_takes_the_same_angle_from_every_swing():
    angles, _ = recorded("constant_coulomb", {"constant_friction": 0.05}, 0.5, "linear")
    found = curves(angles, restoring="linear")
    # the envelope is a straight line: 4 c / ω² a swing, from whatever amplitude is in its middle
    ends = [found["amplitude"].values + sign * 2 * 0.05 / FREQUENCY**2 for sign in (1, -1)]
    assert inside(found, "loss", 1 - ends[1] / ends[0]) > 0.9
    assert inside(found, "friction", np.full(41, 0.05)) > 0.9


def test_quadratic_drag_makes_an_envelope_of_one_over_time():
    coefficient = 0.01  # s
    angles, _ = recorded("quadratic_drag", {"quadratic_coefficient": coefficient}, 0.5, "linear")
    found = curves(angles, restoring="linear")
    # 1 / amplitude grows by 8 ζ ω / 3 each swing (to second order in the loss)
    lost = 1 - np.exp(-8 / 3 * coefficient * FREQUENCY * found["amplitude"].values)
    loss = found["loss"].sel(source="free").values
    assert np.abs(loss / lost - 1)[5:-5].max() < 0.01
    assert inside(found, "friction", FREQUENCY * coefficient * found["speed"].values ** 2) > 0.9


def test_the_period_of_a_pendulum_grows_as_the_elliptic_integral_says():
    angles, _ = recorded("viscous", {"viscous_ratio": 0.002}, 2.2)
    found = curves(angles)
    truth = 4 * ellipk(np.sin(found["amplitude"].values / 2) ** 2) / FREQUENCY
    assert truth[-1] / truth[0] > 1.2
    free = found.sel(source="free")
    assert np.abs(free["period"].values / truth - 1)[2:-2].max() < 1e-4
    assert inside(found, "restoring", FREQUENCY**2 * np.sin(found["angle"].values)) > 0.9
    assert np.allclose(free["frequency"] * free["period"], 1)


@pytest.mark.parametrize("cubic", [6.0, -6.0, 2.0])
def test_friction_knows_that_its_work_and_speed_are_those_of_another_restoring_torque(cubic):
    """A spring that stiffens or softens by 9 % at the turning points: by the ideal one the drag would be 4 % off, four times its band."""
    label, values = "viscous+cubic_stiffness", {"viscous_ratio": 0.006, "cubic_stiffness": cubic}
    held = []
    for seed in range(3):
        angles, _ = recorded(label, values, 0.6, "linear", 2e-3, seed)
        found = curves(angles, restoring="linear")
        held.append(inside(found, "friction", 2 * 0.006 * FREQUENCY * found["speed"].values))
    assert np.mean(held) > 0.9


def test_a_spring_beside_the_weight_is_in_the_restoring_torque():
    angles, _ = recorded("viscous+torsion_spring", {"viscous_ratio": 0.004, "torsion_stiffness": 8.0}, 1.2)
    found = curves(angles)
    angle = found["angle"].values[1:]
    torque = found["restoring"].sel(source="free").values[1:]
    truth = FREQUENCY**2 * np.sin(angle) + 8.0 * angle
    assert torque == pytest.approx(truth, rel=5e-3)
    # a third of the stiffness is no small deviation: the period goes by its square as well
    reached = angle > found["amplitude"].values[0]
    assert torque[reached] == pytest.approx(truth[reached], rel=3e-4)


@pytest.mark.parametrize(
    "label, values",
    [("structural_damping", {"structural_coefficient": 0.6}), ("viscous", {"viscous_ratio": 0.0075})],
)
def test_where_in_a_swing_friction_acts_is_seen_in_the_restoring_torque(label, values):
    # both take 0.024 of the amplitude in a half-swing; the one near the turning points makes it 0.02 % longer than the other
    angles, _ = recorded(label, values, 0.6, noise=2e-4)
    found = curves(angles)
    assert inside(found, "restoring", FREQUENCY**2 * np.sin(found["angle"].values)) > 0.9
    free = found.sel(source="free")
    assert np.max(free["restoring_u"] / free["restoring"]) < 0.024**2 / 3


def test_a_fluid_that_takes_much_of_the_first_swings_takes_nothing_of_the_restoring_torque():
    held = []
    for seed in range(4):
        angles, _ = recorded("quadratic_drag", {"quadratic_coefficient": 0.08}, 0.9, noise=2e-4, seed=seed)
        found = curves(angles)
        held.append(inside(found, "restoring", FREQUENCY**2 * np.sin(found["angle"].values)))
    assert np.mean(held) > 0.9


def test_bands_hold_the_truth_where_the_model_is_wrong():
    """The free ones, and those of the model with what it lacks; the model alone is told apart."""
    held, model_held, missed = [], [], []
    for seed in range(6):
        values = {"viscous_ratio": 0.002, "eddy_coefficient": 0.15, "eddy_width": 0.1}
        angles, model = recorded("viscous+eddy_brake", values, 0.6, seed=seed, noise=5e-4)
        wrong = Model("viscous", {"natural_frequency": FREQUENCY, "viscous_ratio": 0.005})
        found = curves(angles, wrong, np.diag([1e-4, 1e-6]) ** 2)
        loss, period = course_of(model, *found["amplitude"].values[[0, -1]]).at(found["amplitude"].values)
        held += [inside(found, "loss", -np.expm1(-2 * loss)), inside(found, "period", period)]
        model_held.append(inside(found, "loss", -np.expm1(-2 * loss), "model"))
        own, alone = (found.sel(source=source) for source in ("model", "alone"))
        # the loss of a viscous pendulum grows a little with the amplitude, for wider swings take longer
        assert alone["damping_ratio"].values == pytest.approx(0.005, rel=0.05)
        assert np.isnan(alone["damping_ratio_u"]).all()
        missed.append(np.mean(np.abs(alone["loss"] - own["loss"]) > 3 * own["loss_u"]))
    assert np.mean(held) > 0.9
    assert np.mean(model_held) > 0.9
    assert np.mean(missed) > 0.8


def test_a_wrong_restoring_torque_is_beside_the_model_too():
    angles, model = recorded(
        "viscous+torsion_spring", {"viscous_ratio": 0.005, "torsion_stiffness": 5.0}, 0.9
    )
    answer = swingdown.fit(angles[0]["time"].values, angles[0]["angle"].values)
    assert answer.label == "viscous"
    found = answer.curves()
    _, period = course_of(model, *found["amplitude"].values[[0, -1]]).at(found["amplitude"].values)
    torque = FREQUENCY**2 * np.sin(found["angle"].values) + 5.0 * found["angle"].values
    assert inside(found, "period", period, "model") > 0.9
    assert inside(found, "restoring", torque, "model") > 0.9
    alone = found.sel(source="alone")
    assert np.abs(alone["period"].values / period - 1).max() > 1e-3


def test_a_right_model_keeps_a_band_of_its_own():
    """Narrower than the free one by what the law says, though any discrepancy is possible."""
    angles, model = recorded("viscous", {"viscous_ratio": 0.005}, 0.5)
    known = np.diag([1e-5, 1e-5]) ** 2
    found = curves(
        angles, Model("viscous", {"natural_frequency": FREQUENCY, "viscous_ratio": 0.00502}), known
    )
    free, own = (found["loss_u"].sel(source=source).values for source in ("free", "model"))
    assert np.median(own / free) < 0.8
    assert inside(found, "damping_ratio", ratio(model, found), "model") > 0.9


def test_a_model_s_friction_of_speed_alone_is_its_own_at_slow_speeds_too():
    angles, model = recorded("viscous", {"viscous_ratio": 0.005}, 0.5)
    found = curves(angles, model, np.diag([1e-6, 1e-6]) ** 2)
    truth = 2 * FREQUENCY * 0.005 * found["speed"].values
    assert found["friction"].sel(source="alone").values[1:] == pytest.approx(truth[1:], rel=1e-3)
    free, own = (found["friction_u"].sel(source=source).values[1:] for source in ("free", "model"))
    assert np.median(own / free) < 0.6
    assert inside(found, "friction", truth, "model") > 0.9


def test_a_model_with_a_friction_of_the_load_leaves_one_of_the_speed_open():
    """Of another friction only what it takes is known: where Stribeck's has its peak, no swing tells it from the load's."""
    held = []
    for seed in range(6):
        values = {"viscous_ratio": 0.002, "stribeck_friction": 0.04, "stribeck_velocity": 0.6}
        angles, _ = recorded("viscous+stribeck", values, 0.6, seed=seed, noise=2e-3)
        answer = swingdown.fit(angles[0]["time"].values, angles[0]["angle"].values, unit="rad")
        assert "load_coulomb" in answer.label
        found = answer.curves()
        speed = found["speed"].values
        truth = 2 * FREQUENCY * 0.002 * speed + 0.04 * np.exp(-speed / 0.6)
        held.append(inside(found, "friction", truth, "model"))
    assert np.mean(held) > 0.9


def test_a_band_of_a_mixture_holds_95_percent_of_it():
    """Of nine in ten cases known to 1 and one known to 10: half as wide as the normal band of that variance, not a little less."""
    cases = np.array([0.9, 0.1]), np.zeros((2, 1)), np.array([[[1.0]], [[100.0]]])
    told = Posterior(np.zeros(1), np.array([[10.9]]), np.inf, np.zeros(1), 1.0, cases)
    value, u, factor = told.band(np.ones((1, 1)))
    half = float((factor * u)[0])
    assert value[0] == 0 and u[0] == pytest.approx(np.sqrt(10.9))
    assert 0.9 * 2 * ndtr(-half) + 0.1 * 2 * ndtr(-half / 10) == pytest.approx(0.05, abs=1e-4)
    # what is beside it is in every case
    _, u, factor = told.band(np.ones((1, 1)), 100.0)
    assert factor[0] == pytest.approx(1.96, abs=0.01) and u[0] == pytest.approx(100.05, abs=0.01)


@pytest.mark.parametrize("noise", [2e-5, 2e-3])
def test_a_right_model_says_more_than_none_whatever_the_noise(noise):
    """What it lacks is as likely to be a law with nothing beside it as what swings free of a model lack."""
    values = {"viscous_ratio": 0.003, "quadratic_coefficient": 0.02}
    angles, model = recorded("viscous+quadratic_drag", values, 0.5, noise=noise)
    answer = swingdown.fit(angles[0]["time"].values, angles[0]["angle"].values, unit="rad")
    assert answer.label == "viscous+quadratic_drag"
    found = answer.curves()
    free, own = (found["loss_u"].sel(source=source).values for source in ("free", "model"))
    assert np.median(own / free) < 0.85
    assert inside(found, "damping_ratio", ratio(model, found), "model") > 0.9


def test_a_clock_within_limits_widens_the_period_by_no_more_than_these():
    angles, _ = recorded("viscous", {"viscous_ratio": 0.005}, 0.5, noise=1e-6)
    found = curves(angles).sel(source="free")
    half = (found["period_high"] - found["period_low"]).values / 2 / found["period"].values
    assert np.median(half) == pytest.approx(0.95 * CLOCK_TOLERANCE, rel=0.01)


def test_a_narrow_brake_has_its_own_loss_between_the_releases_too():
    values = {
        "natural_frequency": FREQUENCY,
        "viscous_ratio": 0.002,
        "eddy_coefficient": 0.17,
        "eddy_width": 0.2,
    }
    model = Model("viscous+eddy_brake", values)
    found = course_of(model, 0.04, 1.1)
    times = np.arange(0, 1, 1e-4)
    for release in (0.85, 0.93, 1.02):
        angle = simulate(model, times, release)
        turn = -angle.min()
        loss, _ = found.at(np.array([np.sqrt(release * turn)]))
        assert loss[0] == pytest.approx(np.log(release / turn), rel=2e-4)


def test_the_model_s_curves_are_those_of_the_free_ones_where_it_is_right():
    angles, model = recorded("viscous+load_coulomb", {"viscous_ratio": 0.004, "load_friction": 0.001}, 0.5)
    answer = swingdown.fit(angles[0]["time"].values, angles[0]["angle"].values)
    found = answer.curves()
    assert found.attrs["model"] == answer.label == "viscous+load_coulomb"
    for name in ("period", "damping_ratio", "restoring", "friction"):
        free, own = (found[name].sel(source=source).values for source in ("free", "model"))
        u = np.hypot(*(found[f"{name}_u"].sel(source=source).values for source in ("free", "model")))
        assert np.mean(np.abs(free - own)[1:] < 3 * u[1:]) > 0.95, name
        assert (found[f"{name}_u"].sel(source="model").values[1:] < found[f"{name}_u"].sel(source="free").values[1:]).mean() > 0.5, name  # fmt: skip


def test_turning_points_alone_have_curves_too():
    truth = Model("viscous", {"natural_frequency": FREQUENCY, "viscous_ratio": 0.004})
    times = np.arange(0, 60, 0.002)
    angle = simulate(truth, times, 1.0)
    turns = np.flatnonzero(np.diff(np.sign(np.diff(angle)))) + 1
    rng = np.random.default_rng(2)
    marks, size = times[turns] + 0.002 * rng.standard_normal(turns.size), angle[turns] + 0.002 * rng.standard_normal(turns.size)  # fmt: skip
    found = swingdown.fit(marks, size, kind="half_swings").curves()
    assert found.attrs["passages"] == "no"
    assert inside(found, "damping_ratio", ratio(truth, found)) > 0.9
    assert inside(found, "period", 4 * ellipk(np.sin(found["amplitude"].values / 2) ** 2) / FREQUENCY) > 0.8


@pytest.mark.parametrize("kind", ["swing", "half_swings", "turning_points"])
def test_each_swing_s_loss_and_period_are_the_decay_s_within_what_is_stated(kind):
    """However they were recorded: samples, turning points of both sides, or those of one side."""
    truth = Model("viscous", {"natural_frequency": FREQUENCY, "viscous_ratio": 0.006}, restoring="linear")
    rng = np.random.default_rng(4)
    times = np.arange(0, 60, 0.01 if kind == "swing" else 0.001)
    angle = simulate(truth, times, 0.5)
    if kind != "swing":
        turns = np.flatnonzero(np.diff(np.sign(np.diff(angle)))) + 1
        turns = turns[1::2] if kind == "turning_points" else turns
        times = times[turns] + 2e-3 * rng.standard_normal(turns.size)
        angle = angle[turns]
    angle = angle + NOISE * rng.standard_normal(angle.size)
    found = curves(swings(times, angle, "rad", restoring="linear", kind=kind), restoring="linear")
    own = FREQUENCY * np.sqrt(1 - 0.006**2)
    truths = {"loss": 1 - np.exp(-2 * np.pi * 0.006 * FREQUENCY / own), "period": 2 * np.pi / own}
    for name, exact in truths.items():
        value, u = (found[f"swing_{name}{end}"].values for end in ("", "_u"))
        assert np.isfinite(value).sum() > 40, name
        assert np.median(value) == pytest.approx(exact, rel=0.02), name
        if (
            kind == "swing"
        ):  # how well points are known is taken from their digits, and these have all of them
            assert 0.8 < np.sqrt(np.mean(((value - exact) / u) ** 2)) < 1.25, name


def test_angular_rates_have_the_curves_of_the_angles_behind_them():
    truth = Model("viscous", {"natural_frequency": FREQUENCY, "viscous_ratio": 0.005})
    rate = simulate(truth.of(RATE), TIMES, 0.8) + 5e-3 * np.random.default_rng(3).standard_normal(TIMES.size)
    found = swingdown.fit(TIMES, rate, unit="rad/s").curves()
    assert found["amplitude"].values[-1] == pytest.approx(0.79, abs=0.02)
    assert inside(found, "damping_ratio", ratio(truth, found)) > 0.9


def test_recordings_of_one_pendulum_share_their_curves():
    first, truth = recorded("viscous", {"viscous_ratio": 0.006}, 0.8, seed=1)
    second, _ = recorded("viscous", {"viscous_ratio": 0.006}, 0.25, seed=2)
    both, one = curves([*first, *second]), curves(first)
    assert both["amplitude"].values[0] < 0.6 * one["amplitude"].values[0]
    assert inside(both, "damping_ratio", ratio(truth, both)) > 0.85
    assert set(both["swing_recording"].values) == {"swing"} and both.sizes["swing"] > one.sizes["swing"]


def test_the_table_is_tidy_and_has_a_unit_in_every_row():
    angles, model = recorded("viscous", {"viscous_ratio": 0.006}, 0.5)
    rows = table(curves(angles, model))
    assert set(rows["quantity"]) == {
        "period",
        "frequency",
        "loss",
        "damping_ratio",
        "quality",
        "restoring",
        "friction",
    }
    assert set(rows["source"]) == {"free", "model", "alone", "swing"}
    assert rows["unit"].notna().all() and rows["value"].notna().all()
    free = rows[rows["source"] == "free"]
    assert (free["low"] <= free["value"]).all() and (free["value"] <= free["high"]).all()


def test_too_few_swings_have_no_curves():
    angles, _ = recorded("viscous", {"viscous_ratio": 0.006}, 0.5, times=np.arange(0, 3.2, 0.01))
    with pytest.raises(InputError, match="half-swings above the noise"):
        curves(angles)


def test_swings_beyond_half_a_turn_have_no_curves():
    """Degrees that nobody said are some: 3.3° are no 3.3 rad."""
    angles, _ = recorded("viscous", {"viscous_ratio": 0.003}, 3.3, restoring="linear")
    with pytest.raises(InputError, match=r"its swings reach 18\d°.*restoring: linear"):
        curves(angles)


def test_where_only_one_side_has_samples_enough_its_decay_is_told():
    times = np.arange(0.0, 30.0, 0.1)  # seven and eight samples of a half-swing in turn
    noise = np.random.default_rng(1).normal(0, 5e-4, times.size)
    angle = 0.08 * np.exp(-times / 40) * np.cos(2 * np.pi * times / 1.5) + noise
    found = swingdown.fit(times, angle).curves()
    assert float(np.nanmedian(found["loss"])) == pytest.approx(1.5 / 40, rel=0.05)


@pytest.mark.parametrize("tilt", [0.7, -0.7])
def test_a_torque_that_moves_the_middle_leaves_the_model_its_curves(tilt):
    """A swing goes further and takes longer on one side of where it hangs than on the other: their mean is what is compared."""
    values = {"viscous_ratio": 0.003, "constant_torque": tilt}
    angles, model = recorded("viscous+constant_torque", values, 0.8, noise=1e-4)
    found = curves(angles, model)
    for name, share in (("period", 3e-4), ("damping_ratio", 0.02), ("restoring", 1e-3)):
        free, alone = (found[name].sel(source=source).values[1:] for source in ("free", "alone"))
        assert alone == pytest.approx(free, rel=share), name
