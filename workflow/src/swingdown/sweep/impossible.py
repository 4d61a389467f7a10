"""What cannot be made or fitted: an outcome of a cell like any other, with its reason, that stops nothing else."""

from numpy.linalg import LinAlgError

from ..errors import InputError

# What the engine and the fits raise where there is no such swing, or nothing to fit in it; anything else is a fault.
IMPOSSIBLE = (InputError, ArithmeticError, LinAlgError)


def reason(error):
    """Why something cannot be, on one line: an InputError's problem, else the message."""
    return " ".join(str(getattr(error, "problem", error)).split()) or type(error).__name__
