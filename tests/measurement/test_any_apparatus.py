"""Whatever stands in an apparatus sheet: an InputError with a mend, or a calibration of finite numbers."""

import copy

import numpy as np
import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from ways import paths

from swingdown.calibration import calibrate
from swingdown.errors import InputError
from swingdown.measurement.apparatus import read_apparatus

FUZZ = settings(deadline=None, max_examples=80, suppress_health_check=[HealthCheck.function_scoped_fixture])
scalar = st.one_of(
    st.none(), st.booleans(), st.integers(-3, 12), st.floats(), st.floats(0, 0.3), st.text(max_size=8),
    st.sampled_from([1e308, 5e-324, "nan", "0.1", "uniform", "normal", "random", "systematic", "/", "..", "http://localhost:1/a.csv", "a\0b"]),
)  # fmt: skip
value = scalar | st.lists(scalar, max_size=3) | st.dictionaries(st.text(max_size=6), scalar, max_size=3)


@pytest.fixture(scope="module")
def sheet(root):
    return yaml.safe_load((root / "config/apparatus.yaml").read_text())


@FUZZ
@given(data=st.data())
def test_any_value_anywhere(sheet, data, tmp_path):
    content = copy.deepcopy(sheet)
    way = data.draw(st.sampled_from(sorted(paths(sheet), key=repr)))
    inside = content
    for key in way[:-1]:
        inside = inside[key]
    if data.draw(st.integers(0, 4)):
        inside[way[-1]] = data.draw(value)
    else:
        del inside[way[-1]]
    path = tmp_path / "apparatus.yaml"
    path.write_text(yaml.safe_dump(content))
    try:
        found = read_apparatus(path)
        if any(str(point["file"]).startswith("http") for point in found["points"]):
            return  # nobody answers there
        line, budget = calibrate(found, None, draws=500, seed=1, mode="gum")
    except InputError as error:
        assert error.where and error.problem
        return
    for mode in line["mode"].values:
        own = line.sel(mode=mode)
        assert np.isfinite(own["line"].values).all() and float(own["line"].sel(coefficient="slope")) != 0
        variances = np.diag(own["line_covariance"].values)
        assert np.isfinite(variances).all() and (variances > 0).all()


@FUZZ
@given(raw=st.binary(max_size=300))
def test_any_bytes(raw, tmp_path):
    path = tmp_path / "apparatus.yaml"
    path.write_bytes(raw)
    with pytest.raises(InputError):
        read_apparatus(path)
