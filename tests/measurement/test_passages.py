"""Files of passages through a light gate: what is told from the values, what is counted, and what is asked."""

import numpy as np
import pytest

from swingdown.errors import InputError
from swingdown.measurement.recording import ingest
from swingdown.measurement.sheet import COLUMNS

HALF = 0.7
NUMBER = np.arange(60)
T = 1.3 + HALF * NUMBER + 0.001 * np.random.default_rng(5).standard_normal(60)
SPEEDS = 1.5 * np.exp(-0.01 * NUMBER)


def taken(folder, text, **cells):
    """The recording of a file with this text."""
    path = folder / "gate.csv"
    path.write_text(text)
    return ingest({**COLUMNS, "recording": "gate", "file": str(path), **cells})


def column(header, values):
    return "\n".join([header, *(f"{value:.5f}" for value in values), ""])


def columns(header, *values):
    return "\n".join(
        [header, *(",".join(f"{one:.5f}" for one in row) for row in zip(*values, strict=True)), ""]
    )


def edges(width):
    """A gate's states: dark and light again about each passage."""
    lines = [
        f"{t + side * dark / 2:.6f},{int(side < 0)}"
        for t, dark in zip(T, width, strict=True)
        for side in (-1, 1)
    ]
    return "\n".join(["Time (s),Gate State", *lines, ""])


def test_even_times_ask_whether_they_are_half_swings(tmp_path):
    with pytest.raises(InputError, match="is that a half-swing or a whole period"):
        taken(tmp_path, column("t (s)", T))
    assert list(taken(tmp_path, column("t (s)", T), signal_kind="passages")["half_swings"].values) == list(
        NUMBER
    )
    assert list(taken(tmp_path, column("t (s)", T), signal_kind="periods")["half_swings"].values) == list(
        2 * NUMBER
    )


@pytest.mark.parametrize("late", [0.02, 0.2])
def test_uneven_times_are_half_swings_about_a_gate_beside_the_middle(tmp_path, late):
    found = taken(tmp_path, column("t (s)", T + late * (NUMBER % 2)))
    assert found.attrs["kind"] == "passages" and "each half-swing" in found.attrs["taken"]
    assert list(found["half_swings"].values) == list(NUMBER)


def test_passages_that_were_missed_are_counted(tmp_path):
    kept = np.delete(NUMBER, [7, 20, 21])
    found = taken(tmp_path, column("t (s)", T[kept]), signal_kind="passages")
    assert list(found["half_swings"].values) == list(kept)
    assert "3 more were missed" in found.attrs["remarks"]


def test_numbers_beside_the_times_and_no_unit(tmp_path):
    rows = "\n".join(f"{n},{t:.0f}" for n, t in enumerate(1e3 * (T + 0.02 * (NUMBER % 2)), 1))
    found = taken(tmp_path, rows)
    assert "taken for ms" in found.attrs["remarks"]
    assert found["time"].values[0] == pytest.approx(1.3, abs=0.01)


def test_periods_are_summed(tmp_path):
    found = taken(tmp_path, columns("swing,period (s)", NUMBER[1:30], np.diff(T[::2])))
    assert found.attrs["kind"] == "periods" and found["half_swings"].values[-1] == 58
    assert np.ptp(found["time"].values) == pytest.approx(np.ptp(T[::2]), abs=1e-3)
    with pytest.raises(InputError, match="half-swing or a whole period"):
        taken(tmp_path, columns("n,interval (s)", NUMBER[1:30], np.diff(T[::2])))


def test_a_gate_tells_passages_and_how_fast_they_were(tmp_path):
    found = taken(tmp_path, edges(0.02 / SPEEDS))
    assert list(found["half_swings"].values) == list(NUMBER)
    np.testing.assert_allclose(found["time"].values, T, atol=1e-5)
    np.testing.assert_allclose(np.abs(found["signal"].values), SPEEDS / 0.02, rtol=1e-3)


@pytest.mark.parametrize("separator", [",", "\t", ";"])
def test_states_in_words(tmp_path, separator):
    text = (
        edges(0.02 / SPEEDS)
        .replace("Gate State", "State")
        .replace(",1\n", ",Blocked\n")
        .replace(",0\n", ",Unblocked\n")
    )
    found = taken(tmp_path, text.replace(",", separator))
    np.testing.assert_allclose(found["time"].values, T, atol=1e-5)


def test_speeds_that_do_not_fall_hold_no_damping(tmp_path):
    found = taken(tmp_path, edges(np.full(60, 0.02)))
    assert np.isnan(found["signal"].values).all() and "do not fall" in found.attrs["remarks"]


def test_a_bob_that_turns_in_the_gate_ends_the_count(tmp_path):
    found = taken(tmp_path, column("t (s)", [*T, T[-1] + 0.1, T[-1] + 0.25]), signal_kind="passages")
    assert found["half_swings"].values[-1] == 59 and "cannot be told" in found.attrs["remarks"]


@pytest.mark.parametrize(
    "text",
    [
        columns("t (s),v (m/s)", 0.1 * NUMBER, np.cos(0.45 * NUMBER)),
        columns("t (s),v (m/s)", 0.1 * NUMBER, 2 + np.cos(0.45 * NUMBER)),
        columns("length (m),T (s)", 0.3 + 0.01 * NUMBER, 2.006 * np.sqrt(0.3 + 0.01 * NUMBER)),
        column("angle", np.cos(0.45 * NUMBER)),
    ],
)
def test_nothing_else_is_taken_for_passages(tmp_path, text):
    try:
        found = taken(tmp_path, text)
    except InputError as problem:
        assert "half-swing or a whole period" not in problem.problem
    else:
        assert "half_swings" not in found or found.attrs["kind"] not in ("passages", "periods")
