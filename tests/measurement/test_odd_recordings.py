"""Recordings that no pendulum on a bench makes: refused, or told in one line; and nothing is told of good ones."""

from contextlib import nullcontext

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from swingdown.errors import InputError, as_told
from swingdown.measurement.judge import Reading, check_used, judge
from swingdown.measurement.plausibility import in_step_and_dying, in_step_and_steady
from swingdown.measurement.recording import ingest
from swingdown.measurement.sheet import read_sheet
from swingdown.measurement.units import check_steps, in_rad, time_factor, unwrapped

RATE = 100
TIME = np.arange(30 * RATE) / RATE


def swing(time=TIME, amplitude=0.5, noise=0.001, seed=1, decay=0.03):
    clean = amplitude * np.exp(-decay * time) * np.cos(7.25 * time)
    return clean + noise * np.random.default_rng(seed).standard_normal(time.size)


def looked_at(signal, time=TIME, unit="rad", time_told=True, unit_told=True, restoring="sine"):
    factor, told = time_factor(time, signal, time_told, "a.csv")
    judged = judge(time * factor, signal, Reading(unit, unit_told, in_rad(unit), restoring), "a.csv")
    told += judged.remarks + check_used(time * factor, judged, slice(None), "a.csv")
    return list(map(as_told, told))


def refused(*told, signal, **how):
    with pytest.raises(InputError) as caught:
        looked_at(signal, **how)
    for part in ("a.csv", *told, "Mend:"):
        assert part in str(caught.value), str(caught.value)


def test_nothing_is_told_of_a_good_swing():
    for seed in range(20):
        assert looked_at(swing(seed=seed), time_told=False, unit_told=False) == []
        assert looked_at(np.round(swing(seed=seed), 2)) == []
        assert looked_at(np.degrees(swing(seed=seed)), unit="deg") == []
        assert looked_at(swing(seed=seed, decay=1.0)) == []


def test_degrees_that_somebody_calls_rad_are_asked_about():
    refused(
        "in rad, as stated",
        "back and forth by",
        "restoring: linear",
        "deg in the cell signal_unit",
        signal=np.degrees(swing()),
    )


@pytest.mark.parametrize("amplitude", [0.15, 0.5, 2.5])
def test_degrees_without_a_word_are_taken_for_degrees(amplitude):
    (told,) = looked_at(np.degrees(swing(amplitude=amplitude)), unit_told=False)
    assert (
        told.startswith("no unit is stated, and in rad it would swing back and forth by")
        and "TAKEN AS DEGREES" in told
    )


def test_a_disc_on_a_spring_swings_by_any_number_of_turns():
    for turns in (1.4, 5.0):
        angle = swing(amplitude=2 * np.pi * turns)
        assert looked_at(angle, restoring="linear") == []
        assert looked_at(np.degrees(angle), unit="deg", restoring="linear") == []
        refused("back and forth by", "restoring: linear", signal=angle)
        refused("in deg, as stated", "restoring: linear", signal=np.degrees(angle), unit="deg")


def rotating():
    """A pendulum that goes over the top, and swings about the turn it comes to."""
    time = np.arange(20 * RATE) / RATE

    def motion(t, state):
        return state[1], -49 * np.sin(state[0]) - 0.6 * state[1]

    solution = solve_ivp(motion, (0, 20), (0, 22), t_eval=time, rtol=1e-9, atol=1e-9)
    return time, solution.y[0] + 0.001 * np.random.default_rng(4).standard_normal(time.size)


def test_counted_turns_are_told_where_somebody_states_rad():
    time, angle = rotating()
    remarks = looked_at(angle, time)
    assert len(remarks) == 1 and "counted turns" in remarks[0]


def test_a_torsion_balance_in_seconds_is_not_taken_for_a_pendulum_in_milliseconds():
    """Read by hand each ten seconds, its period is some 200: as many ms would be a pendulum's."""
    refused("in s it would suit a torsion balance", signal=swing(), time=250 * TIME, time_told=False)
    assert looked_at(swing(), 250 * TIME)  # stated to be s, it is


def test_milliseconds_without_a_word():
    (told,) = looked_at(swing(), 1000 * TIME, time_told=False)
    assert "TAKEN AS ms" in told and "a period of 0.86" in told
    refused("a period of 0.0008", signal=swing(), time=TIME / 1000, time_told=False)
    remarks = looked_at(swing(), 1000 * TIME)
    assert len(remarks) == 1 and "a period of 86" in remarks[0]
    few = np.arange(60) * 10.0
    refused("a sample every 10 s", signal=np.linspace(1, 0, 60), time=few, time_told=False)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_zero_at_the_top_is_taken_away(sign):
    for signal, unit in ((swing() + sign * np.pi, "rad"), (np.degrees(swing()) + sign * 180, "deg")):
        (told,) = looked_at(signal, unit=unit)
        assert "3.14 rad (180°)" in told.replace("-", "") and "taken away" in told


def test_turns_from_a_zero_that_is_nowhere_are_none():
    """A ranger's 22.8 that nobody gave a unit is no three turns and a half, which a pendulum would have made."""
    (told,) = looked_at(swing() + 22.8, unit_told=False)
    assert "it swings about 22.8 rad" in told and "turns" not in told


@pytest.mark.parametrize("bits", [8, 12, 14])
def test_counts_that_begin_anew_at_a_power_of_two_run_on(bits):
    turn = 2**bits
    counts = np.round(turn * swing(noise=0) / (2 * np.pi))
    told = looked_at(counts % turn, unit_told=False)
    assert any("jumps by a whole turn" in one for one in told)
    judged = judge(TIME, counts % turn, Reading("rad", False, 1.0), "a.csv")
    assert np.ptp(judged.signal) == np.ptp(counts)


@pytest.mark.parametrize("high", [1023.0, 1.7e308])
def test_what_is_on_and_off_begins_no_turn_anew(high):
    gate = np.where(np.cos(7.25 * TIME) > 0, high, 2.0)
    signal, told = unwrapped(gate, "")
    assert not told and np.array_equal(signal, gate)


def test_a_zero_beside_the_vertical():
    told = "it swings about 0.3 rad (17.2°), and 0 should be where it hangs: this is taken away"
    assert looked_at(swing() + 0.3) == [told]
    assert looked_at(swing() + 0.03) == []


def test_what_swings_wider_and_wider_is_driven():
    refused("its swings grow", "1.4", "drives", signal=swing(decay=-0.02))
    remarks = looked_at(swing(decay=0))
    assert len(remarks) == 1 and remarks[0].startswith("its swings do not shrink")


def test_readings_that_are_no_angle_have_no_scale():
    """A count of 900 back and forth is no angle in degrees either; period and decay need no scale."""
    (told,) = looked_at(450 * swing(amplitude=1.0), unit_told=False)
    assert "TAKEN AS A READING OF UNKNOWN SCALE" in told and "cell scale" in told
    refused("in deg, as stated", "turns", signal=450 * swing(amplitude=1.0), unit="deg")


@pytest.mark.parametrize("told", [True, False])
def test_an_angle_that_wraps_runs_on(told):
    wrapped = (swing(amplitude=2.9) + 0.4 + np.pi) % (2 * np.pi) - np.pi
    for signal, unit in ((wrapped, "rad"), (np.degrees(wrapped), "deg")):
        remarks = looked_at(signal, unit=unit if told else "rad", unit_told=told)
        assert "jumps by a whole turn" in remarks[0] and "it swings about 0.4 rad" in remarks[-1]


def test_a_number_that_is_wrong_by_far():
    signal = swing()
    signal[700] = 3.28e4
    assert looked_at(signal) == ["a spike at 7 s, left out as missing: 1 of 3000 samples"]


@pytest.mark.parametrize("size", [0.05, -0.3, 2.5])
def test_spikes(size):
    signal = swing()
    signal[[700, 1500, 2222]] += size
    assert looked_at(signal) == ["a spike at 7 s and 2 times more, left out as missing: 3 of 3000 samples"]


def test_samples_lost_with_the_time_renumbered():
    long = np.arange(3005) / RATE
    lost = np.delete(swing(long), [1010, 1011, 1012, 1013, 1014])  # on its way through the middle
    remarks = looked_at(lost)
    assert len(remarks) == 1 and remarks[0].startswith("the signal jumps") and "at 10.1 s" in remarks[0]


def test_a_sign_that_flips():
    signal = swing()
    signal[1310:] *= -1
    assert "the signal jumps" in looked_at(signal)[0]


def test_a_clock_that_stumbles():
    time = TIME.copy()
    time[1200:] += 0.4 / RATE
    assert "the clock stumbles at 12.004 s" in looked_at(swing(), time)[0]
    jitter = TIME + 0.002 * np.random.default_rng(1).standard_normal(TIME.size)
    assert "the time between samples varies" in looked_at(swing(jitter), jitter)[0]


@pytest.mark.parametrize("at", [1000, 1003, 1010, 1022, 1030])
def test_a_sensor_that_dies(at):
    signal = np.round(swing(), 4)
    signal[at:] = signal[at]
    refused("the sensor is dead", "stop_s: ", signal=signal)


@pytest.mark.parametrize(("steps", "dead"), [(8, False), (9, True)])
def test_a_sensor_dies_where_the_swing_before_is_of_more_than_eight_steps(steps, dead):
    signal = 0.01 * np.round(steps * (1 + np.cos(7.25 * TIME[:1500])) / 2)
    signal = np.concatenate([signal, np.full(500, signal[-1])])
    with pytest.raises(InputError, match="the sensor is dead") if dead else nullcontext():
        looked_at(signal, TIME[: signal.size])


@pytest.mark.parametrize("step", [0.0016, 0.01])
def test_a_pendulum_that_friction_stops_is_not_dead(step):
    """Constant friction takes the same off every half-swing, and holds the pendulum where it stops."""
    half = np.pi / 7
    for take_off in (0.02, 0.05, 0.1):
        amplitude, signal, side, rest = 0.5, [], 1, 0.0
        while amplitude > take_off / 2:
            phase = np.arange(0, half, 0.01) * 7
            rest = side * take_off / 2
            signal += list(rest + (side * amplitude - rest) * np.cos(phase))
            amplitude, side = amplitude - take_off, -side
        signal += [signal[-1]] * 300
        signal = np.round(np.array(signal) / step) * step
        time = np.arange(signal.size) / 100
        assert not [one for one in looked_at(signal, time) if "dead" in one]


def test_nothing_is_told_of_the_bench_and_of_real_pendulums(shared_data, root, tmp_path):
    """The error rate of the checks on recordings that are as they should be: 0 of 21."""
    files = sorted(shared_data.resolve().glob("real/*/*.csv"))
    lines = [f"{file.stem},{file},{16.99 if 'digitised' in file.stem else ''}\n" for file in files]
    (tmp_path / "real.csv").write_text("recording,file,stop_s\n" + "".join(lines))
    told = {}
    for sheet in (root / "config/recordings.csv", tmp_path / "real.csv"):
        for name, row in read_sheet(sheet).iterrows():
            told[name] = ingest(row, str(sheet)).attrs.get("remarks", "")
    assert len(told) == 25
    # what is true of them is told: the hand that lifts the link, and the arm that friction has stopped
    for name, released in (("rel45", 0.12), ("rel90", 0.36), ("rel135", 0.21)):
        assert f"released at about {released:.2f} s" in told.pop(name)
    assert told.pop("free_swing_small").startswith("it comes to rest and stays there")
    assert not {name: remark for name, remark in told.items() if remark}


def test_samples_lost_about_a_turning_point_leave_the_swing_out_of_step():
    """Nothing jumps there that stands out of the noise; the swings after it come too early."""
    long = np.arange(3015) / RATE
    signal = swing(long, noise=0.01)
    top = 1000 + int(np.argmax(swing(long, noise=0)[1000:1087]))
    lost = np.delete(signal, range(top - 6, top + 6))
    remarks = looked_at(lost, np.arange(lost.size) / RATE)
    assert len(remarks) == 1 and "out of step with the clock" in remarks[0]
    told = float(remarks[0].partition(" at ")[2].partition(" s")[0])
    assert told == pytest.approx(top / RATE, abs=0.1)


def test_a_period_that_changes_by_half_is_in_step_where_the_swing_dies():
    """As of a ball in a bowl that is no circle: what a motor sweeps does not die."""
    phase = 2 * np.pi * (0.5 * TIME + 0.004 * TIME**2)  # from 2 to 1.35 s
    dying, kept = np.exp(-0.05 * TIME) * np.cos(phase), np.cos(phase)
    assert in_step_and_dying(TIME, dying)
    assert not in_step_and_dying(TIME, kept) and not in_step_and_steady(TIME, kept)


def test_what_hangs_turns_beside_zero_in_degrees_is_no_angle():
    """A converter's readings about 2000, that in rad swing back and forth by many turns."""
    raw = 1975 + 140 * swing()
    assert any("READING OF UNKNOWN SCALE" in one for one in looked_at(raw, unit_told=False))
    assert any("TAKEN AS DEGREES" in one for one in looked_at(raw - 1975, unit_told=False))


def test_a_driven_swing_of_scattered_sizes_that_ends_smaller_by_chance_does_not_die():
    sizes = np.repeat([1, 1.11, 1.1, 0.96, 0.98, 0.96, 1.05, 1, 1.06, 0.85, 1.13, 0.99], 50)
    half = np.sin(np.pi * np.arange(600) / 50)
    times = np.arange(600) / 50
    assert not in_step_and_dying(times, sizes * half)
    assert in_step_and_dying(times, np.exp(-0.006 * times) * half)


def test_an_angle_turns_further_than_half_round_in_a_hole_alone():
    angle = np.array([0.0, 1.0, 2.0, 6.0, 6.5])
    with pytest.raises(InputError, match=r"swing, 0\.3 s: the angle changes by 0\.637 turns"):
        check_steps(np.array([0.0, 0.1, 0.2, 0.3, 0.4]), angle, "swing")
    check_steps(np.array([0.0, 0.1, 0.2, 0.4, 0.5]), angle, "swing")  # a sample is missing


@pytest.mark.parametrize(("turn", "told"), [(2**14, False), (2**14, True), (2400, True)])
def test_a_counter_that_begins_anew_runs_on(turn, told):
    counts = np.round(swing(amplitude=0.6) / (2 * np.pi) * turn) % turn
    scale = 2 * np.pi / turn if told else np.nan
    found = judge(TIME, counts, Reading("counts", True, scale), "here")
    assert "jumps by a whole turn" in found.remarks[0]
    assert np.ptp(found.signal) == pytest.approx(1.2 / (2 * np.pi) * turn, rel=0.02)


@pytest.mark.parametrize(("noise", "told"), [(0.0, True), (1e-7, True), (2e-6, False)])
def test_a_swing_without_noise_is_asked_whether_it_was_computed(noise, told):
    """A millionth of half a radian: no sensor on a bench reads so finely."""
    asked = "NO SENSOR IS SO QUIET: its noise is less than a millionth of the swing; was it computed, or smoothed?"
    assert looked_at(swing(noise=noise)) == [asked] * told


def test_readings_in_coarse_steps_are_not_out_of_step_by_their_rounding():
    long = np.arange(1500) / 25
    signal = 0.055 * np.exp(-long / 30) * np.cos(4.5 * long)
    rounded = 0.01 * np.round(signal / 0.01)
    assert looked_at(rounded, long) == []
    top = 200 + int(np.argmax(signal[200:235]))
    lost = np.delete(rounded, range(top - 8, top + 8))
    assert "out of step with the clock" in looked_at(lost, np.arange(lost.size) / 25)[0]
