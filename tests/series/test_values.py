"""What was varied: out of the names of files, a table beside them, and cells of the sheet."""

import numpy as np
import pandas as pd
import pytest

from swingdown.errors import InputError
from swingdown.series import from_names, from_rows, from_table, merged, series_of
from swingdown.series.values import table_beside


@pytest.mark.parametrize(
    ("name", "column", "value"),
    [("l=0.40", "length", 0.40), ("500g", "mass", 0.5), ("40cm", "length", 0.4), ("vary_l_15cm", "length", 0.15),
     ("100g_DATA", "mass", 0.1), ("data10L=0.15m", "length", 0.15), ("QFactorGraph10(43cm)", "length", 0.43),
     ("1.3_400mA", "current", 0.4), ("20 cm2", "area", 0.002), ("0,5 kg", "mass", 0.5), ("212mm sorted", "length", 0.212)],
)  # fmt: skip
def test_names_of_files_tell_what_was_varied(name, column, value):
    values, _, told = from_names({"one": name})
    assert list(values["one"]) == [column] and values["one"][column].value == pytest.approx(value)
    assert np.isnan(values["one"][column].uncertainty) and name in told[0]


@pytest.mark.parametrize(
    "name", ["swing 3", "60deg", "group 12", "10cm or 20cm", "trial1", "p1c3", "2022-03-12_03h19m"]
)
def test_a_name_that_says_nothing_or_two_things_is_not_guessed_at(name):
    assert not from_names({"one": name})[0]["one"]


def test_sides_are_groups():
    groups = from_names({"a": "symmetry_left", "b": "symmetry right", "c": "left and right"})[1]
    assert groups == {"a": {"group": "left"}, "b": {"group": "right"}, "c": {}}


def test_a_table_beside_the_files(tmp_path):
    for name in ("a.csv", "b.csv"):
        (tmp_path / name).write_text("time,angle\n0,1\n")
    (tmp_path / "values.csv").write_text(
        'file,length (cm),u_length,mass_g,who\na.csv,40,0.1,500,Ann\nB,60.0(2),,"1,0e3",Ben\n'
    )
    beside = table_beside(tmp_path.iterdir())
    assert beside == tmp_path / "values.csv"
    values, groups = from_table(beside, {"one": "a", "two": "b"})
    assert values["one"]["length"].value == pytest.approx(0.4)
    assert values["one"]["length"].uncertainty == pytest.approx(0.001)
    assert values["two"]["length"].uncertainty == pytest.approx(0.002)
    assert values["two"]["mass"].value == pytest.approx(1.0) and values["one"]["mass"].unit == "kg"
    assert groups == {"one": {"who": "Ann"}, "two": {"who": "Ben"}}


@pytest.mark.parametrize(("separator", "charset"), [(";", "cp1252"), ("\t", "utf-16"), (",", "utf-8-sig")])
def test_a_table_as_a_spreadsheet_saves_it_is_read(tmp_path, separator, charset):
    lines = ["file|length (cm)|who", "# two days", "", "a|40±0.1|Zoë", "b|60"]
    path = tmp_path / "values.csv"
    path.write_text("\n".join(lines).replace("|", separator), encoding=charset)
    values, groups = from_table(path, {"one": "a", "two": "b"})
    assert [values[key]["length"].value for key in ("one", "two")] == pytest.approx([0.4, 0.6])
    assert groups["one"] == {"who": "Zoë"} and not groups["two"]


def test_a_cell_that_is_no_number_is_refused_with_its_line_and_column(tmp_path):
    path = tmp_path / "values.csv"
    path.write_text("file,length (cm)\na,40\nb,about 60\n")
    with pytest.raises(
        InputError, match=r"values.csv, line 3, column length \(cm\): 'about 60' is no length"
    ):
        from_table(path, {"one": "a", "two": "b"})


def test_a_table_of_other_files_is_refused(tmp_path):
    (tmp_path / "values.csv").write_text("file,length\nx,1\n")
    with pytest.raises(InputError, match="none of its files is here"):
        from_table(tmp_path / "values.csv", {"one": "a"})


def test_cells_of_the_sheet_count_before_a_name():
    sheet, groups = from_rows(
        [{"recording": "one", "length": "0.41±0.01", "group": "A"}, {"recording": "two", "length": "350px"}]
    )
    named = from_names({"one": "40cm", "two": "50cm"})[0]
    both = merged(sheet, named)
    assert (
        both["one"]["length"].value == 0.41
        and both["two"]["length"].value == 0.5
        and groups["one"] == {"group": "A"}
    )


def table(count=4):
    lengths = np.linspace(0.3, 0.9, count)
    omega = np.sqrt(9.81 / lengths)
    rows = {
        "campaign": "x",
        "label": "x",
        "natural_frequency_rad_per_s": omega,
        "natural_frequency_rad_per_s_u": 1e-4 * omega,
    }
    rows |= {"quality": 80.0, "quality_u": 1.0, "decay_time_s": 40.0, "decay_time_s_u": 0.5}
    names = [f"r{k}" for k in range(count)]
    return pd.DataFrame({"recording": names} | rows), from_rows(
        {"recording": name, "length": f"{length} m"} for name, length in zip(names, lengths, strict=True)
    )[0]


def test_a_table_of_pendulums_becomes_a_series():
    rows, values = table()
    period, quality = series_of(rows, values)
    assert period.quantity == "period" and period.law.exponent == pytest.approx(0.5)
    assert "theory says 0.5, which agrees" in period.sentence and "g = 9.81" in period.sentence
    assert "the uncertainty of length was not given" in period.sentence
    assert quality.law.exponent == pytest.approx(0, abs=1e-9) and "theory" not in quality.sentence


def test_a_recording_without_a_quantity_is_left_out_and_too_few_make_no_series():
    rows, values = table()
    rows.loc[0, "natural_frequency_rad_per_s"] = np.nan
    assert len(series_of(rows, values)[0].table) == 3
    rows.loc[1, "natural_frequency_rad_per_s"] = np.nan
    assert [one.quantity for one in series_of(rows, values)] == ["quality"]


def test_a_column_that_is_not_there_is_refused_with_those_that_are():
    with pytest.raises(InputError, match="the recordings have length"):
        series_of(*table(), by="mass")
