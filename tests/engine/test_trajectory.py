"""Trajectories against the oracle: 1e-8 rad for swings up to 60 degrees, 1e-6 up to 170, or a refusal, never silence."""

import warnings

import cases
import numpy as np
import pytest
from cases import TIMES, friction
from scipy.special import ellipj, ellipk

from swingdown.engine.trajectory import TrajectoryError, effort, sensitivities, simulate, simulate_each
from swingdown.pendulum.model import PAPER_MODELS, Model
from swingdown_trials import second_pendulum as oracle

# at 170 degrees friction in proportion to the load drives, and engine and oracle follow that to the letter alike
pytestmark = pytest.mark.filterwarnings("ignore:.*gains energy")
LIMITS = {60: 1e-8, 170: 1e-6}  # degrees: rad
STEP = 2 * np.pi / 4096  # rad, of a usual encoder
LABELS = [*cases.paper_models(), *cases.single_effects()]


def expected(case):
    """What the oracle sees of a case; None where the motion runs away."""
    model = case.model
    try:
        return oracle.trajectory(
            model.names,
            model.values,
            case.times,
            case.release_angle,
            case.release_velocity,
            model.restoring,
            model.form,
        )
    except oracle.Runaway:
        return None


def compare(case):
    """(largest error in rad, refused, what the oracle saw); the error is zero where the engine refuses."""
    seen = expected(case)
    try:
        read = simulate(*case.arguments)
    except TrajectoryError:
        return 0.0, True, seen
    assert seen is not None, f"the engine follows a motion that runs away: {case}"
    return float(np.abs(read - seen.reading).max()), False, seen


def sweep(draws, limit):
    """The worst (error, index) over draws; fails on a silent error, or on refusals of what the oracle can follow."""
    worst, refused, stuck, wrong = (0.0, -1), [], 0, []
    for index, case in draws:
        error, refusal, seen = compare(case)
        if refusal and seen is not None:
            refused.append(index)
        stuck += seen is not None and seen.stuck_after is not None
        if not error <= limit:
            wrong.append((index, f"{error:.1e}"))
        worst = max(worst, (error, index))
    return worst, refused, stuck, wrong


@pytest.mark.parametrize("degrees", LIMITS)
@pytest.mark.parametrize("label", LABELS)
def test_a_few_random_pendulums(label, degrees):
    worst, refused, _, wrong = sweep(
        ((k, cases.draw(label, k, np.radians(degrees), 2.5)) for k in range(2)), LIMITS[degrees]
    )
    assert not wrong and not refused


def test_a_first_try_that_ends_in_no_number_is_shortened():
    """A hardening spring at 170 degrees, where the first panel's iteration overflows: that is not solved."""
    error, refused, seen = compare(cases.draw("viscous+cubic_stiffness", 145, np.radians(170)))
    assert seen is not None and not refused and error < 1e-6


@pytest.mark.slow("many pendulums")
@pytest.mark.parametrize("degrees", LIMITS)
@pytest.mark.parametrize("label", LABELS)
def test_random_pendulums(label, degrees, capsys):
    """``DRAWS`` of every model and effect; the table of worst errors goes to the terminal."""
    draws = ((k, cases.draw(label, k, np.radians(degrees))) for k in range(cases.DRAWS))
    worst, refused, stuck, wrong = sweep(draws, LIMITS[degrees])
    with capsys.disabled():
        print(
            f"\n{label:40s} {degrees:3d} deg: worst {worst[0]:.1e} rad (draw {worst[1]}), refused {len(refused)}, stuck {stuck}",
            end="",
        )
    assert not wrong, f"silent errors over {LIMITS[degrees]} rad: {wrong}"
    assert not refused


@pytest.mark.parametrize("index", [12, 72, 92, 141])
def test_a_brake_narrower_than_the_nodes_is_seen(index):
    """At 170 degrees the pendulum rushes through a brake of 2 to 5 degrees; missed, it changes the angle by up to 0.3 rad."""
    error, refused, _ = compare(cases.draw("viscous+eddy_brake", index, np.radians(170)))
    assert not refused and error < 1e-8


def together(index):
    """A random label of two to four effects, one torque at least, whose order of sensors is theirs to combine."""
    rng = cases.generator("together", index)
    names = [name for name in cases.SHIPPED.names if name != "finite_amplitude"]
    chosen = set(rng.choice(names, size=rng.integers(2, 5), replace=False))
    if {"backlash", "sensor_lag"} <= chosen:
        chosen.remove("backlash")
    return "+".join(name for name in names if name in chosen)


@pytest.mark.parametrize(
    "part",
    [
        pytest.param(range(30), id="few"),
        pytest.param(range(30, 30 + 2 * cases.DRAWS), id="many", marks=pytest.mark.slow("many pendulums")),
    ],
)
def test_effects_together(part):
    _, refused, _, wrong = sweep(
        ((k, cases.draw(together(k), k, np.radians(60), 2.5)) for k in part), LIMITS[60]
    )
    assert not wrong and len(refused) <= len(part) // 50


@pytest.mark.parametrize("label", ["load_coulomb", "viscous+load_coulomb", "quadratic_drag+load_coulomb"])
def test_the_printed_form(label):
    _, refused, _, wrong = sweep(((k, cases.draw(label, k, form="printed")) for k in range(4)), LIMITS[60])
    assert not wrong and not refused


@pytest.mark.parametrize("ratio", [0.2, 0.5, 0.7, 1.0, 3.0])
@pytest.mark.parametrize("label", ["viscous", "viscous+quadratic_drag+load_coulomb"])
def test_strong_damping(label, ratio):
    """Exact up to half of critical damping and beyond; near critical, where nothing swings any more, it may refuse."""
    worst, refused, _, wrong = sweep(
        (
            (k, cases.draw(label, k, np.radians(degrees), viscous_ratio=ratio))
            for k in range(3)
            for degrees in LIMITS
        ),
        LIMITS[60],
    )
    assert not wrong and (not refused or ratio == 1.0)


@pytest.mark.parametrize(
    ("name", "own", "share"),
    [
        ("presliding", {"presliding_friction": 0.2, "presliding_angle": 0.01}, 0.1),
        ("power_law_drag", {"power_law_coefficient": 0.1, "power_law_exponent": 1.5}, 0.2),
    ],
)
def test_a_half_swing_knows_the_panels_of_the_last(name, own, share):
    """Where many panels make a half-swing, few are tried in vain: as long as those of the last one they do."""
    values = {"natural_frequency": 7.0, "viscous_ratio": 0.008} | own
    spent = effort(Model(f"viscous+{name}", values), np.arange(2001) / 100, 0.8)
    assert spent.panels > 2 * spent.reversals and spent.rejected < share * spent.panels


@pytest.mark.parametrize("label", PAPER_MODELS)
def test_swings_below_one_encoder_step_keep_their_digits(label):
    """Errors in proportion to the swing: a pendulum released at half a step is as exact as a large one."""
    fixed = {"viscous_ratio": 0.05, "quadratic_coefficient": 0.05, "load_friction": 2e-6}
    case = cases.draw(
        label, 2, **{name: value for name, value in fixed.items() if name in Model(label).parameters}
    )
    for release in (STEP / 2, 1e-6):
        model = case.model
        if "load_friction" in model.parameters:
            model = model.with_values(model.values | {"load_friction": release * 0.01})
        seen = oracle.trajectory(model.names, model.values, case.times, release, 0.0, model.restoring)
        assert np.abs(simulate(model, case.times, release) - seen.reading).max() < 1e-8 * release


def test_the_end_of_a_long_swing():
    """From 40 degrees to a hundredth of an encoder step, and then friction holds it."""
    values = {"natural_frequency": 7.25, "viscous_ratio": 0.03, "load_friction": 1e-7}
    model, times = Model("viscous+load_coulomb", values), np.linspace(0, 45, 901)
    seen = oracle.trajectory(model.names, values, times, np.radians(40))
    read = simulate(model, times, np.radians(40))
    assert abs(read[-1]) < STEP / 100
    assert np.abs(read - seen.reading).max() < 1e-9
    assert np.abs(read - seen.reading)[-100:].max() < 1e-12


@pytest.mark.parametrize("degrees", [1, 20, 60, 120, 170])
def test_the_undamped_pendulum_is_jacobis_sine(degrees):
    """θ = 2 asin(k sn(K + ωn t, k)), with k the sine of half the amplitude (Nayfeh and Mook 1979)."""
    times, k = np.linspace(0, 60, 3001), np.sin(np.radians(degrees) / 2)
    model = Model("viscous", {"natural_frequency": 5.0, "viscous_ratio": 0.0})
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # what is as exact as promised is told without a word
        read = simulate(model, times, np.radians(degrees))
    exact = 2 * np.arcsin(k * ellipj(ellipk(k**2) + 5.0 * times, k**2)[0])
    assert np.abs(read - exact).max() < (1e-8 if degrees <= 60 else 1e-6)


def test_the_linear_pendulum_is_a_damped_cosine():
    times, w, ratio = np.linspace(0, 20, 2001), 7.25, 0.03
    read = simulate(
        Model("viscous", {"natural_frequency": w, "viscous_ratio": ratio}, restoring="linear"),
        times,
        0.4,
        -0.7,
    )
    wd = w * np.sqrt(1 - ratio**2)
    exact = np.exp(-ratio * w * times) * (
        0.4 * np.cos(wd * times) + (ratio * w * 0.4 - 0.7) / wd * np.sin(wd * times)
    )
    assert np.abs(read - exact).max() < 1e-9


def test_other_samples_do_not_matter():
    model = friction(0.4)
    every = simulate(model, TIMES, 0.6, 0.3)
    assert np.array_equal(simulate(model, TIMES[::7], 0.6, 0.3), every[::7])
    assert np.array_equal(simulate(model, TIMES[:3], 0.6, 0.3), every[:3])
    assert np.abs(simulate(model, TIMES + 1e3, 0.6, 0.3) - every).max() < 1e-11
    assert simulate(model, [4.0], 0.6) == pytest.approx([0.6], abs=1e-15)


def test_many_rows_are_each_a_trajectory_of_their_own():
    """A root of the speed takes more panels a second than any fit would grant it: rows may take what they need."""
    model = Model("power_law_drag+load_coulomb")
    own = {
        "natural_frequency": 7.25,
        "power_law_coefficient": 0.1,
        "power_law_exponent": 0.2,
        "load_friction": 0.012,
    }
    first = [*model.with_values(own).vector(), 0.35, 0.1]
    values = np.array([first, [*first[:-2], -0.5, 0.0], [np.nan, *first[1:]], [*first[:3], 0.1, *first[4:]]])
    found = simulate_each(model, np.arange(1001) / 100, values)
    for row, series in zip(values[:2], found, strict=False):
        one = model.with_values(dict(zip(model.parameters, row, strict=False)))
        assert np.array_equal(series, simulate(one, np.arange(1001) / 100, *row[-2:]))
    assert np.all(np.isnan(found[2:]))


def test_a_mirrored_release_gives_the_mirrored_swing():
    model = friction(0.4)
    assert np.array_equal(simulate(model, TIMES, -0.6, 0.3), -simulate(model, TIMES, 0.6, -0.3))


def test_slopes_do_not_change_the_angle():
    for label in (
        "viscous+quadratic_drag+load_coulomb",
        "viscous+flexible_pivot",
        "viscous+sensor_lag",
        "viscous+backlash",
    ):
        case = cases.draw(label, 3)
        assert np.abs(sensitivities(*case.arguments)[0] - simulate(*case.arguments)).max() < 1e-11
