"""Settings are named as the user of the sheet, the command or the call says them."""

import re

import numpy as np
import pytest

import swingdown
from swingdown.answer.options import CELLS, TO_READ, TO_THE_COMMAND
from swingdown.errors import SHEET, InputError, as_told, told_to
from swingdown.measurement.sheet import COLUMNS

NAMED = "name it ⟨in time_column⟩; ⟨start_s⟩ and ⟨stop_s=3.2⟩; say ⟨restoring=linear⟩; write counts ⟨in signal_unit⟩; ⟨in gain_tolerance⟩"


@pytest.mark.parametrize(
    ("audience", "told"),
    [
        (SHEET, "name it in the cell time_column of the sheet; start_s and stop_s: 3.2; say restoring: linear; write counts in the cell signal_unit of the sheet; "),
        (TO_THE_COMMAND, "name it with --time-column; --start and --stop 3.2; say --restoring linear; write counts with --unit; "),
        (TO_READ, "name it with time_column=; start= and stop=3.2; say restoring='linear'; write counts with unit=; "),
    ],
)  # fmt: skip
def test_settings_are_named_as_those_say_them_who_are_told(audience, told):
    told += "in the cell gain_tolerance of the sheet"  # which no option or argument stands for
    with told_to(audience):
        problem = InputError("a.csv", "it is no swing", "one", NAMED)
    assert problem.mend == told and told in str(problem)
    assert problem.settings["stop_s"] == "3.2" and problem.settings["time_column"] == ""
    assert as_told("⟨rate_hz⟩") == "rate_hz"  # the block is left


def test_each_setting_that_a_text_names_is_one(root):
    """A cell of the sheet, or what pulls a pendulum back; a name that is in no list would be told as a cell that nobody has."""
    texts = [
        path.read_text()
        for path in (root / "workflow/src/swingdown").rglob("*.py")
        if path.name != "errors.py"
    ]
    names = {name for text in texts for name in re.findall(r"⟨(?:in )?(\w+)", text)}
    assert len(names) > 8 and names <= {*COLUMNS, "restoring"}
    assert {*CELLS} <= {*COLUMNS}


def test_what_the_mend_of_a_path_names_can_be_said_in_the_call(tmp_path):
    """A column of readings without times asks for their rate, and ``fit`` takes it as ``read`` does."""
    angle = 0.2 * np.exp(-0.02 * np.arange(0, 20, 0.02)) * np.cos(5 * np.arange(0, 20, 0.02))
    np.savetxt(file := tmp_path / "a.txt", angle + np.random.default_rng(3).normal(0, 1e-4, angle.size))
    with pytest.raises(InputError, match="rate="):
        swingdown.fit(file)
    found = swingdown.fit(file, rate=50, unit="rad", stop=15, restoring="linear")
    assert abs(found["period"].value - 2 * np.pi / 5) < 1e-3 and found.swings[0]["time"].values[-1] <= 15
    with pytest.raises(InputError, match="argument rat.*say rate="):
        swingdown.fit(file, rat=50)
    with pytest.raises(InputError, match="no such argument"):
        swingdown.fit(np.arange(angle.size) / 50, angle, rate=50)
    with pytest.raises(InputError, match="zero_tolerance= to swingdown.read"):
        swingdown.fit(swingdown.read(file, rate=50, unit="rad"), zero_tolerance=0.2)


def test_one_label_and_one_name_need_no_list():
    times = np.arange(0, 20, 0.02)
    angle = 0.2 * np.exp(-0.02 * times) * np.cos(5 * times) + np.random.default_rng(3).normal(
        0, 1e-4, times.size
    )
    found = swingdown.fit(times, angle, fitted="viscous", names="anna", restoring="linear")
    assert list(found.fits["fitted"].values) == ["viscous"] and found.table["recording"].tolist() == ["anna"]
