"""What whole kinds of files hold: columns at rest, frames for times, structures, positions on no circle, slow swings in whole numbers."""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.io import savemat

import swingdown
from swingdown.answer.again import once_more
from swingdown.errors import InputError
from swingdown.studies.doubt import NotFree
from swingdown.study import own

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


def test_period_and_decay_are_told_of_what_no_model_follows(tmp_path):
    one = taken(isochronous(tmp_path / "angle.csv"))
    with pytest.raises(InputError):
        swingdown.read(tmp_path / "angle.csv").fit()
    used, answer, told = once_more(one, "sine")
    assert "PERIOD AND DECAY ALONE" in told and used.row["scale"] == "relative"
    assert float(answer.table["period_s"].iloc[0]) == pytest.approx(1.3, rel=5e-3)


def test_nothing_that_is_stated_is_overruled(tmp_path):
    one = taken(isochronous(tmp_path / "angle.csv"), signal_unit="deg")
    assert once_more(one, "sine") is None


def test_a_steady_drive_is_no_free_swing(tmp_path):
    """Its period would be the motor's."""
    values = np.degrees(0.9 * np.sin(2 * np.pi * TIMES / 1.3) + 0.3 * np.sin(2 * np.pi * TIMES / 0.43))
    path = written(tmp_path / "driven.csv", [TIMES, values], "t,angle")
    try:
        swingdown.read(path).fit()
    except NotFree:
        assert once_more(taken(path), "sine") is None


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
