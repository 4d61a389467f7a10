"""Tables across the page, rows in brackets, and times as a processor counts them are read as what they are, and no others are."""

import numpy as np
import pytest

from swingdown.errors import InputError
from swingdown.measurement.files.across import upright
from swingdown.measurement.recording import ingest
from swingdown.measurement.sheet import COLUMNS
from swingdown.measurement.swings.clock import counts_ticks

TIMES = np.arange(0.0, 12.0, 0.1)
ANGLE = 20 * np.exp(-TIMES / 40) * np.cos(2 * np.pi * TIMES / 1.4)


def row(values, separator, decimal="."):
    return separator.join(f"{value:.3f}".replace(".", decimal) for value in values)


@pytest.mark.parametrize(("separator", "decimal"), [(",", "."), ("\t", "."), (";", ","), ("\t", ",")])
@pytest.mark.parametrize("named", [True, False])
def test_times_in_a_row_and_the_angle_below(tmp_path, separator, decimal, named):
    names = ("time (s)", "angle (deg)") if named else ("", "")
    lines = [row(one, separator, decimal) for one in (TIMES, ANGLE)]
    lines = [f"{name}{separator}{line}" if named else line for name, line in zip(names, lines, strict=True)]
    file = tmp_path / "across.csv"
    file.write_text("# by hand\n" + "\n".join(lines) + "\n")
    found = ingest({**COLUMNS, "recording": "a", "file": str(file)})
    assert "its rows as columns" in found.attrs["taken"]
    assert np.allclose(found["time"], TIMES, atol=1e-3) and np.allclose(found["signal"], ANGLE, atol=1e-3)


@pytest.mark.parametrize(
    "lines",
    [
        ["1,2,3", "2,3,4"],  # too few in a row to be samples
        [row(TIMES, ","), row(ANGLE[:-1], ",")],  # one row has another number of readings
        [row(ANGLE, ","), row(ANGLE, ",")],  # no clock
        [row(TIMES[:12], ",")] * 12,  # rows enough to be samples
    ],
)
def test_what_does_not_lie_across_is_left_as_it_is(lines):
    assert upright(lines) is None


def test_a_row_of_words_is_no_row_of_readings(tmp_path):
    file = tmp_path / "words.csv"
    file.write_text("a,b\nc,d\n")
    with pytest.raises(InputError):
        ingest({**COLUMNS, "recording": "a", "file": str(file)})


@pytest.mark.parametrize("brackets", ["()", "[]"])
def test_rows_in_brackets_are_rows(tmp_path, brackets):
    file = tmp_path / "printed.txt"
    lines = [f"{brackets[0]}{t:.3f}, {y:.3f}{brackets[1]}" for t, y in zip(TIMES, ANGLE, strict=True)]
    file.write_text("\n".join(lines) + "\n")
    found = ingest({**COLUMNS, "recording": "a", "file": str(file), "signal_unit": "deg"})
    assert "rows in brackets" in found.attrs["taken"] and np.allclose(found["signal"], ANGLE, atol=1e-3)


def ticks(steps, header, named):
    times = np.cumsum(np.resize(steps, 600))
    y = 20 * np.exp(-times / 20e3) * np.cos(2 * np.pi * times / 500)
    rows = "\n".join(f"{t},{a:.3f},{0.3 * a + 1:.3f}" for t, a in zip(times, y, strict=True))
    return f"{named}\n{rows}\n" if header else f"{rows}\n"


def test_a_processors_ticks_are_ms(tmp_path):
    file = tmp_path / "ticks.csv"
    file.write_text(ticks([25, 27, 26, 24], True, "t,angle (deg),volt (V)"))
    found = ingest({**COLUMNS, "recording": "a", "file": str(file)})
    assert "TAKEN AS ms" in found.attrs["remarks"] and found["time"].values[-1] == pytest.approx(
        15.3, rel=0.02
    )


@pytest.mark.parametrize(
    ("steps", "question"),
    [([25, 27, 26, 24], "what its columns hold, nor the unit"), ([25], "torsion balance")],
)
def test_even_seconds_may_be_a_torsion_balances(tmp_path, steps, question):
    file = tmp_path / "ticks.csv"
    file.write_text(ticks(steps, False, ""))
    with pytest.raises(InputError, match=question):
        ingest({**COLUMNS, "recording": "a", "file": str(file)})


def test_whole_numbers_that_only_fall_are_no_clock_of_a_processor():
    assert not counts_ticks(np.arange(400.0)[::-1]) and counts_ticks(
        np.cumsum(np.tile([9.0, 11.0, 10.0], 200))
    )


@pytest.mark.parametrize("header", ["", "pulse,tick\n"])
def test_the_first_column_may_be_the_swing(take, header):
    named = {"signal_column": "pulse" if header else "column 1"}
    found = take(header + "".join(f"{x:.4f},{t:.4f}\n" for x, t in zip(ANGLE, TIMES, strict=True)), **named)
    assert np.allclose(found["time"], TIMES) and np.allclose(found["signal"], ANGLE, atol=1e-3)


@pytest.mark.parametrize(
    ("beside", "problem", "mend"), [("", "the file has 1 column", "samples a second"), (",{:.3f}", "none rises from row to row", "samples a second")],
)  # fmt: skip
def test_a_swing_without_a_time_is_refused(take, beside, problem, mend):
    lines = [f"{x:.4f}" + beside.format(y) for x, y in zip(ANGLE, ANGLE[::-1], strict=True)]
    with pytest.raises(InputError, match=problem) as told:
        take("\n".join(lines) + "\n", signal_column="column 1")
    assert mend in told.value.mend


def test_what_is_called_a_time_is_no_swing(take):
    with pytest.raises(InputError, match="column t.* a time is no angle"):
        take("t,angle\n" + "".join(f"{t:.3f},{x:.4f}\n" for t, x in zip(TIMES, ANGLE, strict=True)), signal_column="t")  # fmt: skip


@pytest.mark.parametrize(("parts", "digits"), [(100, 2), (1000, 3)])
def test_a_films_times_have_their_fractions_behind_a_third_colon(tmp_path, parts, digits):
    """As Kinovea writes them; below 60 they might as well be frames, which are no hundredths."""
    units = np.round(TIMES * parts).astype(int)
    stamps = [f"0:00:{one // parts:02d}:{one % parts:0{digits}d}" for one in units]
    lines = [f"{stamp} {angle:.3f}" for stamp, angle in zip(stamps, ANGLE, strict=True)]
    (file := tmp_path / "film.txt").write_text("T angle(deg)\n" + "\n".join(lines))
    found = ingest({**COLUMNS, "recording": "a", "file": str(file)})
    assert np.allclose(found["time"], TIMES, atol=1e-9) and np.allclose(found["signal"], ANGLE, atol=1e-3)
    frames = [f"0:00:{k // 10:02d}:{k % 10:02d} {angle:.3f}" for k, angle in enumerate(ANGLE)]
    file.write_text("T angle(deg)\n" + "\n".join(frames))
    with pytest.raises(InputError):
        ingest({**COLUMNS, "recording": "a", "file": str(file)})
