"""Tables that lie across the page are turned upright, and nothing else is."""

import pytest

from swingdown.measurement.files.across import upright

TIMES = ["0", "0.1", "0.2", "0.3", "0.4", "0.5", "0.6", "0.7", "0.8", "0.9"]
ANGLES = ["10", "8", "3", "-4", "-9", "-10", "-6", "1", "7", "9"]


def turned(*rows, between="\t"):
    """The rows that the table of these rows has upright, each a list of cells; None where it is not turned."""
    found = upright([between.join(row) for row in rows])
    return found and [line.split("\t") for line in found.read().decode().splitlines()]


def test_rows_become_columns_with_and_without_their_names():
    assert turned(TIMES, ANGLES) == [[t, a] for t, a in zip(TIMES, ANGLES, strict=True)]
    named = turned(["t (s)", *TIMES], ["angle", *ANGLES])
    assert named[0] == ["t (s)", "angle"] and named[1:] == turned(TIMES, ANGLES)


@pytest.mark.parametrize("between", [",", ";", "\t"])
def test_cells_stand_between_any_of_the_usual_signs(between):
    assert turned(TIMES, ANGLES, between=between) == turned(TIMES, ANGLES)


def test_ten_samples_are_enough_and_nine_are_not():
    assert turned(TIMES[:9], ANGLES[:9]) is None
    assert turned(["t", *TIMES[:9]], ["angle", *ANGLES[:9]]) is None  # ten cells, nine of them numbers
    assert len(turned(["t", *TIMES], ["angle", *ANGLES])) == 11


def test_nine_rows_lie_across_and_ten_are_those_of_a_recording():
    assert len(turned(TIMES, *[ANGLES] * 8)[0]) == 9
    assert turned(TIMES, *[ANGLES] * 9) is None
    assert turned(TIMES) is None


def test_no_row_of_rising_numbers_is_no_row_of_times():
    assert turned(ANGLES, ANGLES) is None
    assert turned(ANGLES, TIMES) is not None  # the times may stand in any row
    twice = [*TIMES[:5], *TIMES[4:-1]]
    assert turned(twice, ANGLES) is None


def test_rows_of_unequal_length_and_words_among_numbers_are_left():
    assert turned([*TIMES, "1.0"], ANGLES) is None
    assert turned(TIMES, [*ANGLES[:-1], "left"]) is None
    assert turned(["t", *TIMES], ["0", *ANGLES]) is None  # one row with its name, one without


def test_comments_empty_lines_and_separators_at_the_end_are_passed_over():
    lines = ["# a pendulum", "", ",".join(TIMES) + ",,", ",".join(ANGLES) + ","]
    assert upright(lines).read() == upright([",".join(TIMES), ",".join(ANGLES)]).read()


def test_a_reading_that_is_missing_stays_missing():
    gap = ["" if k == 4 else one for k, one in enumerate(ANGLES)]
    assert turned(TIMES, gap)[4] == ["0.4", ""]
    assert turned([*TIMES[:3], "", *TIMES[4:]], ANGLES)[3] == ["", "-4"]


def test_decimal_commas_and_powers_of_ten_are_numbers():
    commas = [one.replace(".", ",") for one in TIMES]
    assert turned(commas, ANGLES, between=";")[1] == ["0,1", "8"]
    small = [f"{k + 1}.5e-3" for k in range(10)]
    assert turned(TIMES, small)[0] == ["0", "1.5e-3"]


@pytest.mark.parametrize("form", ["{} = [{}]", "{} = np.array([{}])", "{} = [{}];", "{}: ({}),"])
def test_lists_as_a_program_prints_them_are_rows(form):
    lines = [form.format(name, ", ".join(cells)) for name, cells in (("t", TIMES), ("theta", ANGLES))]
    found = upright(lines).read().decode().splitlines()
    assert found[0] == "t\ttheta" and found[1:] == [f"{t}\t{a}" for t, a in zip(TIMES, ANGLES, strict=True)]
