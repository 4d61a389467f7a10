"""An answer's numbers are the same wherever it tells them, and its swings are those of its model from where each began."""

import json
import math

import numpy as np
import pandas as pd
import pytest

import swingdown
from swingdown.answer.result import Answer
from swingdown.engine.trajectory import simulate
from swingdown.errors import InputError
from swingdown.pendulum.model import Model

TIMES = np.arange(801) / 50 + 3  # the clock began before the swing
TRUE = Model("viscous", {"natural_frequency": 4.4, "viscous_ratio": 0.006})
WIDE, NARROW = (simulate(TRUE, TIMES - 3, begin) for begin in (0.35, 0.2))
NOISE = 1e-3 * np.random.default_rng(3).standard_normal((2, TIMES.size))


@pytest.fixture(scope="module")
def one():
    return swingdown.fit(TIMES, WIDE + NOISE[0], unit="rad", fitted=["viscous", "load_coulomb"])


@pytest.fixture(scope="module")
def both():
    angles = [WIDE + NOISE[0], NARROW + NOISE[1]]
    return swingdown.fit(TIMES, angles, unit="rad", names=["wide", "narrow"], fitted=["viscous"])


@pytest.fixture(scope="module")
def gate():
    """Passages of a light gate without speeds."""
    return swingdown.fit(0.714 * np.arange(40) + 1e-4 * NOISE[0][:40], kind="passages")


def test_table_dict_and_quantities_tell_the_same(one):
    table, told = one.to_dataframe(), one.to_dict()
    assert isinstance(one, Answer) and list(table.index) == list(told["quantities"]) == list(one.quantities)
    for name, found in told["quantities"].items():
        value, u, unit = one.quantities[name]
        assert (
            found["value"] == table.loc[name, "value"] == value
            and found["unit"] == table.loc[name, "unit"] == unit
        )
        assert found["standard_uncertainty"] == u or (
            found["standard_uncertainty"] is None and not math.isfinite(u)
        )
        assert found["text"] == table.loc[name, "text"] and found["holds"] == table.loc[name, "holds"]
    assert one["natural_frequency"].value == pytest.approx(4.4, abs=4 * one["natural_frequency"].u)
    assert told["model"] == one.label == "viscous" and told["sentence"] == one.sentence
    assert told["amplitude_rad"] == pytest.approx(0.35, abs=0.02) and told["verdict"] is None
    assert json.loads(json.dumps(told)) == told


def test_what_a_fit_leaves_is_the_noise_in_rad(one):
    told, labelled = one.to_dict(), one.to_xarray()
    assert told["residual_rad"] == told["residual"]["value"] == pytest.approx(1e-3, rel=0.1)
    assert told["residual"]["unit"] == "rad" and told["emulated"] is False
    np.testing.assert_allclose(labelled["residual"], WIDE + NOISE[0] - labelled["fit"], atol=1e-12)
    assert labelled.attrs["model"] == "viscous" and labelled.attrs["emulated"] == "no"
    for name, found in one.quantities.items():
        assert float(labelled["value"].sel(quantity=name)) == found.value
        assert str(labelled["unit"].sel(quantity=name).values) == found.unit


def test_samples_of_several_swings_stand_in_their_order_under_their_names(both):
    labelled = both.to_xarray()
    assert list(dict.fromkeys(labelled["recording"].values)) == list(both.begins)
    for name, angle in (("wide", WIDE + NOISE[0]), ("narrow", NARROW + NOISE[1])):
        own = labelled.isel(sample=labelled["recording"].values == name)
        np.testing.assert_allclose(own["angle"], angle, atol=1e-12)
        assert float(np.std(own["residual"])) == pytest.approx(1e-3, rel=0.1)
    assert both.to_dict()["recordings"] == ["wide", "narrow"]
    assert both.row["recording"] == both.table["recording"].iloc[-1] not in ("wide", "narrow")


def test_a_swing_goes_on_from_where_and_when_it_began(both):
    for name, true in (("wide", WIDE), ("narrow", NARROW)):
        found = both.simulate(recording=name)
        np.testing.assert_allclose(found["time"], TIMES)
        assert np.abs(found.values - true).max() < 1e-3
        later = both.simulate([10.0, 15.0], recording=name)
        np.testing.assert_allclose(later, np.interp([10, 15], TIMES, true), atol=2e-3)
    np.testing.assert_array_equal(both.simulate(), both.simulate(recording=next(iter(both.begins))))
    pushed = both.simulate([0.0, 0.01], angle=0.1, velocity=2.0)
    assert float(pushed[0]) == pytest.approx(0.1) and float(pushed[1]) == pytest.approx(0.12, abs=1e-3)
    noisy = both.simulate(noise=0.01, seed=7)
    assert float(np.std(noisy - both.simulate())) == pytest.approx(0.01, rel=0.1)
    np.testing.assert_array_equal(noisy, both.simulate(noise=0.01, seed=7))


def test_what_is_not_there_is_told_with_what_is(one, both):
    with pytest.raises(InputError, match="none of that name. Expected: period, "):
        one["perod"]
    with pytest.raises(InputError, match="none of that name. Expected: wide, narrow"):
        both.simulate(recording="anna")
    with pytest.raises(InputError, match="there is no picture 'curve'"):
        one.plot("curve")


def test_passages_without_speeds_have_a_period_and_neither_model_nor_samples(gate):
    assert gate["period"].value == pytest.approx(1.428, abs=1e-3) and "sample" not in gate.to_xarray().dims
    assert gate.label == "not in the data" and gate.to_dict()["residual_rad"] is None
    for ask in (lambda: gate.model, gate.simulate, gate.plot):
        with pytest.raises(InputError, match="a swing, turning points, or passages with speeds|a swing"):
            ask()


def test_remarks_are_those_of_the_swings_and_then_of_the_fits_each_once(both):
    table = both.table.assign(remark=["odd", "odd", "odder"])
    swings = [
        one.assign_attrs(remarks=text) for one, text in zip(both.swings, ("held first", ""), strict=True)
    ]
    found = Answer(tuple(swings), both.fits, table, both.shown)
    assert found.remarks == ["wide: held first", "odd", "odder"]
    assert repr(found).splitlines()[:2] == [found.sentence, "wide: held first"]


def test_a_verdict_joins_the_row_of_all_and_leaves_the_answer_as_it_was(one):
    found = {"campaign": "swing", "status": "consistent", "sentence": "Nothing is missing.", "effects": [], "base": ["viscous"],
             "model": {}, "next_measurement": None, "not_needed": []}  # fmt: skip
    after = one.with_verdict(found)
    assert after.verdict == found and one.verdict is None and after.shown == one.shown
    assert isinstance(after.table, pd.DataFrame) and len(after.table) == len(one.table)
    assert after.to_dict()["verdict"] == found and after.quantities["period"] == one.quantities["period"]


def test_a_length_gives_g_and_none_leaves_the_answer(one):
    length = 9.81 / 4.4**2
    named, found = one.with_g({"swing": {"recording": "swing", "length": f"{length:.6f}(50) m"}})
    assert named["g"].value == pytest.approx(9.81, abs=0.01) and list(found) == ["swing"]
    same, none = one.with_g({"swing": {"recording": "swing"}})
    assert same is one and none == {}
