"""A measured drive: trajectories against scipy's DOP853 under the same curve, slopes against differences, and swings without one as before."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from swingdown.engine.trajectory import effort, sensitivities, simulate
from swingdown.errors import InputError
from swingdown.pendulum.drive import BETWEEN, KINDS, drive
from swingdown.pendulum.model import Model

TIMES = 3.0 + 0.02 * np.arange(600)
FORCE = np.sin(2 * np.pi * 1.3 * TIMES) + 0.3 * np.random.default_rng(1).standard_normal(TIMES.size)
GAIN = {"torque": 2.0, "pivot_acceleration": 0.1, "pivot_position": 0.002, "pivot_angle": 0.05}
LATE = 0.013  # s


def torque(kind, omega, angle, u, curve):
    """What the drive adds to the angular acceleration, written once more by hand."""
    return (
        GAIN[kind]
        * {
            "torque": u,
            "pivot_acceleration": -(omega**2) * np.cos(angle) * u,
            "pivot_position": -(omega**2) * np.cos(angle) * curve / 9.80665,
            "pivot_angle": omega**2 * u,
        }[kind]
    )


def driven(kind, between="curve", effects="viscous"):
    """A model under the drive of that kind, its sensor's gain and delay among its parameters where it can have one."""
    free = ("gain",) if between == "hold" else ("gain", "delay")
    under = drive(TIMES, FORCE, kind, between, free)
    model = Model(f"{effects}+{under.effect}", drive=under)
    known = {"natural_frequency": 7.0, "viscous_ratio": 0.02, "input_delay": LATE, "constant_friction": 0.2}
    known[f"{kind}_gain"] = GAIN[kind]
    return model.with_values({name: known[name] for name in model.parameters})


def by_scipy(model, kind, late):
    """The angle by DOP853, from knot to knot of the drive."""
    omega, ratio = model.values["natural_frequency"], model.values["viscous_ratio"]
    inside = model.drive.knots + late
    ends = [TIMES[0], *inside[(inside > TIMES[0]) & (inside < TIMES[-1])], TIMES[-1]]
    state, found = [0.5, 0.1], {}
    for start, stop in zip(ends, ends[1:], strict=False):
        middle = 0.5 * (start + stop) - late

        def rates(t, y, middle=middle):
            # the piece's own cubic, to its very ends
            piece = np.searchsorted(model.drive.knots, middle, side="right") - 1
            a, b, c, d = model.drive.coefficients[piece]
            x = t - late - model.drive.knots[piece]
            u, curve = a + x * (b + x * (c + x * d)), 2 * c + 6 * d * x
            return [
                y[1],
                -(omega**2) * np.sin(y[0]) - 2 * ratio * omega * y[1] + torque(kind, omega, y[0], u, curve),
            ]

        seen = TIMES[(start <= TIMES) & (stop >= TIMES)]
        whole = solve_ivp(rates, (start, stop), state, "DOP853", dense_output=True, rtol=1e-12, atol=1e-13)
        found |= dict(zip(seen, whole.sol(seen)[0], strict=True))
        state = whole.y[:, -1]
    return np.array([found[t] for t in TIMES])


@pytest.mark.parametrize("between", BETWEEN)
@pytest.mark.parametrize("kind", [*KINDS])
def test_a_trajectory_is_that_of_scipy(kind, between):
    if kind == "pivot_position" and between != "curve":
        pytest.skip("a position along straight lines has no acceleration")
    model = driven(kind, between)
    late = model.values.get("input_delay", 0.0)
    assert np.abs(simulate(model, TIMES, 0.5, 0.1) - by_scipy(model, kind, late)).max() < 1e-8


@pytest.mark.parametrize("kind", [*KINDS])
def test_slopes_are_those_of_differences(kind):
    model = driven(kind, effects="viscous+constant_coulomb")
    slopes = dict(
        zip(
            (*model.parameters, "release_angle", "release_velocity"),
            sensitivities(model, TIMES, 0.5, 0.1)[1],
            strict=True,
        )
    )
    for name, value in model.values.items():
        step = 1e-5 * max(abs(value), 1e-2)
        ends = [
            simulate(model.with_values(model.values | {name: value + by}), TIMES, 0.5, 0.1)
            for by in (step, -step)
        ]
        difference = (ends[0] - ends[1]) / (2 * step)
        assert np.abs(slopes[name] - difference).max() < 1e-4 * np.abs(difference).max(), name


def test_friction_holds_until_the_drive_is_stronger():
    """A torque that rises steadily: nothing moves until it is that of friction; then a closed form."""
    rise, friction, omega = 0.3, 0.25, 5.0
    times = 0.01 * np.arange(400)
    under = drive(times, rise * times, "torque", "line", ())
    model = Model(f"constant_coulomb+{under.effect}", restoring="linear", drive=under)
    model = model.with_values({"natural_frequency": omega, "constant_friction": friction})
    after = np.maximum(times - friction / rise, 0.0)
    expected = rise / omega**2 * (after - np.sin(omega * after) / omega)
    assert np.abs(simulate(model, times, 0.0) - expected).max() < 1e-9


def test_a_model_without_a_drive_is_followed_to_the_bit_as_before():
    model = Model("viscous").with_values({"natural_frequency": 7.0, "viscous_ratio": 0.02})
    under = model.driven_by(drive(TIMES, FORCE, "torque"))
    assert (simulate(model, TIMES, 0.5) == simulate(under, TIMES, 0.5)).all()
    assert effort(model, TIMES, 0.5) == effort(under, TIMES, 0.5)


def test_the_clock_of_a_drive_is_that_of_the_samples():
    """A part of a recording is driven by that part of its input."""
    model, first = driven("torque"), 250
    whole = simulate(model, TIMES, 0.5, 0.1)
    speed = simulate(model.of("rate"), TIMES, 0.5, 0.1)
    part = simulate(model, TIMES[first:], whole[first], speed[first])
    assert np.abs(part - whole[first:]).max() < 1e-8


def test_what_is_no_drive_is_refused():
    with pytest.raises(InputError, match="it has a measured drive, and no drive is given"):
        simulate(driven("torque").driven_by(None), TIMES, 0.5)
    for wrong, said in (
        ({"kind": "force"}, "unknown input_kind"),
        ({"between": "steps"}, "unknown input_between"),
        ({"free": ("phase",)}, "unknown 'phase'"),
        ({"between": "hold", "free": ("delay",)}, "jumps from sample to sample"),
        ({"values": np.where(TIMES[7] == TIMES, np.nan, FORCE)}, "no number at 3.14 s"),
        ({"values": FORCE[:-1]}, "599 values for 600 times"),
        ({"times": TIMES[::-1]}, "do not increase"),
    ):
        given = {"times": TIMES, "values": FORCE, "kind": "torque"} | wrong
        with pytest.raises(InputError, match=said):
            drive(**given)
