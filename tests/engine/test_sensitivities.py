"""Sensitivities against exact ones, against 36 digits, and against differences of the oracle; the jump at reversals included."""

import cases
import mpmath
import numpy as np
import pytest

from swingdown.engine.trajectory import sensitivities, simulate
from swingdown.errors import InputError
from swingdown.pendulum.catalogue import SHIPPED
from swingdown.pendulum.model import PAPER_MODELS, Model
from swingdown_trials import second_pendulum as oracle

RELEASE = ("release_angle", "release_velocity")


def relative(found, exact, inside=slice(None)):
    """The largest error of a row against the row's own size."""
    return float(np.abs(found - exact)[inside].max() / np.abs(exact).max())


def test_linear_coulomb_swings_exactly():
    """Half-swing n of a linear pendulum with friction c: θ = (-1)^n D + (A - (2n + 1) D) cos ωt, with D = c/ω²."""
    w, c, release = 6.0, 1.5, 0.9
    times = np.linspace(0, 4, 801)
    n = np.floor(w * times / np.pi)
    sign, d, phase = (-1.0) ** n, c / w**2, w * times
    wave, slope = np.cos(phase), -np.sin(phase)
    exact = {
        "natural_frequency": -2 * d / w * (sign - (2 * n + 1) * wave)
        + (release - (2 * n + 1) * d) * slope * times,
        "constant_friction": (sign - (2 * n + 1) * wave) / w**2,
        "release_angle": wave,
    }
    model = Model("constant_coulomb", {"natural_frequency": w, "constant_friction": c}, restoring="linear")
    angle, slopes = sensitivities(model, times, release, free=tuple(exact))
    assert release - (2 * n[-1] + 1) * d > d, "still swinging at the end"
    assert np.abs(angle - sign * d - (release - (2 * n + 1) * d) * wave).max() < 1e-9
    for row, (name, column) in zip(slopes, exact.items(), strict=True):
        assert relative(row, column) < 1e-8, name


@pytest.mark.parametrize("lag", [5e-4, 2.3e-3, 0.02, 0.1])
@pytest.mark.parametrize("start", [0.0, 0.8])
def test_a_slow_sensor_on_a_linear_pendulum_is_known_exactly(lag, start):
    """The reading is Re(A e^λt / (1 + τλ)) and a transient e^(-t/τ), for the swing Re(A e^λt)."""
    w, ratio, release, velocity, times = 7.0, 0.02, 0.6, 0.5, np.linspace(0, 3, 601)
    pole = w * complex(-ratio, np.sqrt(1 - ratio**2))
    amplitude = complex(release, (release * pole.real - velocity) / pole.imag)
    steady, steady_slope = amplitude / (1 + lag * pole), -amplitude * pole / (1 + lag * pole) ** 2
    moving = velocity**4 / (velocity**4 + (w * release / 4) ** 4)
    slow = (lag * w) ** 2
    first = release - (lag * velocity + moving * release * slow) / (1 + slow)
    first_slope = -(velocity * (1 - slow) + 2 * moving * release * lag * w**2) / (1 + slow) ** 2
    behind = -velocity / w * slow / (1 + slow) * np.exp(-np.pi / 2 / (lag * w))
    behind_slope = behind * (2 / (lag * (1 + slow)) + np.pi / 2 / (lag**2 * w))
    first, first_slope = first + start * behind, first_slope + start * behind_slope
    transient, fading = first - steady.real, np.exp(-times / lag)
    exact = (steady * np.exp(pole * times)).real + transient * fading
    slope = (steady_slope * np.exp(pole * times)).real + (first_slope - steady_slope.real) * fading
    slope += transient * fading * times / lag**2
    values = {"natural_frequency": w, "viscous_ratio": ratio, "lag_time": lag}
    values |= {"lag_start": start} if start else {}
    model = Model("viscous+sensor_lag", values, restoring="linear")
    angle, slopes = sensitivities(model, times, release, velocity, free=("lag_time", "lag_start"))
    assert np.abs(angle - exact).max() < 1e-8
    assert relative(slopes[0], slope) < 1e-6
    assert np.abs(slopes[1] - behind * fading).max() < 1e-8


def many_digits(values, release, velocity, times):
    """Angles of the paper's full model by Taylor series of order 26 in 36 digits, from one reversal to the next."""
    w, viscous, quadratic, load = values
    t, state, s, read = mpmath.mpf(0), (release, velocity), (1 if velocity > 0 else -1), []
    order, longest = 26, mpmath.mpf("0.06")

    def series(th, v):
        th, v, sn, cs = [th], [v], [mpmath.sin(th)], [mpmath.cos(th)]
        for k in range(order):
            square = sum(v[j] * v[k - j] for j in range(k + 1))
            a = (
                -w * w * sn[k]
                - 2 * viscous * w * v[k]
                - s * w * quadratic * square
                - s * load * (square + w * w * cs[k])
            )
            th.append(v[k] / (k + 1))
            v.append(a / (k + 1))
            sn.append(sum((j + 1) * th[j + 1] * cs[k - j] for j in range(k + 1)) / (k + 1))
            cs.append(-sum((j + 1) * th[j + 1] * sn[k - j] for j in range(k + 1)) / (k + 1))
        return th, v

    def at(coefficients, h):
        return mpmath.polyval(coefficients[::-1], h)

    for time in times:
        while True:
            th, v = series(*state)
            h = min(longest, time - t)
            if s * at(v, h) >= 0:
                t, state = t + h, (at(th, h), at(v, h))
                if t == time:
                    break
            else:  # the reversal: Newton's steps on the velocity's series, then the other way
                root = mpmath.findroot(
                    lambda x, v=v: at(v, x), (0, h), solver="anderson", tol=mpmath.mpf(10) ** -64
                )
                t, state, s = t + root, (at(th, root), mpmath.mpf(0)), -s
        read.append(state[0])
    return read


def test_many_digits():
    """Every derivative of the full model after three reversals, to 1e-8 of its size, by differences of 1e-11."""
    values = {
        "natural_frequency": 7.25,
        "viscous_ratio": 0.03,
        "quadratic_coefficient": 0.05,
        "load_friction": 0.012,
    }
    times, release, velocity = [0.0, 0.3, 0.6, 1.2, 1.6], 0.7, -0.5
    model = Model("viscous+quadratic_drag+load_coulomb", values)
    angle, slopes = sensitivities(model, times, release, velocity)
    with mpmath.workdps(36):
        given = [mpmath.mpf(x) for x in (*values.values(), release, velocity)]
        stamped = [mpmath.mpf(x) for x in times]
        exact = many_digits(given[:4], *given[4:], stamped)
        assert max(abs(a - float(b)) for a, b in zip(angle, exact, strict=True)) < 1e-9
        step = mpmath.mpf(10) ** -11
        for k, row in enumerate(slopes):
            up, down = list(given), list(given)
            up[k] += step
            down[k] -= step
            high, low = (many_digits(x[:4], *x[4:], stamped) for x in (up, down))
            column = np.array([float((a - b) / (2 * step)) for a, b in zip(high, low, strict=True)])
            assert relative(row, column) < 1e-8, (*values, *RELEASE)[k]


def differences(case, name, step):
    """The oracle's derivative by ``name``, of fourth order, and the samples that no event passed over on the way."""
    runs = {}
    for k in (-2, -1, 1, 2):
        values, angle, velocity = dict(case.model.values), case.release_angle, case.release_velocity
        if name in values:
            values[name] += k * step
        angle += k * step * (name == "release_angle")
        velocity += k * step * (name == "release_velocity")
        runs[k] = oracle.trajectory(
            case.model.names, values, case.times, angle, velocity, case.model.restoring, case.model.form
        )
    slope = (8 * (runs[1].reading - runs[-1].reading) - (runs[2].reading - runs[-2].reading)) / (12 * step)
    elapsed = case.times - case.times[0]
    clear = elapsed > 1e-3
    if len({len(run.reversals) for run in runs.values()}) > 1:
        return None, None  # a different number of half-swings: no derivative to speak of
    for moved in zip(*(run.reversals for run in runs.values()), strict=True):
        spread = np.ptp(moved)
        clear &= (elapsed < min(moved) - spread - 1e-9) | (elapsed > max(moved) + spread + 1e-9)
    if (
        "clock_drift" in case.model.names
    ):  # events are in true time, samples in stamped; their order is all that matters
        true = elapsed + case.model.values["clock_drift"] * elapsed**2 / elapsed[-1]
        clear = elapsed > 1e-3
        for moved in zip(*(run.reversals for run in runs.values()), strict=True):
            clear &= (true < min(moved) - 1e-3) | (true > max(moved) + 1e-3)
    same = [
        run.contact == runs[1].contact for run in runs.values()
    ]  # play that lets go or picks up is an event too
    return slope, clear & np.all(same, axis=0)


def worst_of(case):
    """The largest error over all free values of a case, over what is admitted of it, and whose it is.

    Admitted are 1e-6 of the slope's size, and the 3e-11 rad that the oracle's own digits leave in a difference.
    """
    _, slopes = sensitivities(*case.arguments)
    worst = (0.0, "")
    for name, row in zip((*case.model.parameters, *RELEASE), slopes, strict=True):
        if name == "release_velocity" and case.release_velocity == 0.0:
            continue  # at rest, the release is itself a reversal: the slopes from either side differ
        step = 5e-4 * max(abs(case.model.values.get(name, 0.3)), 0.01)
        column, clear = differences(case, name, step)
        if column is None or np.count_nonzero(clear) < 100:
            continue
        admitted = 1e-6 * np.abs(column[clear]).max() + 3e-11 / step
        worst = max(worst, (float(np.abs(row - column)[clear].max() / admitted), name))
    return worst


PARTICULAR = {"power_law_exponent": 1.6, "backlash_width": 0.02, "cubic_stiffness": 2.0}


def moving_case(label, index):
    """A random case that keeps swinging: with friction small enough, so that there is a derivative all along."""
    model = Model(label)
    fixed = {
        "load_friction": 0.01,
        "constant_friction": 0.3,
        "stribeck_friction": 0.2,
        "viscous_ratio": 0.02,
    } | PARTICULAR
    return cases.draw(
        label,
        index,
        np.radians(60),
        2.5,
        **{name: value for name, value in fixed.items() if name in model.parameters},
    )


@pytest.mark.parametrize("label", PAPER_MODELS)
def test_the_papers_models(label):
    for index in (0, 1):
        error, name = worst_of(moving_case(label, index))
        assert error < 1, name


@pytest.mark.parametrize("label", [*cases.single_effects(), "viscous+sensor_lag+clock_drift"])
def test_every_effect(label):
    error, name = worst_of(moving_case(label, 5))
    assert error < 1, name


@pytest.mark.parametrize(
    ("label", "exponent"),
    [
        ("power_law_drag", 0.3),
        ("power_law_drag", 0.6),
        ("power_law_drag+base_vibration", 0.3),
        ("power_law_drag+flexible_pivot", 0.3),
    ],
)
def test_a_root_of_the_speed(label, exponent):
    """Its slope by the velocity is infinite at every reversal; three of them, which would add up what is missed there."""
    values = {
        "natural_frequency": 7.0, "power_law_coefficient": 0.1, "power_law_exponent": exponent, "vibration_acceleration": 0.3,
        "vibration_frequency": 0.7, "vibration_phase": 0.5, "pivot_mass_ratio": 0.02, "pivot_frequency": 30.0,
        "pivot_damping_ratio": 0.05,
    }  # fmt: skip
    model = Model(label)
    model = model.with_values({name: values[name] for name in model.parameters})
    case = cases.Case(model, np.linspace(0, 1.6, 161), 0.5, 0.0)
    free = ("natural_frequency", "power_law_exponent", "release_angle")
    for name, row in zip(free, sensitivities(*case.arguments, free=free)[1], strict=True):
        column, clear = differences(case, name, 2e-4 * values.get(name, 0.5))
        assert relative(row[clear], column[clear]) < 3e-6, name


def test_a_push_at_rest_counts_the_way_the_pendulum_leaves():
    model = Model("constant_coulomb", {"natural_frequency": 7.0, "constant_friction": 1.0})
    case, step = cases.Case(model, np.linspace(0, 2, 101), 0.5, 0.0), 1e-5
    row = sensitivities(*case.arguments, free=("release_velocity",))[1][0]
    pushed = simulate(model, case.times, 0.5, -step)
    still = simulate(model, case.times, 0.5)
    assert relative(row, (still - pushed) / step) < 1e-4
    assert relative(row, (simulate(model, case.times, 0.5, step) - still) / step) > 0.01


@pytest.mark.slow("many pendulums")
@pytest.mark.parametrize("label", [*PAPER_MODELS, *cases.single_effects()])
def test_random_pendulums(label, capsys):
    found = [(*worst_of(moving_case(label, index)), index) for index in range(6, 8 + cases.DRAWS // 25)]
    with capsys.disabled():
        print(f"\n{label:40s} worst error of a slope over what is admitted {max(found)}", end="")
    assert max(found)[0] < 1


def test_nothing_moves_once_it_sticks_but_where_it_sticks():
    """The resting angle keeps its derivatives, constant in time and equal to the oracle's differences."""
    values = {"natural_frequency": 7.0, "viscous_ratio": 0.01, "constant_friction": 3.0}
    model, times = Model("viscous+constant_coulomb", values), np.linspace(0, 4, 400)
    _, slopes = sensitivities(model, times, 0.6)
    seen = oracle.trajectory(model.names, values, times, 0.6)
    held = times > seen.stuck_after + 1e-3
    assert held.sum() > 100
    assert np.all(np.ptp(slopes[:, held], axis=1) == 0.0)
    case = cases.Case(model, times, 0.6, 0.0)
    for name, row in zip((*model.parameters, "release_angle"), slopes, strict=False):
        column, _ = differences(case, name, 1e-5)
        assert row[-1] == pytest.approx(column[-1], rel=1e-6)


def test_only_what_is_asked_for():
    model = Model("viscous", {"natural_frequency": 7.0, "viscous_ratio": 0.01})
    times = np.linspace(0, 4, 50)
    angle, every = sensitivities(model, times, 0.6, 0.2)
    assert every.shape == (4, 50)
    _, two = sensitivities(model, times, 0.6, 0.2, free=("release_angle", "viscous_ratio"))
    assert np.abs(two - every[[2, 1]]).max() < 1e-12
    assert sensitivities(model, times, 0.6, 0.2, free=())[1].shape == (0, 50)
    assert np.abs(angle - simulate(model, times, 0.6, 0.2)).max() < 1e-11
    with pytest.raises(InputError, match="gamma"):
        sensitivities(model, times, 0.6, free=("gamma",))


@pytest.mark.parametrize(
    ("label", "values"),
    [
        ("load_coulomb+power_law_drag", {"power_law_coefficient": 0.7, "power_law_exponent": 0.5}),
        ("load_coulomb+power_law_drag", {"power_law_coefficient": 0.05, "power_law_exponent": 1.4}),
        ("load_coulomb+presliding", {"presliding_friction": 0.1, "presliding_angle": 0.006}),
        ("load_coulomb+stribeck", {"stribeck_friction": 0.1, "stribeck_velocity": 0.3}),
        ("load_coulomb+magnet", {"magnet_depth": 0.5, "magnet_width": 0.1}),
    ],
)
def test_rough_ones_take_other_panels_and_are_off_by_little(label, values):
    model = Model(label, {"natural_frequency": 7.2, "load_friction": 0.002, **values})
    times = np.arange(2001) / 100
    (angle, slopes), (exact, exact_slopes) = (
        sensitivities(model, times, 0.7, rough=rough) for rough in (True, False)
    )
    assert 0 < np.abs(angle - exact).max() < 1e-6
    assert max(map(relative, slopes, exact_slopes)) < 2e-3


@pytest.mark.parametrize(
    ("frequency", "release", "values"),
    [
        (6.828, 2.625, {"viscous_ratio": 0.002145, "detent_torque": 0.1888, "detent_order": 17.85, "detent_phase": -0.162}),
        (7.2, 0.7, {"load_friction": 0.002, "detent_torque": 0.1, "detent_order": 16.0, "detent_phase": 0.3}),
        (7.99, 1.637, {"detent_torque": 0.03561, "detent_order": 20.72, "detent_phase": 0.01151}),
        (8.216, 2.904, {"structural_coefficient": 0.05806}),
        (5.817, 2.052, {"constant_torque": -0.9794, "vibration_acceleration": 0.06045, "vibration_frequency": 8.627,
                        "vibration_phase": -1.141, "lag_time": 0.001094}),
    ],
)  # fmt: skip
def test_rough_ones_are_exact_where_their_errors_would_grow(frequency, release, values):
    """Far up, or from notch to notch, a small error becomes a large one: four of these were off by 3e-3 to 0.4 rad."""
    owners = dict.fromkeys(
        effect.name for effect in SHIPPED for one in effect.parameters if one.name in values
    )
    model = Model("+".join(owners), {"natural_frequency": frequency, **values})
    times = np.arange(1001) / 100
    for free in (None, ("natural_frequency",)):
        rough, exact = (
            sensitivities(model, times, release, free=free, rough=rough) for rough in (True, False)
        )
        assert np.abs(rough[0] - exact[0]).max() < 1e-6
        assert rough[1].shape == exact[1].shape
