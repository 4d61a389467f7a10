"""What the amplitudes from swing to swing show of friction and drag, whatever else a model lacks."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import lfilter

from swingdown.discovery.criterion import USUAL
from swingdown.discovery.data.campaign import Swing, campaign
from swingdown.discovery.data.noise import Noise
from swingdown.discovery.judge.findings import _shown, judged, told_of
from swingdown.discovery.judge.structures import Pool
from swingdown.discovery.see import envelope
from swingdown.discovery.see.envelope import Seen, _stretch, amplitudes, seen
from swingdown.engine.trajectory import simulate
from swingdown.fitting.least_squares import fit_jointly
from swingdown.pendulum.catalogue import SHIPPED
from swingdown.pendulum.model import Model

TIMES = np.arange(0, 24, 0.04)  # s
NOISE = Noise(1e-3)  # rad
VALUES = {
    "natural_frequency": 7.0, "viscous_ratio": 0.004, "constant_friction": 0.05, "quadratic_coefficient": 0.02,
    "quadratic_stiffness": 4.0, "cubic_stiffness": 5.0, "sensor_gain": 0.05, "damping_drift": 0.003,
    "load_friction": 0.01,
}  # fmt: skip
FRICTION, SQUARE = frozenset({0}), frozenset({2})


def swings(*hidden, angles=(0.9, -0.7, 0.5, 0.3), times=TIMES):
    """A campaign of a pendulum with viscous drag and what is hidden, each recording with a zero of its own."""
    rng = np.random.default_rng(3)
    bare = Model(("viscous", *hidden))
    model = bare.with_values({name: VALUES[name] for name in bare.parameters})
    made = []
    for k, angle in enumerate(angles):
        reading = simulate(model, times, angle, 0.0)
        noise = NOISE.deviation * rng.standard_normal(times.size)
        made.append(Swing(f"{angle}", times, reading + 0.01 * k + noise))
    return campaign("losses", made)


def shown(one, laws):
    return seen(amplitudes(one, 7.0, "sine"), laws)


@pytest.mark.parametrize(
    ("hidden", "laws", "others"),
    [("constant_coulomb", FRICTION, SQUARE), ("quadratic_drag", SQUARE, FRICTION)],
)
@pytest.mark.parametrize("beside", [(), ("quadratic_stiffness", "cubic_stiffness", "sensor_gain")])
def test_a_loss_is_seen_whatever_spring_or_sensor_error_is_there_too(hidden, laws, others, beside):
    one = swings(hidden, *beside)
    there, other = shown(one, laws), shown(one, others)
    assert there.chance > 0.999
    assert there.share < 0.2
    assert there.held_out < 0.5
    assert not (other.chance > 0.95 and other.share < 0.2 and other.held_out < 0.5)


def test_a_loss_is_seen_in_a_film_of_few_images():
    """Five images a half-swing, of which no turning point is read."""
    one = swings("constant_coulomb", times=np.arange(0, 24, 0.09))
    found = shown(one, FRICTION)
    assert found.chance > 0.999
    assert found.share < 0.2
    assert found.held_out < 0.5
    known = shown(swings("constant_coulomb", times=np.arange(0, 24, 0.03)), FRICTION)
    assert found.gain == pytest.approx(known.gain, rel=0.5)
    none = shown(swings(times=np.arange(0, 24, 0.09)), FRICTION)
    assert not (none.chance > 0.95 and none.share < 0.2 and none.held_out < 0.5)


def test_beside_noise_whole_half_swings_show_a_loss_more_surely():
    one, rng = swings("quadratic_drag"), np.random.default_rng(7)
    loud = [replace(k, angle=k.angle + 0.02 * rng.standard_normal(k.times.size)) for k in one.whole]
    one = campaign("loud", loud)
    by_turns = seen(envelope._told(one, 7.0, "sine", False), SQUARE)
    assert shown(one, SQUARE).gain > 1.5 * by_turns.gain > 0


def test_amplitudes_are_those_that_err_less_beside_all_laws(monkeypatch):
    """Whole half-swings of a film that loses a frame now and then are off slowly, turns from one to the next."""
    one = swings("quadratic_drag")
    real = envelope.half_swings

    def worse(*arguments):
        table = real(*arguments)
        wave = 0.02 * np.sin(np.arange(len(table)) / 2) if arguments[-1] else 0.0
        return table.assign(amplitude_rad=table["amplitude_rad"] + wave)

    monkeypatch.setattr(envelope, "half_swings", worse)
    kept = [part.sizes for part in amplitudes(one, 7.0, "sine")]
    for part, own in zip(envelope._told(one, 7.0, "sine", False), kept, strict=True):
        np.testing.assert_array_equal(part.sizes, own)


@pytest.mark.parametrize("hidden", ["viscous", "quadratic_drag"])
def test_a_balance_of_microradians_shows_the_same_as_one_of_degrees(hidden):
    values = {
        "natural_frequency": 7.0,
        "constant_friction": 0.05,
        "viscous_ratio": 0.01,
        "quadratic_coefficient": 0.02,
    }
    model = Model(("constant_coulomb", hidden), restoring="linear")
    model = model.with_values({name: values[name] for name in model.parameters})
    rng = np.random.default_rng(6)
    read = [
        simulate(model, TIMES, angle, 0.0) + 1e-3 * rng.standard_normal(TIMES.size)
        for angle in (0.9, 0.7, 0.5)
    ]
    found = []
    for unit in (1.0, 1e-6):
        one = campaign("balance", [Swing(f"{k}", TIMES, unit * angle) for k, angle in enumerate(read)])
        found.append(seen(amplitudes(one, 7.0, "linear"), frozenset({1, 2})))
    large, small = found
    assert large.gain > 5
    assert small.gain == pytest.approx(large.gain, rel=1e-3)
    assert (small.share, small.held_out) == pytest.approx((large.share, large.held_out), abs=1e-3)


def test_amplitudes_that_come_and_go_hide_no_loss():
    """A bob that swings round as well: its ellipse turns, and what a camera sees of it grows and falls again, which no loss does."""
    plain = swings("constant_coulomb")
    beat = [replace(each, angle=each.angle * (1 + 0.02 * np.sin(1.1 * each.times))) for each in plain.whole]
    found = shown(campaign("beating", beat), FRICTION)
    assert found.chance > 0.99
    assert found.share < 0.2
    assert found.held_out < 0.5


@pytest.mark.parametrize("hidden", [(), ("quadratic_stiffness",), ("damping_drift",)])
def test_no_loss_is_seen_where_only_viscous_drag_takes_energy(hidden):
    for angles in ((0.9, -0.7, 0.5, 0.3), (0.9,)):
        one = swings(*hidden, angles=angles)
        for laws in (FRICTION, SQUARE):
            found = shown(one, laws)
            assert not (found.chance > 0.95 and found.share < 0.2 and found.held_out < 0.5)


@pytest.mark.parametrize("hidden", [(), ("cubic_stiffness",)])
def test_friction_that_goes_with_the_load_takes_more_of_larger_swings_and_is_no_drag(hidden):
    one = swings("load_coulomb", *hidden, angles=(1.0, -0.8, 0.6, 0.4))
    assert shown(one, SQUARE).chance < 0.5
    assert shown(one, FRICTION).chance > 0.999


def test_of_a_few_swings_no_loss_is_told():
    assert np.isnan(shown(swings("constant_coulomb", times=TIMES[:60]), FRICTION).chance)


def test_of_driven_swings_no_loss_is_told():
    one = swings("constant_coulomb")
    driven = [replace(swing, drive=object()) for swing in one.whole]
    assert np.isnan(shown(campaign("driven", driven), FRICTION).chance)


def test_the_unit_of_a_spring_is_any():
    """What hangs on a spring is as sure in millimetres as in metres."""
    one = swings("constant_coulomb")
    found = [
        seen(amplitudes(campaign("spring", [replace(each, angle=each.angle * step) for each in one.whole]), 7.0, "linear"), FRICTION)
        for step in (1.0, 1000.0)
    ]  # fmt: skip
    assert found[0][:3] == pytest.approx(found[1][:3], rel=1e-6)
    assert found[0].laws == found[1].laws


def test_a_hole_in_a_recording_is_no_loss():
    whole = swings("constant_coulomb")
    gone = (TIMES > 8) & (TIMES < 11)
    holed = campaign("holes", [Swing(one.name, one.times[~gone], one.angle[~gone]) for one in whole.whole])
    a, b = (shown(one, FRICTION) for one in (whole, holed))
    assert b.chance > 0.999
    assert b.share == pytest.approx(a.share, abs=0.1)


def wheel(hidden, seconds, times=None):
    """One recording of a wheel with friction in its bearing and what is hidden."""
    bare = Model(("constant_coulomb", hidden), restoring="linear")
    values = {
        "natural_frequency": 7.0,
        "constant_friction": 0.02,
        "viscous_ratio": 0.06,
        "quadratic_coefficient": 0.2,
    }
    model = bare.with_values({name: values[name] for name in bare.parameters})
    times = np.arange(0, seconds, 0.02) if times is None else times
    noise = NOISE.deviation * np.random.default_rng(5).standard_normal(times.size)
    return campaign("wheel", [Swing("braked", times, simulate(model, times, 1.0, 0.0) + noise)])


@pytest.mark.parametrize(("hidden", "law"), [("viscous", 1), ("quadratic_drag", 2)])
def test_the_parts_of_one_recording_lose_as_one(hidden, law):
    """A brake stops the wheel within some turns, of which each part has a few."""
    one = wheel(hidden, 6.0)
    assert len(one.fit) + len(one.holdout) == 3
    found = seen(amplitudes(one, 7.0, "linear"), {1, 2})
    assert found.chance > 0.95
    assert found.share < 0.1
    assert found.held_out < 0.2
    assert law in found.laws


def test_half_swings_that_are_missing_have_lost_too():
    times = np.arange(0, 10, 0.02)
    (whole,), (holed,) = (
        amplitudes(wheel("viscous", 0, one), 7.0, "linear")
        for one in (times, times[(times < 3) | (times > 3.6)])
    )
    assert holed.sizes.size < whole.sizes.size
    assert holed.lost[-1, :3] == pytest.approx(whole.lost[-1, :3], rel=0.02)


def test_what_noise_of_a_memory_does_to_amplitudes_speaks_against_no_drag():
    half_swings, fitted = np.arange(120), np.repeat([True, False, True, False, True], 24)

    def told(sizes):
        rng, found = np.random.default_rng(1), 0
        for _ in range(40):
            noise = lfilter([0.71], [1, -0.7], 6e-4 * rng.standard_normal(170))[50:]
            steps = np.ones(half_swings.size - 1)
            one = _stretch(half_swings / half_swings.size, sizes + noise, steps, fitted, "linear")
            of = seen((one,), {1, 2})
            found += of.gain > 6 and of.share <= 0.2 and of.held_out <= 0.5
        return found

    assert told(0.1 * np.exp(-half_swings / 250)) >= 8
    assert told(0.1 - 3.2e-4 * half_swings) == 0  # friction


def test_everyday_laws_that_lose_alike_are_tied():
    """The springs that are missing, too, make one of two drags the more probable, of which the amplitudes know nothing."""
    one = swings("quadratic_stiffness", "cubic_stiffness", angles=(0.9,))
    pairs = [swing.pair for swing in one.fit]
    pool = Pool(one, NOISE, fit_jointly(Model("constant_coulomb"), pairs, bounded=True))
    pool.look(fit_jointly(Model("constant_coulomb+structural_damping"), pairs, bounded=True))
    found = told_of(pool, pool.known[frozenset(("constant_coulomb", "structural_damping"))])[1][
        "structural_damping"
    ]
    assert found.of_amplitudes
    assert found.any_unit
    assert "viscous" in found.ties


def test_friction_is_told_though_springs_are_more_probable():
    """The search knows the friction beside a wrong spring, and a spring without it that does better."""
    one = swings("constant_coulomb", "quadratic_stiffness", "cubic_stiffness")
    pairs = [swing.pair for swing in one.fit]
    base = fit_jointly(Model("viscous"), pairs, bounded=True)
    pool = Pool(one, NOISE, base)
    for label in ("viscous+constant_coulomb", "viscous+quadratic_stiffness+cubic_stiffness"):
        pool.look(fit_jointly(Model(label), pairs, bounded=True))
    best = pool.known[frozenset(("viscous", "quadratic_stiffness", "cubic_stiffness"))]
    assert pool.best is best
    last, found = told_of(pool, best)
    friction = found["constant_coulomb"]
    assert "constant_coulomb" in last.key
    assert friction.sure
    assert friction.law_open
    assert friction.of_amplitudes
    assert np.isnan(friction.without)  # what a spring makes of held-out swings is not told of a friction
    assert friction.share < 0.2
    assert friction.probability > 0.95
    pool.look(fit_jointly(Model("viscous+constant_coulomb+cubic_stiffness"), pairs, bounded=True))
    beside = pool.known[frozenset(("viscous", "constant_coulomb", "cubic_stiffness"))]
    shown = {name: one.any_unit for name, one in judged(pool, beside).items()}
    assert shown == {"constant_coulomb": True, "cubic_stiffness": False}


def test_recordings_that_do_not_lose_alike_show_nothing():
    one = swings("constant_coulomb")
    pairs = [swing.pair for swing in one.fit]
    for own in ((), ("viscous_ratio",)):
        base = fit_jointly(replace(Model("viscous"), own=own, own_frequency=True), pairs, bounded=True)
        pool = Pool(one, NOISE, base)
        laws, like = pool.unlike_the_base(pool.frictions())
        assert (laws, "constant_coulomb" in like) == (FRICTION, True)
        assert np.isnan(pool.envelope(laws).chance) == bool(own)


@pytest.mark.parametrize(("gain", "sure"), [(-5.0, 0.0), (0.0, 0.999), (np.nan, 0.999)])
def test_a_friction_that_the_envelope_makes_improbable_is_not_seen(gain, sure):
    pool = SimpleNamespace(
        criterion=USUAL,
        frictions=lambda: ["constant_coulomb"],
        known={frozenset(["viscous"]): SimpleNamespace(evidence=0.0, rubs=0.999)},
        unlike_the_base=lambda kind: (FRICTION, kind),
        envelope=lambda laws: Seen(gain, 1.0, 1.0),
    )
    assert Pool.sees_friction(pool) == pytest.approx(sure)


@pytest.mark.parametrize(
    ("gain", "of_swings", "share", "whole", "told"),
    [(4.0, 0.0, 0.15, 0.0, True), (-0.8, 0.99, 0.15, 0.0, True), (-0.8, 0.5, 0.15, 0.0, False), (-5.0, 0.99, 0.15, 0.0, False),
     (-0.8, 0.99, 0.3, 0.0, False), (np.nan, 0.99, 0.15, 0.0, False), (9.8, 0.0, 0.0, 0.99, False)],
)  # fmt: skip
def test_a_drag_is_sure_by_swings_or_amplitudes_unless_these_speak_against_it(
    gain, of_swings, share, whole, told
):
    """Or unless nothing may be missing without it: amplitudes of a false unit lose as by another law."""
    pool = SimpleNamespace(
        criterion=USUAL,
        unlike_the_base=lambda kind: (SQUARE, kind),
        envelope=lambda laws: Seen(gain, share, 0.3),
        of=lambda names: of_swings,
        whole_without=lambda names: whole,
    )
    assert (_shown(pool, ["quadratic_drag"])[0] is not None) == told


def test_the_laws_of_loss_are_those_of_the_catalogue():
    powers = {name: set(SHIPPED.powers_lost(name)) for name in SHIPPED.names if SHIPPED.damps(name)}
    assert powers["viscous"] == powers["structural_damping"] == {1}
    assert powers["constant_coulomb"] == powers["load_coulomb"] == powers["presliding"] == {0}
    assert powers["quadratic_drag"] == {2}
    assert {1, 2} <= powers["power_law_drag"]
    assert not SHIPPED.powers_lost("cubic_stiffness")
