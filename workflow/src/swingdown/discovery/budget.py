"""How long a search may go on: by the work of its fits, so that a slower machine gives the same verdict."""

from ..fitting import effort

_A_SECOND = 9e5  # of work (``effort``), about what a search does in a second of CPU time on one core


class Budget:
    """A number of seconds, in work of fits, that runs down from when it is made; None for no end."""

    def __init__(self, seconds: float | None = None) -> None:
        self._end = None if seconds is None else effort.done() + int(seconds * _A_SECOND)

    @property
    def spent(self) -> bool:
        """True once nothing is left."""
        return self._end is not None and effort.done() >= self._end

    @property
    def left(self) -> float | None:
        """The seconds that are left, none below 0; None for no end."""
        return None if self._end is None else max(self._end - effort.done(), 0) / _A_SECOND
