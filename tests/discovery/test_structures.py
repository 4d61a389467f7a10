"""How sure a verdict is of each effect, what a model lacks and what is said of it: on swings that the second pendulum makes."""

from dataclasses import replace

import numpy as np
import pytest

from swingdown.discovery.data.campaign import Swing, campaign
from swingdown.discovery.data.noise import Noise
from swingdown.discovery.judge.findings import judged
from swingdown.discovery.judge.structures import Pool
from swingdown.discovery.move.refit import refit
from swingdown.discovery.search import discover
from swingdown.discovery.see.discrepancy import Unnamed
from swingdown.discovery.see.linear import frame, orthonormal
from swingdown.discovery.see.restricted import Likelihood
from swingdown.discovery.tell.files import summary
from swingdown.discovery.tell.verdict import verdict
from swingdown.engine.trajectory import simulate
from swingdown.fitting.least_squares import fit_jointly
from swingdown.fitting.result import Begin, SwingStart
from swingdown.pendulum.model import Model
from swingdown_trials.second_pendulum import trajectory

TIMES = np.arange(0, 12, 0.02)  # s
NOISE = Noise(1e-3)  # rad
VALUES = {"natural_frequency": 7.0, "viscous_ratio": 0.008}


def swings(releases, *hidden, seed=1, **values):
    """A campaign of a pendulum with viscous drag and these effects more (default: a cubic spring)."""
    hidden = hidden or ("cubic_stiffness",)
    rng = np.random.default_rng(seed)
    made = []
    for angle in releases:
        reading = trajectory(("viscous", *hidden), VALUES | values, TIMES, angle).reading
        made.append(Swing(f"{angle}", TIMES, reading + NOISE.deviation * rng.standard_normal(TIMES.size)))
    return campaign("springs", made)


def fitted(one, label):
    return fit_jointly(Model(label), [swing.pair for swing in one.fit], bounded=True)


def pooled(one, *labels):
    """All these structures, the first the base."""
    pool = Pool(one, NOISE, fitted(one, labels[0]))
    for label in labels[1:]:
        pool.look(fitted(one, label))
    return pool


@pytest.fixture(scope="module")
def spring():
    """Swings of a pendulum whose spring stiffens with the square of the angle."""
    return swings((0.9, -0.7, 0.5, 0.3), cubic_stiffness=1.5)


def lacking(one, label, **options):
    fit = fitted(one, label)
    return Unnamed(fit, one.fit, 2 * np.pi / 7, NOISE, **options).beside(frame(fit, one.fit))


def test_what_first_order_cannot_know_speaks_for_no_structure():
    """A wheel that friction stops, read to a four-thousandth of its swing: beside drag and a spring a discrepancy would do the friction's work to
    the noise, of what a hundred times as much is wrong to first order."""
    truth = Model(("viscous", "presliding"), restoring="linear")
    values = {
        "natural_frequency": 3.7,
        "viscous_ratio": 0.0016,
        "presliding_friction": 0.3,
        "presliding_angle": 0.05,
    }
    times, rng = np.arange(0, 40, 0.04), np.random.default_rng(1)
    read = [simulate(truth.with_values(values), times, angle, 0.0) for angle in (2.3, 2.2, 2.1)]
    noise = Noise(6e-4)
    one = campaign(
        "wheel",
        [
            Swing(f"{k}", times, angle + noise.deviation * rng.standard_normal(times.size))
            for k, angle in enumerate(read)
        ],
    )
    fits = {
        label: fit_jointly(Model(label, restoring="linear"), [swing.pair for swing in one.fit], bounded=True)
        for label in (
            "viscous",
            "viscous+constant_coulomb",
            "viscous+cubic_stiffness",
            "viscous+quadratic_stiffness",
        )
    }
    pool = Pool(one, noise, fits["viscous"], fits["viscous+constant_coulomb"])
    for fit in fits.values():
        pool.look(fit)
    assert fits["viscous+constant_coulomb"].rms < 0.4 * fits["viscous+cubic_stiffness"].rms
    assert pool.of(["constant_coulomb"]) > 0.999


def test_a_model_that_is_right_lacks_nothing_and_one_that_is_not_lacks_as_much_as_it_leaves(spring):
    right, wrong = lacking(spring, "viscous+cubic_stiffness"), lacking(spring, "viscous")
    assert right.log_evidence - right.log_plain < 1
    assert right.size < 0.2 * NOISE.deviation
    excess = np.sqrt(fitted(spring, "viscous").rms ** 2 - NOISE.deviation**2)
    assert wrong.log_evidence - wrong.log_plain > 100
    assert wrong.size == pytest.approx(excess, rel=0.1)
    assert wrong.rest == pytest.approx(1, abs=0.1)
    assert max(wrong.sizes, key=wrong.sizes.get) == "restoring"


def test_the_kind_of_what_is_lacking_is_told():
    drag = swings((0.9, -0.7, 0.5), "quadratic_drag", quadratic_coefficient=0.01)
    sizes = lacking(drag, "viscous").sizes
    assert max(sizes, key=sizes.get) == "dissipative"


def test_what_all_lack_alike_goes_no_further_than_first_order_can_tell():
    near, far = (swings((0.9, -0.7, 0.5, 0.3), cubic_stiffness=stiff) for stiff in (1.5, 20.0))
    assert lacking(near, "viscous", alike=True).rest == pytest.approx(1, abs=0.1)
    assert lacking(far, "viscous", alike=True).rest > 5


def test_what_all_recordings_lack_alike_is_not_what_differs_between_them():
    """Drags that differ, which a drag of each recording that changes in time does as well."""
    slow, quick = (
        swings((0.8, -0.7), "cubic_stiffness", cubic_stiffness=0.0, viscous_ratio=drag)
        for drag in (0.008, 0.01)
    )
    both = replace(slow, fit=(*slow.fit, *(replace(one, name=f"{one.name} again") for one in quick.fit)))
    each, alike = lacking(both, "viscous"), lacking(both, "viscous", alike=True)
    assert each.log_evidence - each.log_plain > alike.log_evidence - alike.log_plain + 30


def test_a_value_that_a_discrepancy_may_move_is_told_with_less_certainty(spring):
    right, wrong = lacking(spring, "viscous+cubic_stiffness"), lacking(spring, "viscous")
    assert max(right.widened.values()) < 2
    assert wrong.widened["natural_frequency"] > 5


def a_discrepancy(rows=40):
    """Columns of two kinds of discrepancy, a residual, and an orthonormal basis of a fit's slopes that has left none of it there."""
    rng = np.random.default_rng(2)
    columns, basis = rng.standard_normal((rows, 5)), orthonormal(rng.standard_normal((rows, 3)))
    residual = rng.standard_normal(rows)
    return [columns[:, :3], columns[:, 3:]], residual - basis @ (basis.T @ residual), basis


def reduced(parts, residual, basis, variance=0.8):
    """Their likelihood along the directions of the discrepancy."""
    directions = orthonormal(np.hstack(parts))
    parts = [directions.T @ part for part in parts]
    kernels, inside = np.stack([part @ part.T for part in parts]), directions.T @ basis
    return Likelihood(
        parts, kernels, directions.T @ residual, inside, float(residual @ residual), residual.size, variance
    )


def test_the_likelihood_is_that_of_what_is_left_once_the_fit_is_projected_out():
    """What the whole covariance says of the residual in the directions that the fit cannot reach."""
    parts, residual, basis = a_discrepancy()
    likelihood, x = reduced(parts, residual, basis), np.array([0.4, -0.7, 0.05])
    beyond = np.linalg.qr(basis, mode="complete")[0][:, basis.shape[1] :]
    covariance = 0.8 * np.exp(x[-1]) * np.eye(residual.size)
    for size, scale, part in zip(x, likelihood.scale, parts, strict=False):
        covariance += np.exp(size) * scale * part @ part.T
    covariance, left = beyond.T @ covariance @ beyond, beyond.T @ residual
    weights = np.linalg.solve(covariance, left)
    wanted = 0.5 * (left @ weights + np.linalg.slogdet(covariance / 0.8)[1])
    assert likelihood.at(x).value == pytest.approx(wanted, rel=1e-9)
    assert likelihood.at(x).left == pytest.approx((0.8 * np.exp(x[-1])) ** 2 * weights @ weights, rel=1e-9)


def test_the_likelihood_has_the_slopes_that_its_differences_have():
    likelihood = reduced(*a_discrepancy())
    at, step = np.array([0.4, -0.7, 0.05]), 1e-5
    for k, unit in enumerate(np.eye(3)):
        difference = (likelihood.at(at + step * unit).cost - likelihood.at(at - step * unit).cost) / (
            2 * step
        )
        assert likelihood.at(at).slopes[k] == pytest.approx(difference, rel=1e-6)


def test_the_average_information_is_that_of_the_whole_covariance():
    parts, residual, basis = a_discrepancy(rows=12)
    likelihood, x = reduced(parts, residual, basis), np.array([0.4, -0.7, 0.05])
    each = [
        np.exp(size) * scale * part @ part.T
        for size, scale, part in zip(x, likelihood.scale, parts, strict=False)
    ]
    each.append(0.8 * np.exp(x[-1]) * np.eye(12))
    beyond = np.linalg.qr(basis, mode="complete")[0][:, basis.shape[1] :]
    inverse = beyond @ np.linalg.inv(beyond.T @ sum(each) @ beyond) @ beyond.T
    pulled = [one @ inverse @ residual for one in each]
    wanted = [[0.5 * one @ inverse @ other for other in pulled] for one in pulled]
    assert likelihood.at(x).curvature - np.diag([0, 0, 1 / 9]) == pytest.approx(np.array(wanted), rel=1e-9)


def test_a_tie_is_shared_out_and_what_is_plain_is_sure(spring):
    tied = swings((0.3, -0.25, 0.2), cubic_stiffness=1.5)
    labels = ("viscous", "viscous+cubic_stiffness", "viscous+quadratic_stiffness")
    pool = pooled(tied, *labels)
    assert sum(pool.probabilities().values()) == pytest.approx(1)
    assert pool.nothing() < 0.01
    assert 0.05 < pool.of(["cubic_stiffness"]) < 0.95
    assert pool.of(["cubic_stiffness", "quadratic_stiffness"]) > 0.9  # or something unnamed
    assert pooled(spring, *labels).of(["cubic_stiffness"]) > 0.99


def test_of_one_structure_the_better_fit_counts(spring):
    pool = pooled(spring, "viscous")
    best = fitted(spring, "viscous+cubic_stiffness")
    worse = replace(best, swings=tuple(replace(one, angle=one.angle + 1e-3) for one in best.swings))
    pool.look(worse)
    before = pool.of(["cubic_stiffness"])
    pool.look(best)
    assert len(pool.known) == 2
    assert pool.of(["cubic_stiffness"]) > before or before > 0.999


def test_something_unnamed_is_a_rival_of_each_name():
    """A narrow magnet does a little of what a spring leaves: not what is missing, whatever its evidence."""
    one = swings((0.9, -0.7, 0.5, 0.3), cubic_stiffness=1.5)
    pool = pooled(one, "viscous")
    pairs = [swing.pair for swing in one.fit]
    pool.look(fit_jointly(Model("viscous+magnet"), pairs, bounded=True, fixed={"magnet_width": 0.1}))
    assert pool.nothing() < 0.01
    best = pool.known[frozenset(("viscous", "magnet"))]
    finding = judged(pool, best)["magnet"]
    assert not finding.sure
    assert finding.share > 0.5


def test_what_is_missing_is_judged_by_all_three_numbers(spring):
    pool = pooled(spring, "viscous", "viscous+cubic_stiffness")
    finding = judged(pool, pool.best)["cubic_stiffness"]
    assert finding.sure
    assert finding.probability > 0.99
    assert finding.share < 0.05
    assert finding.held_out < 0.2


def test_where_nothing_can_be_fitted_without_an_effect_no_share_of_it_is_told(spring, monkeypatch):
    pool = pooled(spring, "viscous", "viscous+cubic_stiffness")
    monkeypatch.setattr(Pool, "lacking", lambda *_: [])
    (found,) = judged(pool, pool.best).values()
    assert not found.sure
    assert np.isnan([found.share, found.held_out, found.without]).all()


def test_a_richer_effect_at_the_values_of_a_simpler_one_is_no_rival_of_it():
    drag = swings((0.9, -0.7, 0.5, 0.3), "quadratic_drag", quadratic_coefficient=0.01)
    pool = pooled(drag, "viscous", "viscous+quadratic_drag", "viscous+power_law_drag")
    finding = judged(pool, pool.known[frozenset(("viscous", "quadratic_drag"))])["quadratic_drag"]
    assert finding.sure and finding.ties == ()


def told(one, **options):
    """(verdict, last round) of a search from viscous drag."""
    states = discover(one, "viscous", **options)
    return verdict([summary(state, one) for state in states]), states[-1]


def test_a_hidden_effect_is_named_with_what_remains_without_it(spring):
    found, last = told(spring, allowed=("cubic_stiffness", "quadratic_stiffness", "constant_torque"))
    assert found["status"] == "named"
    (one,) = found["effects"]
    assert one["name"] == "cubic_stiffness"
    assert one["probability"] > 0.99 and one["share_left"] < 0.05 and one["gap_without"] > 3
    assert found["next_swing"] is None and found["next_measurement"] is None  # nothing is left to ask
    assert last.fit.model.values["cubic_stiffness"] == pytest.approx(1.5, rel=0.05)


def test_nothing_is_named_where_nothing_is_hidden():
    found, last = told(swings((0.9, -0.7, 0.5), cubic_stiffness=0.0))
    assert found["status"] == "consistent"
    assert found["nothing"] > 0.9
    assert last.findings == {}


def test_what_the_catalogue_lacks_has_no_name():
    """A buffer that large swings touch on one side."""
    found, last = told(swings((0.9, -0.7, 0.5), "soft_stop", stop_stiffness=1.0, stop_from=0.25))
    assert found["status"] == "unknown"
    assert found["nothing"] < 0.01
    assert last.unnamed > NOISE.deviation
    assert "has no name in the catalogue" in found["sentence"]


def test_what_something_unnamed_does_as_well_is_told_as_possible():
    """A wrong zero beside a little of a buffer: nearly all of what is missing is the zero, which an unnamed torque does as well."""
    little = {"stop_stiffness": 0.15, "stop_from": 0.25}
    one = swings((0.9, -0.7, 0.5, 0.35, -0.25), "sensor_zero", "soft_stop", sensor_zero=0.006, **little)
    found, last = told(one)
    assert (found["status"], found["effects"]) == ("unknown", [])
    (possible,) = found["stand_ins"]
    assert "sensor_zero" in (possible["name"], *possible["tied_with"])
    assert 0.05 < possible["probability"] < 0.95
    assert "something that has no name may do as well" in found["sentence"]
    assert "has no name in the catalogue" not in found["sentence"]
    assert found["gap"]["holdout"][-1] < 0.3 * found["gap"]["holdout"][0]


def test_what_took_the_place_of_an_effect_of_the_base_is_held_against_that_one():
    """Structural damping in the place of viscous drag: without any damping much is missing, with what it took the place of nothing."""
    plain = swings((0.9, -0.7, 0.5, 0.3), cubic_stiffness=0.0)
    pool = pooled(plain, "viscous", "structural_damping")
    finding = judged(pool, pool.known[frozenset(("structural_damping",))])["structural_damping"]
    assert not finding.sure
    assert finding.share > 1


def test_an_effect_that_does_the_whole_of_the_restoring_is_no_structure():
    """It is a pendulum in the place of the one that is searched."""
    rng, made = np.random.default_rng(4), []
    well = {"natural_frequency": 0.02, "viscous_ratio": 0.1, "magnet_depth": 38.0, "magnet_width": 2.3}
    model = Model("viscous+magnet", well, restoring="linear")
    for angle in (1.6, -0.9):
        noise = NOISE.deviation * rng.standard_normal(TIMES.size)
        made.append(Swing(f"{angle}", TIMES, simulate(model, TIMES, angle) + noise))
    one = replace(campaign("well", made), fit=tuple(made))
    base = fit_jointly(Model("viscous", restoring="linear"), [swing.pair for swing in made], bounded=True)
    starts = tuple(SwingStart(well, angle, 0.0) for angle in (1.6, -0.9))
    pool, found = Pool(one, NOISE, base), refit(Begin(model, starts), made, ended=True)
    pool.look(found)
    assert found.rms < 2 * NOISE.deviation < base.rms / 2
    assert list(pool.known) == [pool.base]


def test_what_is_not_there_is_a_rival_and_nothing_beside_what_is_there(spring):
    pool = pooled(
        spring, "viscous", "viscous+cubic_stiffness", "viscous+detent", "viscous+cubic_stiffness+detent"
    )
    left = pool.but({"detent"}, {"cubic_stiffness"})
    assert {tuple(left.added(key)) for key in left.known} == {(), ("cubic_stiffness",), ("detent",)}
    assert len(pool.known) == 4
    assert left.of(["cubic_stiffness"]) > 0.99


def test_what_is_told_alone_is_as_probable_as_it_is_alone(spring):
    """Of what is left out the probability of the rest is no longer that of the structures which have both."""
    pool = pooled(spring, "viscous", "viscous+cubic_stiffness", "viscous+cubic_stiffness+detent")
    evidences = {(): -10.0, ("cubic_stiffness",): -20.0, ("cubic_stiffness", "detent"): 0.0}
    for key, one in pool.known.items():
        pool.known[key] = replace(one, plain=evidences[tuple(pool.added(key))], unnamed=-99.0)
    alone, both = (next(one for key, one in pool.known.items() if len(key) == size) for size in (2, 3))
    assert judged(pool, both)["cubic_stiffness"].probability > 0.99
    assert judged(pool, alone, both)["cubic_stiffness"].probability < 0.01


def test_what_was_left_out_beside_an_effect_is_no_rival_of_it(spring):
    """A torque that is in every structure, and is not told for it takes away too little, is tied with nothing in its place."""
    added = (
        "cubic_stiffness",
        "constant_torque",
        "constant_torque+quadratic_stiffness",
        "constant_torque+cubic_stiffness",
    )
    pool = pooled(spring, "viscous", *(f"viscous+{one}" for one in added))
    evidences = {
        (): -50.0,
        ("constant_torque",): -50.0,
        ("cubic_stiffness",): -2.0,
        ("constant_torque", "quadratic_stiffness"): -1.0,
    }
    for key, one in pool.known.items():
        pool.known[key] = replace(
            one, plain=evidences.get(tuple(sorted(pool.added(key))), 0.0), unnamed=-99.0
        )
    alone, both = (
        next(one for one in pool.known.values() if set(pool.added(one.key)) == added)
        for added in ({"cubic_stiffness"}, {"constant_torque", "cubic_stiffness"})
    )
    assert judged(pool, alone, both)["cubic_stiffness"].ties == ("quadratic_stiffness",)
