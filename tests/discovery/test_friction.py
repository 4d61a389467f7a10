"""What only something that takes energy could do, apart from springs and zeros: on swings that the second pendulum makes."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from swingdown.discovery.criterion import USUAL, Doubt
from swingdown.discovery.data.campaign import Swing, campaign
from swingdown.discovery.data.noise import Noise
from swingdown.discovery.judge import findings
from swingdown.discovery.judge.confirm import predict
from swingdown.discovery.judge.findings import Finding, judged, told_of
from swingdown.discovery.judge.structures import Pool
from swingdown.discovery.move.admissible import at_its_bound
from swingdown.discovery.see import friction
from swingdown.discovery.see.envelope import NOT_SEEN
from swingdown.discovery.see.linear import frame
from swingdown.fitting.least_squares import fit_jointly
from swingdown.pendulum.model import Model
from swingdown_trials.second_pendulum import trajectory

TIMES = np.arange(0, 12, 0.02)  # s
NOISE = Noise(1e-3)  # rad
VALUES = {"natural_frequency": 7.0, "viscous_ratio": 0.008}


def swings(hidden, zeros=(0.0, 0.0, 0.0, 0.0), angles=(0.9, -0.7, 0.5, 0.3), **values):
    """A campaign of a pendulum with viscous drag and what is hidden; each recording's zero (rad)."""
    rng = np.random.default_rng(3)
    made = []
    for angle, zero in zip(angles, zeros, strict=True):
        reading = trajectory(("viscous", *hidden), VALUES | values, TIMES, angle).reading
        noise = NOISE.deviation * rng.standard_normal(TIMES.size)
        made.append(Swing(f"{angle}", TIMES, reading + zero + noise))
    return campaign("drags", made)


def fitted(one, label, **values):
    known = {name: value for name, value in (VALUES | values).items() if name in Model(label).parameters}
    guess = Model(label, known) if values else None
    return fit_jointly(Model(label), [swing.pair for swing in one.fit], guess=guess, bounded=True)


def asked(one, added, **values):
    """What is judged of an effect beside viscous drag, fitted from these values."""
    pool = Pool(one, NOISE, fitted(one, "viscous"))
    pool.look(fitted(one, f"viscous+{added}", **values))
    return judged(pool, pool.known[frozenset(("viscous", added))])[added], pool


@pytest.fixture(scope="module")
def beside_a_spring():
    return swings(
        ("quadratic_drag", "quadratic_stiffness"), quadratic_coefficient=0.02, quadratic_stiffness=4.0
    )


@pytest.mark.slow("many trajectories")
def test_a_drag_is_told_though_a_spring_is_missing_too(beside_a_spring):
    finding, pool = asked(beside_a_spring, "quadratic_drag")
    left = [one.left(NOISE) for one in pool.known.values()]
    assert left[1] > 0.3 * left[0]  # of all that is missing
    assert finding.share < 0.1 and finding.held_out < 0.2
    assert finding.sure


@pytest.mark.slow("many trajectories")
def test_a_spring_and_zeros_leave_nothing_that_takes_energy():
    one = swings(("cubic_stiffness",), (0.02, -0.01, 0.0, 0.01), cubic_stiffness=0.2)
    fit = fitted(one, "viscous")
    assert fit.rms > 5 * NOISE.deviation
    for work in (
        friction.fitted(frame(fit, one.fit)),
        friction.held_out(predict(fit, one.holdout), one.holdout),
    ):
        assert 0.01 < work.share < 0.2
        assert work.mean_square < (work.share + 0.2) * NOISE.deviation**2


@pytest.mark.slow("many trajectories")
def test_a_drag_is_told_though_the_pivot_shakes():
    """What comes and goes with time is no law of friction, and takes nothing from what a drag explains."""
    shaken = {"vibration_acceleration": 1.6, "vibration_frequency": 2.3, "vibration_phase": 0.3}
    one = swings(("quadratic_drag", "base_vibration"), quadratic_coefficient=0.02, **shaken)
    finding, pool = asked(one, "quadratic_drag")
    left = [one.left(NOISE) for one in pool.known.values()]
    assert left[1] > 0.3 * left[0]  # of all that is missing
    assert finding.share < 0.2 and finding.sure


@pytest.mark.slow("many trajectories")
def test_a_brake_that_may_be_as_wide_as_the_swing_is_tied_with_the_uniform_one():
    one = swings(("eddy_brake",), viscous_ratio=0.0, eddy_coefficient=0.28, eddy_width=2.0)
    pool = Pool(one, NOISE, fitted(one, "constant_coulomb"))
    brake = {"constant_friction": 0.01, "eddy_coefficient": 0.28, "eddy_width": 2.0}
    pool.look(fitted(one, "constant_coulomb+eddy_brake", **brake))
    best = pool.known[frozenset(("constant_coulomb", "eddy_brake"))]
    assert "viscous" not in judged(pool, best)["eddy_brake"].ties
    # as where what is missing leaves the width open
    best = replace(
        best, plain=-1e3, lacks=replace(best.lacks, widened=best.lacks.widened | {"eddy_width": 30.0})
    )
    assert "viscous" in judged(pool, best)["eddy_brake"].ties


@pytest.mark.slow("many trajectories")
@pytest.mark.parametrize("stiffness", [0.0, 2.0])
def test_a_spring_that_softens_as_a_weight_does_is_tied_with_it(stiffness):
    """A wheel on a spring that turns out to be a pendulum: its torque is that of a cubic spring of one size."""
    one = swings(("cubic_stiffness",), angles=(0.3, -0.25, 0.2, 0.15), cubic_stiffness=stiffness)
    base = Model("viscous", restoring="linear")
    fits = [
        fit_jointly(model, [swing.pair for swing in one.fit], bounded=True)
        for model in (base, base.with_effects(("viscous", "cubic_stiffness")))
    ]
    pool = Pool(one, NOISE, fits[0])
    pool.look(fits[1])
    found = judged(pool, pool.known[frozenset(("viscous", "cubic_stiffness"))])
    assert ("finite_amplitude" in found["cubic_stiffness"].ties) is (stiffness == 0)


@pytest.mark.slow("many trajectories")
def test_what_a_tied_effect_is_nearly_is_tied_too():
    """A weight taken for a spring: another effect is tied with a cubic spring that softens as the weight does, and so with the weight."""
    one = swings((), angles=(0.3, -0.25, 0.2, 0.15))
    base, cubic, other = (
        fit_jointly(Model(label, restoring="linear"), [swing.pair for swing in one.fit], bounded=True)
        for label in ("viscous", "viscous+cubic_stiffness", "viscous+sensor_curvature")
    )
    pool = Pool(one, NOISE, base)
    for fit in (cubic, other):
        pool.look(fit)
    for key, evidence in (
        (("viscous",), -50.0),
        (("viscous", "cubic_stiffness"), -1.0),
        (("viscous", "sensor_curvature"), 0.0),
    ):
        pool.known[frozenset(key)] = replace(
            pool.known[frozenset(key)], plain=evidence - 100, unnamed=evidence
        )
    assert judged(pool, pool.best)["sensor_curvature"].ties == ("cubic_stiffness", "finite_amplitude")


@pytest.mark.slow("many trajectories")
def test_a_brake_narrower_than_a_brake_can_be_is_not_told():
    """A brush at the very bottom, of which it leaves next to nothing: the fit ends at the bound of the brake's width."""
    one = swings(("friction_patch",), patch_friction=0.6, patch_from=-0.004, patch_to=0.004)
    fit = fitted(one, "viscous+eddy_brake", eddy_coefficient=1.0, eddy_width=0.02)
    assert at_its_bound(fit, "eddy_brake") == "eddy_width runs to its bound 0.01 rad"
    pool = Pool(one, NOISE, fitted(one, "viscous"))
    pool.look(fit)
    assert list(pool.known) == [pool.base]


@pytest.mark.slow("many trajectories")
def test_drags_that_share_the_work_are_judged_as_one():
    one = swings(("structural_damping",), viscous_ratio=0.02, structural_coefficient=0.01)
    pool = Pool(one, NOISE, fitted(one, "constant_coulomb"))
    pool.look(fitted(one, "constant_coulomb+viscous+structural_damping"))
    found = judged(pool, pool.known[frozenset(("constant_coulomb", "viscous", "structural_damping"))])
    assert list(found) == ["viscous"] and found["viscous"].sure
    assert "structural_damping" in found["viscous"].ties


@pytest.mark.slow("many trajectories")
def test_friction_of_another_kind_is_not_told_by_a_name_that_leaves_some_of_it():
    """Friction at some angles only: a constant one does part of its work."""
    one = swings(("friction_patch",), patch_friction=0.4, patch_from=0.15, patch_to=0.3)
    finding, _ = asked(one, "constant_coulomb")
    assert finding.share > 0.2 and not finding.sure


@pytest.mark.slow("many trajectories")
def test_of_few_samples_nothing_is_told_apart(beside_a_spring):
    few = tuple(Swing(one.name, one.times[::30], one.angle[::30]) for one in beside_a_spring.fit)
    fit = fit_jointly(Model("viscous"), [swing.pair for swing in few], bounded=True)
    assert friction.fitted(frame(fit, few)) is None


@pytest.mark.slow("many trajectories")
@pytest.mark.parametrize(
    ("hidden", "values", "friction"),
    [
        ("constant_coulomb", {"constant_friction": 0.05}, 0.05),
        ("presliding", {"presliding_friction": 0.05, "presliding_angle": 0.005}, 0.05),
        ("structural_damping", {"structural_coefficient": 0.5}, 0.0),
        ("quadratic_drag", {"quadratic_coefficient": 0.02}, 0.0),
        ("one_sided_drag", {"one_sided_drag": 0.05}, 0.0),
    ],
)
def test_an_unnamed_torque_holds_a_friction_where_one_is_left_at_no_speed(hidden, values, friction):
    one = swings((hidden,), **values)
    pool = Pool(one, NOISE, fitted(one, "viscous"))
    lacks = pool.first.lacks
    if friction:
        assert abs(lacks.friction - friction) < 3 * lacks.friction_error
        assert pool.of_friction() > 0.999
    else:
        assert pool.of_friction() < 0.1


@pytest.mark.slow("many trajectories")
def test_a_friction_is_told_though_its_law_has_no_name():
    """Where an unnamed torque is more probable than each name, and holds a friction, that there is one is sure, and its law is open."""
    one = swings(("presliding",), presliding_friction=0.05, presliding_angle=0.005)
    pool = Pool(one, NOISE, fitted(one, "viscous"))
    pool.look(fitted(one, "viscous+constant_coulomb"))
    named = frozenset(("viscous", "constant_coulomb"))
    for key, unnamed in ((pool.base, 0.0), (named, -10.0)):  # as if the name were that improbable
        pool.known[key] = replace(pool.known[key], plain=-1e3, unnamed=unnamed)
    last, found = told_of(pool, pool.best)
    finding = found["constant_coulomb"]
    assert last.key == named and finding.sure and finding.law_open and finding.probability > 0.999


@pytest.mark.slow("many trajectories")
@pytest.mark.parametrize(("behind", "told"), [(1.5, True), (4.0, False)])
def test_of_laws_that_are_as_probable_one_that_leaves_little_is_told(monkeypatch, behind, told):
    """Quadratic drag beside structural damping, which is the more probable and leaves most of what is missing: of a law that is possible, and
    leaves nothing, the tie is told; of one that is improbable nothing is. No envelope shows either."""
    monkeypatch.setattr(Pool, "envelope", lambda *_: NOT_SEEN)
    one = swings(("quadratic_drag",), quadratic_coefficient=0.02)
    pool = Pool(one, NOISE, fitted(one, "viscous"))
    evidences = {"structural_damping": 0.0, "quadratic_drag": -behind}
    for added, evidence in evidences.items():
        pool.look(fitted(one, f"viscous+{added}"))
        key = frozenset(("viscous", added))
        pool.known[key] = replace(pool.known[key], plain=evidence - 100, unnamed=evidence)
    pool.known[pool.base] = replace(pool.first, plain=-1e3, unnamed=-50.0)
    last, found = told_of(pool, pool.best)
    assert pool.added(pool.best.key) == ["structural_damping"]
    assert any(finding.sure for finding in found.values()) is told
    if told:
        assert pool.added(last.key) == ["quadratic_drag"]
        assert found["quadratic_drag"].ties == ("structural_damping",)


@pytest.mark.slow("many trajectories")
@pytest.mark.parametrize(("patch", "sure"), [((-0.1, 0.0), True), ((0.15, 0.3), False)])
def test_a_friction_that_an_unnamed_torque_shows_is_told_whatever_its_law_leaves(monkeypatch, patch, sure):
    """Friction beside the middle only: a constant one does part of its work, and that something rubs there is seen without it, where no
    envelope shows it."""
    monkeypatch.setattr(Pool, "envelope", lambda *_: NOT_SEEN)
    hidden = dict(zip(("patch_from", "patch_to"), patch, strict=True))
    one = swings(("friction_patch",), patch_friction=0.4, **hidden)
    finding, pool = asked(one, "constant_coulomb")
    assert finding.share > 0.2
    assert finding.sure is sure and finding.law_open is sure
    assert (pool.sees_friction() >= 0.99) is sure


@pytest.mark.slow("many trajectories")
@pytest.mark.parametrize(
    ("hidden", "values", "law_open"),
    [
        ("one_sided_drag", {"one_sided_drag": 0.1}, True),
        ("quadratic_drag", {"quadratic_coefficient": 0.02}, False),
    ],
)
def test_the_law_of_a_drag_is_open_where_something_else_that_takes_energy_is_left(hidden, values, law_open):
    """A drag on one side only, of which one on both does the most; and one on both, of which it does all."""
    finding, _ = asked(swings((hidden,), **values), "quadratic_drag")
    assert finding.sure and finding.law_open is law_open


@pytest.mark.slow("many trajectories")
def test_a_spring_that_is_left_opens_no_law_of_a_drag(beside_a_spring):
    finding, pool = asked(beside_a_spring, "quadratic_drag")
    assert pool.best.whole < 0.01 and not finding.law_open


@pytest.mark.slow("many trajectories")
def test_no_friction_is_told_of_an_unnamed_drag():
    one = swings(("quadratic_drag",), quadratic_coefficient=0.02)
    pool = Pool(one, NOISE, fitted(one, "viscous"))
    pool.look(fitted(one, "viscous+constant_coulomb"))
    last, found = told_of(pool, pool.best)
    assert not any(finding.sure for finding in found.values())


def test_a_drag_is_asked_of_what_only_a_drag_could_do_where_held_out_swings_lack_something_else(monkeypatch):
    """Most of what is missing goes with it, of held-out swings too little: what these lack beside it tells nothing of a drag."""
    monkeypatch.setattr(findings, "_whole", lambda *_: (0.1, 0.7, 5.0))
    monkeypatch.setattr(findings, "_of_friction", lambda *_: (0.15, 0.15))
    there = SimpleNamespace(left=lambda _: 1.0, fit=SimpleNamespace(model=Model("viscous")))
    pool = SimpleNamespace(
        lacking=lambda *_: [there], noise=None, criterion=USUAL, loses_more=lambda _: False
    )
    assert findings._asked(pool, there, "quadratic_drag", ["quadratic_drag"], findings.Finding(1.0)).sure
    assert findings._asked(pool, there, "cubic_stiffness", ["cubic_stiffness"], findings.Finding(1.0)).doubt


def _judged(*wanted):
    """A stand-in for ``judged``: of each effect (share, the same of held-out swings) by the effects of the structure."""
    found = dict(wanted)

    def judged(pool, best, most=None):
        shares = found[best.key]
        assert best.key == max(found, key=len) or most.key == max(found, key=len)
        return {
            name: Finding(1.0, share=share, held_out=held, doubt=USUAL.doubt(1.0, share, held))
            for name, (share, held) in shares.items()
        }

    return judged


@pytest.mark.parametrize(
    ("share", "held", "told"), [(0.1, 0.8, {"magnet"}), (0.1, 0.4, {"magnet", "detent"})]
)
def test_what_held_out_swings_speak_against_is_not_in_the_model_that_is_told(monkeypatch, share, held, told):
    both, one = frozenset(("magnet", "detent")), frozenset(("magnet",))
    structures = {key: SimpleNamespace(key=key) for key in (both, one)}
    pool = SimpleNamespace(
        criterion=USUAL,
        nothing=lambda: 1.0,
        added=sorted,
        lacking=lambda here, names: [structures[here.key - set(names)]],
    )
    given = {"magnet": (0.05, 0.1), "detent": (share, held)}
    monkeypatch.setattr(findings, "judged", _judged((both, given), (one, {"magnet": (0.1, 0.2)})))
    last, found = told_of(pool, structures[both])
    assert last.key == told and set(found) == told


def test_an_effect_that_cannot_be_left_out_keeps_no_other_one():
    """Without the clock's drift nothing can be fitted: the detent goes all the same."""
    three, two = (
        frozenset(("constant_coulomb", "clock_drift", "detent")),
        frozenset(("constant_coulomb", "clock_drift")),
    )
    structures = {two: [SimpleNamespace(key=two)]}
    pool = SimpleNamespace(
        criterion=USUAL,
        nothing=lambda: 1.0,
        added=sorted,
        lacking=lambda here, names: structures.get(here.key - set(names), []),
    )
    assert findings._fewer(pool, SimpleNamespace(key=three), ["clock_drift", "detent"]).key == two


def test_what_an_effect_is_nearly_in_the_most_probable_structure_it_is_in_a_smaller_one(monkeypatch):
    """Without its neighbours a size is known too well to be that of the simpler effect."""
    here, most = (
        SimpleNamespace(key=frozenset(names))
        for names in (["cubic_stiffness"], ["cubic_stiffness", "detent"])
    )
    nearly = {here.key: [], most.key: ["finite_amplitude", "detent"]}
    monkeypatch.setattr(findings, "_nearly_in", lambda structure, name: nearly[structure.key])
    assert findings._nearly([here], "cubic_stiffness") == []
    assert findings._nearly([here, most], "cubic_stiffness") == ["finite_amplitude"]


@pytest.mark.parametrize(
    ("exponent", "nearly"), [(0.2, ["constant_coulomb"]), (0.3, []), (0.99, ["viscous"])]
)
def test_a_shape_at_its_bound_may_be_the_simpler_effect_beyond_it(exponent, nearly):
    """A drag in the least power of the speed that is fitted may be one in none, which is friction."""
    values = {"power_law_coefficient": 0.4, "power_law_exponent": exponent}
    model = Model("power_law_drag").with_values(values | {"natural_frequency": 7.0})
    model = replace(model, standard_errors={"power_law_exponent": 0.01})
    there = SimpleNamespace(key=frozenset(["power_law_drag"]), fit=SimpleNamespace(model=model), widened={})
    assert findings._nearly([there], "power_law_drag") == nearly


@pytest.mark.parametrize(
    ("depth", "width", "nearly"),
    [(4.4, 1.0, ["finite_amplitude"]), (5.5, 1.0, []), (0.0099, 0.15, []), (-4.4, 1.0, [])],
)
def test_a_wide_magnet_may_be_the_weight_of_a_pendulum_on_a_spring(depth, width, nearly):
    """A magnet of a depth about ω²w⁴/12 softens the spring as the sine does, if it is wide; a narrow one only on the whole."""
    values = {"natural_frequency": 7.0, "magnet_depth": depth, "magnet_width": width}
    model = Model("magnet", values, restoring="linear")
    model = replace(model, standard_errors={"magnet_depth": abs(depth) / 20, "magnet_width": width / 50})
    fit = SimpleNamespace(model=model, swings=[SimpleNamespace(angle=np.array([-0.3, 0.4]))])
    there = SimpleNamespace(key=frozenset(["magnet"]), fit=fit, widened={})
    assert findings._nearly([there], "magnet") == nearly


@pytest.mark.parametrize(
    ("share", "held", "ties"),
    [(0.1, 0.3, []), (0.8, 0.3, ["constant_coulomb"]), (0.1, np.inf, ["constant_coulomb"])],
)
def test_an_effect_is_told_from_a_simpler_one_as_it_is_from_nothing(monkeypatch, share, held, ties):
    """With the simpler one in its place as little is missing: the data know no more than that one of both is there."""
    monkeypatch.setattr(findings, "_whole", lambda *_: (share, held, 3.0))
    model = Model("viscous+presliding")
    best = SimpleNamespace(key=frozenset(model.names), fit=SimpleNamespace(model=model))
    known = {best.key: best, frozenset(("viscous", "constant_coulomb")): best}
    pool = SimpleNamespace(criterion=USUAL, known=known, base=frozenset(["viscous"]))
    assert findings._simpler(pool, best, "presliding", ()) == ties


@pytest.mark.parametrize(("of_four", "law_open"), [(0.9, True), (0.995, False)])
def test_a_drag_of_which_more_laws_are_possible_than_a_tie_has_is_told_as_one(monkeypatch, of_four, law_open):
    kind = ["viscous", "quadratic_drag", "power_law_drag", "eddy_brake", "structural_damping"]
    pool = SimpleNamespace(
        criterion=USUAL,
        of=lambda names: of_four if len(list(names)) < len(kind) else 0.997,
        first=SimpleNamespace(fit=SimpleNamespace(model=Model("constant_coulomb"))),
        sees_friction=lambda: 0.0,
    )
    monkeypatch.setattr(findings, "_simpler", lambda *_: [])
    monkeypatch.setattr(findings, "_asked", lambda pool, best, name, names, one: one)
    found = findings._as_one(pool, None, "viscous", ["viscous"], kind, (), None)
    assert found.probability == 0.997 and len(found.ties) == 3 and found.law_open is law_open


@pytest.mark.parametrize(
    ("before", "told"), [(Doubt.REMAINS, {"constant_coulomb"}), (None, {"constant_coulomb", "magnet"})]
)
def test_beside_a_damping_that_is_sure_without_a_name_nothing_is_surer_than_it_was(monkeypatch, before, told):
    """The model that names the friction is less probable than the one that does not: it makes no other effect surer."""
    most, named = (
        SimpleNamespace(key=frozenset(names)) for names in (["magnet"], ["magnet", "constant_coulomb"])
    )
    found = {
        most.key: {"magnet": Finding(1.0, share=0.1, held_out=0.1, doubt=before)},
        named.key: {name: Finding(1.0, share=0.1, held_out=0.1) for name in ("magnet", "constant_coulomb")},
    }
    monkeypatch.setattr(findings, "_naming", lambda *_: named)
    monkeypatch.setattr(findings, "judged", lambda pool, best, most=None: found[best.key])
    last, said = told_of(SimpleNamespace(criterion=USUAL), most)
    assert last is named
    assert {name for name, one in said.items() if one.sure} == told


def test_where_nothing_is_missing_no_friction_is_looked_for():
    best = SimpleNamespace(key=frozenset(["viscous"]))
    assert findings._naming(SimpleNamespace(criterion=USUAL, nothing=lambda: 0.5), best) is best
