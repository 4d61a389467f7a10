"""The window while recording: opened where there is a screen, and a clear word where there is none."""

import os
import shutil
import subprocess
import sys

import pytest

WATCH = """
import numpy as np
from matplotlib import pyplot
from swingdown.plots.live import Window

window = Window("swing-07", "V", lambda count: f"{count} samples | 0 lost", lambda count: ([-1.0, 0.0], [2.0, float(count)]))
window.show(4)
window.show(5)
figure = pyplot.figure("swing-07")
(axes,) = figure.axes
print(axes.get_title(loc="left"), axes.lines[0].get_ydata(), axes.get_ylabel(), np.asarray(figure.canvas.buffer_rgba()).std() > 1)
pyplot.close(figure)
window.show(6)  # closed by the experimenter: the recording goes on
window.close()
print("closed")
"""


def watch(**environment):
    kept = {key: value for key, value in os.environ.items() if key not in ("DISPLAY", "WAYLAND_DISPLAY")}
    return subprocess.run(
        [sys.executable, "-c", WATCH], env=kept | environment, capture_output=True, text=True, timeout=100
    )


@pytest.fixture
def screen():
    """The name of a screen that nobody looks at."""
    if not shutil.which("Xvfb"):
        pytest.skip("NOT TESTED: no Xvfb for a window while recording (tools/install-test-tools)")
    read, write = os.pipe()
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", str(write), "-screen", "0", "1200x700x24"],
        pass_fds=[write],
        stderr=subprocess.DEVNULL,
    )
    name = b""
    while not name.endswith(b"\n"):
        name += os.read(read, 16)
    yield f":{name.decode().strip()}"
    server.terminate()
    server.wait()


def test_the_window_shows_counts_and_trace_and_may_be_closed(screen):
    done = watch(DISPLAY=screen)
    assert "5 samples | 0 lost [2.0, 5.0] signal (V) True" in done.stdout, done.stdout + done.stderr
    assert "closed" in done.stdout


@pytest.mark.parametrize(
    ("environment", "told"), [({}, "there is no screen"), ({"DISPLAY": ":9999"}, "no window can be opened")]
)
def test_without_a_screen_it_is_told(environment, told):
    done = watch(**environment)
    assert f"OSError: {told}" in done.stderr
