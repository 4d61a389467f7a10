"""Several recordings in one go, and the signal without any: one port that stays open, and a person who is led along."""

import io
import threading
import time
from pathlib import Path

import numpy as np
import pytest
import yaml
from traffic import SETTINGS, Line, frame

from swingdown import dataset
from swingdown.capture import job as jobs
from swingdown.capture import monitor, recording, session, source
from swingdown.capture.guide import Guide
from swingdown.capture.takes import takes
from swingdown.errors import InputError
from swingdown.measurement.sheet import read_sheet

FOLDER = Path("resources/recordings")


class Board(Line):
    """A board that sends ``signal(s)`` as frames at 100 S/s until it is unplugged."""

    def __init__(self, signal):
        super().__init__()
        self.sent, self._signal, self._stop = 0, signal, threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self):
        begun = time.monotonic()
        while not self._stop.is_set():
            while self.sent < 100 * (time.monotonic() - begun):
                self.send(frame(self.sent, int(self._signal(self.sent / 100))))
                self.sent += 1
            time.sleep(0.01)

    def close(self):
        self._stop.set()
        super().close()

    unplug_now = close


class Hand:
    """A keyboard at which Enter is pressed at once."""

    there, pressed = True, 0

    def enter(self):
        self.pressed += 1
        return True

    def close(self):
        pass


@pytest.fixture
def board(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    made = []

    def make(signal):
        made.append(Board(signal))
        return made[-1]

    yield make
    for one in made:
        one.close()


def asked(board, config, **capture):
    settings = {
        **SETTINGS,
        "port": board.port,
        "duration_s": 0.6,
        "still_s": 0.4,
        "countdown_s": 0.1,
        **capture,
    }
    complete = {"recordings": "sheet.csv", "apparatus": "apparatus.yaml", "capture": settings, **config}
    return [jobs.job(complete | take, again=True) for take in takes(complete)]


def run(made, keyboard=None, stop=None, seconds=0.1):
    """What was said, in a session of the Jobs."""
    said, stop = [], stop or threading.Event()
    stream = io.StringIO()
    guide = Guide(seconds, stop, keyboard or Hand(), stream)
    try:
        said.append(session.run(made, guide, stop=stop, say=said.append))
    finally:
        said.append(stream.getvalue())
    return "\n".join(said)


def swings(t):
    """Free, and never held."""
    return 500 + 200 * np.cos(7.25 * t)


def held_and_let_go(t):
    """Held for 0.8 s, then free for 1.2 s; again and again."""
    t %= 2.0
    return 700 if t < 0.8 else 500 + 200 * np.cos(7.25 * (t - 0.8))


def test_towers_rest_and_swings_in_one_go(board, monkeypatch):
    """The port is opened once; each recording is on disk, and in its sheet, as it ends."""
    opened, connect = [], source.connect
    monkeypatch.setattr(source, "connect", lambda settings: opened.append(1) or connect(settings))
    Path("apparatus.yaml").write_text("lengths: {}\npoints: []\n")
    plan = [
        {"recording": "tower", "height": 0.024},
        {"recording": "rest", "role": "static"},
        {"recording": "swing", "count": 3},
    ]
    trigger = {"threshold": 10, "pre_s": 0.2, "wait_s": 10}
    made = asked(board(held_and_let_go), {"session": True}, takes=plan, trigger=trigger)
    said = run(made)
    assert len(opened) == 1 and "5 of 5 recorded" in said
    table = read_sheet("sheet.csv")
    assert (
        list(table.index) == ["rest", "swing-01", "swing-02", "swing-03"]
        and table.loc["rest"].role == "static"
    )
    (point,) = yaml.safe_load(Path("apparatus.yaml").read_text())["points"]
    assert point["height"] == 0.024 and "tower" in point["file"]
    for number in (1, 2, 3):
        data = dataset.read(FOLDER / f"swing-0{number}.nc")
        assert data.attrs["partial"] == "no" and data.sizes["time"] == 80
        assert data["sent"].values[data["time"].values >= 0][0] >= 699  # from the release on
    starts = [dataset.read(FOLDER / f"swing-0{k}.nc")["sequence"].values[0] for k in (1, 2, 3)]
    assert np.all(np.diff(starts) >= 80)
    for told in (
        "tower (1 of 5): rest the bob on the tower of 0.024 m",
        "Press Enter",
        "swing-02 (4 of 5): lift the bob",
    ):
        assert told in said


def test_a_prompt_shows_the_signal_at_once_however_long_the_board_takes_to_settle(board):
    """The port has been open since the session began: what comes while somebody is asked is the signal of now."""

    class Looking:
        def prompt(self, text, wait, look):
            until = time.monotonic() + 0.5
            while time.monotonic() < until:
                seen.append(look())
            return False

        def close(self):
            pass

    seen = []
    session.run(asked(board(lambda t: 640), {"recording": "a"}, settle_s=5), Looking(), say=seen.append)
    assert seen[-1].startswith("640.0000 V")


def test_a_session_goes_on_where_it_was_left_and_overwrites_nothing(board):
    line = board(swings)
    said = run(asked(line, {"recording": "a,b"}))
    assert "2 of 2 recorded" in said
    before = (FOLDER / "a.nc").read_bytes()
    said = run(asked(line, {"recording": "a,b,c"}))
    assert "a: there already" in said and "1 of 1 recorded" in said
    assert (FOLDER / "a.nc").read_bytes() == before and list(read_sheet("sheet.csv").index) == ["a", "b", "c"]
    with pytest.raises(InputError, match="all 3 recordings are there already"):
        run(asked(line, {"recording": "a,b,c"}))


def test_ctrl_c_at_a_prompt_ends_the_session_and_keeps_what_there_is(board):
    class Reluctant(Hand):
        there = True

        def enter(self):
            self.pressed += 1
            if self.pressed > 1:
                stop.set()
            return self.pressed == 1

    stop = threading.Event()
    said = run(asked(board(swings), {"recording": "a,b,c"}), Reluctant(), stop, seconds=0)
    assert "1 of 3 recorded; not yet: b, c (the same command goes on with them)" in said
    assert [path.name for path in FOLDER.iterdir()] == ["a.nc"]


def test_one_that_fails_does_not_stop_the_others_and_is_told_at_the_end(board):
    """Nobody lets go for the first."""
    trigger = {"threshold": 10, "pre_s": 0.2, "wait_s": 0.5}
    line = board(lambda t: 500 + round(20 * t) % 2)
    made = asked(line, {"recording": "a"}, trigger=trigger) + asked(line, {"recording": "b"})
    with pytest.raises(InputError, match="1 of 2 recorded; not whole, or not at all: a"):
        run(made)
    assert (FOLDER / "b.nc").exists() and not (FOLDER / "a.nc").exists()


def test_what_an_earlier_capture_left_unfinished_is_told_before_the_bob_is_lifted(board):
    """The session goes on with the others; the command that is told makes a recording of what there is."""
    trigger = {"threshold": 10, "pre_s": 0.2, "wait_s": 0.5}
    line = board(swings)
    with pytest.raises(InputError, match="--config recording=a recover=true"):
        recording.capture(*asked(line, {"recording": "a"}, trigger=trigger))
    hand, said = Hand(), []
    guide = Guide(0.1, threading.Event(), hand, io.StringIO())
    with pytest.raises(InputError, match="1 of 2 recorded; not whole, or not at all: a"):
        session.run(asked(line, {"recording": "a,b"}), guide, say=said.append)
    assert "a.raw" in said[0] and "`--config recording=a recover=true` makes a recording of it" in said[0]
    assert hand.pressed == 2 and (FOLDER / "b.nc").exists()  # Enter for b alone, and for its countdown
    with pytest.raises(InputError, match="0 of 1 recorded; not whole, or not at all: a"):
        run(asked(line, {"recording": "a,b"}))


def test_a_board_that_is_unplugged_between_two_recordings_ends_the_session(board):
    line = board(swings)

    class Unplugging(Hand):
        def enter(self):
            self.pressed += 1
            if self.pressed == 2:
                line.close()
            return self.pressed == 1

    with pytest.raises(InputError, match="the port went away before b.*goes on with what is not there yet"):
        run(asked(line, {"recording": "a,b"}), Unplugging(), seconds=0)
    assert dataset.read(FOLDER / "a.nc").attrs["partial"] == "no"


def watched(line, seconds, **capture):
    """The lines of a monitor at the end of some seconds."""
    shown, stop = [], threading.Event()
    threading.Timer(seconds, stop.set).start()
    settings = {**SETTINGS, "port": line.port, "timeout_s": 2, **capture}
    last = monitor.watch(settings, shown.append, stop)
    return "\n".join(shown[-1]), last


def test_the_monitor_shows_the_signal_and_records_nothing(board):
    line = board(lambda t: 4000 + 500 * np.cos(7.25 * t))
    trigger = {"threshold": 20, "pre_s": 0.2, "wait_s": 10}
    shown, last = watched(
        line,
        4.5,
        signal_unit="counts",
        counts_per_revolution=4000,
        rate_hz=100,
        trigger=trigger,
        range=[0, 4499],
    )
    degrees = float(shown.split(" | ")[1].split(" deg")[0])
    assert 315 <= degrees <= 405 and "threshold 20: it will arm" in shown
    assert 95 < float(shown.split(" S/s by this computer")[0].split()[-1]) < 105 and "rate_hz 100" in shown
    assert float(shown.split("amplitude ")[1].split(" ")[0]) == pytest.approx(500, abs=3)
    assert float(shown.split("period ")[1].split(" ")[0]) == pytest.approx(2 * np.pi / 7.25, rel=0.01)
    assert "SATURATED" in shown and "nothing was recorded" in last
    assert not FOLDER.exists() and not Path("sheet.csv").exists()


def test_the_monitor_tells_noise_above_the_threshold_and_silence(board):
    random = np.random.default_rng(3)
    line = board(lambda t: 500 + 8 * random.standard_normal())
    shown, _ = watched(line, 1.5, trigger={"threshold": 20, "pre_s": 0.2, "wait_s": 10})
    assert "ABOVE IT" in shown and "raise it to" in shown
    line._stop.set()
    shown, _ = watched(line, 1.5)
    assert "nothing yet" in shown


def test_the_monitor_is_ended_by_a_board_that_goes_away(board):
    line = board(swings)
    threading.Timer(0.7, line.close).start()
    with pytest.raises(InputError, match="the port went away.*plug it in"):
        watched(line, 5)
