"""The study's numbers are those of before: code that is moved or tidied changes none of them.

Not to the last bit, for another processor or linear algebra library may round the last digits otherwise.
"""

import numpy as np
import pandas as pd
import pytest
import xarray as xr

SAME = 1e-9  # relative; of standard errors, which take a matrix inverse, a thousand times as much


# standard errors between two ends of one fit: it ends where a step promises 1e-10 of the sum of squares, with n samples
# sqrt(1e-10 n) standard errors from the optimum; where within that depends on how a processor rounds
STOPS = 2 * np.sqrt(1e-10 * 1001)


@pytest.fixture
def former(root):
    return lambda name: pd.read_csv(root / "tests/former" / f"{name}.csv")


def test_fits_of_measured_swings(small_study, former):
    keys = ["recording", "fitted", "parameter"]
    now = pd.read_csv(small_study / "results/tables/parameters.csv").set_index(keys)
    before = former("parameters").set_index(keys)
    assert len(before) == 38
    now = now.loc[before.index]
    off = (now["value"] - before["value"]).abs() - SAME * before["value"].abs()
    assert (off / before["standard_error"]).max() < STOPS
    # which goes with where the fit ends as the value does
    share = 1000 * SAME + STOPS * before["standard_error"] / before["value"].abs()
    assert ((now["standard_error"] / before["standard_error"] - 1).abs() / share).max() < 1


def test_norms_of_simulated_swings(small_study, former):
    with xr.open_dataset(small_study / "results/simulation/norms.nc") as data:
        now = data[["norm", "least_squares_norm"]].sel(simulated="viscous").to_dataframe()
    before = former("norms").set_index(["fitted", "realization"])
    # the simplex stops within a share of 1e-8 of the sum of squares, which lets the norm of what it fits wander further
    for name, share in (("least_squares_norm", 100 * SAME), ("norm", 1e-6)):
        np.testing.assert_allclose(now.loc[before.index, name], before[name], rtol=share)


def test_the_calibrations_line(small_study, former):
    before = former("line").set_index(["mode", "coefficient"])
    with xr.open_dataset(small_study / "results/calibration/calibration.nc") as data:
        for (mode, name), row in before.iterrows():
            assert float(data["line"].sel(mode=mode, coefficient=name)) == pytest.approx(
                row["value"], rel=SAME
            )
            variance = data["line_covariance"].sel(mode=mode, coefficient=name, coefficient_2=name)
            assert float(variance) == pytest.approx(row["variance"], rel=1000 * SAME)
