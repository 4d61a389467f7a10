"""A telephone as a source: recordings from an EMULATED phyphox (emulated_phone.py), sound and with faults."""

import re
import threading
import time

import numpy as np
import pytest
from emulated_phone import EXPORT, INPUT, Telephone
from traffic import SETTINGS

import swingdown
from swingdown import dataset
from swingdown.capture import job as jobs
from swingdown.capture import recording, source, telephone
from swingdown.errors import InputError
from swingdown.measurement.sheet import read_sheet

NC = "resources/recordings/a.nc"


@pytest.fixture
def phone(monkeypatch):
    monkeypatch.setattr(telephone, "_LOOK", 0.5)
    made = Telephone()
    yield made
    made.close()


@pytest.fixture
def capture(phone, tmp_path, monkeypatch):
    """A function that records from the telephone and returns what the experimenter is told."""
    monkeypatch.chdir(tmp_path)

    def run(stop=None, **more):
        settings = {**SETTINGS, "format": "frames", "port": phone.port, "duration_s": 1.5, **more}
        config = {"recording": "a", "recordings": "sheet.csv", "capture": settings}
        return recording.capture(jobs.job(config), stop=stop)

    return run


def test_the_axis_that_moves_is_recorded_on_the_telephones_clock(phone, capture):
    told = capture()
    assert "a: complete: 150 of 150 samples" in told and "0 lost" in told
    assert "gyrY of the telephone (y of its gyroscope, which moved most: x 0.00" in told
    data = dataset.read(NC)
    assert data["rate"].attrs["units"] == "rad/s" and data.attrs["partial"] == "no"
    assert np.diff(data["time"].values) == pytest.approx(0.01, abs=1e-6)
    begun = next(
        at for at in np.arange(0.2, 4, 0.01) if abs(phone.rate_of_y(at) - data["rate"].values[0]) < 1e-6
    )
    expected = [phone.rate_of_y(begun + at) for at in data["time"].values]
    assert data["rate"].values == pytest.approx(expected, abs=1e-6)
    assert phone.port in data.attrs["source"] and "Gyroscope (rotation rate)" in data.attrs["source"]
    row = read_sheet("sheet.csv").loc["a"]
    assert (row["signal_column"], row["signal_unit"]) == ("rate", "rad/s")


def test_it_is_cleared_started_and_stopped_and_asked_for_new_samples_alone(phone, capture):
    capture()
    assert phone.commands == ["clear", "start", "stop"]
    asked = [
        parameters for path, parameters in phone.asked if path == "/get" and "|" in parameters.get("gyrY", "")
    ]
    since = [float(one["gyr_time"]) for one in asked]
    assert len(since) > 5 and since == sorted(since) and since[0] > 0.3
    assert all(one["gyrY"] == f"{one['gyr_time']}|gyr_time" for one in asked)


@pytest.mark.parametrize("asked", ["x", "gyrX"])
def test_an_axis_that_is_asked_for_needs_no_motion(capture, asked):
    assert "gyrX of the telephone (x of its gyroscope, as asked for)" in capture(signal_column=asked)


def test_a_recording_is_read_as_a_pendulum(phone, capture):
    """y is 1.8 exp(-0.02 t) sin(6 t): a rate of a period of 1.0472 s that dies away in 50 s."""
    capture(duration_s=8.0)
    read = swingdown.read(NC, restoring="linear")
    assert "took `rate` as rad/s" in str(read)  # and not what the device sent, which stands beside it
    found = read.fit()
    assert found["period"].value == pytest.approx(2 * np.pi / 6, rel=1e-3)
    assert found["decay_time"].value == pytest.approx(50, rel=0.05)


def test_the_release_of_a_rate_is_found_where_it_leaves_zero(phone, capture):
    """A rate leaves zero with the time, and not with its square as an angle does: a slow one is noticed some 0.2 s later."""
    phone.still_until, phone.omega = 2.5, 0.6
    told = capture(signal_column="y", trigger={"threshold": 0.2, "pre_s": 1.0, "wait_s": 20})
    assert "complete" in told
    data = dataset.read(NC)
    assert data["time"].values[0] == pytest.approx(-1.0, abs=0.011)
    after = data.where(data["time"] > 0.02, drop=True)
    expected = [phone.rate_of_y(2.5 + at) for at in after["time"].values]
    assert after["rate"].values == pytest.approx(expected, abs=0.022)  # two samples


def test_what_lacks_at_first_hides_no_axis(phone, capture):
    phone.lacking = (0.05, 0.2)
    assert "y of its gyroscope, which moved most" in capture(duration_s=0.5)


def test_an_axis_that_is_not_exported_is_none(phone):
    phone.config["export"] = [
        {"set": "s", "sources": [one for one in EXPORT[0]["sources"] if one["buffer"] != "gyrY"]}
    ]
    assert "has no 'y'. Expected: x (gyrX), z (gyrZ)" in refused(phone, signal_column="y")


def test_a_network_that_drops_loses_nothing_and_is_told(phone, capture):
    phone.mute = (1.2, 3.2)
    told = capture(duration_s=4.0)
    assert "400 of 400 samples" in told and "0 lost" in told
    assert "did not answer for" in told and "kept its samples meanwhile" in told
    assert dataset.read(NC).attrs["partial"] == "no"


def test_a_network_that_stays_away_ends_it_as_partial(phone, capture, monkeypatch):
    monkeypatch.setattr(telephone, "PATIENCE", 1.0)
    phone.mute = (1.2, 1e9)
    with pytest.raises(
        InputError, match="marked partial: disconnected: the port went away .no answer for 1 s"
    ):
        capture(duration_s=5.0)
    assert dataset.read(NC).sizes["time"] > 10


def test_a_slow_telephone_is_followed(phone, capture):
    phone.slow = 0.3
    assert "complete: 200 of 200 samples" in capture(duration_s=2.0)


def do(phone, what):
    def session():
        phone.session = "fedcba"

    def other():
        phone.session, phone.foreign = "fedcba", True

    def pause():
        phone.command("stop")
        phone.command("start")

    def anew():
        phone.command("clear")
        phone.command("start")

    def iphone():
        phone.iphone = True
        anew()

    did = {"another": session, "other": other, "clear": anew, "iphone": iphone, "pause": pause}
    return did.get(what, lambda: phone.command(what))


@pytest.mark.parametrize(
    ("what", "told"),
    [
        ("stop", "the recording was stopped on the telephone"),
        ("pause", "the recording was stopped on the telephone"),
        ("another", "another experiment was opened on the telephone"),
        ("other", "another experiment was opened on the telephone"),
        ("clear", "the data were cleared on the telephone"),
        ("iphone", "the data were cleared on the telephone"),
    ],
)
def test_what_is_done_on_the_telephone_ends_it_as_partial(phone, capture, what, told):
    phone.events = [(1.6, do(phone, what))]
    with pytest.raises(InputError, match=told) as refused:
        capture(duration_s=4.0)
    assert "marked partial" in str(refused.value)
    data = dataset.read(NC)
    assert data.attrs["status"] == "disconnected" and 0.3 < data["time"].values[-1] < 1.5


@pytest.mark.parametrize("text", ["<html>no JSON</html>", '{"buffer": {}}', '{"buffer": 3, "status": []}'])
def test_answers_that_are_none_are_no_samples(phone, capture, monkeypatch, text):
    monkeypatch.setattr(telephone, "PATIENCE", 1.0)
    phone.text = (1.4, text)
    with pytest.raises(
        InputError, match="marked partial: disconnected: the port went away .no answer for 1 s"
    ):
        capture(duration_s=4.0)
    assert np.abs(dataset.read(NC)["rate"].values).max() < 2


def test_values_that_are_no_numbers_and_samples_that_lack_are_lost_and_told(phone, capture):
    phone.lacking, phone.hole = (1.5, 1.55), (1.8, 1.9)
    with pytest.raises(InputError, match="15 frames lost and 0 damaged"):
        capture(duration_s=2.0)
    assert np.isfinite(dataset.read(NC)["rate"].values).all()


def test_a_clock_that_jumps_ends_it(phone, capture):
    phone.jumps = (1.6, 1000.0)
    with pytest.raises(InputError, match="its clock jumped"):
        capture(duration_s=3.0)


def test_ctrl_c_ends_and_keeps_it(phone, capture):
    stop = threading.Event()
    threading.Timer(2.0, stop.set).start()
    assert "a: stopped, PARTIAL" in capture(stop=stop, duration_s=20.0)
    time.sleep(0.1)
    assert phone.commands[-1] == "stop" and not phone.measuring


def refused(phone, **more):
    with pytest.raises(InputError) as problem:
        source.connect(source.completed({**SETTINGS, "port": phone.port, **more}))
    return str(problem.value)


def test_a_telephone_that_records_already_is_left_alone(phone):
    phone.command("start")
    assert "recording already" in refused(phone) and "a capture clears it" in refused(phone)
    assert phone.commands == ["start"]


def test_a_timed_run_is_refused(phone):
    phone.timed = True
    assert "switch the timed run off" in refused(phone)
    assert phone.commands == []


def test_nothing_moves_and_no_axis_is_named(phone):
    phone.still_until = 1e9
    told = refused(phone)
    assert re.search(r"x 0\.00\d+, y 0, z 0\.00\d+ rad/s RMS", told) and "signal_column: y" in told
    assert phone.commands == ["clear", "start", "stop"]


@pytest.mark.parametrize(
    ("config", "told"),
    [
        ({"title": "Acceleration", "inputs": [{"source": "accelerometer", "outputs": [{"x": "accX"}, {"t": "acc_time"}]}], "export": []},
         "'Acceleration' on .* exports no gyroscope.*open .Gyroscope"),
        ({"title": "own", "inputs": [INPUT], "export": [{"set": "s", "sources": EXPORT[0]["sources"][1:]}]}, "exports no gyroscope with its time"),
        ({"title": "own", "inputs": [{"source": "gyroscope", "outputs": None}], "export": EXPORT}, "exports no gyroscope"),
        ({"hello": 1}, "not phyphox, or an old one"),
        ("<html>a router</html>", "no phyphox answers at"),
        ([], "not phyphox"),
    ],
)  # fmt: skip
def test_what_is_no_gyroscope_in_phyphox_is_told_with_its_mend(phone, config, told):
    phone.config = config
    with pytest.raises(InputError, match=told):
        source.connect(source.completed({**SETTINGS, "port": phone.port}))
    assert phone.commands == []


def test_nobody_at_the_address_is_told_with_the_mend(phone):
    phone.close()
    told = refused(phone)
    assert "Connection refused" in told and "same network" in told and "Allow remote access" in told


@pytest.mark.parametrize(
    ("more", "told"),
    [
        ({"port": "phyphox://"}, "no address of a telephone"),
        ({"port": "phyphox://host:port"}, "no address of a telephone"),
        ({"port": "phyphox://host/get?gyrY"}, "no address of a telephone"),
        ({"signal_unit": "deg"}, "gives rad/s and capture.signal_unit is deg"),
        ({"signal_column": "roll"}, r"has no 'roll'. Expected: x .gyrX., y .gyrY., z .gyrZ."),
    ],
)
def test_settings_that_no_telephone_has(phone, more, told):
    with pytest.raises(InputError, match=told):
        source.connect(source.completed({**SETTINGS, "port": phone.port, **more}))


@pytest.mark.slow("a capture by the workflow")
def test_the_capture_rule_takes_a_telephone(phone, snakemake, tmp_path):
    (tmp_path / "study.yaml").write_text(
        f"recordings: recordings.csv\ncapture: {{port: '{phone.port}', duration_s: 2, emulated: true}}\n"
    )
    done = snakemake(
        "capture", "--configfile", tmp_path / "study.yaml", "--config", "recording=swing", directory=tmp_path
    )
    assert "swing: complete: 200 of 200 samples" in done.stdout
    assert "gyrY of the telephone" in done.stdout
