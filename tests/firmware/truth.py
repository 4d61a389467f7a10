"""An emulated board that is set up, and what was recorded from it held against what was there."""

import board as boards
import numpy as np
import pytest


def made(tmp_path, name, scene, **more):
    """A board in a folder of its own below ``tmp_path``, with times and angles of a scene before its sensor."""
    folder = tmp_path / f"board-{name}"
    folder.mkdir()
    return boards.Board(folder, *scene, **more)


def check_truth(data, board, rate=100):
    """Every recorded reading is the truth within the converter's step, at the time that its sequence number says."""
    volts, cycles, host = board.truth()
    at = data["sequence"].values
    assert np.abs(data["voltage"].values - volts[at]).max() <= boards.STEP
    between = (
        cycles[at[0] : at[-1] + 1] - cycles[at[0]]
    )  # the emulator sees a match after the instruction it falls into
    assert np.abs(between - 16_000_000 / rate * np.arange(len(between))).max() <= 2
    clock = (cycles[at] - cycles[at[0]]) / 16e6
    passed = data["time"].values - data["time"].values[0]
    if "corrected" not in data["time"].attrs["long_name"]:
        assert passed == pytest.approx(clock, abs=2e-7)
        return
    # On a busy machine the emulator falls behind real time, and the host's clock corrects that. What it catches up looks like a host
    # that is late, so the promptest sample of each tenth counts. Held up as it was asked to be, these agreed within 3 standard
    # uncertainties; where the machine itself stops the emulator, as no board is, they may be wrong by as much as it does.
    # In the jerk that begins to hold it up the emulator stops between two samples: which of the rates theirs is nobody can tell.
    begins = np.abs(cycles[at] - cycles[0] - 16e6 * board.held_up) <= 16e6 * 0.05
    late = (host[at] - host[at[0]] - passed)[~begins]
    promptest = [tenth.min() for tenth in np.array_split(late, 10)]
    assert np.ptp(promptest) <= 5 * data.attrs["time_standard_uncertainty_s"] + jolted(board, at)


def jolted(board, at):
    """By how much (s) the machine stopped the emulator and let it go in samples ``at``, unasked, at worst.

    How far the promptest sample of each thirtieth lies beside the line through those before and after it: 0.1 ms on a quiet machine.
    """
    _, cycles, host = board.truth()
    moment = (cycles - cycles[0]) / 16e6
    late = host - host[0] - moment
    parts = [part[np.argmin(late[part])] for part in np.array_split(at, 30)]
    worst = 0.0
    for before, here, after in zip(parts, parts[1:], parts[2:], strict=False):
        if (
            not moment[before] - 0.1 < board.held_up < moment[after] + 0.1
        ):  # there it bends as it was asked to
            line = np.interp(moment[here], moment[[before, after]], late[[before, after]])
            worst = max(worst, abs(late[here] - line))
    return worst
