"""A recording as it was read, and which part of it is used."""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from . import style
from .calibration import recording_note

LEFT_OUT, EDGE = "#a9b0b7", "#D55E00"
AROUND = 1.5  # s, shown on each side of where the used part begins


@style.styled
def used_part(recording: xr.Dataset) -> Figure:
    """A figure of one recording (``results/recordings/*.nc``): what is used in ink, a hand's part and the rest in grey, spikes as crosses.

    ``signal`` over ``time`` (s) in its own unit. Below, the second and a half before and after where the used part begins.
    """
    time, signal = recording["time"].values, recording["signal"].values
    told = recording.attrs
    begins, ends = float(told.get("begins_s", time[0])), float(told.get("ends_s", time[-1]))
    spikes = recording["spike"].values.astype(bool) if "spike" in recording else np.zeros(time.size, bool)
    used = (time >= begins) & (time <= ends) & ~spikes
    figure = style.new_figure(10.4)
    whole, beginning = figure.subplots(2, 1)
    for axes in (whole, beginning):
        axes.plot(time, signal, color=LEFT_OUT, lw=0.9, label="left out" if not used.all() else None)
        axes.plot(time[used], signal[used], color=style.INK, lw=0.9, label="used")
        words = "spikes, left out" if spikes.any() else None
        axes.plot(time[spikes], signal[spikes], "x", color=EDGE, label=words)
        for key, words in (("released_s", "released"), ("begins_s", "used from"), ("ends_s", "used until")):
            if key in told:
                dashes = "--" if key == "released_s" else "-"
                axes.axvline(told[key], color=EDGE, lw=0.9, ls=dashes, label=f"{words} {told[key]:.2f} s")
        axes.set(xlabel="time as recorded (s)", ylabel=f"signal ({recording['signal'].attrs['units']})")
        axes.grid(True)
    whole.set_xlim(time[0], time[-1])
    first = float(told.get("released_s", begins))
    near = max(time[0], first - AROUND), min(time[-1], first + 2 * AROUND)
    shown = signal[(time >= near[0]) & (time <= near[1])]
    beginning.set(xlim=near, title="the beginning")
    low, high = float(np.min(shown)), float(np.max(shown))
    beginning.set_ylim(low - 0.1 * (high - low), high + 0.1 * (high - low))
    style.legend_above(whole)
    return style.footnote(figure, recording_note(recording))
