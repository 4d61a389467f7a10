"""What is seen while a recording goes on: one line of state, a line of help, the trace, and drawing over itself."""

import io
import os

import numpy as np
import pytest
from traffic import SETTINGS, frame

from swingdown.capture import live, monitor
from swingdown.capture.recorder import Recorder

TRIGGER = {"threshold": 5, "pre_s": 0.2, "wait_s": 30}


def recorder(values=(), lost=(), **more):
    """A Recorder that was fed these values at 100 S/s, without the frames of the indices ``lost``."""
    made = Recorder({**SETTINGS, **more}, 100.0)
    for k, value in enumerate(values):
        if k not in lost:
            made.feed(frame(k, int(value)), 100 + k / 100)
    return made


SWING = np.round(500 + 300 * np.cos(2 * np.pi * np.arange(400) / 130))
DYING = np.round(500 + 300 * 0.98 ** (np.arange(1900) / 130) * np.cos(2 * np.pi * np.arange(1900) / 130))
SAID = "amplitude 227 V | period 1.3000 s | each swing loses 2.02%, over the last 10"


def test_one_line_tells_state_time_samples_rate_and_losses():
    assert live.status(recorder()) == "opening the port ..."
    assert live.status(recorder([500] * 10, trigger=TRIGGER)) == "HOLD THE BOB STILL where you will let it go"
    assert live.status(recorder([500] * 150, trigger=TRIGGER)) == "ARMED: let go | 100.0 S/s"
    going = recorder(SWING[:251], lost=(20, 21, 90), duration_s=6.0)
    assert live.status(going) == "RECORDING (Ctrl-C stops) | 2.5 s | 248 of 600 samples | 100.0 S/s | 3 lost, 0 damaged"  # fmt: skip
    open_end = recorder(SWING[:51], duration_s=None)
    assert live.status(open_end) == "RECORDING (Ctrl-C stops) | 0.5 s | 51 samples | 0 lost, 0 damaged"
    assert live.status(recorder(SWING, duration_s=1.0)).startswith("ended: complete | 1.0 s | 100 of 100")


def test_a_second_line_tells_why_it_does_not_arm_and_then_the_swing():
    restless = live.hint(recorder([500, 520] * 10, trigger=TRIGGER))
    assert restless.startswith("noise of 16.3 V spreads over 73.5 V, beyond capture.trigger.threshold (5): raise it to 1.5e+02")  # fmt: skip
    slow = recorder(np.linspace(500, 520, 60), trigger=TRIGGER)
    assert live.hint(slow) == "it moves by 7 V; still is below 5 for 0.2 s"
    assert live.hint(recorder(trigger=TRIGGER)) == ""
    assert live.hint(recorder(SWING, duration_s=None)).startswith("amplitude 300 V | period 1.300")
    assert live.measured(recorder(DYING, duration_s=None), 20) == SAID


def test_the_trace_has_the_newest_sample_at_the_right_and_the_highest_on_top():
    times = np.linspace(-live.SECONDS, 0, 200)
    rows = live.trace(times, np.linspace(0, 1, 200), 10, 2)
    assert [len(row) for row in rows] == [10, 10]
    filled = [[ord(one) > 0x2800 for one in row] for row in rows]
    assert filled[1][0] and not filled[0][0] and filled[0][-1] and not filled[1][-1]
    assert live.trace([0.0], [1.0], 3, 1) == ["\u2800\u2800\u2808"]
    assert (
        live.trace([-live.SECONDS - 1, 0.0], [1.0, 2.0], 3, 1)[0][-1] == "\u2808"
    )  # what is older is not drawn


def test_the_trace_tells_its_ends_and_of_very_many_samples_shows_a_part():
    lines = live.trace_of(recorder(SWING, duration_s=None, scale=0.5), 50)
    assert lines[0].endswith(" 400 V") and lines[-1].endswith(" 100 V") and len(lines[1]) == 38
    assert live.trace_of(recorder(), 50) == []
    times, values = live.recent(recorder(SWING, duration_s=None), 1.0)
    assert len(times) == len(values) == 101 and times[0] == pytest.approx(-1.0) and times[-1] == 0.0
    fast = Recorder({**SETTINGS, "rate_hz": 10 * live.MOST / live.SECONDS, "duration_s": None}, 100.0)
    fast.order.rows += [type(recorder([1], duration_s=None).rows[0])(k, k * 1e-5, 100.0, k) for k in range(3 * live.MOST)]  # fmt: skip
    fast.first = 0
    _, some = live.recent(fast)
    assert live.MOST / 2 < len(some) <= live.MOST and some[-1] == 3 * live.MOST - 1


class Terminal(io.StringIO):
    def isatty(self):
        return True


def test_a_terminal_is_drawn_over_and_rings_once_when_armed(monkeypatch):
    monkeypatch.setattr(live.shutil, "get_terminal_size", lambda *_, **__: os.terminal_size((81, 24)))
    monkeypatch.setenv("TERM", "xterm")
    stream = Terminal()
    view, made = live.TerminalView(stream), recorder([500] * 150, trigger=TRIGGER)
    view.show(made)
    first = stream.getvalue()
    assert first.startswith("\a\x1b[2KARMED") and all(len(line) <= 80 + 4 for line in first.splitlines())
    view.show(made)
    again = stream.getvalue()[len(first) :]
    assert again.startswith(f"\x1b[{first.count(chr(10))}F") and "\a" not in again
    view.lines(["one"])  # what stood below is wiped
    assert stream.getvalue().count("\x1b[2K\n") == first.count("\n") - 1


def test_elsewhere_a_line_is_written_now_and_then_without_the_trace(monkeypatch):
    now = [100.0]
    monkeypatch.setattr(live.time, "monotonic", lambda: now[0])
    stream = io.StringIO()
    view, made = live.TerminalView(stream), recorder(SWING, duration_s=None)
    view.show(made)
    view.show(made)
    assert stream.getvalue().count("\n") == 1 and "RECORDING" in stream.getvalue() and "\x1b" not in stream.getvalue()  # fmt: skip
    now[0] += 60
    view.lines(["one", live.trace([0.0], [1.0], 3, 1)[0], "two"])
    assert stream.getvalue().endswith("one | two\n")


def watched(values, lost=(), **more):
    seen = monitor.Monitor({**SETTINGS, **more}, 100.0)
    for k, value in enumerate(values):
        if k not in lost:
            seen.feed(frame(k, int(value)), 100 + k / 100)
    return seen


def test_the_monitor_tells_value_angle_noise_rates_and_ends():
    assert watched([]).line() == "nothing yet, for 0 s (0 bytes)"
    degrees = {"trigger": TRIGGER, "signal_unit": "deg", "scale": 0.1}
    assert watched([500, 502] * 60, lost=(7,), range=[0, 50.2], **degrees).lines(trace=False) == [
        "50.2000 deg | +50.20 deg | noise 0.16 deg (threshold 5: it will arm)",
        "100.00 S/s by this computer | rate_hz 100 | 1 lost, 0 damaged",
        "SATURATED: 59 of the last samples are at the end of 0 to 50.2",
    ]
    restless = watched([500, 600] * 60, **degrees)
    first, noisy, _ = restless.lines(trace=False)
    assert first.endswith("noise 8.2 deg (threshold 5: ABOVE IT)") and "raise it to 73 at least" in noisy
    for k in range(60):
        restless.feed(b"", 102 + k / 10)
    assert restless.line() == "SILENT for 6 s"
    swing = watched(DYING)
    assert swing.lines(trace=False)[2] == SAID and len(swing.lines()) > 5


@pytest.mark.parametrize(
    ("unit", "more", "degrees"),
    [("deg", {}, 2.0), ("rad", {}, np.degrees(2.0)), ("counts", {"counts_per_revolution": 8}, 90.0), ("counts", {}, None), ("V", {}, None)],
)  # fmt: skip
def test_a_signal_is_an_angle_where_anybody_knows_how(tmp_path, monkeypatch, unit, more, degrees):
    monkeypatch.chdir(tmp_path)
    found = monitor.angle_of({"signal_unit": unit} | more)(2.0)
    assert found == (None if degrees is None else pytest.approx(degrees))
