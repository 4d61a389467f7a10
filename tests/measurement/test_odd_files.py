"""Files that look in order and are not: each is refused, mended and told, or told; none passes in silence."""

import numpy as np
import pytest
import xarray as xr

from swingdown.engine.trajectory import simulate
from swingdown.errors import InputError
from swingdown.fitting.least_squares import fit_trajectory
from swingdown.measurement.angle import to_angle
from swingdown.measurement.recording import ingest
from swingdown.measurement.sheet import read_sheet
from swingdown.pendulum.model import Model

RATE = 100
TIME = np.arange(3000) / RATE
TRUTH = {"natural_frequency": 7.25, "viscous_ratio": 0.004, "load_friction": 0.0005}


def angle(times=TIME, release=0.6):
    clean = simulate(Model("viscous+load_coulomb", TRUTH), times, release)
    return clean + 0.001 * np.random.default_rng(7).standard_normal(times.size)


def later(seconds):
    """The swing after ``seconds`` of something else, and the samples of that."""
    n = round(seconds * RATE)
    return np.append(np.full(n, np.nan), angle())[: TIME.size], TIME[:n]


def held():
    signal, before = later(3)
    signal[: before.size] = 0.6 + 0.001 * np.random.default_rng(1).standard_normal(before.size)
    return signal


def lifted():
    signal, before = later(2)
    signal[: before.size] = 0.6 * np.sin(np.pi * before / 4) ** 2
    return signal


def spoilt(where, by):
    signal = angle()
    signal[where] += by
    return signal


def stuck():
    signal = angle()
    signal[1003:] = signal[1003]
    return signal


def at_a_turning_point(samples):
    """The swing without some samples about a turning point: nothing jumps there."""
    signal = angle(np.arange(TIME.size + samples) / RATE)
    top = 1000 + int(np.argmax(signal[1000:1090]))
    return np.delete(signal, np.arange(top - samples // 2, top - samples // 2 + samples))


def flipped():
    signal = angle()
    signal[1310:] *= -1
    return signal


jumping = TIME + 0.4 / RATE * (TIME > 12)

# what is wrong: times, signal, header, cells of the sheet, what becomes of it, words of the message
ODD = {
    "degrees in `angle`": (TIME, np.degrees(angle()), "t_s,angle", {}, "mended", "TAKEN AS DEGREES"),
    "degrees in `angle_rad`": (TIME, np.degrees(angle()), "t_s,angle_rad", {}, "refused", "as stated, it swings back and forth"),
    "degrees in `angle (deg)`": (TIME, np.degrees(angle()), "t_s,angle (deg)", {}, "mended", "as degrees"),
    "ms in `time`": (1000 * TIME, angle(), "time,angle_rad", {}, "mended", "TAKEN AS ms"),
    "ms in `t_s`": (1000 * TIME, angle(), "t_s,angle_rad", {}, "told", "unit of the time right?"),
    "hanging at pi": (TIME, angle() + np.pi, "t_s,angle_rad", {}, "mended", "this is taken away"),
    "hanging at -pi": (TIME, angle() - np.pi, "t_s,angle_rad", {}, "mended", "this is taken away"),
    "hanging at 180°": (TIME, np.degrees(angle()) + 180, "t_s,angle_deg", {}, "mended", "this is taken away"),
    "hanging at pi in two halves": (
        TIME, (angle() + 2 * np.pi) % (2 * np.pi), "t_s,angle_rad", {}, "mended", "a whole turn",
    ),
    "an offset of 0.3 rad": (TIME, angle() + 0.3, "t_s,angle_rad", {}, "told", "it swings about 0.3 rad"),
    "held for 3 s before the release": (TIME, held(), "t_s,angle_rad", {}, "mended", "released at about 3.0"),
    "a hand that lifts": (TIME, lifted(), "t_s,angle_rad", {}, "mended", "in a hand and was released at about"),
    "a sensor that is dead after 10 s": (TIME, stuck(), "t_s,angle_rad", {}, "refused", "dead"),
    "dropped samples, time renumbered": (
        TIME[:-5], np.delete(angle(), range(1010, 1015)), "t_s,angle_rad", {}, "told", "OUT OF STEP from",
    ),
    "dropped samples at a turning point": (
        TIME, at_a_turning_point(8), "t_s,angle_rad", {}, "told", "where samples are lost",
    ),
    "a clock that jumps by 0.4 of a sample": (jumping, angle(), "t_s,angle_rad", {}, "told", "clock stumbles"),
    "a clock that jumps by half a sample": (
        TIME + 0.55 / RATE * (TIME > 12), angle(), "t_s,angle_rad", {}, "told", "samples are missing|stumbles",
    ),
    "a sign that flips": (TIME, flipped(), "t_s,angle_rad", {}, "told", "OUT OF STEP from"),
    "an offset that drifts": (TIME, angle() + 0.01 * TIME, "t_s,angle_rad", {}, "told", "drifts by"),
    "three spikes": (TIME, spoilt([700, 1500, 2222], 0.2), "t_s,angle_rad", {}, "mended", "a spike at 7 s and 2"),
    "less than a swing": (TIME[:35], angle()[:35], "t_s,angle_rad", {}, "refused", "the recording is too short"),
    "no header": (TIME, angle(), "", {}, "mended", "no header"),
}  # fmt: skip


@pytest.fixture
def read(tmp_path, monkeypatch):
    """A function that writes a file and a sheet of one row, and reads the recording as a study does."""
    monkeypatch.chdir(tmp_path)

    def one(times, signal, header, cells):
        np.savetxt(
            "a.csv", np.column_stack([times, signal]), fmt="%.9g", delimiter=",", header=header, comments=""
        )
        if not header:
            (tmp_path / "a.csv").write_text((tmp_path / "a.csv").read_text().lstrip())
        columns = {"recording": "a", "file": "a.csv"} | cells
        (tmp_path / "sheet.csv").write_text(f"{','.join(columns)}\n{','.join(columns.values())}\n")
        return ingest(read_sheet("sheet.csv").loc["a"], "sheet.csv")

    return one


@pytest.mark.parametrize("what", ODD)
def test_no_odd_file_passes_in_silence(read, what):
    times, signal, header, cells, becomes, words = ODD[what]
    if becomes == "refused":
        with pytest.raises(InputError, match=words) as caught:
            read(times, signal, header, cells)
        assert caught.value.mend
        return
    found = read(times, signal, header, cells)
    told = found.attrs["taken"] + "; " + found.attrs.get("remarks", "")
    assert any(word in told for word in words.split("|")), told
    if becomes == "mended":
        used = to_angle(found)
        fit = fit_trajectory("viscous+load_coulomb", used["time"].values, used["angle"].values, start="free")
        for name, true in TRUTH.items():
            assert abs(fit.model.values[name] - true) < 5 * fit.model.standard_errors[name], name
        assert fit.model.values["natural_frequency"] == pytest.approx(7.25, abs=0.001)


def test_nothing_is_told_of_that_swing_as_it_is(read):
    found = read(TIME, angle(), "t_s,angle_rad", {})
    assert "remarks" not in found.attrs and found.sizes["time"] == TIME.size


def test_netcdf_whose_units_contradict_the_sheet(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    data = xr.Dataset({"angle": ("time", np.degrees(angle()), {"units": "degrees"})}, {"time": TIME})
    data["time"].attrs["units"] = "s"
    data.to_netcdf("a.nc")
    (tmp_path / "sheet.csv").write_text("recording,file,signal_unit\na,a.nc,rad\nb,a.nc,\n")
    rows = read_sheet("sheet.csv")
    with pytest.raises(InputError, match="the sheet says 'rad' and the file says 'degrees'"):
        ingest(rows.loc["a"], "sheet.csv")
    assert float(np.abs(to_angle(ingest(rows.loc["b"], "sheet.csv"))["angle"]).max()) == pytest.approx(
        0.6, abs=0.01
    )
