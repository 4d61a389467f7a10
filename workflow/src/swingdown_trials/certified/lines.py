"""Straight lines with errors in one coordinate or both: York's and ISO/TS 28037's examples, and the GUM's thermometer (H.3)."""

import csv
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from swingdown.arrays import Floats
from swingdown.measurement.straight_line import Line, fit_line

from .case import Quantity, text, values

YORK = "York et al., Am. J. Phys. 72, 367 (2004); Pearson's data with York's weights"
MATHIOULAKIS = "Mathioulakis' data, as in the tests of GTC"
ISO = "ISO/TS 28037:2010, worked example"
GUM = "JCGM 100:2008, annex H.3"


def columns(path: Path) -> dict[str, Floats]:
    """The columns of a CSV file of numbers, by name."""
    rows = list(csv.DictReader(text(path).splitlines()))
    return {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}


def quantities(folder: Path) -> Iterator[Quantity]:
    """The Quantities of all lines. Standard errors are those of York et al., at the adjusted points."""
    yield from _york(folder / "york_pearson")
    yield from _iso(folder / "iso_ts_28037")
    yield from _thermometer(folder / "gum_h")


def _york(folder: Path) -> Iterator[Quantity]:
    known = values(folder / "expected.json")
    data = columns(folder / "pearson_york.csv")
    line = fit_line(data["x"], data["y"], data["weight_x"] ** -0.5, data["weight_y"] ** -0.5)
    found = _line(line) | {"reduced_chi2": line.chi2 / line.dof}
    for key, certified in known["pearson"].items():
        yield Quantity("York/Pearson", key, certified, found[key], YORK)
    data = columns(folder / "mathioulakis.csv")
    found = _line(fit_line(data["x"], data["y"], data["u_x"], data["u_y"]))
    for key, certified in known["mathioulakis"].items():
        yield Quantity("Mathioulakis", key, certified, found[key], MATHIOULAKIS)


def _line(line: Line) -> dict[str, float]:
    """A Line's numbers by the names that the files have."""
    u_intercept, u_slope = line.uncertainties
    return {
        "slope": line.slope, "intercept": line.intercept, "u_slope": u_slope, "u_intercept": u_intercept,
        "cov": line.covariance[0, 1], "chi2": line.chi2,
    }  # fmt: skip


def _iso(folder: Path) -> Iterator[Quantity]:
    names = {"a": "intercept", "b": "slope", "cov_ab": "cov", "chi2": "chi2"}
    names |= {f"u_{key}": f"u_{names[key]}" for key in "ab"}
    for case, known in values(folder / "expected.json").items():
        data = columns(folder / f"{case}.csv")
        line = fit_line(data["x"], data["y"], data.get("u_x", 0.0), data["u_y"])
        found = _line(line)
        for key, name in names.items():
            yield Quantity(f"ISO/TS 28037 {case.upper()}", name, known[key], found[name], ISO)
        if asked := known.get("inverse"):
            x, u = line.inverse(float(asked["y0"]), float(asked["u_y0"]))
            for key, ours in (("x0", x), ("u_x0", u)):
                yield Quantity(f"ISO/TS 28037 {case.upper()}", f"inverse {key}", asked[key], float(ours), ISO)


def _thermometer(folder: Path) -> Iterator[Quantity]:
    """The GUM takes the scatter about the line for the points' uncertainty."""
    known, data = values(folder / "expected.json")["H3"], columns(folder / "h3_data.csv")
    t, b = data["t_degC"] - float(known["t0"]), data["b_degC"]
    plain = fit_line(t, b, 0.0, 1.0)
    s = float(np.sqrt(plain.chi2 / plain.dof))
    line = fit_line(t, b, 0.0, s)
    b30, u30 = line.predict(10.0)
    u1, u2 = line.uncertainties
    found = {
        "y1": (line.intercept, "°C"), "u_y1": (u1, "°C"), "y2": (line.slope, "1"), "u_y2": (u2, "1"),
        "r": (line.covariance[0, 1] / (u1 * u2), "1"), "s": (s, "°C"), "b30": (b30, "°C"), "u_b30": (u30, "°C"),
    }  # fmt: skip
    for key, (ours, unit) in found.items():
        yield Quantity("GUM H.3", key, known[key], float(ours), GUM, unit)
