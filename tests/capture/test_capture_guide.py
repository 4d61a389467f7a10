"""The experimenter's Enter key and countdown, at a terminal and without one."""

import io
import os
import pty
import threading
import types

import pytest

from swingdown.capture import guide
from swingdown.capture.guide import Guide, Keyboard


@pytest.fixture
def line():
    """A terminal's own end, and the path of the other."""
    ours, theirs = pty.openpty()
    yield ours, os.ttyname(theirs)
    os.close(ours)
    os.close(theirs)


def entered(keyboard, ours, text):
    """Whether the keyboard tells a line, once what was typed has come."""
    os.write(ours, text)
    return any(keyboard.enter() for _ in range(1000))


def test_enter_is_told_once_each_time_that_it_is_pressed(line):
    ours, path = line
    keyboard = Keyboard(path)
    assert keyboard.there and not keyboard.enter()  # nothing was typed, and the key is still there
    for _ in range(2):
        assert keyboard.there and entered(keyboard, ours, b"\n")
        assert not keyboard.enter()
    keyboard.close()
    assert not keyboard.there and not keyboard.enter()


def test_without_a_terminal_nobody_presses_enter(tmp_path):
    keyboard = Keyboard(str(tmp_path / "none"))
    assert not keyboard.there and not keyboard.enter()
    keyboard.close()


class Still:
    """A keyboard that nobody touches, but for Enter at some looks."""

    def __init__(self, pressed=()):
        self.looks, self.pressed, self.there = 0, pressed, True

    def enter(self):
        self.looks += 1
        return self.looks in self.pressed

    def close(self):
        pass


class Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.fixture
def clock(monkeypatch):
    """Time that goes on by a quarter of a second with each look, and by next to nothing else."""
    now = [0.0]

    def monotonic():
        now[0] += 1e-6
        return now[0]

    monkeypatch.setattr(guide, "time", types.SimpleNamespace(monotonic=monotonic))
    monkeypatch.setenv("TERM", "xterm")

    def look():
        now[0] += 0.25
        return f"after {now[0]:.2f} s"

    return look


def test_a_terminal_counts_down_and_beeps_for_each_of_the_last_three_seconds(clock):
    shown = Terminal()
    assert Guide(5, threading.Event(), Still(), shown).prompt("let go", wait=False, look=clock)
    said = shown.getvalue()
    assert said.startswith("\n>>> let go\n") and "Press Enter" not in said
    for left in (5, 4, 3, 2, 1):
        assert said.count(f"in {left} s ... after") == 4  # drawn at each look
        assert said.count(f"\ain {left} s ...") == (left <= 3)
    assert "in 0 s" not in said and "in 6 s" not in said


def test_elsewhere_each_second_is_a_line_and_nothing_beeps(clock):
    shown = io.StringIO()
    assert Guide(3, threading.Event(), Still(), shown).prompt("let go", wait=False, look=clock)
    assert shown.getvalue() == "\n>>> let go\n    in 3 s ...\n    in 2 s ...\n    in 1 s ...\n"


def test_enter_begins_the_countdown_and_once_more_ends_it(clock):
    shown = io.StringIO()
    keyboard = Still(pressed=(3, 5))
    assert Guide(60, threading.Event(), keyboard, shown).prompt("lift it", wait=True, look=clock)
    assert keyboard.looks == 5 and "Press Enter when it is so" in shown.getvalue()


@pytest.mark.parametrize("wait", [True, False])
def test_a_session_that_is_stopped_counts_down_no_further(clock, wait):
    stop = threading.Event()

    def look():
        stop.set()
        return clock()

    assert not Guide(60, stop, Still(), io.StringIO()).prompt("lift it", wait, look)
    assert clock() == "after 0.50 s"  # it looked once


def test_a_session_without_a_keyboard_waits_for_none(clock):
    keyboard = Still()
    keyboard.there = False
    shown = io.StringIO()
    assert Guide(1, threading.Event(), keyboard, shown).prompt("lift it", wait=True, look=clock)
    assert "Press Enter" not in shown.getvalue()
