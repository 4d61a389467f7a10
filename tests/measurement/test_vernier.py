"""Files of Logger Pro: the data sets that they hold, with the names and units of their columns."""

import io

import numpy as np
import pytest

from swingdown.errors import InputError
from swingdown.measurement.files.vernier import data_sets


def column(name, cells, short="", unit=""):
    return (
        f"<DataColumn><DataObjectName>{name}</DataObjectName><DataObjectShortName>{short}</DataObjectShortName>"
        f"<ColumnUnits>{unit}</ColumnUnits><ColumnCells>\n{cells}\n</ColumnCells></DataColumn>"
    )


def data_set(*columns, name="Run 1"):
    return f"<DataSet><DataSetName>{name}</DataSetName>{''.join(columns)}</DataSet>"


def read(*sets):
    return data_sets(io.BytesIO(f"<Document>{''.join(sets)}</Document>".encode()), "swing.cmbl")


TIME, ANGLE = column("Time", "0\n0,1\n0.2", "t", "s"), column("Angle", "0.3\n\n-0.1", "A", "rad")


def test_a_data_set_has_its_columns_with_units_and_the_gaps_of_its_cells():
    (found,) = read(data_set(TIME, ANGLE)).values()
    np.testing.assert_array_equal(found.frame["Time"], [0.0, 0.1, 0.2])
    np.testing.assert_array_equal(found.frame["Angle"], [0.3, np.nan, -0.1])
    assert found.units == {"Time": "s", "Angle": "rad"}
    assert (found.layout, found.about) == ("columns of Logger Pro", {"source": "Logger Pro"})


def test_columns_of_one_name_are_told_apart_and_one_without_numbers_is_left():
    note = column("Note", "left\nright")
    (found,) = read(data_set(TIME, ANGLE, note, column("Angle", "1\n2", "B"))).values()
    assert list(found.frame) == ["Time", "Angle A", "Angle B"]
    assert found.units == {"Time": "s", "Angle A": "rad"}
    assert np.isnan(found.frame["Angle B"].iloc[2])  # shorter than the others


def test_each_data_set_has_a_name_of_its_own():
    both = data_set(TIME, ANGLE)
    assert list(read(both, both, data_set(TIME, ANGLE, name=""))) == ["Run 1", "Run 1 2", "data set"]


@pytest.mark.parametrize("sets", [[], [data_set(ANGLE)], [data_set(TIME, column("Note", "left"))]])
def test_without_two_columns_of_numbers_there_is_no_recording(sets):
    with pytest.raises(InputError, match="no data set with two columns of numbers"):
        read(*sets)
    assert list(read(*sets, data_set(TIME, ANGLE))) == ["Run 1"]


@pytest.mark.parametrize("content", [b"0.1,0.2\n", b"<Document><DataSet>", b"<Document><a/></Document>"])
def test_what_logger_pro_did_not_save_is_told_the_way_in_its_menu(content):
    with pytest.raises(InputError, match=r"with File > Export As > CSV") as refused:
        data_sets(io.BytesIO(content), "swing.cmbl")
    assert "syntax" not in str(refused.value)
