"""How a table is laid out is told from its rows, and what its columns are called from the lines above, as programs write them."""

import pytest

from swingdown.errors import InputError
from swingdown.measurement.files.cells import EITHER, SPACES, Dialect
from swingdown.measurement.files.layout import dialect, layout, tells

TIMES = [f"{k / 10:.1f}" for k in range(12)]
ANGLES = [f"{(-1) ** k * (3 - k / 8):.3f}" for k in range(12)]


def lines(separator=",", sign=".", columns=(TIMES, ANGLES)):
    return [separator.join(row).replace(".", sign) for row in zip(*columns, strict=True)]


def told(rows, **more):
    return dialect(rows, "a.csv", **more)


@pytest.mark.parametrize(
    ("separator", "sign"),
    [(",", "."), ("\t", "."), (";", "."), ("\t", ","), (";", ","), ("|", "."), ("|", ",")],
)
def test_separator_and_decimal_sign_are_those_in_which_rows_are_numbers(separator, sign):
    notes = ["# a comment; with, marks", "Recorded on Monday, by hand", ""]
    assert told(notes + lines(separator, sign)) == Dialect(separator, sign, led=True)
    three = lines(separator, sign, (TIMES, ANGLES, TIMES))
    assert told(three) == Dialect(separator, sign, size=3, led=True)


@pytest.mark.parametrize(("between", "sign"), [(" ", "."), ("   ", ","), (" \t ", ".")])
def test_columns_between_spaces_are_columns(between, sign):
    found = told(lines(between, sign))
    assert found.decimal == sign and found.size == 2 and found.separator in (SPACES, "\t")


def test_a_comma_may_be_both_where_nothing_else_will_do():
    """Two whole numbers and two with a decimal comma: four cells, or two."""
    assert told([f"{k},{k + 1}" for k in range(12)]) == Dialect(",", ".", led=True)
    assert told(['"0,1","2,5"', '"0,2","2,4"', '"0,3","2,3"']) == Dialect(",", ",", led=True)


@pytest.mark.parametrize(("sign", "single"), [(".", False), (".", True), (",", True)])
def test_one_number_a_line_is_one_column(sign, single):
    found = told([one.replace(".", sign) for one in ANGLES], single=single)
    assert (found.size, found.decimal, found.separator) == (1, sign, "\t")


def test_of_a_comma_alone_the_one_who_asks_for_numbers_a_line_decides():
    rows = [f"{k},{k}5" for k in range(12)]
    assert told(rows).size == 2 and told(rows, single=True) == Dialect("\t", ",", size=1)


@pytest.mark.parametrize(
    ("cells", "separator", "sign", "mark"),
    [
        (["1,234.5", "987.6", "12,345.6"], ";", ".", ","),
        (["1.234,5", "987,6", "12.345,6"], ";", ",", "."),
        (["1'234.5", "987.6", "12'345.6"], "\t", ".", "'"),
        (["1 234,5", "987,6", "12 345,6"], ";", ",", " "),
    ],
)
def test_groups_of_three_digits_are_told_where_some_number_has_none(cells, separator, sign, mark):
    rows = [f"{k / 10:.1f}".replace(".", sign) + separator + cell for k, cell in enumerate(cells * 4)]
    found = told(rows)
    assert (found.separator, found.decimal, found.thousands, found.size) == (separator, sign, mark, 2)


def test_three_decimals_are_no_group_and_one_odd_cell_is_a_spoilt_one():
    with pytest.raises(
        InputError, match="one decimal sign in each column"
    ):  # a thousand and more, or a little more than 1
        told([f"{k}.5;1,{k}34" for k in range(1, 9)])
    assert told([f"{k / 10};{1 + k / 1000:.3f}" for k in range(9)]).thousands == ""
    spoilt = lines(";", ",")
    spoilt[4] = "1.234,5;2,5"
    assert told(spoilt) == Dialect(";", ",", led=True)


def test_a_sign_of_its_own_in_each_column_is_taken_and_both_in_one_are_refused():
    plain = [f"{t}5;{a.replace('.', ',')}1" for t, a in zip(TIMES, ANGLES, strict=True)]
    assert told(plain) == Dialect(";", EITHER)
    mixed = [row.replace(",", "." if k % 2 else ",") for k, row in enumerate(plain)]
    with pytest.raises(InputError, match="some numbers have a decimal point and others a decimal comma"):
        told(mixed)


@pytest.mark.parametrize("stamp", ["12:03:11.245 -> ", "[12:03:11.245] "])
def test_a_serial_monitor_s_stamp_is_a_column_more(stamp):
    assert told([stamp + row for row in lines()]) == Dialect(",", ".", True, size=3, led=True)
    assert told([stamp + one for one in ANGLES]) == Dialect("\t", ".", True, size=2)
    few = [stamp + row if k < 3 else row for k, row in enumerate(lines())]
    assert not told(few).arrivals


def test_rows_with_words_are_rows_where_none_is_without():
    rows = [f"left;{t};{a}" for t, a in zip(TIMES, ANGLES, strict=True)]
    assert told(rows) == Dialect(";", ".", words=True, size=3, led=False)
    behind = [f"{t};{a};left" for t, a in zip(TIMES, ANGLES, strict=True)]
    assert told(behind) == Dialect(";", ".", words=True, size=3, led=True)


def test_rows_begin_where_they_begin_and_a_text_has_none():
    assert told(["some words"] * 900 + lines()) == Dialect(",", ".", led=True)
    assert told(["some words, and more"] * 30) is None and told([]) is None


def named(above, rows=None, separator=",", sign=".", **more):
    rows = rows or lines(separator, sign)
    how = dialect(rows, "a.csv")
    return layout(above, rows, how, "utf-8-sig", "a.csv", **more)


@pytest.mark.parametrize(
    ("above", "names"),
    [
        ([], ("column 1", "column 2")),
        (["t (s),angle (deg)"], ("t (s)", "angle (deg)")),
        (["# t (s), angle (deg)"], ("t (s)", "angle (deg)")),
        (["% t (s), angle (deg) | taken by hand"], ("t (s)", "angle (deg)")),
        (["Recording of Monday", "mass,0.5", "t (s),angle (deg)"], ("t (s)", "angle (deg)")),
        (["t,angle", "s,deg"], ("t (s)", "angle (deg)")),
        (["t,angle", "[s],[°]"], ("t (s)", "angle (°)")),
        (["t,reading", "s,au"], ("t", "reading")),
        (["t,reading", "[s],[au]"], ("t (s)", "reading [au]")),
        (["t (s),angle", "s,deg"], ("t (s)", "angle (deg)")),
        (["Time,Angle", "t,θ"], ("Time", "Angle")),
        (["foo,bar"], ("foo", "bar")),
        (["t,t"], ("t", "t.1")),
        (["t;angle"], ("t", "angle")),
        (['"t, angle"'], ("t", "angle")),
        (["t (s),angle (deg)", "sampling rate,50"], ("t (s)", "angle (deg)")),
    ],
)
def test_columns_are_called_as_the_lines_above_say(above, names):
    found = named(above)
    assert found.names == names and found.named is bool(above) and not found.joined and found.stamps == ()


def test_names_with_spaces_stand_above_columns_between_tabs():
    found = named(["time in s\tangle in deg"], separator="\t")
    assert found.names == ("time in s", "angle in deg")
    spaced = named(["t (s)  angle (deg)"], separator="  ")
    assert spaced.names == ("t (s)", "angle (deg)")


def test_a_line_above_gives_titles_and_names_where_there_are_none():
    rows = lines(columns=(TIMES, ANGLES, ANGLES))
    found = named(["Run 1,Run 1,Run 2", "t (s),angle (rad),angle (rad)"], rows)
    assert found.titles == ("Run 1", "Run 1", "Run 2") and found.headers == (
        "t (s)",
        "angle (rad)",
        "angle (rad)",
    )
    assert found.names == ("t (s)", "angle (rad)", "angle (rad).1")
    above = named(["time (s),bob,", ",x (m),y (m)"], rows)
    assert above.names == ("time (s)", "x (m)", "y (m)")


@pytest.mark.parametrize(
    ("above", "names"),
    [
        (["t (s),angle (rad)"], ("t (s)", "angle (rad)", "Unnamed: 2")),
        (["t (s),angle (rad),,"], ("t (s)", "angle (rad)", "Unnamed: 2")),
        (["t (s),angle (rad),volt (V),dt (s),d angle"], ("t (s)", "angle (rad)", "volt (V)")),
        (["t (s),angle (rad),note,more"], ("t (s)", "angle (rad)", "note")),
    ],
)
def test_a_header_of_another_size_is_laid_over_the_rows_where_that_is_clear(above, names):
    rows = [row + "," for row in lines()] if len(above[0].split(",")) < 4 or above[0].endswith(",,") else lines(columns=(TIMES, ANGLES, ANGLES))  # fmt: skip
    assert named(above, rows).names == names


def test_a_header_before_numbered_rows_begins_at_the_second_column_or_is_refused():
    rows = [f"{k},{t},{a}" for k, (t, a) in enumerate(zip(TIMES, ANGLES, strict=True))]
    assert named(["t (s),angle (rad)"], rows).names == ("Unnamed: 0", "t (s)", "angle (rad)")
    falls = [f"{a},{a},{t}" for t, a in zip(TIMES, ANGLES, strict=True)]
    with pytest.raises(InputError, match=r"the header names 2 column\(s\) and the rows have 3 cells"):
        named(["t (s),angle (rad)"], falls)
    with pytest.raises(InputError, match="the header names 3 column"):
        named(["t (s),angle (rad),rate (rad/s)"])


def test_a_header_that_lacks_its_end_leaves_the_first_row():
    rows = lines("\t")
    found = named([f"t (s)\tangle (rad){rows[0].split(chr(9))[0]}\t{ANGLES[0]}"], rows[1:], "\t")
    assert found.joined and found.names == ("t (s)", "angle (rad)")
    assert "the first row stands in the header's line and is left out" in str(found)


def test_units_that_contradict_are_refused():
    with pytest.raises(InputError, match="its name says 'ms' and the line below says 's'"):
        named(["t (ms),angle", "s,deg"])


def test_times_of_day_are_stamps():
    rows = [f"12:00:{k:02d}.5,{a}" for k, a in enumerate(ANGLES)]
    found = named(["time,angle"], rows)
    assert found.stamps == (0,) and str(found) == "`,`, times of day"
    half = [row if k < 6 else row.replace(":", "") for k, row in enumerate(rows)]
    assert layout([], half, Dialect(",", "."), "utf-8-sig", "a.csv").stamps == ()


@pytest.mark.parametrize(
    ("rows", "names"),
    [(ANGLES, ("time (s)", "signal")), ([str(500 + k) for k in range(12)], ("time (s)", "raw")), (lines(), ("time (s)", "column 1", "column 2"))],
)  # fmt: skip
def test_what_a_board_prints_without_a_name_is_a_reading_after_its_arrival(rows, names):
    stamped = [f"12:03:{k:02d}.245 -> {row}" for k, row in enumerate(rows)]
    found = named([], stamped)
    assert found.names == names and found.named
    assert named(["12:03:10.1 -> angle (deg)"] if names[1] != "column 1" else ["12:03:10.1 -> t (s),angle (deg)"], stamped).names[-1] == "angle (deg)"  # fmt: skip
    if names[1] == "column 1":
        assert named(["12:03:10.1 -> t (s),angle (deg)"], stamped).names == (
            "arrival",
            "t (s)",
            "angle (deg)",
        )


def test_a_layout_is_told_in_words():
    assert str(named([])) == "`,`, no header"
    assert str(named(["t;a"], separator=";", sign=",")) == "`;`, decimal comma"
    how = Dialect(SPACES, EITHER, thousands="'")
    said = str(layout(["t (s) a"], lines(" "), how, "cp1252", "a.csv"))
    assert said == "spaces, decimal comma in some columns, groups of digits by `'`, Latin-1"
    assert (
        str(layout([], ANGLES, Dialect("\t", ".", size=1), "utf-16", "a.csv"))
        == "one column, UTF-16, no header"
    )


def test_more_columns_than_an_office_program_has_are_refused():
    wide = Dialect(",", ".", size=16385)
    with pytest.raises(InputError, match="it has 16385 columns"):
        layout([], [], wide, "utf-8-sig", "a.csv")


def test_what_tells_is_a_quantity_or_an_axis():
    assert [one for one in ("t (s)", "angle", "x", "foo", "U (V)", "") if tells(one)] == [
        "t (s)",
        "angle",
        "x",
        "U (V)",
    ]
