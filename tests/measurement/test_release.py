"""A recording that begins in a hand is used from where the pendulum swings by itself, and says so."""

import numpy as np
import pytest

from swingdown.engine.trajectory import simulate
from swingdown.errors import InputError
from swingdown.measurement.angle import to_angle
from swingdown.measurement.recording import ingest
from swingdown.measurement.sheet import read_sheet
from swingdown.measurement.swings.release import find_windows
from swingdown.pendulum.half_swings import half_swings
from swingdown.pendulum.model import Model


def swing(time, phase=0.0, noise=0.002, seed=1):
    clean = 0.6 * np.exp(-0.05 * time) * np.cos(7.25 * time + phase)
    return clean + noise * np.random.default_rng(seed).standard_normal(time.size)


def held(rate, seconds, seed=1):
    time = np.arange(15 * rate) / rate
    noise = 0.002 * np.random.default_rng(seed).standard_normal(time.size)
    return time, swing(np.maximum(time - seconds, 0), noise=0) + noise


@pytest.mark.parametrize("rate", [30, 100, 250])
def test_a_free_swing_is_used_from_its_first_sample_on(rate):
    time = np.arange(10 * rate) / rate
    for k in range(40):
        signal = swing(time, phase=k * np.pi / 20, seed=k)
        for scale in (1.0, 0.0):  # in rad, and in a unit of which nothing is known
            windows, pushed = find_windows(time, signal, scale)
            assert pushed == [] and len(windows) == 1
            assert np.isnan([windows[0].begins, windows[0].ends]).all()


@pytest.mark.parametrize("rate", [30, 100, 250])
@pytest.mark.parametrize("seconds", [0.7, 1.5, 3.0, 6.0])
def test_a_bob_that_is_held_first(rate, seconds):
    time, signal = held(rate, seconds)
    for scale in (1.0, 0.0):
        (found,), pushed = find_windows(time, signal, scale)
        assert pushed == []
        assert found.released == pytest.approx(seconds, abs=0.08)
        assert seconds + 0.15 < found.begins < seconds + 0.35


@pytest.mark.parametrize("seed", range(10))
def test_a_bob_that_is_held_for_a_moment_in_a_film_of_few_images(seed):
    time = np.arange(0, 20, 1 / 12)
    noise = 0.01 * np.random.default_rng(seed).standard_normal(time.size)
    model = Model("viscous", {"natural_frequency": 6.85, "viscous_ratio": 0.001})
    signal = simulate(model, np.append(0, time[time > 0.25] - 0.25), 0.7)
    (free,), _ = find_windows(time, simulate(model, time, 0.7) + noise, 1.0)
    assert np.isnan(free.begins)
    (found,), _ = find_windows(time, np.append([0.7] * (time.size - signal.size), signal) + noise, 1.0)
    assert 0.08 <= found.released <= 0.34 and 0.4 < found.begins < 0.6


def test_a_bob_that_is_lifted_first():
    time, signal = held(100, 2.0)
    signal[:200] -= 0.4 * (1 - time[:200] / 2)
    (found,), _ = find_windows(time, signal, 0.0)
    assert found.released == pytest.approx(2.0, abs=0.08)


@pytest.mark.parametrize("rest", [0.5, 2.0, 5.0])
@pytest.mark.parametrize("restoring", ["sine", "linear"])
def test_a_pendulum_that_hangs_still_until_it_is_pulled_out(rest, restoring):
    """The pull is as quick as a swing, and is none: no hand holds, and no lift is against the weight."""
    model = Model("viscous", {"natural_frequency": 6.85, "viscous_ratio": 0.01}, restoring=restoring)
    time = np.arange(0, 15, 0.01)
    out, after = time[time < 0.3], time[time > rest + 0.3]
    pull = 0.35 * (1 - np.cos(np.pi * out / 0.3))
    signal = np.concatenate(
        [
            np.zeros(time.size - after.size - out.size),
            pull,
            simulate(model, np.append(0, after - rest - 0.3), 0.7)[1:],
        ]
    )
    signal += 0.002 * np.random.default_rng(4).standard_normal(time.size)
    for scale in (1.0, 0.0):
        (found,), _ = find_windows(time, 0.3 + signal, scale)
        assert rest < found.released < rest + 0.31
        assert rest + 0.4 < found.begins < rest + 0.7


def test_the_recording_is_kept_and_the_angle_begins_after_the_release(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    time, signal = held(100, 3.0)
    text = "t_s,theta_rad\n" + "".join(f"{t:.2f},{x:.6f}\n" for t, x in zip(time, signal, strict=True))
    (tmp_path / "swing.csv").write_text(text)
    (tmp_path / "sheet.csv").write_text("recording,file,start_s\na,swing.csv,\nb,swing.csv,1\n")
    rows = read_sheet("sheet.csv")
    found = ingest(rows.loc["a"], "sheet.csv")
    assert found.sizes["time"] == 1500 and "released at about 3.0" in found.attrs["remarks"]
    angle = to_angle(found)
    assert 3.15 < float(angle["time"][0]) < 3.35
    assert angle.attrs["expected_samples"] == angle.sizes["time"]
    stated = ingest(rows.loc["b"], "sheet.csv")
    assert "released" not in stated.attrs.get("remarks", "")
    assert float(to_angle(stated)["time"][0]) == 1.0


def test_a_lift_that_moves_nearly_as_a_free_swing_is_seen_in_rad(shared_data):
    """The link of a rotary pendulum is highest 0.12, 0.25 and 0.13 s after the first sample, and in a hand until about then."""
    for name, highest in (("rel45", 0.124), ("rel90", 0.245), ("rel135", 0.131)):
        time, angle = np.loadtxt(shared_data / f"real/jensen_rotary/{name}.csv", delimiter=",", skiprows=1).T
        (found,), _ = find_windows(time, angle, 1.0)
        assert highest - 0.01 < found.released < highest + 0.16
        assert found.released < found.begins < found.released + 0.25


def test_a_rest_at_the_end_is_left_out_but_for_a_period(tmp_path):
    time = np.arange(3000) / 100
    signal = np.where(time < 15, swing(time, noise=0) * (1 - time / 15), 0)
    signal += 0.002 * np.random.default_rng(3).standard_normal(time.size)
    (found,), _ = find_windows(time, signal, 1.0)
    assert found.rests and np.isnan(found.begins)
    moving = time[np.abs(signal) > 0.01 * np.ptp(signal)].max()
    assert found.ends == pytest.approx(moving + 2 * np.pi / 7.25, abs=0.1)
    (early,), _ = find_windows(time[:1700], signal[:1700], 1.0)
    assert early.rests and early.ends == found.ends
    (found,), _ = find_windows(time[:1600], signal[:1600], 1.0)
    assert np.isnan(found.ends)  # what tells where friction stopped it stays


def test_a_swing_of_one_step_of_the_reading_is_no_rest():
    """A rangefinder that reads whole centimetres still sees a swing of one to either side."""
    time = np.arange(3000) / 50
    small = 0.06 * np.exp(-time / 30) * np.cos(6 * time)
    (found,), _ = find_windows(time, 0.01 * np.round(small / 0.01), 0.0)
    assert np.isnan(found.ends)


def test_what_flickers_between_two_steps_rests():
    time = np.arange(3000) / 50
    signal = np.where(time < 20, 0.06 * (1 - time / 20) * np.cos(6 * time), 0.0)
    noisy = signal + 0.0045 + 0.001 * np.random.default_rng(5).standard_normal(time.size)
    (found,), _ = find_windows(time, 0.01 * np.round(noisy / 0.01), 0.0)
    assert found.rests and 16 < found.ends < 23


def test_a_pendulum_that_a_hand_stops_is_used_until_then():
    time = np.arange(1500) / 100
    signal = swing(time)
    caught = np.argmax(np.abs(signal) * (time > 9) > 0.3)
    signal[caught:] = 0.3 * np.exp(-8 * (time[caught:] - time[caught])) * np.sign(signal[caught])
    signal += 0.001 * np.random.default_rng(3).standard_normal(time.size)
    (found,), _ = find_windows(time, signal, 1.0)
    assert found.ends == pytest.approx(time[caught], abs=0.5)


def three_releases():
    """(times, angle): let go at 2, 12 and 22 s, each time caught and lifted within the second and a half before."""
    time = np.arange(3200) / 100
    parts = []
    for _ in range(3):
        own = swing(np.arange(850) / 100, noise=0)
        lift = np.interp(np.arange(150), [0, 120, 150], [own[-1], 0.6, 0.6])
        parts += [own, lift]
    first = np.interp(np.arange(200), [0, 100, 200], [0, 0.6, 0.6])
    signal = np.concatenate([first, *parts])[: time.size]
    return time, signal + 0.002 * np.random.default_rng(5).standard_normal(time.size)


def test_several_releases_are_refused_with_the_rows_that_part_them(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    time, signal = three_releases()
    text = "t_s,theta_rad\n" + "".join(f"{t:.2f},{x:.6f}\n" for t, x in zip(time, signal, strict=True))
    (tmp_path / "anna.csv").write_text(text)
    (tmp_path / "sheet.csv").write_text("recording,campaign,file\nanna,bob,anna.csv\n")
    with pytest.raises(InputError, match="released 3 times") as caught:
        ingest(read_sheet("sheet.csv").loc["anna"], "sheet.csv")
    rows = caught.value.mend.partition(":\n")[2]
    assert rows.splitlines()[0] == "recording,campaign,file,start_s,stop_s"
    (tmp_path / "parted.csv").write_text(rows + "\n")
    parted = read_sheet("parted.csv")
    assert list(parted.index) == ["anna-1", "anna-2", "anna-3"]
    assert list(parted["campaign"].unique()) == ["bob"]
    for name, let_go in zip(parted.index, (2, 12, 22), strict=True):
        found = ingest(parted.loc[name], "parted.csv")
        assert "remarks" not in found.attrs
        assert let_go + 0.1 < float(found["time"][0]) < let_go + 0.5
        assert float(found["time"][-1]) == pytest.approx(let_go + 8.5, abs=0.6)


def test_a_window_in_the_sheet_keeps_several_releases_together(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    np.savetxt("a.csv", np.column_stack(three_releases()), delimiter=",", header="t_s,theta_rad", comments="")
    (tmp_path / "sheet.csv").write_text("recording,file,start_s\na,a.csv,0\n")
    found = ingest(read_sheet("sheet.csv").loc["a"], "sheet.csv")
    assert found.sizes["time"] == to_angle(found).sizes["time"] == 3200
    assert "released 3 times" in found.attrs["remarks"]


def knocked():
    """(times, angle): a swing into which something hits at 9.6 s, for half a second."""
    time = np.arange(2000) / 100
    signal = swing(time)
    pushed = (time > 9.6) & (time < 10.1)
    signal[pushed] += 0.15 * np.sin(np.pi * (time[pushed] - 9.6) / 0.5) ** 2
    return time, signal


@pytest.mark.parametrize(("hole", "told"), [((5, 6), 1), ((9.2, 9.4), 0), ((10.4, 10.6), 0), ((14, 15), 1)])
def test_beside_a_hole_no_knock_is_told(hole, told):
    assert len(find_windows(*knocked(), 1.0, hidden=[hole])[1]) == told


def test_a_knock_is_told_and_parts_nothing():
    windows, told = find_windows(*knocked(), 1.0)
    assert len(windows) == 1 and np.isnan([windows[0].begins, windows[0].ends]).all()
    assert len(told) == 1 and told[0] == pytest.approx(9.9, abs=0.6)


@pytest.mark.parametrize(("height", "anew"), [(0.44, False), (0.5, True)])
def test_a_pendulum_that_swings_higher_after_a_hand_is_released_anew(height, anew):
    """From 0.4 rad on, by a hand that stays for half a period."""
    time = np.arange(2000) / 100
    before, after = 0.4 * np.cos(7.25 * time[:960]), height * np.cos(7.25 * time[:990])
    signal = np.concatenate([before, np.linspace(before[-1], height, 50), after])
    signal += 0.002 * np.random.default_rng(3).standard_normal(time.size)
    windows, pushed = find_windows(time, signal, 1.0)
    assert (len(windows), len(pushed)) == ((2, 0) if anew else (1, 1))


@pytest.mark.parametrize(("end", "count", "told"), [(440, 4, False), (475, 5, True)])
def test_of_a_few_half_swings_no_release_is_told(end, count, told):
    time, signal = held(100, 3.0)
    (found,), _ = find_windows(time[:end], signal[:end], 1.0)
    assert len(half_swings(signal[:end]).starts) == count
    assert np.isfinite(found.released) == told
