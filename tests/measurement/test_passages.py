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
    with pytest.raises(InputError, match="is that a half-swing, a whole period, or several"):
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


def test_times_by_hand_that_are_called_t_may_be_of_several_swings(tmp_path):
    """As ten times five swings of a ball on a spring, which the head calls T."""
    times = [9.03, 9.12, 9.12, 8.97, 9.03, 9.12, 9.06, 9.03, 9.09, 9.06]
    with pytest.raises(InputError, match="or several") as asked:
        taken(tmp_path, column("T / s", times))
    assert "10T (s)" in asked.value.mend
    assert taken(tmp_path, column("Periodendauer / s", times)).attrs["kind"] == "periods"
    assert taken(tmp_path, column("T / s", times), signal_kind="periods").attrs["kind"] == "periods"


def test_periods_are_summed(tmp_path):
    found = taken(tmp_path, columns("swing,period (s)", NUMBER[1:30], np.diff(T[::2])))
    assert found.attrs["kind"] == "periods" and found["half_swings"].values[-1] == 58
    assert np.ptp(found["time"].values) == pytest.approx(np.ptp(T[::2]), abs=1e-3)
    with pytest.raises(InputError, match="half-swing, a whole period, or several"):
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


def test_speeds_with_a_sign_turn_from_passage_to_passage(tmp_path):
    there = np.delete(NUMBER, [7, 30])  # two are missed
    text = columns("t (s),v (m/s)", T[there], (SPEEDS * (-1.0) ** NUMBER)[there])
    found = taken(tmp_path, text, signal_kind="passages")
    np.testing.assert_allclose(np.abs(found["signal"].values), SPEEDS[there], rtol=1e-4)


def test_a_bob_that_turns_in_the_gate_ends_the_count(tmp_path):
    found = taken(tmp_path, column("t (s)", [*T, T[-1] + 0.1, T[-1] + 0.25]), signal_kind="passages")
    assert found["half_swings"].values[-1] == 59 and "cannot be told" in found.attrs["remarks"]


@pytest.mark.parametrize(
    "text",
    [
        columns("t (s),v (m/s)", 0.1 * NUMBER, np.cos(0.45 * NUMBER)),
        columns("t (s),v (m/s)", 0.1 * NUMBER, 2 + np.cos(0.45 * NUMBER)),
        columns("t (s),v (m/s)", 0.1 * NUMBER, 2 * np.exp(-0.05 * NUMBER) * np.cos(0.45 * NUMBER)),
        columns("length (m),T (s)", 0.3 + 0.01 * NUMBER, 2.006 * np.sqrt(0.3 + 0.01 * NUMBER)),
        column("angle", np.cos(0.45 * NUMBER)),
    ],
)
def test_nothing_else_is_taken_for_passages(tmp_path, text):
    try:
        found = taken(tmp_path, text)
    except InputError as problem:
        assert "half-swing, a whole period, or several" not in problem.problem
    else:
        assert "half_swings" not in found or found.attrs["kind"] not in ("passages", "periods")


def test_of_two_gates_the_one_with_more_passages_is_taken(tmp_path):
    events = [
        (t + late + side * 0.01, gate, int(side < 0))
        for gate, late in (("A", 0.0), ("B", 0.06))
        for t in T
        for side in (-1, 1)
    ]
    state, lines = {"A": 0, "B": 0}, []
    for at, gate, dark in sorted(events)[:-4]:
        state[gate] = dark
        lines.append(f"{at:.5f},{at:.4f},{state['A']},{state['B']},")
    text = "\n".join(["Time,Event Time,State at A,State at B,Comment", "s,s,State,State,", "", *lines, ""])
    found = taken(tmp_path, text)
    assert "another gate is left out" in found.attrs["remarks"] and "`State at A`" in found.attrs["remarks"]
    np.testing.assert_allclose(found["time"].values, T[:59] + 0.06, atol=1e-3)
    other = taken(tmp_path, text, signal_column="State at A")  # its first passage has begun before
    np.testing.assert_allclose(other["time"].values, T[1:59], atol=1e-3)


def test_times_with_the_period_and_the_dark_time_at_each(tmp_path):
    rows = "\n".join(f"{t:.6f}\t{2 * HALF:.6f}\t{0.02 / v:.6f}" for t, v in zip(T, SPEEDS, strict=True))
    found = taken(tmp_path, f"#Creator: a gate\n#Time\tPeriod\tTransit time\n#[s]\t[s]\t[s]\n{rows}\n")
    assert found.attrs["kind"] == "passages"
    assert list(found["half_swings"].values) == list(NUMBER)
    np.testing.assert_allclose(np.abs(found["signal"].values), SPEEDS / 0.02, rtol=1e-3)


@pytest.mark.parametrize("numbered", [False, True])
def test_a_column_of_periods_without_a_name_is_asked_about(tmp_path, numbered):
    periods = 2.03 - 1e-5 * NUMBER + 0.02 * np.random.default_rng(8).standard_normal(60)
    text = "\n".join(f"{value:.4f}" + f",{n:03}" * numbered for n, value in enumerate(periods, 1))
    with pytest.raises(InputError, match="periods of a pendulum, or readings"):
        taken(tmp_path, text)
    found = taken(tmp_path, text, signal_kind="periods")
    assert found["half_swings"].values[-1] == 120
    assert found["time"].values[-1] == pytest.approx(periods.sum(), abs=0.01)


def test_periods_that_grow_are_no_times(tmp_path):
    periods = 1.4 + 1e-4 * NUMBER
    found = taken(tmp_path, column("period (s)", periods))
    assert found["time"].values[-1] == pytest.approx(periods.sum(), abs=0.01)


def test_numbered_readings_of_a_swing_are_not_asked_whether_they_are_periods(tmp_path):
    text = "\n".join(f"{n},{512 + 90 * np.cos(0.3 * n):.0f}" for n in range(400))
    try:
        taken(tmp_path, text)
    except InputError as problem:
        assert "periods of a pendulum" not in problem.problem


@pytest.mark.parametrize("dark", [0, 1])
def test_edges_tell_passages_whichever_level_is_dark(tmp_path, dark):
    """Rows of a board that writes the pin, the edge and its time."""
    rows = [f"2, {dark if side < 0 else 1 - dark}, {t + side * 0.005:.6f}" for t in T for side in (-1, 1)]
    found = taken(tmp_path, "\n".join(["# Pin number, Edge type, Time [s]", *rows, ""]))
    assert found.attrs["kind"] == "passages" and "`Edge type` as a light gate's" in found.attrs["taken"]
    assert np.allclose(found["time"].values, T, atol=2e-6)
    assert list(found["half_swings"].values) == list(NUMBER)


def test_edges_of_a_comparator_of_the_side_are_no_passages(tmp_path):
    """A level that lasts for nearly half a period is a side of the swing, not a bob in the gate."""
    rows = [f"{t:.6f},{k % 2}" for k, t in enumerate(T + 0.1 * (NUMBER % 2))]
    with pytest.raises(InputError, match="it holds no passages of a light gate"):
        taken(
            tmp_path,
            "\n".join(["Time (s),Edge type", *rows, ""]),
            signal_kind="passages",
            signal_column="Edge type",
        )


def voltage(late, between=0.0, width=0.1, slow=0.0):
    """Samples of a gate's voltage, low while the bob is in it, of which a share is on the way between the levels; each edge is ``slow`` (s)."""
    times, passed = np.arange(0.0, 30.0, 0.001), T + late * (NUMBER % 2)
    beside = np.abs(times[:, None] - passed).min(axis=1) - width / 2
    read = 0.04 + 4.76 * (np.clip(beside / slow + 0.5, 0, 1) if slow else beside >= 0)
    on_the_way = np.random.default_rng(2).random(times.size) < between
    return passed, columns("t (s),gate (V)", times, np.where(on_the_way, 2.0, read))


@pytest.mark.parametrize("slow", [0.0, 0.01])
def test_a_gates_voltage_tells_passages_where_its_gaps_are_uneven(tmp_path, slow):
    passed, text = voltage(0.05, slow=slow)
    found = taken(tmp_path, text)
    whole = passed[passed < 29.9]
    assert found.attrs["kind"] == "passages" and list(found["half_swings"].values) == list(
        NUMBER[: whole.size]
    )
    assert np.allclose(found["time"].values, whole, atol=1e-3)
    alternate = 2 * np.diff(found["time"].values)[:2]
    assert abs(alternate[0] - alternate[1]) > 0.15  # which are no periods each
    assert np.mean(alternate) == pytest.approx(2 * HALF, abs=0.01)


def test_even_gaps_of_a_gates_voltage_are_asked_about(tmp_path):
    with pytest.raises(InputError, match="is that a half-swing, a whole period, or several"):
        taken(tmp_path, voltage(0.0)[1])
    assert taken(tmp_path, voltage(0.0)[1], signal_kind="periods")["half_swings"].values[1] == 2


@pytest.mark.parametrize("spoilt", [{"between": 0.2}, {"width": 0.35}, {"slow": 0.08}])
def test_a_voltage_that_is_no_gates_gives_no_passages(tmp_path, spoilt):
    """One that is between its levels for long, in single samples or in its edges, and one whose levels last alike, as of a side or of a swing cut off."""
    with pytest.raises(InputError):
        taken(tmp_path, voltage(0.05, **spoilt)[1])


def test_several_columns_of_periods_are_asked_about_with_their_names(tmp_path):
    """Four pendulums timed by hand, a column each."""
    draws = 0.03 * np.random.default_rng(3).standard_normal((30, 4))
    text = "one,two,three,four\n" + "\n".join(
        ",".join(f"{x:.2f}" for x in row) for row in draws + [1.8, 1.6, 1.4, 1.2]
    )
    with pytest.raises(InputError, match="are they periods of a pendulum, or readings") as caught:
        taken(tmp_path, text)
    assert "one, two, three, four name one" in caught.value.mend
    found = taken(tmp_path, text, signal_kind="periods", signal_column="three")
    assert np.median(np.diff(found["time"])) == pytest.approx(1.4, abs=0.02)
