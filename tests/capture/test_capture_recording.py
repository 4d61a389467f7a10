"""From a port to a file and a row: what a fault leaves behind, and that nothing is ever overwritten."""

import os
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from one_recording import NC, RAW, SWING, row, swing
from traffic import frame

from swingdown import dataset
from swingdown.capture import recording, take
from swingdown.capture.journal import read_journal
from swingdown.errors import InputError
from swingdown.measurement.recording import ingest


def test_a_recording_lands_in_its_file_and_in_the_sheet(record):
    told = record(swing())
    assert "a: complete: 100 of 100 samples" in told and "0 lost, 0 damaged" in told and "sheet.csv" in told
    found = ingest(row(), "sheet.csv")
    assert found["signal"].values == pytest.approx(SWING)
    assert found["time"].values == pytest.approx(np.arange(100) / 100)
    assert found.attrs["emulated"] == "yes" and found.attrs["campaign"] == "mine"
    assert not RAW.exists() and [path.name for path in NC.parent.iterdir()] == ["a.nc"]


def test_lines_as_an_arduino_prints_them(record):
    """``Serial.print(millis()); Serial.print(","); Serial.println(angle)`` of a sketch that greets and is not quite regular."""
    late = [10 * k + (k % 3 == 0) for k in range(110)]
    text = [b"%d,%.2f\r\n" % (5000 + late[k], SWING[k % 100] / 10) for k in range(110)]
    pieces = [(0, b"pendulum 1.0\r\n"), *((0.1, b"".join(text[k : k + 10])) for k in range(0, 110, 10))]
    told = record(pieces, format="csv", columns=["time_ms", "angle"], signal_unit="deg")
    assert "a: complete: 100 of 100 samples" in told
    found = ingest(row(), "sheet.csv")
    assert found["signal"].attrs["units"] == "deg"
    assert found["signal"].values == pytest.approx(np.array(SWING) / 10, abs=0.01)
    # the swing is smooth over even times, and the device's stamps are up to a millisecond late
    assert "as of a computer that was late" in found.attrs["remarks"]
    assert found["time"].values == pytest.approx((np.array(late[:100]) - 1) / 1000, abs=1e-3)
    assert np.diff(found["time"].values) == pytest.approx(0.01, rel=1e-3)


def test_unplugged_in_the_middle_of_a_frame(record):
    with pytest.raises(InputError, match="kept and marked partial: disconnected") as caught:
        record([*swing()[:4], (0.1, frame(40, 400)[:5])], unplug=True)
    assert "40 came" in str(caught.value) and "allow" in str(caught.value)
    data = dataset.read(NC)
    assert data.attrs["status"] == "disconnected" and data.attrs["expected"] == 100
    assert list(data["sent"].values) == SWING[:40]


def test_partial_recordings_are_refused_unless_the_sheet_allows_them(record):
    with pytest.raises(InputError):
        record(swing()[:4], unplug=True)
    with pytest.raises(
        InputError, match=r"sheet.csv, line 2, a, column partial.*the recording is partial.*40 of 100.*allow"
    ):
        ingest(row(), "sheet.csv")
    text = Path("sheet.csv").read_text()
    Path("sheet.csv").write_text(text.rstrip("\n") + "allow\n")
    found = ingest(row(), "sheet.csv")
    assert found.sizes["time"] == 40 and found.attrs["partial"] == "yes"


def test_a_gap_of_lost_frames_is_partial_and_keeps_its_place_in_time(record):
    pieces = swing()
    with pytest.raises(InputError, match="10 frames lost and 0 damaged of 100"):
        record([*pieces[:4], (0.1, b""), *pieces[5:]])
    Path("sheet.csv").write_text(Path("sheet.csv").read_text().rstrip("\n") + "allow\n")
    found = ingest(row(), "sheet.csv")
    assert found["time"].values == pytest.approx(np.r_[0:40, 50:100] / 100)


def test_silence_from_the_beginning(record, line):
    with pytest.raises(
        InputError, match=r"nothing was recorded: timed out: for 0\.[5-9] s nothing came.*resources/firmware"
    ):
        record()
    assert not NC.exists() and not RAW.exists() and not Path("sheet.csv").exists()


def test_bytes_that_are_no_frames(record):
    with pytest.raises(InputError, match=r"400 bytes arrived and no whole frames sample.*capture.format"):
        record([(0.1, b"12,512\r\n" * 50)])


def swing_with(what, before=5):
    """The pieces of a swing, and something that happens before the one of this number, when the one ahead of it has arrived."""
    pieces = swing()
    for k, piece in enumerate([*pieces, (0, b"")]):
        if k == before:
            while pieces[k - 1][1] not in RAW.read_bytes():
                time.sleep(0.01)
            what()
        yield piece


def test_a_stop_before_the_end(record):
    stop = threading.Event()
    told = record(swing_with(stop.set), stop=stop)
    assert "a: stopped, PARTIAL" in told and "early" in told
    assert dataset.read(NC).attrs["status"] == "stopped"


def test_a_stop_where_no_duration_is_fixed_is_a_whole_recording(record):
    stop = threading.Event()
    told = record(swing_with(stop.set, 10), stop=stop, duration_s=None, timeout_s=2)
    assert "a: stopped: 100 of 100 samples" in told
    ingest(row(), "sheet.csv")


def test_a_recording_is_never_overwritten(record):
    record(swing())
    before = NC.read_bytes()
    with pytest.raises(
        InputError, match=r"a\.nc: there is a recording of this name, and .* never overwritten"
    ):
        record(swing())
    assert NC.read_bytes() == before


def test_not_even_one_that_appears_while_it_is_recorded(record):
    with pytest.raises(InputError, match="never overwritten"):
        record(swing_with(lambda: NC.write_text("mine")))
    assert NC.read_text() == "mine"
    assert sum(len(data) for _, data in read_journal(RAW)[1]) == 800  # and what was recorded is kept


def test_nor_one_that_appears_in_the_last_moment(record, monkeypatch):
    record(swing())
    before = NC.read_bytes()
    monkeypatch.setattr(take, "check_absent", lambda path: None)
    with pytest.raises(InputError, match="never overwritten"):
        take.write_new(dataset.read(NC), NC)
    assert NC.read_bytes() == before and [path.name for path in NC.parent.iterdir()] == ["a.nc"]


@pytest.mark.parametrize(
    ("sheet", "told"),
    [
        ("recording,file\na,x.csv\n", "has a row 'a' already"),
        ("recording,fiel\nb,x.csv\n", "column fiel: unknown column"),
    ],
)
def test_a_sheet_that_cannot_take_the_row_is_told_before_the_swing(record, sheet, told):
    Path("sheet.csv").write_text(sheet)
    with pytest.raises(InputError, match=told):
        record(swing())
    assert not NC.exists() and Path("sheet.csv").read_text() == sheet


def test_a_folder_one_may_not_write_is_told_before_the_swing(record, tmp_path):
    root = os.geteuid() == 0
    os.chmod(tmp_path, 0o555)
    if root:
        os.seteuid(65534)
    try:
        with pytest.raises(InputError, match="you may not write to it"):
            record(swing())
    finally:
        if root:
            os.seteuid(0)
        os.chmod(tmp_path, 0o755)


def test_a_rate_that_changes_is_told_and_the_times_are_those_of_the_bob(record, line):
    """110 then 90 samples a second: 100 on average, and each time in between would be wrong by up to 0.27 s."""
    true = np.concatenate([np.arange(300) / 110, 300 / 110 + np.arange(320) / 90])
    values = np.round(500 + 300 * np.cos(6 * true)).astype(int)
    pauses = np.diff(true, prepend=0)
    pieces = [(pauses[k], frame(k, int(values[k]))) for k in range(len(true))]
    told = (
        r"1\d\d.* until 2|most 1[01]\d.* at \d.*, least (8|9)\d.* at"  # a busy host's clock sees more courses
    )
    with pytest.raises(
        InputError, match=f"marked partial: the board's rate changes, by the host's clock: ({told})"
    ):
        record(pieces, duration_s=6)
    data = dataset.read(NC)
    assert np.std(data["time"].values - true[:600]) < 0.02
    assert data.attrs["status"] == "complete" and "times are corrected" in data.attrs["remarks"]


def test_a_board_that_is_ten_times_too_slow_does_not_hold_the_recording_up(record):
    begun = time.monotonic()
    pieces = [(0.1, frame(k, SWING[k])) for k in range(60)]
    with pytest.raises(
        InputError,
        match=r"timed out: 2\d samples came in 2.* s, (9|10)\.?\d* a second, where 200 should in 2 s",
    ):
        record(pieces, duration_s=2)
    assert time.monotonic() - begun < 5
    data = dataset.read(NC)
    assert data.attrs["status"] == "timed out" and list(data["sent"].values) == SWING[: data.sizes["time"]]


def test_a_port_that_answers_nothing_at_all_ends_too(record, monkeypatch):
    """A driver that hangs in a read: the thread that waits for it says nothing more."""
    hung = threading.Event()

    class Hung:
        name, rate, what, events = "hung", None, "", ()

        def read(self):
            hung.wait(30)
            return b""

        def close(self):
            hung.set()

    monkeypatch.setattr(recording.source, "connect", lambda settings: Hung())
    with pytest.raises(InputError, match="timed out: for 0.* s the port did not answer"):
        record()


def test_a_sensor_at_its_rail_is_told_at_once(record):
    with pytest.raises(
        InputError, match="all 100 samples are 1023 V: a sensor at its rail, or not connected"
    ):
        record(swing([1023] * 110))
    assert dataset.read(NC).attrs["partial"] == "yes"


def test_a_bob_at_rest_may_be_read_as_one_value(record):
    told = record(swing([512] * 110), role="static", still_s=1.0)
    assert "a: complete: 100 of 100 samples" in told
