"""NIST's 27 certified non-linear fits, from both starts, by the minimiser that fits swings."""

from collections.abc import Callable, Iterator
from decimal import Decimal
from pathlib import Path
from typing import NamedTuple

import numpy as np

from swingdown.arrays import Floats

from .case import Quantity, text
from .minimum import least_squares

SOURCE = "NIST StRD, nonlinear regression"


def _lanczos(b: Floats, x: Floats) -> Floats:
    return b[0] * np.exp(-b[1] * x) + b[2] * np.exp(-b[3] * x) + b[4] * np.exp(-b[5] * x)


def _gauss(b: Floats, x: Floats) -> Floats:
    return (
        b[0] * np.exp(-b[1] * x)
        + b[2] * np.exp(-((x - b[3]) ** 2) / b[4] ** 2)
        + b[5] * np.exp(-((x - b[6]) ** 2) / b[7] ** 2)
    )


def _cubic(b: Floats, x: Floats) -> Floats:
    return (b[0] + b[1] * x + b[2] * x**2 + b[3] * x**3) / (1 + b[4] * x + b[5] * x**2 + b[6] * x**3)


def _chwirut(b: Floats, x: Floats) -> Floats:
    return np.exp(-b[0] * x) / (b[1] + b[2] * x)


def _saturating(b: Floats, x: Floats) -> Floats:
    return b[0] * (1 - np.exp(-b[1] * x))


def _enso(b: Floats, x: Floats) -> Floats:
    def wave(cosine: float, sine: float, period: float) -> Floats:
        return cosine * np.cos(2 * np.pi * x / period) + sine * np.sin(2 * np.pi * x / period)

    return b[0] + wave(b[1], b[2], 12) + wave(b[4], b[5], b[3]) + wave(b[7], b[8], b[6])


MODELS: dict[str, Callable[[Floats, Floats], Floats]] = {
    "Bennett5": lambda b, x: b[0] * (b[1] + x) ** (-1 / b[2]),
    "BoxBOD": _saturating,
    "Chwirut1": _chwirut,
    "Chwirut2": _chwirut,
    "DanWood": lambda b, x: b[0] * x ** b[1],
    "ENSO": _enso,
    "Eckerle4": lambda b, x: b[0] / b[1] * np.exp(-0.5 * ((x - b[2]) / b[1]) ** 2),
    "Gauss1": _gauss,
    "Gauss2": _gauss,
    "Gauss3": _gauss,
    "Hahn1": _cubic,
    "Kirby2": lambda b, x: (b[0] + b[1] * x + b[2] * x**2) / (1 + b[3] * x + b[4] * x**2),
    "Lanczos1": _lanczos,
    "Lanczos2": _lanczos,
    "Lanczos3": _lanczos,
    "MGH09": lambda b, x: b[0] * (x**2 + x * b[1]) / (x**2 + x * b[2] + b[3]),
    "MGH10": lambda b, x: b[0] * np.exp(b[1] / (x + b[2])),
    "MGH17": lambda b, x: b[0] + b[1] * np.exp(-x * b[3]) + b[2] * np.exp(-x * b[4]),
    "Misra1a": _saturating,
    "Misra1b": lambda b, x: b[0] * (1 - (1 + b[1] * x / 2) ** -2),
    "Misra1c": lambda b, x: b[0] * (1 - (1 + 2 * b[1] * x) ** -0.5),
    "Misra1d": lambda b, x: b[0] * b[1] * x * (1 + b[1] * x) ** -1,
    "Nelson": lambda b, x: b[0] - b[1] * x[0] * np.exp(-b[2] * x[1]),
    "Rat42": lambda b, x: b[0] / (1 + np.exp(b[1] - b[2] * x)),
    "Rat43": lambda b, x: b[0] / (1 + np.exp(b[1] - b[2] * x)) ** (1 / b[3]),
    "Roszman1": lambda b, x: b[0] - b[1] * x - np.arctan(b[2] / (x - b[3])) / np.pi,
    "Thurber": _cubic,
}


class Problem(NamedTuple):
    """One of NIST's files: two ``starts``, the certified values, and the data."""

    starts: Floats  # (2, n)
    parameters: list[Decimal]
    deviations: list[Decimal]
    rss: Decimal
    x: Floats  # (m,), of Nelson (2, m)
    y: Floats  # (m,), of Nelson the logarithm


def read(folder: Path, name: str) -> Problem:
    """The Problem of a file in NIST's layout."""
    lines = text(folder / f"{name}.dat").splitlines()
    rows = [
        line.split("=")[1].split() for line in lines[40:60] if line.strip().startswith("b") and "=" in line
    ]
    rss = next(line.split(":")[1].strip() for line in lines if line.startswith("Residual Sum of Squares"))
    data = np.array([line.split() for line in lines[60:] if line.strip()], dtype=float).T
    x, y = data[1] if len(data) == 2 else data[1:], np.log(data[0]) if name == "Nelson" else data[0]
    starts = np.array([row[:2] for row in rows], dtype=float).T
    certified, deviations = ([Decimal(row[k]) for row in rows] for k in (2, 3))
    return Problem(starts, certified, deviations, Decimal(rss), x, y)


def residuals(name: str, x: Floats, y: Floats) -> Callable[[Floats], tuple[Floats, Floats]]:
    """The residuals of one of NIST's models with their exact derivatives, by complex steps."""
    model = MODELS[name]

    def both(b: Floats) -> tuple[Floats, Floats]:
        with np.errstate(all="ignore"):
            moved = b + 1e-30j * np.eye(b.size)
            columns = [model(point, x).imag / 1e-30 for point in moved]
            return model(b, x) - y, np.stack(columns, axis=1)

    return both


def quantities(folder: Path) -> Iterator[Quantity]:
    """The Quantities of all fits: parameters, their standard deviations, and the residual sum of squares."""
    for name in MODELS:
        problem = read(folder / "nist_strd_nonlinear", name)
        for number, start in enumerate(problem.starts, 1):
            found = least_squares(residuals(name, problem.x, problem.y), start)
            case, dof = f"NIST {name}", problem.y.size - start.size
            spread = np.sqrt(np.diag(np.linalg.inv(found.normal)) * found.rss / dof)
            for k, (value, deviation) in enumerate(zip(problem.parameters, problem.deviations, strict=True)):
                which = f"b{k + 1}, start {number}"
                yield Quantity(case, which, value, float(found.x[k]), SOURCE)
                yield Quantity(case, f"standard deviation of {which}", deviation, float(spread[k]), SOURCE)
            yield Quantity(case, f"residual sum of squares, start {number}", problem.rss, found.rss, SOURCE)
