"""What is raised when an input cannot be used."""

MAKE_ANEW = "delete it and give the same command again, which makes it anew"  # the mend of a damaged result


class InputError(ValueError):
    """An input that cannot be used: where, what is wrong, what was expected, the mend.

    Parameters
    ----------
    where
        The file, row, column or key.
    problem, expected, mend
        Plain sentences without a final full stop.
    """

    def __init__(self, where: object, problem: str, expected: str = "", mend: str = "") -> None:
        self.where, self.problem, self.expected, self.mend = str(where), problem, expected, mend
        super().__init__(_sentences(where, problem, expected, mend))


class EngineError(RuntimeError):
    """An engine that cannot be built or loaded; its parts are those of an ``InputError``."""

    def __init__(self, where: object, problem: str, expected: str = "", mend: str = "") -> None:
        self.where, self.problem, self.expected, self.mend = str(where), problem, expected, mend
        super().__init__(_sentences(where, problem, expected, mend))


def _sentences(where: object, problem: str, expected: str, mend: str) -> str:
    parts = [f"{where}: {problem}."]
    if expected:
        parts.append(f"Expected: {expected}.")
    if mend:
        parts.append(f"Mend: {mend}.")
    return " ".join(parts)
