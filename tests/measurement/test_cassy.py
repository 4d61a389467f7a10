"""Measurements of CASSY Lab: the channels of each run beside its times, with their units, and no spectrum or number of a sample."""

import io

import numpy as np
import pytest
from exports import zipped

import swingdown
from swingdown.errors import InputError
from swingdown.measurement.files.programs import saved_by_program
from swingdown.measurement.recording import ingest
from swingdown.measurement.sheet import COLUMNS

TIMES = np.round(np.arange(1000) * 0.0201, 6)
DEGREES = np.round(np.degrees(0.5 * np.exp(-0.02 * TIMES) * np.cos(3.5 * TIMES)), 4)


def saved(content, name):
    return saved_by_program(io.BytesIO(content), name)


def read(content, name):
    return {key: columns.frame for key, columns in saved(content, name).items()}


def channel(quantity, symbol, unit, values):
    cells = "".join(f"<value>{one}</value>" if one == one else "<value />" for one in values)
    return (
        f'<channel datetime="2016-11-03T13:52:12+01:00"><quantity>{quantity}</quantity><symbol>{symbol}</symbol>'
        f'<unit>{unit}</unit><values count="{len(values)}">{cells}</values></channel>'
    )


def cassy(runs):
    """A measurement of CASSY Lab 2: each channel with its runs, a rate that ends earlier, and a spectrum."""
    groups = [
        ("Index", "n", "", [np.arange(1, len(t) + 1) for t, _ in runs]),
        ("Zeit", "t", "s", [t for t, _ in runs]),
        ("Frequenz", "f", "Hz", [np.arange(64.0) for _ in runs]),
        ("Winkel", "&amp;a_A1", "°", [a for _, a in runs]),
        ("omega", "v", "1/s", [np.r_[np.nan, np.diff(a)[:-1]] for _, a in runs]),
        ("Spektrum", "F", "°", [np.arange(64.0) for _ in runs]),
    ]
    inside = "".join(
        f'<channels count="{len(of_runs)}">{"".join(channel(quantity, symbol, unit, one) for one in of_runs)}</channels>'
        for quantity, symbol, unit, of_runs in groups
    )
    return f'\ufeff<?xml version="1.0" encoding="utf-8"?><cassylab><allchannels>{inside}</allchannels></cassylab>'.encode()  # fmt: skip


def cassy_1(columns):
    """A file of CASSY Lab 1: quantities in four lines each, what was computed last, the rows, a spectrum, and how it is drawn."""
    shown = "0 80 10 0 3 0 0 1 0 0 0 0 0 0 1 1"
    own = (("Index", "n", ""), ("Zeit", "t", "s"), ("Frequenz", "f", "Hz"))
    first = [f"{name}\n{symbol}\n{unit}\n{shown}\n" for name, symbol, unit in own]
    more = [f"0 1 0 1\n1 0 0 0 1 0 4 0 0 0 0 0 0 0 0 2500 0\n{name}\n{symbol}\n{unit}\n-1 1 0.5 0 3 0 0 0 0 1 1 0 0 -0.014 1 1\n" for name, symbol, unit in (("Spannung", "U_A1", "V"), ("Spannung", "U_B1", "V"), ("neue Größe", "f_1", "V"))]  # fmt: skip
    rows = "".join("\t".join(map(str, row)) + "\t\n" for row in columns)
    spectrum = "2 30\n" + "".join(f"{k / 10}\t{1 / (1 + k)}\t\n" for k in range(30))
    text = f"CL4\n180 0.1\n{''.join(first)}3 1\n{''.join(more)}4 {len(columns)}\n{rows}{spectrum}1 0 0\n-1\n2\nStandard\n"
    return text.replace("\n", "\r\n").encode("latin-1")


@pytest.mark.parametrize("packed", [False, True])
def test_a_measurement_of_cassy_lab(tmp_path, packed):
    content = cassy([(TIMES, DEGREES)])
    path = tmp_path / "wheel.labx"
    path.write_bytes(zipped({"data.xml": content}) if packed else content)
    found = ingest({**COLUMNS, "recording": "a", "campaign": "a", "file": str(path)})
    np.testing.assert_array_equal(found["signal"].values, DEGREES)
    np.testing.assert_array_equal(found["time"].values, TIMES)
    assert found["signal"].attrs["units"] == "deg"
    assert found.attrs["begun"] == "2016-11-03T13:52:12+01:00"


def test_a_table_of_cassy_lab_1(tmp_path):
    noise = np.round(12 + 0.01 * np.random.default_rng(1).standard_normal(TIMES.size), 3)
    rows = [[k, *row] for k, row in enumerate(zip(TIMES, np.round(DEGREES / 40, 4), noise, strict=True), 1)]
    rows[999][2] = "NAN"
    path = tmp_path / "wheel.lab"
    path.write_bytes(cassy_1(rows))
    (found,) = swingdown.read(path, restoring="linear").swings
    np.testing.assert_array_equal(found["time"].values, TIMES[:999])
    assert found.attrs["own_unit"] == "V"
    assert [*read(cassy_1(rows), "a.lab")[""]] == ["Zeit", "Spannung U_A1", "Spannung U_B1"]
    path.write_text("t,angle\n" + "".join(f"{t},{x}\n" for t, x in zip(TIMES, DEGREES, strict=True)))
    assert swingdown.read(path).swings[0].sizes["time"] == 1000  # another program's
    with pytest.raises(InputError, match="no quantity beside the time"):
        read(cassy_1([[1, 0.0], [2, 0.1]]), "a.lab")


def test_each_run_of_cassy_lab_is_a_recording():
    found = read(cassy([(TIMES, DEGREES), (TIMES[:600], 2 * DEGREES[:600])]), "a.labx")
    assert list(found) == ["run 1", "run 2"]
    assert list(found["run 1"].columns) == ["Zeit", "Winkel", "omega"]
    np.testing.assert_array_equal(found["run 2"]["Winkel"], 2 * DEGREES[:600])
    assert found["run 1"]["omega"].isna().sum() == 2  # before the first, and after its end


def test_columns_of_a_run_have_their_units_and_a_repeated_name_its_symbol():
    angles = channel("Winkel", "a_A1", "°", DEGREES), channel("Winkel", "a_B1", "rad", TIMES + 1)
    time = channel("Zeit", "t", "ms", TIMES)
    inside = "".join(f"<channels>{one}</channels>" for one in (time, *angles))
    (found,) = saved(f"<cassylab>{inside}</cassylab>".encode(), "a.labx").values()
    assert found.units == {"Zeit": "ms", "Winkel a_A1": "°", "Winkel a_B1": "rad"}
    assert found.about == {"source": "CASSY Lab", "begun": "2016-11-03T13:52:12+01:00"}
    np.testing.assert_array_equal(found.frame["Winkel a_B1"], TIMES + 1)


def test_a_group_with_fewer_runs_is_of_the_first_ones():
    """A quantity that was measured in the first run alone is no column of the second; nor is a date told that no channel has."""
    groups = [2 * channel("Zeit", "t", "s", TIMES), 2 * channel("U", "U_A", "V", DEGREES), channel("W", "U_B", "V", DEGREES)]  # fmt: skip
    dated = "".join(f"<channels>{one}</channels>" for one in groups)
    undated = dated.replace('datetime="2016-11-03T13:52:12+01:00"', "")
    found = saved(f"<a>{undated}</a>".encode(), "a.labx")
    assert [list(run.frame) for run in found.values()] == [["Zeit", "U", "W"], ["Zeit", "U"]]
    assert found["run 1"].about == {"source": "CASSY Lab"}


def test_a_table_of_cassy_lab_1_has_its_quantities_in_their_order():
    """The number of the row and the frequency are none of them; each has the numbers of its own column."""
    rows = [[k, t, x, 3 * x, x - 1] for k, (t, x) in enumerate(zip(TIMES, DEGREES, strict=True), 1)]
    (found,) = saved(cassy_1(rows), "a.lab").values()
    assert list(found.frame) == ["Zeit", "Spannung U_A1", "Spannung U_B1", "neue Größe"]
    assert found.units == {"Zeit": "s", "Spannung U_A1": "V", "Spannung U_B1": "V", "neue Größe": "V"}
    np.testing.assert_allclose(found.frame.T, [TIMES, DEGREES, 3 * DEGREES, DEGREES - 1])
    with_time_alone = saved(cassy_1([row[:3] for row in rows]), "a.lab")[""]
    assert list(with_time_alone.frame) == ["Zeit", "Spannung"] and len(with_time_alone.frame) == 1000
