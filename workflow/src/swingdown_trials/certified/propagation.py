"""Propagation of uncertainty: the GUM's end gauge and impedance (H.1, H.2) to first order, JCGM 101's cases by Monte Carlo."""

import csv
from collections.abc import Iterator
from math import sqrt
from pathlib import Path
from typing import Any

import numpy as np

from swingdown.arrays import Floats
from swingdown.measurement.uncertainty import (
    Input,
    coverage_factor,
    draw_inputs,
    from_limit,
    propagate_gum,
    symmetric_interval,
)

from .case import Quantity, pairs, text, values
from .lines import columns

DRAWS = 1_000_000
DRAWN = ("y", "u", "shortest 95 % low", "shortest 95 % high")  # what ``summarise`` tells
RECALLED = "; recalled, and derived again by 4e6 draws of another program"


def summarise(values: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Mean, standard deviation, and the ends of the shortest interval that holds 95 % of draws, which lie along the last axis."""
    low, high = shortest_interval(values)
    return values.mean(axis=-1), values.std(axis=-1, ddof=1), low, high


def shortest_interval(values: Floats) -> tuple[Floats, Floats]:
    """The ends of the shortest interval that holds 95 % of draws, which lie along the last axis."""
    ordered = np.sort(values, axis=-1)
    inside = int(0.95 * ordered.shape[-1] + 0.5)
    at = np.argmin(ordered[..., inside:] - ordered[..., :-inside], axis=-1)[..., None]
    low, high = (np.take_along_axis(ordered, k, axis=-1)[..., 0] for k in (at, at + inside))
    return low, high


def quantities(folder: Path) -> Iterator[Quantity]:
    """The Quantities of the GUM's and of JCGM 101's examples."""
    yield from _end_gauge(folder / "gum_h")
    yield from _impedance(folder / "gum_h")
    known = values(folder / "jcgm_101_102/expected.json")
    yield from _additive(known)
    yield from _mass(known["mass_calibration_9.3"])
    yield from _loss(known["comparison_loss_9.4"]["rows"])


def _end_gauge(folder: Path) -> Iterator[Quantity]:
    known, source = values(folder / "expected.json")["H1"], "JCGM 100:2008, annex H.1"
    inputs = []
    for row in csv.DictReader(text(folder / "h1_inputs.csv").splitlines()):
        name, kind = row["name"], row["distribution"]
        value, width, dof = (float(row[key]) for key in ("value", "half_width_or_u", "dof"))
        normal = Input(name, value, width, dof=dof)
        inputs.append(normal if kind == "normal" else from_limit(name, value, width, kind, dof=dof))

    def gauge(x: Floats) -> Floats:
        standard, d0, d1, d2, alpha, d_alpha, d_theta, theta, cyclic = x
        return standard + d0 + d1 + d2 - standard * (d_alpha * (theta + cyclic) + alpha * d_theta)

    length, difference = propagate_gum(gauge, inputs), propagate_gum(lambda x: x.sum(axis=0), inputs[1:4])
    found = {
        "l_nm": (length.value[0], "nm"), "u_nm": (length.standard_uncertainty[0], "nm"), "eff_dof": (np.floor(length.dof[0]), "1"),
        "u_d_nm": (difference.standard_uncertainty[0], "nm"), "dof_d": (difference.dof[0], "1"),
        "k": (coverage_factor(np.floor(length.dof[0]), 0.99), "1"),
    }  # fmt: skip
    for key, (ours, unit) in found.items():
        more = "; recalled" if key == "k" else ""
        yield Quantity("GUM H.1", key.removesuffix("_nm"), known[key], float(ours), source + more, unit)


def _impedance(folder: Path) -> Iterator[Quantity]:
    known, source = values(folder / "expected.json")["H2"], "JCGM 100:2008, annex H.2"
    data = columns(folder / "h2_data.csv")
    data["I_mA"] = 1e-3 * data["I_mA"]
    inputs = [Input(name, one.mean(), one.std(ddof=1) / sqrt(len(one))) for name, one in data.items()]

    def impedance(x: Floats) -> Floats:
        volts, amperes, phase = x
        z = volts / amperes
        return np.array([z * np.cos(phase), z * np.sin(phase), z])

    result = propagate_gum(impedance, inputs, np.corrcoef(list(data.values())))
    u = result.standard_uncertainty
    r = result.covariance / np.outer(u, u)
    for k, name in enumerate("RXZ"):
        yield Quantity("GUM H.2", name, known[name], float(result.value[k]), source, "ohm")
        yield Quantity("GUM H.2", f"u_{name}", known[f"u_{name}"], float(u[k]), source, "ohm")
    for name, at in (("r_RX", (0, 1)), ("r_RZ", (0, 2)), ("r_XZ", (1, 2))):
        yield Quantity("GUM H.2", name, known[name], float(r[at]), source)


def _additive(known: dict[str, Any]) -> Iterator[Quantity]:
    keys = {"9.2.2": "additive_normal", "9.2.3": "additive_rect", "9.2.4": "additive_rect_unequal"}
    for number, key in keys.items():
        case, name = known[f"{key}_{number}"], f"JCGM 101 {number}"
        source = f"JCGM 101:2008, {number}" + (RECALLED if "recalled" in case["source"] else "")
        widths = [sqrt(3)] * 3 + [10 * sqrt(3) if number == "9.2.4" else sqrt(3)]
        normal = number == "9.2.2"
        inputs = [Input("x", 0.0, 1.0) if normal else from_limit("x", 0.0, width) for width in widths]
        drawn = draw_inputs(inputs, DRAWS, 1).sum(axis=0)
        yield Quantity(name, "u", case["u"], float(drawn.std()), source, draws=DRAWS)
        both = pairs(case["ci95"], symmetric_interval(drawn))
        for end, (true, ours) in zip(("low", "high"), both, strict=True):
            yield Quantity(name, f"95 % {end}", true, ours, source, draws=DRAWS)


def _mass(case: dict[str, Any]) -> Iterator[Quantity]:
    source = "JCGM 101:2008, 9.3" + RECALLED
    inputs = [
        Input("m", 100000.0, 0.05),
        Input("dm", 1.234, 0.02),
        from_limit("rho_a", 1.2, 0.1),
        from_limit("rho_w", 8000.0, 1000.0),
        from_limit("rho_r", 8000.0, 50.0),
    ]

    def mass(x: Floats) -> Floats:
        m, dm, air, weight, reference = x
        return (m + dm) * (1 + (air - 1.2) * (1 / weight - 1 / reference)) - 100000.0

    first = propagate_gum(mass, inputs)
    half = first.expanded()[0]
    for key, true, ours in (
        ("y", case["y_mg"], first.value[0]),
        ("u, first order", case["u_first_order"], first.standard_uncertainty[0]),
        ("95 % low, first order", case["ci95_first_order"][0], first.value[0] - half),
        ("95 % high, first order", case["ci95_first_order"][1], first.value[0] + half),
    ):
        yield Quantity("JCGM 101 9.3", key, true, float(ours), source, "mg")
    found = summarise(mass(draw_inputs(inputs, DRAWS, 2)))
    known = [case["y_mg"], case["u_mc"], *case["shortest95_mc"]]
    for key, (true, ours) in zip(DRAWN, pairs(known, found), strict=True):
        yield Quantity("JCGM 101 9.3", key, true, ours, source, "mg", draws=DRAWS)


def _loss(rows: list[dict[str, Any]]) -> Iterator[Quantity]:
    source = "JCGM 101:2008, 9.4" + RECALLED
    for row in rows:
        inputs = [Input("x1", float(row["x1"]), 0.005), Input("x2", 0.0, 0.005)]
        r = float(row["r"])
        correlation = np.array([[1, r], [r, 1]])
        name = f"JCGM 101 9.4, x1 {row['x1']}, r {row['r']}"

        def loss(x: Floats) -> Floats:
            return 1e6 * (x**2).sum(axis=0)

        first = propagate_gum(loss, inputs, correlation).standard_uncertainty[0]
        yield Quantity(name, "u, first order", row["gum_u"], float(first), source, "1e-6")
        found = summarise(loss(draw_inputs(inputs, DRAWS, 3, correlation)))
        known = [row["mean"], row["u"], *row["shortest95"]]
        for key, (true, ours) in zip(DRAWN, pairs(known, found), strict=True):
            yield Quantity(name, key, true, ours, source, "1e-6", draws=DRAWS)
