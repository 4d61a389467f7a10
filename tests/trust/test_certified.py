"""Published cases with known answers, as ``make certified`` computes them: in how many digits they are met."""

import shutil

import pytest

from swingdown.errors import InputError
from swingdown_trials.certified import table


@pytest.fixture(scope="module")
def found(certified):
    """The Quantities of all cases."""
    return table.quantities(certified)


def of(found, source, name=""):
    chosen = [one for one in found if source in one.source and name in one.name]
    assert chosen
    return chosen


def test_nists_fits_reach_six_digits_from_both_starts(found):
    """Of Lanczos1 the parameters alone: its certified sum of squares is 1e-25, the rounding of the data."""
    fits = of(found, "NIST StRD, nonlinear")
    cases = {one.case for one in fits}
    assert len(cases) == 27
    for start in (1, 2):
        assert {one.case for one in fits if one.name.endswith(f"start {start}")} == cases
    for one in fits:
        if one.name.startswith("b"):
            assert one.digits > 6, one
        elif one.case != "NIST Lanczos1":
            assert one.digits > (8 if "sum" in one.name else 4), one


# NumAcc3 and NumAcc4 scatter by 1e-7 and 1e-8 of their mean: a double holds that many digits fewer of the scatter.
KEPT = {"NIST NumAcc3": 9, "NIST NumAcc4": 8}


def test_nists_samples_keep_the_digits_that_the_data_have(found):
    for one in of(found, "NIST StRD, univariate"):
        assert one.digits > (14 if one.name == "mean" else KEPT.get(one.case, 14)), one


@pytest.mark.parametrize(
    ("source", "name"),
    [("York", ""), ("ISO/TS 28037", ""), ("annex H.3", ""), ("annex H.1", "u"), ("annex H.2", "r_")],
)
def test_all_printed_digits_are_met(found, source, name):
    for one in of(found, source, name):
        assert one.digits == one.stated, one


def test_monte_carlo_meets_what_a_million_draws_can(found):
    for one in of(found, "JCGM 101"):
        assert one.digits > min(one.stated, 2) - 0.01, one


def test_the_table_tells_the_worst_of_every_source(found):
    told = table.told(table.table(found)).splitlines()
    assert len(told) == len({one.source for one in found})
    assert any(
        line.startswith("NIST StRD, nonlinear regression: 534 quantities, digits met") for line in told
    )


def test_another_certified_value_is_met_in_fewer_digits_and_a_missing_file_is_told(certified, tmp_path):
    """The table is of what was computed: a value that is changed in its third digit is met in two."""
    copy = tmp_path / "certified"
    shutil.copytree(certified, copy)
    file = copy / "york_pearson/expected.json"
    file.write_text(file.read_text().replace("-0.480533407", "-0.489533407"))
    (slope,) = [
        one for one in table.lines.quantities(copy) if (one.case, one.name) == ("York/Pearson", "slope")
    ]
    assert 1.5 < slope.digits < 2
    file.unlink()
    with pytest.raises(InputError, match=r"expected\.json: it is not there.*restore resources/certified"):
        table.quantities(copy)
