"""How a calibration is laid out as a dataset: every number with its unit and what it is."""

from collections.abc import Callable, Mapping, Sequence
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from ..arrays import Floats
from ..dataset import variable
from ..measurement.apparatus import Apparatus
from ..measurement.uncertainty import Mean
from .chain import Chain
from .deviation import KINDS, deviation_lines
from .modes import COVERAGE, MODES


class Read(NamedTuple):
    """Mean voltages on the ``towers``, in the order of the apparatus's points, and at ``rest`` (None: not recorded), and the standard
    deviation (V) of the ``noise`` of a sample."""

    towers: Sequence[Mean]
    rest: Mean | None
    noise: float


def dataset(
    apparatus: Apparatus,
    points: SimpleNamespace,
    results: Mapping[str, SimpleNamespace],
    read: Read,
    chain: Chain,
    used: list[int],
) -> xr.Dataset:
    means, n = read.towers, len(read.towers)

    def each(pick: Callable[[SimpleNamespace], ArrayLike]) -> Floats:
        return np.array([pick(results[mode]) for mode in MODES])

    def over_points(pick: Callable[[SimpleNamespace], ArrayLike]) -> Floats:
        filled = np.full((len(MODES), n), np.nan)
        filled[:, used] = each(pick)
        return filled

    deviation = {}
    for mode in MODES:
        found = results[mode]
        x, y = chain.voltages(chain.values), chain.angles(chain.values)
        deviation[mode] = deviation_lines(found.line, x, y, *found.boxes)
    angle_u = over_points(lambda r: r.boxes[1])
    angle_u[1], angle_u[2] = points.gum, points.monte_carlo
    worst = np.full(n, np.nan)
    worst[used] = results["paper"].worst
    volts = [m.value for m in means]
    two = ("coefficient", "coefficient_2")
    gum, drawn = results["gum"], results["monte-carlo"]
    line_zero = [r.line.inverse(0.0) for r in results.values()]
    names = ["intercept", "slope", "rest_voltage"]
    v: dict[str, tuple[Any, ...]] = {
        "height": ("point", [p["height"] for p in apparatus["points"]], "m", "height of the calibration tower"),
        "height_limit": ("point", [p["limit"] for p in apparatus["points"]], "m", "limit of error of the height"),
        "angle": ("point", points.angle, "rad", "angle of the arm from the lengths (Eq. 7a)"),
        "angle_uncertainty": (("mode", "point"), angle_u, "rad", "uncertainty of the angle; mode paper: limit of error"),
        "angle_worst_case": ("point", worst, "rad", "limit of error of the angle, sizes of all terms added"),
        "angle_correlation": (("point", "point_2"), points.correlation, "1", "correlation of the angles by shared lengths"),
        "voltage": ("point", volts, "V", "mean voltage on the tower"),
        "voltage_uncertainty": (("mode", "point"), over_points(lambda r: r.boxes[0]), "V",
                                "uncertainty of the voltage; mode paper: limit of error"),
        "voltage_random_uncertainty": ("point", [m.standard_uncertainty for m in means], "V",
                                       "Type A uncertainty of the mean voltage, autocorrelation included"),
        "voltage_lag_1": ("point", [m.lag_1 for m in means], "1", "lag-1 autocorrelation of the voltage"),
        "probability_impossible": ("point", points.impossible, "1", "share of draws with the drop longer than the arm"),
        "disagreement": ("point", points.disagreement, "1",
                         "distance of GUM and Monte-Carlo interval ends, in standard uncertainties"),
        "residual": (("mode", "point"), over_points(lambda r: chain.angles(chain.values) - r.line.predict(chain.voltages(chain.values))[0]),
                     "rad", "point minus line"),
        "deviation_line_factor": ("mode", [deviation[m][1] for m in MODES], "1",
                                  "what the error boxes were multiplied by for a line to pass through all"),
        "chi2": ("mode", each(lambda r: r.line.chi2), "1", "chi-squared of the line"),
        "line_rest_voltage": ("mode", [z[0] for z in line_zero], "V", "voltage where the line is zero"),
        "line_rest_voltage_uncertainty": ("mode", [z[1] for z in line_zero], "V", "uncertainty of line_rest_voltage"),
        "rest_voltage": ("mode", each(lambda r: r.values[2]), "V", "voltage V0 of the vertical arm (Eq. 11)"),
        "rest_voltage_uncertainty": ("mode", each(lambda r: np.sqrt(r.covariance[2, 2])), "V", "uncertainty of rest_voltage"),
        "slope_rest_covariance": ("mode", each(lambda r: r.covariance[1, 2]), "rad", "covariance of slope and rest_voltage"),
        "coverage_factor": ("mode", each(lambda r: r.factor), "1",
                            "k of U = k u for 95 %; mode paper: 1, its uncertainties being limits"),
        "effective_dof": ("mode", each(lambda r: r.dof), "1", "degrees of freedom of an angle (Welch-Satterthwaite)"),
        "noise_voltage": ((), read.noise, "V", "standard deviation of a single sample with nothing moving"),
        "encoder_up_to": ("range", [e["up_to"] for e in apparatus["encoder"]["limits"]], "V", "upper end of a range"),
        "encoder_limit": ("range", [e["limit"] for e in apparatus["encoder"]["limits"]], "V", "limit of the encoder's error"),
        "grid_angle": ("grid", drawn.grid[0], "rad", "mean angle of one sample by Monte Carlo"),
        "grid_uncertainty": ("grid", drawn.grid[1], "rad", "standard deviation of that angle"),
        "grid_low": ("grid", drawn.grid[2], "rad", "lower end of its 95 % interval"),
        "grid_high": ("grid", drawn.grid[3], "rad", "upper end of its 95 % interval"),
    }  # fmt: skip
    variables = {k: variable(d, np.asarray(a, dtype=float), t, u) for k, (d, a, u, t) in v.items()}
    tells = np.flatnonzero(np.any(gum.propagation.contributions[1:3] != 0, axis=0))
    mixed = "numbers of rad for the intercept, of rad V-1 for the slope"
    covaried = "numbers of the products of the coefficients' units"
    lines = each(lambda r: [r.line.intercept, r.line.slope])
    covariances, farthest = each(lambda r: r.covariance[:2, :2]), np.array([deviation[m][0] for m in MODES])
    numbers = "numbers of rad V-1 for the slope, of V for the rest voltage"
    does = "what a standard uncertainty of a source does to slope and rest voltage"
    sources = gum.propagation.contributions[1:3, tells]
    over, ends = ("mode", "coefficient"), ("mode", "kind", "side", "coefficient")
    variables |= {
        "line": variable(over, lines, "angle = intercept + slope voltage", "1", comment=mixed),
        "line_covariance": variable(
            ("mode", *two), covariances, "covariance of the line", "1", comment=covaried
        ),
        "deviation_line": variable(ends, farthest, "lines of maximum deviation", "1", comment=mixed),
        "contribution": variable(("quantity", "source"), sources, does, "1", comment=numbers),
        "flagged": variable(
            "point", list(map(bool, points.reasons)), "point where the angle's uncertainty is in doubt"
        ),
        "used": variable("point", [k in used for k in range(n)], "point used for the line"),
        "flag_reason": variable("point", np.array(points.reasons, dtype="U"), "why the point is flagged"),
    }
    coords = {
        "mode": list(MODES),
        "point": np.arange(1, n + 1),
        "point_2": np.arange(1, n + 1),
        "coefficient": names[:2],
        "coefficient_2": names[:2],
        "kind": list(KINDS),
        "quantity": names[1:],
        "source": [gum.propagation.inputs[k].name for k in tells],
        "side": ["lower", "upper"],
        "range": np.arange(len(apparatus["encoder"]["limits"])),
        "grid": variable("grid", drawn.grid_voltage, "voltage of the sample", "V"),
    }
    attrs = {
        "dof": chain.line.dof,
        "encoder_kind": apparatus["encoder"]["kind"],
        "draws_left_out": float(drawn.left_out),
        "coverage": COVERAGE,
        "coverage_applies_to": "gum, monte-carlo; the limits of mode paper hold some 90 % of angles (docs/trust.md)",
    }
    if read.rest is not None:
        difference = gum.line.inverse(0.0)[0] - gum.values[2]
        attrs["zero_difference_over_u"] = float(abs(difference) / gum.line.inverse(0.0)[1])
    return xr.Dataset(variables, coords, attrs)
