"""Recordings enter through the sample sheet; whatever cannot be used stops with one message and leaves no file."""

import hashlib

import numpy as np
import pytest
import xarray as xr

from swingdown import dataset
from swingdown.errors import InputError
from swingdown.measurement.recording import ingest, read_recording
from swingdown.measurement.sheet import read_sheet

TIME = np.arange(400) / 100


@pytest.fixture
def make(tmp_path, monkeypatch):
    """A function that writes a recording and a sheet of one row, and ingests it to ``made.nc``."""
    monkeypatch.chdir(tmp_path)

    def make(signal=None, time=TIME, text=None, file="swing.csv", **cells):
        if text is None:
            signal = 0.4 * np.cos(7 * TIME) if signal is None else signal
            text = "t_s,theta_rad\n" + "".join(
                f"{t!r},{x!r}\n" for t, x in zip(map(float, time), map(float, signal), strict=True)
            )
        if file == "swing.csv":
            (tmp_path / file).write_text(text)
        cells = {"recording": "a", "file": file, **cells}
        (tmp_path / "sheet.csv").write_text(
            ",".join(cells) + "\n" + ",".join(map(str, cells.values())) + "\n"
        )
        return read_recording(dataset.write(ingest(read_sheet("sheet.csv").loc["a"], "sheet.csv"), "made.nc"))

    return make


@pytest.fixture
def refused(make, tmp_path):
    """A function that expects the recording to be refused with an error that names all of ``told``."""

    def refused(*told, **recording):
        with pytest.raises(InputError) as caught:
            make(**recording)
        message = str(caught.value)
        for part in (*told, "Expected:", "Mend:"):
            assert part in message, message
        assert not [path for path in tmp_path.iterdir() if path.name not in ("swing.csv", "sheet.csv")]

    return refused


def test_a_recording_keeps_its_numbers_and_its_provenance(make, tmp_path):
    made = make(campaign="mine", role="holdout")
    assert made["signal"].values == pytest.approx(0.4 * np.cos(7 * TIME), abs=0)
    assert made["time"].values == pytest.approx(TIME, abs=0)
    assert made["signal"].attrs["units"] == "rad" and made["time"].attrs["units"] == "s"
    digest = hashlib.sha256((tmp_path / "swing.csv").read_bytes()).hexdigest()
    told = {"recording": "a", "campaign": "mine", "role": "holdout", "file": "swing.csv", "sha256": digest}
    assert told.items() <= made.attrs.items()
    assert made.attrs["emulated"] == "no" and made.attrs["expected_samples"] == 400


def test_a_file_says_of_itself_that_it_is_emulated(make):
    text = "# emulated: yes\n# source: a program\nt_s,theta_rad\n" + "".join(
        f"{t},{np.cos(t)}\n" for t in TIME
    )
    made = make(text=text)
    assert made.attrs["emulated"] == "yes" and made.attrs["source"] == "a program"


@pytest.mark.parametrize(("unit", "factor"), [("s", 1), ("ms", 1e-3), ("us", 1e-6)])
def test_time_units(make, unit, factor):
    assert make(time=TIME / factor, time_unit=unit)["time"].values == pytest.approx(TIME, rel=1e-12)


def test_the_window_is_cut_before_anything_is_checked(make):
    signal = 0.4 * np.cos(7 * TIME)
    signal[:10] = np.nan
    made = make(signal, start_s=0.1, stop_s=2)
    assert made["time"].values[[0, -1]] == pytest.approx([0.1, 2.0])


@pytest.mark.parametrize(
    ("factor", "begins", "rows", "start", "stop"), [(1e-3, 0.0, 4000, 15, ""), (1e-6, 0.0, 4000, 15, 30), (1, 0.0, 4000, 15, 30), (1e-3, 1.7e9, 1000, 1.7e9 + 2, "")],
)  # fmt: skip
def test_the_window_is_in_seconds_where_the_values_tell_the_unit_of_the_time(
    make, factor, begins, rows, start, stop
):
    time = begins + np.arange(rows) / 100
    signal = 0.4 * np.cos(7 * (time - begins)) * np.exp(-0.01 * (time - begins))
    text = "clock,theta_rad\n" + "".join(
        f"{t / factor:.0f},{x!r}\n" if factor < 1 else f"{t!r},{x!r}\n"
        for t, x in zip(map(float, time), map(float, signal), strict=True)
    )
    made = make(text=text, start_s=start, stop_s=stop)
    assert made["time"].values[[0, -1]] == pytest.approx([start, stop or time[-1]], rel=0, abs=1e-6)


def test_netcdf_is_read_as_csv_is(make, tmp_path):
    xr.Dataset({"theta_deg": ("t_s", np.cos(TIME))}, {"t_s": TIME}).to_netcdf(tmp_path / "raw.nc")
    made = make(file="raw.nc", time_column="t_s", signal_column="theta_deg")
    assert made["signal"].attrs["units"] == "deg"
    assert made["signal"].values == pytest.approx(np.cos(TIME), abs=0)


def test_a_file_by_address(make, tmp_path):
    (tmp_path / "other.csv").write_text("t_s,theta_rad\n" + "".join(f"{t},{np.cos(t)}\n" for t in TIME))
    assert make(file=(tmp_path / "other.csv").as_uri()).sizes["time"] == 400


def test_a_static_record_may_be_constant(make):
    assert make(np.zeros(400), role="static").sizes["time"] == 400


def test_a_swing_may_end_at_rest(make):
    made = make(np.round(0.4 * np.cos(7 * TIME) * np.exp(-3 * TIME), 3))
    assert made.sizes["time"] == 400


def test_a_signal_cut_off_at_a_rail(refused):
    time = np.arange(4000) / 1000
    signal = np.round(np.clip(0.4 * np.cos(7 * time), -0.3, 0.3), 4)
    refused("swing.csv", "theta_rad", "saturated", signal=signal, time=time)


def test_a_constant_signal(refused):
    refused("swing.csv", "theta_rad", "constant (0.2)", signal=np.full(400, 0.2))


def test_a_missing_file(refused):
    refused("sheet.csv, line 2, column file", "no file gone.csv", file="gone.csv")


@pytest.mark.parametrize("key", ["time_column", "signal_column"])
def test_a_missing_column(refused, key):
    refused("swing.csv", key, "no column 'angle'", "t_s, theta_rad", **{key: "angle"})


def test_a_file_with_one_column(refused):
    refused("swing.csv", "1 column", text="t_s\n" + "1\n" * 20)


@pytest.mark.parametrize(
    ("key", "unit", "hint"),
    [
        ("time_unit", "sec", "s, ms, us"),
        ("signal_unit", "volts", "V, rad"),
        ("signal_unit", "Deg", "write 'deg'"),
    ],
)
def test_an_unknown_unit(refused, key, unit, hint):
    refused("sheet.csv, line 2", key, repr(unit), hint, **{key: unit})


def test_volts_and_counts_that_only_the_file_tells(refused):
    text = "time_ms,voltage_V\n" + "".join(f"{10 * k},{np.cos(k / 9)}\n" for k in range(99))
    refused("voltage_V", "signal_unit", "calibration", text=text)


def test_a_row_that_repeats_a_time_is_left_out(make):
    time = TIME.copy()
    time[200] = time[199]
    made = make(time=time)
    assert made.sizes["time"] == 399 and "1 of 400 rows repeat the time of another" in made.attrs["remarks"]


def test_a_file_in_reverse_is_turned_round(make):
    made = make((0.4 * np.cos(7 * TIME))[::-1], time=TIME[::-1])
    assert made["signal"].values == pytest.approx(0.4 * np.cos(7 * TIME), abs=0)
    assert "run backwards in time" in made.attrs["remarks"]


def test_a_clock_that_jumps_back_begins_a_second_part(make, refused):
    time = np.append(TIME[:200], TIME[:200])
    refused("swing.csv", "jumps back from 1.99 to 0 s", "2 parts", "part 1, part 2", time=time)
    made = make(time=time, run="part 2")
    assert made["time"].values == pytest.approx(TIME[:200], abs=0)
    assert made["signal"].values == pytest.approx(0.4 * np.cos(7 * TIME[200:]), abs=0)


def test_a_missing_sample_is_told(make):
    made = make(np.delete(0.4 * np.cos(7 * TIME), 200), np.delete(TIME, 200))
    assert (
        made.attrs["remarks"]
        == "1 of 400 samples are missing, the longest hole 0.01 s; the others are taken at their times"
    )


@pytest.mark.parametrize("cell", ["nan", "", "inf", "oops"])
@pytest.mark.parametrize("column", [0, 1])
def test_a_cell_that_is_no_number_is_a_missing_sample(make, cell, column):
    rows = [[f"{t}", f"{0.4 * np.cos(7 * t)}"] for t in TIME]
    rows[200][column] = cell
    made = make(text="t_s,theta_rad\n" + "".join(",".join(row) + "\n" for row in rows))
    name = ("t_s", "theta_rad")[column]
    assert f"1 of 400 cells of `{name}` hold no number" in made.attrs["remarks"]
    assert made["time"].values == pytest.approx(np.delete(TIME, 200), abs=0)


def test_a_column_with_few_numbers_is_refused(refused):
    rows = [f"{t},{np.cos(t) if k % 3 == 0 else ''}\n" for k, t in enumerate(TIME)]
    text = "t_s,theta_rad\n" + "".join(rows)
    refused(
        "column theta_rad",
        "266 of 400 cells hold no finite number",
        "134 rows with a number",
        "half_swings",
        text=text,
    )
    spoilt = [f"{t},{np.cos(t) if k % 10 else 'bad'}\n" for k, t in enumerate(TIME)]
    refused("line 2, column theta_rad", "40 of 400 cells", "'bad'", text="t_s,theta_rad\n" + "".join(spoilt))


def test_beside_a_hole_that_hides_an_unknown_number_of_swings_the_longest_part_is_used(
    make, refused, tmp_path
):
    """Where the period is known well enough the swings in it are counted; a part that somebody states is not made shorter."""
    time = np.concatenate([np.arange(300), np.arange(1300, 2300)]) / 100
    swing = np.exp(-0.02 * time) * np.cos(7 * time - 0.3)
    assert make(0.4 * swing, time).sizes["time"] == 1300
    (tmp_path / "made.nc").unlink()
    # 100 s in which it slows down by a swing or so
    time = np.concatenate([np.arange(300), np.arange(10300, 11300)]) / 100
    phase = np.where(time < 50, 7 * time, 7 * time + 0.1 * (time - 50))
    made = make(0.4 * np.cos(phase), time)
    assert made.attrs["begins_s"] == 103 and "ends_s" not in made.attrs
    assert "hides about 1" in made.attrs["remarks"] and "from 103.000 s on" in made.attrs["remarks"]
    (tmp_path / "made.nc").unlink()
    refused("hides about 1", "start_s: 103", signal=0.4 * np.cos(phase), time=time, start_s=0.5)


def test_too_few_samples(refused):
    refused("swing.csv", "9 samples", "at least 10", time=TIME[:9], signal=TIME[:9])
    refused("swing.csv", "0 samples", start_s=70)


def test_a_start_that_counts_from_the_first_sample_of_stamped_times(refused, make, tmp_path):
    """It would cut nothing off, and a hand or a rest in front no more."""
    stamps = 1776529395.25 + TIME
    refused(
        "column",
        "start_s, 0.5 s, is long before its first time, 1776529395.25 s",
        "start_s: 1776529395.75",
        time=stamps,
        start_s=0.5,
    )
    assert make(time=stamps, start_s=1776529395.75)["time"][0] >= 1776529395.75
    (tmp_path / "made.nc").unlink()
    assert make(time=stamps, start_s=0).sizes["time"] == TIME.size


def test_a_checksum_that_does_not_match(refused):
    refused("swing.csv", "sheet.csv", "sha256", "the checksum does not match", "0" * 64, sha256="0" * 64)


def test_something_that_is_no_table(refused, tmp_path):
    refused("swing.csv", "no table", text="dear diary,\ntoday, again, it swung\n")
    (tmp_path / "swing.csv").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match="not text"):
        ingest({**read_sheet("sheet.csv").loc["a"], "recording": "a"})


def test_hdf5_is_read_of_its_only_group_and_several_are_told(make, tmp_path):
    data = xr.Dataset({"theta_rad": ("sample", 0.3 * np.cos(TIME)), "time_s": ("sample", TIME)})
    data.to_netcdf(tmp_path / "raw.h5", group="run1")
    np.testing.assert_allclose(make(file="raw.h5")["signal"].values, 0.3 * np.cos(TIME))
    data.to_netcdf(tmp_path / "raw.h5", group="run2", mode="a")
    with pytest.raises(InputError, match="but the groups run1, run2"):
        make(file="raw.h5")


def test_a_netcdf_that_cannot_be_read(refused, tmp_path):
    (tmp_path / "sheet.csv").write_bytes(b"")
    (tmp_path / "swing.csv").write_bytes(b"CDF nonsense")
    (tmp_path / "swing.csv").rename(tmp_path / "broken.nc")
    with pytest.raises(InputError, match=r"broken\.nc: it cannot be read"):
        ingest({"recording": "a", "file": "broken.nc", "sha256": ""})


def test_a_recording_that_lost_samples_on_disk(make):
    made = make()
    dataset.write(made.isel(time=slice(0, 300)), "made.nc")
    with pytest.raises(InputError, match=r"300 samples.*400"):
        read_recording("made.nc")


@pytest.mark.parametrize(
    "name",
    [
        "dynamicslab_single/free_swing_large",
        "dynamicslab_single/free_swing_small",
        "jensen_rotary/rel45",
        "jensen_rotary/rel90",
        "jensen_rotary/rel135",
    ],
)
def test_recordings_of_real_pendulums_are_accepted(make, shared_data, name):
    made = make(file=str(shared_data / "real" / f"{name}.csv"))
    assert made.attrs["emulated"] == "no" and made.sizes["time"] >= 5000


def test_the_digitised_figure_is_read_across_its_hole(make, shared_data):
    file = str(shared_data / "real/khasawneh_rig/fig13_digitised.csv")
    assert make(file=file, time_column="t_s", signal_column="theta_rad").sizes["time"] > 1000
