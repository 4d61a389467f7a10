"""What is raised when an input cannot be used."""


class InputError(ValueError):
    """An input that cannot be used, told as: where, what is wrong, what was expected, the mend.

    ``where`` names the file, row, column or key; the other parts are plain sentences without a final full stop.
    """

    def __init__(self, where: object, problem: str, expected: str = "", mend: str = "") -> None:
        self.where, self.problem, self.expected, self.mend = str(where), problem, expected, mend
        parts = [f"{where}: {problem}."]
        if expected:
            parts.append(f"Expected: {expected}.")
        if mend:
            parts.append(f"Mend: {mend}.")
        super().__init__(" ".join(parts))
