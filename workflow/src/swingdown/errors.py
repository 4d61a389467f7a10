"""What is raised when something cannot be done: told to people in four parts, and to programs by class and code."""

MAKE_ANEW = "delete it and give the same command again, which makes it anew"  # the mend of a damaged result


class Refusal(Exception):
    """Something that cannot be done: where, what is wrong, what was expected, the mend.

    Parameters
    ----------
    where
        The file, row, column or key.
    problem, expected, mend
        Plain sentences without a final full stop.
    code
        What a program goes by, "" where none needs to: no text is searched for what it means.
    """

    heading = "This cannot be done."

    def __init__(
        self, where: object, problem: str, expected: str = "", mend: str = "", code: str = ""
    ) -> None:
        self.where, self.problem, self.expected, self.mend = str(where), problem, expected, mend
        self.code = code
        parts = [f"{where}: {problem}.", expected and f"Expected: {expected}.", mend and f"Mend: {mend}."]
        super().__init__(" ".join(filter(None, parts)))


class InputError(Refusal, ValueError):
    """An input that cannot be used; its parts are those of a ``Refusal``."""

    heading = "This input cannot be used."


class EngineError(Refusal, RuntimeError):
    """An engine that cannot be built or loaded; its parts are those of a ``Refusal``."""

    heading = "The engine cannot be built."


class Unwritten(OSError):
    """A result that cannot be written, for want of room or of leave; it has the errno, and tells in words where, and the mend."""


class PackageError(Refusal, ImportError):
    """A package that is needed and not installed; its parts are those of a ``Refusal``."""

    heading = "A package is not installed."
