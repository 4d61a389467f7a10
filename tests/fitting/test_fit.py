"""The fitter: it finds the truth, the best optimum from anywhere, and says what it knows."""

from time import process_time

import numpy as np
import pytest
from swings import CASES, FULL, SHORT, TIMES, paper_model

from swingdown.engine.trajectory import TrajectoryWarning, simulate
from swingdown.errors import InputError
from swingdown.fitting.least_squares import fit_jointly, fit_trajectory
from swingdown.fitting.nelder_mead import fit_nelder_mead
from swingdown.fitting.result import Begin, SwingStart
from swingdown.pendulum.model import PAPER_MODELS, Model


@pytest.mark.parametrize("label", PAPER_MODELS)
def test_the_truth_is_found_without_noise(label):
    model = paper_model(label)
    fit = fit_trajectory(label, SHORT, simulate(model, SHORT, 0.6, -0.4))
    assert fit.converged
    assert fit.values == pytest.approx([*model.vector(), 0.6, -0.4], rel=1e-6)
    assert fit.rms < 1e-9
    assert fit.free == (*model.parameters, "release_angle", "release_velocity")


@pytest.mark.parametrize("name", CASES)
def test_the_truth_is_found_within_its_standard_errors(name):
    case = CASES[name]
    angle, noise = case.noisy(1)
    fit = fit_trajectory(case.model.label, TIMES, angle)
    truth = np.array([*case.model.vector(), case.release_angle, case.release_velocity])
    assert fit.converged
    assert np.abs((fit.values - truth) / fit.standard_errors).max() < 4
    assert fit.rms == pytest.approx(noise, rel=0.1)
    assert fit.model.values == dict(zip(case.model.parameters, fit.values, strict=False))
    assert np.array_equal(
        fit.angle, simulate(fit.model, TIMES, fit.only.release_angle, fit.only.release_velocity)
    )
    assert fit.rss == pytest.approx(np.sum((fit.angle - angle) ** 2), rel=1e-9)


def test_from_rest_the_first_sample_is_the_release():
    angle, _ = CASES["five"].noisy(2)
    fit = fit_trajectory("viscous", TIMES, angle, start="rest")
    assert fit.only.release_angle == angle[0] and fit.only.release_velocity == 0.0
    assert fit.free == ("natural_frequency", "viscous_ratio")


@pytest.mark.filterwarnings("ignore:.*gains energy")  # of some of the models: what each leaves is asked alone
@pytest.mark.parametrize("start", ["free", "rest"])
def test_a_term_more_never_makes_a_fit_worse(start):
    """The paper's κv,q,c is worse than its κq,c: a global minimum cannot be."""
    for seed, name in ((3, "five"), (4, "sticking"), (5, "seven")):
        angle, _ = CASES[name].noisy(seed)
        rss = {label: fit_trajectory(label, TIMES, angle, start=start).rss for label in PAPER_MODELS}
        for label in PAPER_MODELS:
            for more in PAPER_MODELS:
                if set(label.split("+")) < set(more.split("+")):
                    assert rss[more] <= rss[label] * (1 + 1e-9), (name, label, more)


def test_unbounded_coefficients_may_be_negative_and_bounded_may_not():
    """Simulated quadratic drag, fitted with viscous and Coulomb terms: the paper's own fits go negative here."""
    truth = Model("quadratic_drag", {"natural_frequency": 7.25, "quadratic_coefficient": 0.05})
    angle = simulate(truth, SHORT, np.radians(20))
    free = fit_trajectory("viscous+load_coulomb", SHORT, angle, start="rest")
    assert free.model.values["load_friction"] == pytest.approx(-0.0106, abs=0.002)
    held = fit_trajectory("viscous+load_coulomb", SHORT, angle, start="rest", bounded=True)
    assert held.model.values["load_friction"] == 0.0, "on the bound itself, not near it"
    assert held.converged and held.rss > free.rss
    alone = fit_trajectory("viscous", SHORT, angle, start="rest")
    assert held.rss == pytest.approx(alone.rss, rel=1e-9), "the rest is as good as without the held term"
    assert held.model.values["viscous_ratio"] == pytest.approx(alone.model.values["viscous_ratio"], rel=1e-6)
    assert np.isnan(held.model.standard_errors["load_friction"])
    # a value held at its bound still counts as one that the data were spent on
    spent = np.sqrt((SHORT.size - 2) / (SHORT.size - 3))
    assert held.model.standard_errors["viscous_ratio"] == pytest.approx(
        alone.model.standard_errors["viscous_ratio"] * spent, rel=1e-6
    )


def test_unbounded_shapes_stay_where_the_effect_is_one():
    """A brake ever narrower explains noise ever better; an exponent below its least is no drag."""
    angle, _ = CASES["five"].noisy(16)
    for label, name, least in (
        ("eddy_brake", "eddy_width", 0.01),
        ("power_law_drag", "power_law_exponent", 0.2),
    ):
        fit = fit_trajectory(f"viscous+{label}", TIMES, angle)
        assert fit.model.values[name] >= least


def test_bounds_do_nothing_where_nothing_is_at_them():
    angle, _ = CASES["five"].noisy(8)
    label = CASES["five"].model.label
    free, held = (fit_trajectory(label, TIMES, angle, bounded=bounded) for bounded in (False, True))
    assert held.values == pytest.approx(free.values, rel=1e-6)


def test_a_fit_tells_of_friction_that_drives():
    model = Model(
        "viscous+load_coulomb", {"natural_frequency": 7.25, "viscous_ratio": 0.01, "load_friction": 0.01}
    )
    with pytest.warns(TrajectoryWarning):
        angle = simulate(model, SHORT, 2.2)
    with pytest.warns(TrajectoryWarning, match="it gains energy there"):
        fit = fit_trajectory(model.label, SHORT, angle)
    assert fit.values[:3] == pytest.approx(model.vector(), rel=1e-6)


def test_a_dense_record_is_fitted_to_its_last_sample():
    """Where to search is told by a few of its samples; the optimum is that of all, short swings beside it included."""
    model, dense = paper_model("viscous+load_coulomb"), np.arange(60_000) / 1000
    slow = model.with_values(model.values | {"viscous_ratio": 1e-3, "load_friction": 5e-4})
    rng = np.random.default_rng(19)
    swings = [
        (at, simulate(slow, at, 0.5) + 1e-3 * rng.standard_normal(at.size))
        for at in (dense, SHORT[:150], SHORT)
    ]
    alone, joint = fit_trajectory(slow.label, *swings[0]), fit_jointly(slow.label, swings)
    for fit in (alone, joint):
        assert fit.converged and fit.rms == pytest.approx(1e-3, rel=0.02)
        errors = [fit.model.standard_errors[name] for name in model.parameters]
        assert np.abs((np.array(fit.model.vector()) - slow.vector()) / errors).max() < 4
    known = fit_trajectory(slow.label, *swings[0], guess=alone, seen=False)
    assert known.rss == pytest.approx(alone.rss, rel=1e-9)
    own = fit_jointly(slow.label, swings[::2], own=("natural_frequency",))
    assert own.converged and own.swings[0].own["natural_frequency"] == pytest.approx(7.25, abs=1e-3)


def test_information_criteria_prefer_the_truth():
    angle, _ = CASES["five"].noisy(13)
    right = fit_trajectory("viscous+sensor_zero", TIMES, angle)
    more = fit_trajectory("viscous+quadratic_drag+load_coulomb+sensor_zero", TIMES, angle)
    less = fit_trajectory("viscous", TIMES, angle)
    assert right.bic < more.bic and right.bic < less.bic
    assert right.aicc < less.aicc
    n, k = TIMES.size, 5
    assert right.bic == pytest.approx(n * np.log(right.rss / n) + k * np.log(n))
    assert right.aicc == pytest.approx(
        n * np.log(right.rss / n) + 2 * (k + 1) + 2 * (k + 1) * (k + 2) / (n - k - 2)
    )


def test_nothing_is_asked_twice_where_only_noise_is_left():
    """And all is as before where more than noise is left: another start may explain it."""
    angle, noise = CASES["five"].noisy(14)
    right = fit_trajectory("viscous+sensor_zero", TIMES, angle)
    assert right.message.startswith("1 of 1 starts")
    assert right.rms == pytest.approx(noise, rel=0.05)
    rough = angle + 2 * noise * np.sin(9 * TIMES)
    wrong = fit_trajectory("viscous+sensor_zero", TIMES, rough)
    assert not wrong.message.startswith("1 of 1 starts") and wrong.evaluations > right.evaluations
    astray = Begin(right.model, (SwingStart(right.model.values | {"natural_frequency": 9.0}, 0.3, 0.0),))
    found = fit_trajectory("viscous+sensor_zero", TIMES, angle, guess=astray)
    assert found.rss == pytest.approx(right.rss, rel=1e-8)


@pytest.mark.filterwarnings("ignore:.*gains energy")  # after two steps, or 200 samples
def test_convergence_is_told_honestly():
    angle, _ = CASES["seven"].noisy(14)
    stopped = fit_trajectory(FULL, TIMES, angle, most=2)
    assert not stopped.converged and "not stationary" in stopped.message
    fit = fit_trajectory(FULL, TIMES, angle)
    assert fit.converged and "starts reached the best optimum; stationary" in fit.message
    assert fit.rss < stopped.rss
    one = fit_nelder_mead(FULL, TIMES[:200], angle[:200], restarts=1)
    assert not one.converged and "not stationary after 1" in one.message


def test_what_grows_over_the_record_grows_half_as_much_over_its_half():
    values = {"natural_frequency": 7.25, "viscous_ratio": 0.01, "damping_drift": 0.02}
    angle = simulate(Model("viscous+damping_drift", values), TIMES[:401], 0.4)
    half = fit_trajectory("viscous+damping_drift", TIMES[:201], angle[:201])
    assert half.model.values["damping_drift"] == pytest.approx(0.01, rel=1e-5)


@pytest.mark.parametrize("friction", [{"load_friction": 0.012}, {"constant_friction": 0.6}], ids=str)
@pytest.mark.parametrize("exponent", [0.2, 0.5])
def test_drag_by_a_root_of_the_speed_until_friction_holds(exponent, friction):
    """Its slope at rest is infinite, so that every reversal takes ten times the panels: dear, but no reason to refuse."""
    label = (
        "power_law_drag+"
        + {"load_friction": "load_coulomb", "constant_friction": "constant_coulomb"}[next(iter(friction))]
    )
    drag = {"natural_frequency": 7.25, "power_law_coefficient": 0.1, "power_law_exponent": exponent}
    model = Model(label, drag | friction)
    angle = simulate(model, TIMES, 0.35) + 1e-3 * np.random.default_rng(18).standard_normal(TIMES.size)
    guess = Begin(model, (SwingStart(model.values, 0.35, 0.0),))
    fit = fit_trajectory(label, TIMES, angle, guess=guess, seen=False)
    assert fit.converged
    assert fit.rss <= np.sum((angle - simulate(model, TIMES, 0.35)) ** 2)
    assert fit.rms == pytest.approx(1e-3, rel=0.1)


@pytest.mark.parametrize("label", ["viscous+power_law_drag", "viscous+flexible_pivot"])
def test_data_of_no_pendulum_do_not_hold_a_fit_up(label):
    """Its values run to where a trajectory takes a thousand times what a pendulum's does; that ends, and is told."""
    sharp = np.sign(np.sin(3 * TIMES))
    begun = process_time()
    fit = fit_trajectory(label, TIMES, sharp)
    assert process_time() - begun < 4
    assert fit.rms > 0.1 and (fit.converged or "not stationary" in fit.message)


def with_one(series, place, value):
    """The series with another value at one place."""
    found = series.copy()
    found[place] = value
    return found


@pytest.mark.parametrize(
    ("arguments", "options", "told"),
    [
        (("viscous", TIMES, np.zeros(TIMES.size)), {}, "half-swing"),
        (("viscous", TIMES, np.ones(3)), {}, "angles for"),
        (("viscous", TIMES[:4], np.array([1.0, -1.0, 1.0, -1.0])), {}, "samples for"),
        (("viscous", TIMES, np.full(TIMES.size, np.nan)), {}, "not finite"),
        (("viscous", TIMES, with_one(np.cos(TIMES), 7, np.nan)), {}, "not finite"),
        (("viscous", TIMES, with_one(np.cos(TIMES), 7, -np.inf)), {}, "not finite"),
        (("viscous", with_one(TIMES, 7, np.nan), np.cos(TIMES)), {}, "not finite"),
        (("viscous", with_one(TIMES, -1, np.inf), np.cos(TIMES)), {}, "not finite"),
        (("viscous", with_one(TIMES, 7, TIMES[6]), np.cos(TIMES)), {}, "increasing"),
        (("viscous", TIMES[::-1], np.cos(TIMES)), {}, "increasing"),
        (("viscosity", TIMES, np.cos(TIMES)), {}, "no such effect"),
        (("viscous", TIMES, np.cos(TIMES)), {"start": "somewhere"}, "free or rest"),
    ],
)
@pytest.mark.parametrize("fitter", [fit_trajectory, fit_nelder_mead])
def test_bad_input_is_told(fitter, arguments, options, told):
    with pytest.raises(InputError, match=told):
        fitter(*arguments, **options)
