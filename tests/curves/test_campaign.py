"""What curves are drawn of: the recordings that can be used, with the model that describes them."""

import numpy as np
import pandas as pd
import pytest

import swingdown
from swingdown.curves.campaign import recorded
from swingdown.engine.trajectory import simulate
from swingdown.errors import InputError
from swingdown.pendulum.catalogue import SHIPPED
from swingdown.pendulum.model import Model
from swingdown.studies.experiment import fit_recording
from swingdown.studies.pendulums import NO_MODEL

TIMES = np.arange(0, 20, 0.02)
NOISE = 1e-3


@pytest.fixture(scope="module")
def pair():
    """An angle dataset of a swing with viscous drag, and its fits."""
    model = Model("viscous", {"natural_frequency": 5.0, "viscous_ratio": 0.01})
    angle = simulate(model, TIMES, 0.5) + NOISE * np.random.default_rng(1).standard_normal(TIMES.size)
    (swing,) = swingdown.fit(TIMES, angle, unit="rad").swings
    return swing, fit_recording(swing, ["viscous", "quadratic_drag", "load_coulomb"])


def pendulums(pair, campaign="one", model="viscous"):
    name = str(pair[0].attrs["recording"])
    return pd.DataFrame([{"campaign": campaign, "recording": name, "model": model, "emulated": ""}])


def of(pairs, table):
    return recorded("one", pairs, [], [], table, SHIPPED, "sine")


def test_what_was_refused_is_left_out_and_damping_describes_the_rest(pair):
    one = of([(None, None), pair], pendulums(pair))
    assert [angle.attrs["recording"] for angle in one.angles] == [pair[0].attrs["recording"]]
    (found,) = one.laws()
    assert found.best.label == "viscous"
    curves = one.curves()
    assert curves["damping_ratio"].median().item() == pytest.approx(0.01, rel=0.05)


def test_a_recording_without_fits_is_none_where_others_have_them(pair):
    alone = pair[0].assign_attrs(recording="alone")
    assert len(of([(alone, None), pair], pendulums(pair)).angles) == 1


@pytest.mark.parametrize(
    ("pairs", "changed", "why"),
    [
        ([(None, None)], {}, "no recording can be used"),
        (None, {"campaign": "another"}, "no recording can be used"),
        (None, {"model": NO_MODEL[0]}, "damping"),
    ],
)
def test_where_nothing_tells_of_damping_the_reason_is_told(pair, pairs, changed, why):
    with pytest.raises(InputError, match=why):
        of(pairs or [pair], pendulums(pair, **changed))
