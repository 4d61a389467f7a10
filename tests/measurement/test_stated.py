"""Quantities as people write them in a cell, an option or a table."""

import numpy as np
import pytest

from swingdown.errors import InputError
from swingdown.measurement.positions import metres
from swingdown.measurement.stated import quantity, read


@pytest.mark.parametrize(
    "text",
    ["0.583±0.001", "0.583 ± 0.001 m", "0.583+-0.001", "0.583 +/- 0.001 m", "0.583(1)", "0.583(1) m", "0,583±0,001",
     "58.3(1) cm", "58.3±0.1cm", "(58.3 ± 0.1) cm", "583(1)mm", "583 mm ± 1 mm", "0.583 m ± 1 mm", "0.583(0.001)", "5.83(1)e-1"],
)  # fmt: skip
def test_a_length_is_read_with_its_standard_uncertainty(text):
    found = read(text).of("m")
    assert found.value == pytest.approx(0.583, rel=1e-12) and found.uncertainty == pytest.approx(
        0.001, rel=1e-12
    )


@pytest.mark.parametrize(
    ("text", "kind", "value"),
    [("2 m", "m", 2), ("5 dm", "m", 0.5), ("40 mm", "m", 0.04), ("10 in", "m", 0.254), ("2 ft", "m", 0.6096), ("2 kg", "kg", 2), ("500 g", "kg", 0.5),
     ("500 mg", "kg", 5e-4), ("2 m²", "m^2", 2), ("40cm2", "m^2", 0.004), ("40 mm^2", "m^2", 4e-5), ("2 A", "A", 2), ("400mA", "A", 0.4), ("5 V", "V", 5),
     ("300 mV", "V", 0.3), ("2 rad", "rad", 2), ("90°", "rad", np.pi / 2), ("1.2 kg/m³", "kg/m^3", 1.2), ("7.8 g/cm3", "kg/m^3", 7800)],
)  # fmt: skip
def test_units_become_those_of_the_si_and_nobody_invents_an_uncertainty(text, kind, value):
    found = read(text).of(kind)
    assert found.value == pytest.approx(value) and np.isnan(found.uncertainty)


@pytest.mark.parametrize(
    "text", ["58 kg", "abc", "-0.5", "0", "0.5±", "0.5(1)±0.1", "0.5 ± 0.1 kg", "nan", "1 m 2 cm"]
)
def test_what_is_no_length_is_refused_with_what_one_looks_like(text):
    with pytest.raises(InputError, match="is no length. Expected: a value above 0 in m, cm or mm"):
        quantity(text, "m", "--length", "length", "correct it")


def test_a_length_of_a_coordinate_may_bring_its_uncertainty():
    assert metres("58.0±0.2 cm", "mm", "here") == pytest.approx(580)
    assert metres("350(2)", "px", "here") == 350
