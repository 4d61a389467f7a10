"""How long a search may go on: CPU seconds of the process that searches."""

import time

GENEROUS = 600.0  # s


class Budget:
    """A number of CPU seconds that runs down from when it is made; None for no end."""

    def __init__(self, seconds: float | None = None) -> None:
        self.seconds = seconds
        self._end = None if seconds is None else time.process_time() + seconds

    @property
    def spent(self) -> bool:
        """True once nothing is left."""
        return self._end is not None and time.process_time() >= self._end

    @property
    def left(self) -> float | None:
        """The seconds that are left, none below 0; None for no end."""
        return None if self._end is None else max(self._end - time.process_time(), 0.0)
