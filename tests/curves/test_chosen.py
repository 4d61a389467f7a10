"""Of which model a pendulum's curves are drawn after a search."""

import numpy as np
import pytest

from swingdown.curves.chosen import of_verdict

NAMES = ["natural_frequency", "viscous_ratio"]
VERDICT = {
    "status": "named",
    "conclusion": {
        "model": "viscous+sensor_gain",
        "left_out": ["sensor_gain"],
        "parameters": NAMES,
        "quantities": {"natural_frequency": {"value": 7.25}, "viscous_ratio": {"value": 0.01}},
        "covariance": [[1e-6, None], [None, 1e-8]],
    },
}


def concluded(**changed):
    return VERDICT | {"conclusion": VERDICT["conclusion"] | changed}


def test_it_is_the_motion_that_the_verdict_concludes_with_and_what_is_unknown_is_nan():
    model, covariance = of_verdict(VERDICT)
    assert model.names == ("viscous",) and dict(model.values) == {
        "natural_frequency": 7.25,
        "viscous_ratio": 0.01,
    }
    assert covariance[0, 0] == 1e-6 and np.isnan(covariance[0, 1]) and covariance.shape == (2, 2)
    assert of_verdict(VERDICT, "linear")[0].restoring == "linear"


@pytest.mark.parametrize(
    "verdict",
    [
        VERDICT | {"status": "unknown"},
        {"status": "named", "conclusion": None},
        {"status": "consistent"},
        concluded(model="viscous+nobody_knows"),
        concluded(parameters=[*NAMES, "another"]),
        concluded(quantities={"natural_frequency": {"value": 7.25}}),
        concluded(quantities={"natural_frequency": {"value": 7.25}, "viscous_ratio": {"value": None}}),
    ],
    ids=[
        "unknown",
        "nothing concluded",
        "none told",
        "no name",
        "other parameters",
        "no value",
        "value unknown",
    ],
)
def test_without_a_model_that_moves_there_is_none(verdict):
    assert of_verdict(verdict) is None
