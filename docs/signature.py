"""The small picture by which an effect is known: what a fit without it leaves of a swing."""

import numpy as np
from matplotlib.figure import Figure

from swingdown.arrays import Floats
from swingdown.plots import style


@style.styled
def signature(times: Floats, angle: Floats, residual: Floats) -> Figure:
    """The residual (rad) of a swing over time (s) and over the angle (rad), on the scale of its largest.

    A torque that depends on the angle alone, or an error of the sensor, is one line over the angle; one that takes energy a loop.
    """
    figure = style.new_figure(3.2)
    over_time, over_angle = figure.subplots(1, 2, sharey=True, width_ratios=[3, 2])
    milli = 1e3 * residual
    over_time.plot(times, milli, color=style.COLOURS["viscous"], lw=0.7)
    over_angle.plot(style.degrees(angle), milli, color=style.COLOURS["viscous"], lw=0.4)
    over_time.set(
        xlabel="time (s)", ylabel="residual (mrad)", title=f"{np.sqrt(np.mean(milli**2)):.2g} mrad RMS"
    )
    over_angle.set_xlabel("angle (°)")
    for axes in (over_time, over_angle):
        style.symmetric(axes, milli if np.abs(milli).max() > 1e-3 else np.ones(1))
        axes.axhline(0, color=style.FAINT, lw=0.6, zorder=0)
    return figure
