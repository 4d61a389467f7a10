"""How often theory's exponent lies inside two standard uncertainties, in series of computed recordings that are fitted as files are.

    .venv/bin/python tests/benchmarks/series_coverage.py [SERIES]

Each series has five recordings of 15 s with noise, of a viscous pendulum let go at 10 to 25 degrees: T over lengths with errors of a
millimetre, and with one beside that all share, of a centimetre, which nobody states; decay rate over the area of a sail (one of them none),
decay rate over the mass. The errors of what was varied are stated, or they are not, and the scatter has to tell them. The exponent is the one
that the sentence tells; that of lengths taken for exact is printed too.
"""

import sys

import numpy as np
import pandas as pd

import swingdown
from swingdown.engine.trajectory import simulate
from swingdown.measurement.stated import Stated
from swingdown.pendulum.model import Model
from swingdown.series import series_of

TIMES = np.arange(751) / 50  # s
NOISE = 0.002  # rad


def recording(draw: np.random.Generator, length: float, rate: float) -> tuple[np.ndarray, np.ndarray]:
    """Times and angles of a pendulum with a decay rate (1/s)."""
    omega = np.sqrt(9.81 / length)
    model = Model("viscous", {"natural_frequency": omega, "viscous_ratio": rate / omega})
    exact = simulate(model, TIMES, np.radians(draw.uniform(10, 25)))
    return TIMES, exact + NOISE * draw.standard_normal(TIMES.size)


def drawn(
    kind: str, draw: np.random.Generator
) -> tuple[str, list[tuple[Stated, tuple[np.ndarray, np.ndarray]]]]:
    """What is varied, and for each of five recordings the stated value and the samples."""
    if kind.startswith("T of L"):
        stated, u, dimension = np.array([0.2, 0.3, 0.45, 0.7, 1.0]), 0.001, "m"
        true = stated + u * draw.standard_normal(5)
        if kind != "T of L":
            true += 0.01 * draw.standard_normal()
        return "length", [
            (Stated(x, u, dimension), recording(draw, at, 0.03)) for x, at in zip(stated, true, strict=True)
        ]
    if kind == "γ of area":
        stated, u, dimension = np.array([0.0, 20.0, 40.0, 60.0, 80.0]), 0.5, "cm^2"
        true = np.where(stated > 0, stated + u * draw.standard_normal(5), 0.0)
        return "area", [
            (Stated(x, u if x else 0.0, dimension), recording(draw, 0.4, 0.02 + 0.002 * at))
            for x, at in zip(stated, true, strict=True)
        ]
    stated, dimension = np.array([50.0, 100.0, 200.0, 300.0, 500.0]), "g"
    u = 0.01 * stated
    true = stated + u * draw.standard_normal(5)
    return "mass", [
        (Stated(x, one, dimension), recording(draw, 0.4, 8.0 / at))
        for x, one, at in zip(stated, u, true, strict=True)
    ]


THEORY = {
    "T of L": "period",
    "T of L, all off": "period",
    "γ of area": "decay_rate",
    "γ of 1/m": "decay_rate",
}


def inside(kind: str, draw: np.random.Generator) -> list[bool]:
    """Whether theory is inside two standard uncertainties, with the errors of what was varied stated, and without; and the same of what was
    varied taken for exact but for these errors."""
    column, points = drawn(kind, draw)
    tables, values = [], {}
    for k, (x, (times, angles)) in enumerate(points):
        tables.append(swingdown.fit(times, angles, fitted=("viscous",), names=[str(k)]).table)
        values[str(k)] = {column: x}
    table = pd.concat(tables, ignore_index=True)
    bare = {name: {column: one[column]._replace(uncertainty=np.nan)} for name, one in values.items()}
    found = [
        next(one for one in series_of(table, given) if one.quantity == THEORY[kind])
        for given in (values, bare)
    ]
    return [one.away <= 2 for one in found] + [one.law.away <= 2 for one in found]


if __name__ == "__main__":
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 70
    for number, kind in zip((0, 3, 1, 2), THEORY, strict=True):  # each kind keeps its draws
        found = np.array([inside(kind, np.random.default_rng([26, number, k])) for k in range(count)])
        told, bare, exact, bare_exact = (f"{one:.0%}" for one in found.mean(axis=0))
        print(
            f"{kind}: theory inside two u in {told} of {count} with the errors stated, {bare} without; taken for exact {exact}, {bare_exact}",
            flush=True,
        )
