"""Tables that lie across the page are read as what they are, and no other table is turned."""

import numpy as np
import pytest

from swingdown.errors import InputError
from swingdown.measurement.across import upright
from swingdown.measurement.recording import ingest
from swingdown.measurement.sheet import COLUMNS

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
