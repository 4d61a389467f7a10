"""What whole kinds of files hold: columns at rest, frames for times, structures, positions on no circle, slow swings in whole numbers."""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from scipy.io import savemat

import swingdown
from swingdown.answer.command import Wishes, answer
from swingdown.errors import InputError
from swingdown.measurement.plausibility import in_step_and_dying
from swingdown.measurement.second_reading import OPEN, readings
from swingdown.planning import own

TIMES = np.arange(0, 30, 0.02)


def swing(period=1.3, size=0.05, dies=40.0, times=TIMES, seed=1, noise=2e-4):
    return size * np.exp(-times / dies) * np.cos(2 * np.pi * times / period) + np.random.default_rng(
        seed
    ).normal(0, noise, times.size)


def written(path, columns, header=None):
    np.savetxt(path, np.column_stack(columns), "%.6f", ",", header=header or "", comments="")
    return path


def period(recording):
    return float(recording.fit().table["period_s"].iloc[0])


def test_a_column_of_one_value_is_left_out(tmp_path):
    path = written(tmp_path / "torsion.csv", [TIMES, np.zeros(TIMES.size), swing()])
    recording = swingdown.read(path)
    assert "`column 2` holds one value throughout: left out" in "".join(recording.remarks)
    assert period(recording) == pytest.approx(1.3, rel=5e-3)


def test_a_column_of_one_value_alone_is_told(tmp_path):
    with pytest.raises(InputError, match="constant"):
        swingdown.read(written(tmp_path / "dead.csv", [TIMES, np.ones(TIMES.size)], "t,angle"))


def test_frames_are_no_times(tmp_path):
    x, y = np.sin(swing(size=0.2)), -np.cos(swing(size=0.2))
    path = written(tmp_path / "film.csv", [np.arange(TIMES.size), 300 * x, 300 * y], "frame,X,Y")
    with pytest.raises(InputError, match="counts frames"):
        swingdown.read(path)
    assert period(swingdown.read(path, rate=50.0)) == pytest.approx(1.3, rel=5e-3)


def test_fields_of_structures_are_columns(tmp_path):
    signals = np.empty((1, 2), dtype=[("values", object), ("label", object)])
    signals[0, 0] = (swing()[:, None], "PendPos")
    signals[0, 1] = (np.gradient(swing(), TIMES)[:, None], "PendVel")
    savemat(tmp_path / "log.mat", {"run": {"time": TIMES[:, None], "signals": signals}})
    recording = swingdown.read(tmp_path / "log.mat", column="PendPos")
    assert period(recording) == pytest.approx(1.3, rel=5e-3)


def test_positions_on_no_circle_are_one_coordinate(tmp_path):
    """A marker on a platform that turns and rocks: its path is no arc."""
    along, beside = swing(size=60), 20 * np.sin(2 * np.pi * TIMES / 0.7)
    path = written(tmp_path / "platform.csv", [TIMES, 600 + 0.8 * along - 0.6 * beside, 150 + 0.6 * along + 0.8 * beside], "t,x,y")  # fmt: skip
    recording = swingdown.read(path)
    assert "ON NO CIRCLE" in "".join(recording.remarks)
    assert period(recording) == pytest.approx(1.3, rel=5e-3)


def test_a_slow_swing_in_whole_numbers_is_none_of_turning_points(tmp_path):
    times = np.arange(0, 4500, 5.63)
    values = np.round(37 + 36 * np.exp(-times / 1100) * np.cos(2 * np.pi * times / 587))
    path = written(tmp_path / "balance.dat", [times, values])
    with pytest.raises(InputError, match="no unit of the time"):
        swingdown.read(path)
    assert period(swingdown.read(path, time_unit="s")) == pytest.approx(587, rel=2e-2)  # by whole numbers


def test_a_pendulum_at_rest_beside_another_is_left_out(tmp_path):
    rest = 469 + np.round(np.random.default_rng(2).normal(0, 1, TIMES.size))
    path = written(tmp_path / "two.csv", [TIMES, 470 + swing(size=150), TIMES, rest], "t1,x1,t2,x2")  # fmt: skip
    parts = own.take(own.rows([path], Path(), False, {})[0], path)
    used = [one for one in parts if isinstance(one, own.Taken)]
    assert [one.row["run"] for one in used] == ["run 1"]
    assert any(isinstance(one, own.Refused) and "at rest beside it" in one.problem for one in parts)


def test_few_swings_give_no_number():
    times = np.arange(0, 0.92, 0.02)
    values = 0.1 * np.sin(2 * np.pi * times / 0.5 + 2 * times**2) + np.random.default_rng(3).normal(0, 0.03, times.size)  # fmt: skip
    with pytest.raises(InputError):
        swingdown.fit(times, values)


def taken(path, **cells):
    one = own.take(own.rows([path], Path(), False, cells)[0], path)
    assert len(one) == 1 and isinstance(one[0], own.Taken), one
    return one[0]


def isochronous(path):
    """An angle in degrees that some script made: as wide as no pendulum swings with one period."""
    values = np.degrees(swing(size=0.9, dies=35.0))
    return written(path, [TIMES, values], "t,angle")


ALONE = "PERIOD AND DECAY ALONE ARE REPORTED, by its passages"


def told(path, **stated):
    """What is said beside the answer on a file, and its period."""
    row = swingdown.read(path, **stated).fit().row
    return row["remark"], pytest.approx(float(row["period_s"]), rel=5e-3)


def test_period_and_decay_are_told_of_what_no_model_follows(tmp_path):
    remark, found = told(isochronous(tmp_path / "angle.csv"))
    assert ALONE in remark and "unit is in doubt" in remark and found == 1.3


def test_a_rate_that_no_model_follows_tells_its_period(tmp_path):
    path = written(tmp_path / "phone.csv", [TIMES, swing(size=4.3)], "Time (s),Gyroscope x (rad/s)")
    remark, found = told(path)
    assert ALONE in remark and found == 1.3


def kicked():
    """Angles of a pendulum that is kicked at 6.5 s."""
    size = np.where(TIMES < 6.5, 0.08, 0.3) * np.exp(-np.where(TIMES < 6.5, TIMES, TIMES - 6.5) / 10)
    return size * np.sin(2 * np.pi * TIMES / 1.3)


def test_the_free_stretch_is_used_of_what_somebody_kicks(tmp_path):
    remark, found = told(written(tmp_path / "kicked.csv", [TIMES, kicked()], "t,angle (rad)"))
    assert "USED FROM 6.5" in remark and found == 1.304


def test_the_command_reads_it_as_the_call_does(tmp_path, capsys):
    path = isochronous(tmp_path / "angle.csv")
    assert answer([str(path)], {}, Wishes(into=str(tmp_path / "study"), quick=True)) == 0
    assert ALONE in capsys.readouterr().out
    sheet = pd.read_csv(tmp_path / "study" / "recordings.csv")
    assert list(sheet["scale"]) == ["relative"]  # the workflow reads it so
    table = pd.read_csv(tmp_path / "study" / "first_answer.csv")
    assert table["period_s"][0] == swingdown.read(path).fit().table["period_s"].iloc[0]


def test_beside_others_the_free_stretch_is_used(tmp_path):
    free = swing(size=0.2, dies=10.0, noise=0)
    paths = [
        written(tmp_path / f"{k}.csv", [TIMES, one], "t,angle (rad)")
        for k, one in enumerate((free, kicked()))
    ]
    table = swingdown.read(paths).fit().table
    assert "USED FROM" not in table["remark"][0] and "USED FROM 6.5" in table["remark"][1]


def test_nothing_that_is_stated_is_overruled(tmp_path):
    path = isochronous(tmp_path / "angle.csv")
    with pytest.raises(InputError, match="weight does not pull it back"):
        swingdown.read(path, unit="deg").fit()


def test_a_steady_drive_is_no_free_stretch():
    """The period of what does not die would be the motor's."""

    def read_again(dies):
        early, late = (
            0.1 * np.sin(2 * np.pi * TIMES / 1.3),
            0.3 * np.exp(-TIMES / dies) * np.sin(2 * np.pi * TIMES / 1.3),
        )
        angle = xr.DataArray(np.where(TIMES < 7.8, early, late), {"time": TIMES}, ["time"], "angle")
        return list(readings(xr.Dataset({"angle": angle}, attrs={OPEN: "yes", "mode": ""})))

    assert len(read_again(dies=30.0)) == 2
    assert read_again(dies=1e9) == []


def test_what_takes_longer_on_one_side_is_no_free_stretch():
    """As a bob beside a magnet: its periods are even, and it is no swing about where it rests."""

    def even(longer):
        along = (TIMES / 1.3) % 1.0
        side = np.where(along < longer, along / longer, 1 + (along - longer) / (1 - longer))
        return in_step_and_dying(TIMES, np.exp(-TIMES / 30) * np.sin(np.pi * side))

    assert even(0.5) and even(0.52)
    assert not even(0.55) and not even(0.45)


def test_the_height_of_a_bob_on_a_spring_is_its_swing(tmp_path):
    remark, found = told(written(tmp_path / "spring.csv", [TIMES, 0.14 + swing(size=0.1)], "t,y"))
    assert found == 1.3
    angle = swing(size=0.6)
    with pytest.raises(InputError, match="twice a period"):
        swingdown.read(written(tmp_path / "height.csv", [TIMES, 1 - np.cos(angle)], "t,y"))


@pytest.mark.parametrize("header", ["t (s),Distance (cm)", "Time (s),Velocity (cm/s)", "t (s),x (m)"])
def test_a_coordinate_tells_its_period_whatever_pulls_it_back(tmp_path, header):
    """A weight on a spring above a ranger: no length belongs to it."""
    recording = swingdown.read(written(tmp_path / "spring.csv", [TIMES, 40 + swing(size=9.0)], header))
    assert "PERIOD AND DECAY ALONE" in "".join(recording.remarks)
    assert period(recording) == pytest.approx(1.3, rel=2e-3)
    assert "g" not in recording.fit().row


def test_a_height_is_no_coordinate_by_another_name(tmp_path):
    height = 1 - np.cos(swing(size=0.6))
    with pytest.raises(InputError, match="turning points of one side stay"):
        swingdown.read(written(tmp_path / "ranger.csv", [TIMES, 100 * height], "t (s),Distance (cm)"))


def test_a_camera_that_drifts_leaves_the_coordinate_that_swings(tmp_path):
    slow = 60 * np.sin(TIMES / 4) + 8 * TIMES
    x, y = 300 * swing(size=0.3) + slow / 3, 900 + 1.2 * slow
    remark, found = told(written(tmp_path / "drift.csv", [TIMES, x, y], "t,x,y"))
    assert found == 1.3


def test_parts_of_a_quaternion_are_no_angle(tmp_path):
    half = swing(size=0.1) / 2
    path = written(
        tmp_path / "imu.csv", [TIMES, np.cos(half), 0 * half, np.sin(half), 0 * half], "t,qw,qx,qy,qz"
    )
    with pytest.raises(InputError, match="quaternion"):
        swingdown.read(path)


@pytest.mark.parametrize("ending", ["npy", "npz", "json", "json rows"])
def test_saved_arrays_are_read(tmp_path, ending):
    path = tmp_path / f"swing.{ending.split()[0]}"
    if ending == "npy":
        np.save(path, np.column_stack([TIMES, swing()]))
    elif ending == "npz":
        np.savez(path, time=TIMES, angle=swing())
    elif ending == "json":
        path.write_text(json.dumps({"time": TIMES.tolist(), "angle": swing().tolist(), "note": "a"}))
    else:
        path.write_text(json.dumps([{"t": t, "angle": x} for t, x in zip(TIMES, swing(), strict=True)]))
    assert swingdown.read(path).swings[0]["angle"].values == pytest.approx(swing(), abs=1e-9)


def test_damaged_arrays_are_refused(tmp_path):
    for name in ("a.npy", "a.npz", "a.json"):
        (tmp_path / name).write_bytes(b"\x93NUMPY nothing {")
        with pytest.raises(InputError, match="cannot be read"):
            swingdown.read(tmp_path / name)


def test_stamps_since_1970_tell_their_unit(tmp_path):
    lines = [
        f"{1_600_000_000_000_000_000 + round(t * 1e9)},{x:.6f}" for t, x in zip(TIMES, swing(), strict=True)
    ]
    (tmp_path / "ros.csv").write_text("\n".join(["%time,field.position0", *lines]))
    recording = swingdown.read(tmp_path / "ros.csv")
    assert "ns since 1970" in "".join(recording.remarks)
    assert period(recording) == pytest.approx(1.3, rel=5e-3)


def test_a_sheet_of_notes_before_the_recording_is_passed(tmp_path):
    with pd.ExcelWriter(tmp_path / "two.xlsx") as book:
        pd.DataFrame({"notes": ["string", "ball"]}).to_excel(book, sheet_name="notes", index=False)
        pd.DataFrame({"t (s)": TIMES, "angle (rad)": swing()}).to_excel(book, sheet_name="data", index=False)
    assert "sheet `data`" in swingdown.read(tmp_path / "two.xlsx").taken[0]


def test_a_slow_rate_is_a_rate(tmp_path):
    """A torsion pendulum of a minute, a sample each two seconds, saved without times."""
    times = 2.0 * np.arange(400)
    np.save(tmp_path / "slow.npy", 0.3 * np.exp(-times / 600) * np.cos(2 * np.pi * times / 60))
    recording = swingdown.read(tmp_path / "slow.npy", rate=0.5, unit="rad", restoring="linear")
    assert recording.swings[0]["time"].values[:3] == pytest.approx([0, 2, 4])
