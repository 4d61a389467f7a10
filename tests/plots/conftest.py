"""Small datasets laid out as the workflow lays them out, for figures to be drawn from."""

import json
import os
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from picture import panels

from swingdown.pendulum.model import PAPER_MODELS
from swingdown.plots import style

FROZEN = Path(__file__).with_name("frozen.json")


@pytest.fixture
def frozen(request, monkeypatch):
    """Of a test whose figures stay as they are: what each looks like is held against what it looked like.

    Where a figure was meant to change, look at it, and ``FROZEN_WRITE=1 make test TESTS="tests/plots -n0"`` writes all anew.
    """
    drawn, new_figure = [], style.new_figure

    def kept(*args, **kwargs):
        drawn.append(new_figure(*args, **kwargs))
        return drawn[-1]

    monkeypatch.setattr(style, "new_figure", kept)
    yield
    known, name = json.loads(FROZEN.read_text()), request.node.nodeid.split("/")[-1]
    seen = [" ".join(f"{panel}:{letters}" for panel, letters in panels(figure).items()) for figure in drawn]
    if os.environ.get("FROZEN_WRITE"):
        FROZEN.write_text(json.dumps(known | {name: seen}, indent=0, sort_keys=True) + "\n")
    else:
        # a figure that is new has no look yet
        assert seen == known.get(name, seen), "a figure is another than it was (see the fixture ``frozen``)"


SIMULATED = PAPER_MODELS[:3]
PAPER_TABLE_2 = {
    ("viscous", "viscous"): (0.09, 0.06),
    ("viscous", "quadratic_drag"): (0.45, 0.06),
    ("viscous", "load_coulomb"): (0.51, 0.09),
    ("viscous", "quadratic_drag+load_coulomb"): (0.09, 0.09),
    ("quadratic_drag", "viscous"): (0.56, 0.07),
    ("quadratic_drag", "quadratic_drag"): (0.07, 0.05),
    ("quadratic_drag", "load_coulomb"): (1.24, 0.10),
    ("quadratic_drag", "viscous+load_coulomb"): (0.12, 0.02),
    ("load_coulomb", "viscous"): (0.65, 0.07),
    ("load_coulomb", "quadratic_drag"): (1.13, 0.05),
    ("load_coulomb", "load_coulomb"): (0.12, 0.06),
    ("load_coulomb", "viscous+quadratic_drag"): (0.18, 0.02),
}
PAPER_TABLE_3 = {
    "error_bounds": (0.09418, 0.00137),
    "viscous": (0.82469, 0.03612),
    "quadratic_drag": (1.41769, 0.0454),
    "load_coulomb": (0.15843, 0.01971),
    "viscous+quadratic_drag": (0.30802, 0.03956),
    "viscous+load_coulomb": (0.13205, 0.01061),
    "quadratic_drag+load_coulomb": (0.13102, 0.00998),
    "viscous+quadratic_drag+load_coulomb": (0.13249, 0.00909),
}


def decay(times, release, rate=0.12, frequency=7.2):
    """A swing that dies out, in rad: good enough to look at."""
    return np.radians(release) * np.exp(-rate * times) * np.cos(frequency * times)


@pytest.fixture
def realizations():
    random = np.random.default_rng(1)
    time = np.linspace(0, 5, 501)
    truth = np.stack([decay(time, 20, rate) for rate in (0.2, 0.1, 0.15)])
    noisy = truth[:, None] * (1 + random.standard_normal((3, 4, time.size)) / 50)
    return xr.Dataset(
        {"truth": (("simulated", "time"), truth), "noisy": (("simulated", "realization", "time"), noisy)},
        coords={"simulated": list(SIMULATED), "realization": range(4), "time": time},
        attrs={"snr": 50.0, "seed": 150, "stream": "R", "inferred": "release angle 20°, duration 5 s, ζq, γ"},
    )


@pytest.fixture
def norms():
    random = np.random.default_rng(2)
    middle = np.stack([[PAPER_TABLE_2.get((s, f), (0.1, 0))[0] for f in PAPER_MODELS] for s in SIMULATED])
    norm = np.abs(middle[..., None] + 0.07 * random.standard_normal((3, 7, 10)))
    dims = ("simulated", "fitted", "realization")
    return xr.Dataset(
        {"norm": (dims, norm), "least_squares_norm": (dims, norm + 1e-4)},
        coords={"simulated": list(SIMULATED), "fitted": list(PAPER_MODELS), "realization": range(10)},
        attrs={
            "snr": 50.0,
            "seed": 150,
            "inferred": "release angle 20°, duration 5 s, ζq, γ, start at rest, norm",
        },
    )


@pytest.fixture
def table2():
    rows = [(s, f, m, d) for (s, f), (m, d) in PAPER_TABLE_2.items()]
    return pd.DataFrame(rows, columns=["simulated", "fitted", "published_mean", "published_std"])


@pytest.fixture
def apparatus():
    lengths = {
        "arm": (0.208, 4e-5),
        "shaft_diameter": (0.0127, 2e-6),
        "over_shaft": (0.24635, 4e-5),
        "bob_diameter": (0.0254, 2e-6),
    }
    return {
        "emulated": True,
        "lengths": {name: {"value": value, "limit": limit} for name, (value, limit) in lengths.items()},
        "points": [{"height": height, "limit": 4e-5} for height in (0.0195, 0.02385, 0.03445, 0.0509)],
    }


@pytest.fixture
def calibration():
    angle = np.radians([12.0, 31.0, 47.0, 61.0])
    modes, sides, kinds = (
        ["paper", "gum", "monte-carlo"],
        ["lower", "upper"],
        ["extreme", "one-sigma", "covariance"],
    )
    slope, intercept = np.radians(9.0), np.radians(-20.0)
    voltage = (angle - intercept) / slope + np.array([0.004, -0.006, 0.005, -0.002])
    turn = np.radians([[-0.5, 0.085], [0.5, -0.085]])
    deviation = np.stack([scale * turn + (intercept, slope) for scale in (1.0, 0.5, 0.4)])
    sizes = np.radians([[0.09, 0.05, 0.04, 0.035], [0.06, 0.035, 0.028, 0.025], [0.07, 0.035, 0.028, 0.025]])
    return xr.Dataset(
        {
            "height": ("point", [0.05, 0.07, 0.09, 0.11]),
            "angle": ("point", angle),
            "angle_uncertainty": (("mode", "point"), sizes),
            "voltage": ("point", voltage),
            "voltage_uncertainty": (
                ("mode", "point"),
                [[0.015, 0.015, 0.025, 0.025]] + [[0.0087, 0.0087, 0.0144, 0.0144]] * 2,
            ),
            "flagged": ("point", [True, False, False, False]),
            "line": (("mode", "coefficient"), [[intercept, slope]] * 3),
            "deviation_line": (("mode", "kind", "side", "coefficient"), np.stack([deviation] * 3)),
            "deviation_line_factor": ("mode", [1.0, 2.0, 2.0]),
        },
        coords={
            "mode": modes,
            "point": range(4),
            "coefficient": ["intercept", "slope"],
            "kind": kinds,
            "side": sides,
        },
        attrs={"emulated": "yes"},
    )


@pytest.fixture
def angles():
    random = np.random.default_rng(3)
    time = 0.5 + np.arange(1501) / 100
    angle = decay(time - 0.5, 24, 0.06) + np.radians(0.05) * random.standard_normal(time.size)
    bound = np.radians(0.18 + 0.004 * np.degrees(np.abs(angle)))
    attrs = {
        "recording": "swing-01",
        "campaign": "bench",
        "mode": "gum",
        "coverage_factor": 1.98,
        "emulated": "yes",
    }
    random = ("time", np.full(time.size, np.radians(0.05)))
    variables = {"angle": ("time", angle), "angle_bound": ("time", bound), "angle_random_uncertainty": random}
    return xr.Dataset(variables, {"time": time}, attrs)


@pytest.fixture
def fits():
    random = np.random.default_rng(3)
    time = 0.5 + np.arange(1501) / 100
    angle = decay(time - 0.5, 24, 0.06) + np.radians(0.05) * random.standard_normal(time.size)
    norm = [PAPER_TABLE_3[label][0] for label in PAPER_MODELS]
    residual = np.stack([np.radians(1.4 * size * np.sin(7.2 * time) * np.cos(0.3 * time)) for size in norm])
    residual += np.radians(0.05) * random.standard_normal(residual.shape)
    return xr.Dataset(
        {
            "norm": ("fitted", norm),
            "fit": (("fitted", "time"), angle - residual),
            "residual": (("fitted", "time"), residual),
        },
        coords={"fitted": list(PAPER_MODELS), "time": time},
        attrs={"recording": "swing-01", "campaign": "bench", "emulated": "yes"},
    )


@pytest.fixture
def run_norms():
    random = np.random.default_rng(4)
    columns = np.stack([m + d * random.standard_normal(10) for m, d in list(PAPER_TABLE_3.values())[1:]])
    return xr.Dataset(
        {
            "norm": (("fitted", "recording"), columns),
            "error_bound_norm": ("recording", 0.12 + 0.001 * random.standard_normal(10)),
        },
        coords={
            "fitted": list(PAPER_MODELS),
            "recording": [f"swing-{number:02d}" for number in range(10)],
            "campaign": ("recording", ["bench"] * 10),
        },
        attrs={"emulated": "yes"},
    )


@pytest.fixture
def table3():
    rows = [("bench", f, 0.9 * m, d, 10, m, d) for f, (m, d) in PAPER_TABLE_3.items()]
    names = ["campaign", "fitted", "mean", "std", "n", "published_mean", "published_std"]
    return pd.DataFrame(rows, columns=names)
