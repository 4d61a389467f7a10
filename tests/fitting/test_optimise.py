"""The project's minimiser on NIST's certified fits, on bounds, and on functions that fail."""

import numpy as np
import pytest
from minimiser import least_squares

from swingdown.errors import InputError

exp, pi = np.exp, np.pi


def lanczos(b, x):
    return b[0] * exp(-b[1] * x) + b[2] * exp(-b[3] * x) + b[4] * exp(-b[5] * x)


def gauss(b, x):
    return (
        b[0] * exp(-b[1] * x)
        + b[2] * exp(-((x - b[3]) ** 2) / b[4] ** 2)
        + b[5] * exp(-((x - b[6]) ** 2) / b[7] ** 2)
    )


def cubic(b, x):
    return (b[0] + b[1] * x + b[2] * x**2 + b[3] * x**3) / (1 + b[4] * x + b[5] * x**2 + b[6] * x**3)


def chwirut(b, x):
    return exp(-b[0] * x) / (b[1] + b[2] * x)


def saturating(b, x):
    return b[0] * (1 - exp(-b[1] * x))


def enso(b, x):
    def wave(cosine, sine, period):
        return cosine * np.cos(2 * pi * x / period) + sine * np.sin(2 * pi * x / period)

    return b[0] + wave(b[1], b[2], 12) + wave(b[4], b[5], b[3]) + wave(b[7], b[8], b[6])


MODELS = {
    "Bennett5": lambda b, x: b[0] * (b[1] + x) ** (-1 / b[2]),
    "BoxBOD": saturating,
    "Chwirut1": chwirut,
    "Chwirut2": chwirut,
    "DanWood": lambda b, x: b[0] * x ** b[1],
    "ENSO": enso,
    "Eckerle4": lambda b, x: b[0] / b[1] * exp(-0.5 * ((x - b[2]) / b[1]) ** 2),
    "Gauss1": gauss,
    "Gauss2": gauss,
    "Gauss3": gauss,
    "Hahn1": cubic,
    "Kirby2": lambda b, x: (b[0] + b[1] * x + b[2] * x**2) / (1 + b[3] * x + b[4] * x**2),
    "Lanczos1": lanczos,
    "Lanczos2": lanczos,
    "Lanczos3": lanczos,
    "MGH09": lambda b, x: b[0] * (x**2 + x * b[1]) / (x**2 + x * b[2] + b[3]),
    "MGH10": lambda b, x: b[0] * exp(b[1] / (x + b[2])),
    "MGH17": lambda b, x: b[0] + b[1] * exp(-x * b[3]) + b[2] * exp(-x * b[4]),
    "Misra1a": saturating,
    "Misra1b": lambda b, x: b[0] * (1 - (1 + b[1] * x / 2) ** -2),
    "Misra1c": lambda b, x: b[0] * (1 - (1 + 2 * b[1] * x) ** -0.5),
    "Misra1d": lambda b, x: b[0] * b[1] * x * (1 + b[1] * x) ** -1,
    "Nelson": lambda b, x: b[0] - b[1] * x[0] * exp(-b[2] * x[1]),
    "Rat42": lambda b, x: b[0] / (1 + exp(b[1] - b[2] * x)),
    "Rat43": lambda b, x: b[0] / (1 + exp(b[1] - b[2] * x)) ** (1 / b[3]),
    "Roszman1": lambda b, x: b[0] - b[1] * x - np.arctan(b[2] / (x - b[3])) / pi,
    "Thurber": cubic,
}


def read(folder, name):
    """Starts (2, n), certified values and standard deviations (n,), rss, and the data of one of NIST's files."""
    lines = (folder / f"{name}.dat").read_text().splitlines()
    rows = [
        line.split("=")[1].split() for line in lines[40:60] if line.strip().startswith("b") and "=" in line
    ]
    table = np.array(rows, dtype=float).T
    rss = next(float(line.split(":")[1]) for line in lines if line.startswith("Residual Sum of Squares"))
    data = np.array([line.split() for line in lines[60:] if line.strip()], dtype=float).T
    y, x = data[0], data[1] if len(data) == 2 else data[1:]
    return table[:2], table[2], table[3], rss, np.log(y) if name == "Nelson" else y, x


def problem(name, y, x):
    """Residuals and exact derivatives (complex steps) of one of NIST's models."""
    model = MODELS[name]

    def both(b):
        with np.errstate(all="ignore"):
            moved = b + 1e-30j * np.eye(b.size)
            columns = [model(point, x).imag / 1e-30 for point in moved]
            return model(b, x) - y, np.stack(columns, axis=1)

    return both


def digits(found, certified):
    """The number of correct digits of the worst value (NIST's log relative error), at most 11."""
    return float(np.clip(-np.log10(np.abs((found - certified) / certified).max() + 1e-99), 0, 11))


@pytest.fixture(scope="module")
def nist(shared_data):
    folder = shared_data / "trust" / "nist_strd_nonlinear"
    if not folder.is_dir():
        pytest.skip(f"NOT TESTED: no folder {folder} with NIST's certified fits")
    return folder


@pytest.mark.parametrize("name", MODELS)
def test_nist_from_both_starts(nist, name):
    starts, certified, deviations, rss, y, x = read(nist, name)
    for start in starts:
        found = least_squares(problem(name, y, x), start)
        assert found.converged
        assert digits(found.x, certified) > 6
        if name != "Lanczos1":  # certified rss of 1e-25, the rounding of the data
            assert found.rss == pytest.approx(rss, rel=1e-8)
            errors = np.sqrt(np.diag(np.linalg.inv(found.normal)) * found.rss / (y.size - certified.size))
            assert digits(errors, deviations) > 4


def both(x):
    """Rosenbrock's valley."""
    return np.array([10 * (x[1] - x[0] ** 2), 1 - x[0]]), np.array([[-20 * x[0], 10.0], [-1.0, 0.0]])


def test_bounds_hold_by_an_active_set():
    free = least_squares(both, [-1.2, 1.0])
    assert free.converged and free.x == pytest.approx([1, 1], abs=1e-7)
    held = least_squares(both, [-1.2, 1.0], upper=[0.5, np.inf])
    assert held.converged and held.x[0] == 0.5 and held.x[1] == pytest.approx(0.25, abs=1e-9)
    corner = least_squares(both, [2.0, 3.0], lower=[1.5, 2.5], upper=[4, 4])
    assert corner.x[0] >= 1.5 and corner.converged
    outside = least_squares(both, [9.0, 9.0], upper=[0.5, 0.1])
    assert outside.x == pytest.approx([0.316227766, 0.1], abs=0.2) and np.all(outside.x <= [0.5, 0.1])


def test_a_minimum_that_is_not_reached_is_not_called_one():
    assert not least_squares(both, [-1.2, 1.0], most=3).converged


def test_a_point_that_cannot_be_computed_is_stepped_back_from():
    def narrow(x):
        with np.errstate(invalid="ignore"):
            root = np.sqrt(1.0 - x)
        return np.array([root[0] - 0.9]), np.array([[-0.5 / root[0]]])

    assert least_squares(narrow, [0.99]).x[0] == pytest.approx(0.19, abs=1e-6)
    with pytest.raises(InputError, match="not finite"):
        least_squares(narrow, [2.0])


def test_what_the_function_raises_comes_through():
    def broken(x):
        raise LookupError("mine")

    with pytest.raises(LookupError, match="mine"):
        least_squares(broken, [1.0])


@pytest.mark.parametrize(
    "arguments",
    [
        ([],),
        ([np.nan, 1.0],),
        ([1.0, 1.0], [0.0]),
        ([1.0, 1.0], [2.0, 0.0], [1.0, 1.0]),
        ([1.0, 1.0, 1.0],),
    ],
)
def test_bad_input_is_told(arguments):
    with pytest.raises(InputError, match="least squares"):
        least_squares(both, *arguments)
