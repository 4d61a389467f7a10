"""A window with the trace while a swing is recorded, where there is a screen."""

import os
from collections.abc import Callable, Sequence
from typing import Generic, TypeVar

import matplotlib

SCREENS = ("DISPLAY", "WAYLAND_DISPLAY")


_Recorder = TypeVar("_Recorder", contravariant=True)


class Window(Generic[_Recorder]):
    """A window that shows what a view of ``capture.live`` shows; ``status`` and ``recent`` are functions of the recorder."""

    def __init__(
        self,
        title: str,
        unit: str,
        status: Callable[[_Recorder], str],
        recent: Callable[[_Recorder], tuple[Sequence[float], Sequence[float]]],
    ) -> None:
        if not any(os.environ.get(name) for name in SCREENS):
            raise OSError("there is no screen (neither DISPLAY nor WAYLAND_DISPLAY is set)")
        try:
            matplotlib.use("TkAgg", force=True)
            from tkinter import TclError

            from matplotlib import pyplot
        except ImportError as error:
            mend = ". Tk is missing (Debian: python3-tk)" if isinstance(error, ModuleNotFoundError) else ""
            raise OSError(f"no window can be opened ({error}){mend}") from error
        self._status, self._recent = status, recent
        try:
            self._figure, axes = pyplot.subplots(figsize=(9, 4), layout="constrained", num=title)
        except TclError as error:
            raise OSError(f"no window can be opened ({error})") from error
        (self._line,) = axes.plot([], [], linewidth=1)
        self._text = axes.set_title("", loc="left", fontsize="medium")
        axes.set(xlabel="time before now (s)", ylabel=f"signal ({unit})", xlim=(-10, 0))
        self._axes = axes
        self._figure.show()

    def show(self, recorder: _Recorder) -> None:
        """Draws the recorder as it stands; a window that was closed stays closed."""
        if not self._figure.canvas.manager or not matplotlib.pyplot.fignum_exists(self._figure.number):
            return
        times, values = self._recent(recorder)
        self._line.set_data(times, values)
        self._axes.relim()
        self._axes.autoscale_view(scalex=False)
        self._text.set_text(self._status(recorder))
        self._figure.canvas.draw()
        self._figure.canvas.flush_events()

    def close(self) -> None:
        """Closes the window."""
        matplotlib.pyplot.close(self._figure)
