"""Figures 1 and 7: what hangs and what pulls at it, and which lengths make the angle. Drawn, not plotted."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Circle, Polygon, Rectangle
from numpy.typing import ArrayLike

from ..rounding import plus_minus
from . import style
from .drawing import (
    DASHED,
    DOTTED,
    FORCE,
    MOTION,
    ROD,
    STEEL,
    arrow,
    canvas,
    dimension,
    edge,
    ground,
    label,
    xy,
)


@style.styled
def fig01() -> Figure:
    """The pendulum and its free-body diagram (the paper's Figure 1): two drawn panels."""
    figure = style.new_figure(7.6)
    left, right = figure.subplots(1, 2)
    left.set_title("(a) simple pendulum")
    right.set_title("(b) free-body diagram of the bob")
    _pendulum(canvas(left, (-0.66, 1.14), (-1.3, 0.24)))
    _free_body(canvas(right, (-0.87, 0.93), (-0.96, 0.58)))
    return figure


_SWING = np.radians(33)
_ALONG, _ACROSS = np.array([np.sin(_SWING), -np.cos(_SWING)]), np.array([np.cos(_SWING), np.sin(_SWING)])


def _bob(axes: Axes, centre: ArrayLike) -> None:
    axes.add_patch(Circle(xy(centre), 0.095, facecolor=STEEL, edgecolor=style.INK, lw=1.1, zorder=4))
    label(axes, *xy(centre), r"$m$", size=12)


def _pendulum(axes: Axes) -> None:
    ground(axes, -0.3, 0.3, 0.1, -0.09)
    axes.add_patch(
        Polygon([(-0.09, 0.1), (0.09, 0.1), (0, 0)], facecolor=style.PALE, edgecolor=style.INK, lw=1)
    )
    axes.plot([0, 0], [0, -1.2], color=style.GREY, lw=0.8, ls=DASHED)
    axes.plot(*zip((0, 0), _ALONG, strict=True), color=ROD, lw=3.2, zorder=2)
    axes.add_patch(Circle((0, 0), 0.03, facecolor="white", edgecolor=style.INK, lw=1.1, zorder=4))
    axes.add_patch(Arc((0, 0), 2, 2, theta1=-90 - 25, theta2=-90 + 62, color=style.FAINT, lw=0.9, ls=DOTTED))
    _bob(axes, _ALONG)
    axes.add_patch(Arc((0, 0), 0.9, 0.9, theta1=-90, theta2=-90 + 33, color=style.INK, lw=1))
    label(axes, 0.53 * np.sin(_SWING / 2), -0.53 * np.cos(_SWING / 2), r"$\theta$", size=13)
    dimension(axes, (0, 0), _ALONG, r"$L$", offset=0.17 * _ACROSS, reach=0.18)
    middle, spread = np.radians(51), np.radians(7)
    start, end = (np.array([np.sin(turn), -np.cos(turn)]) for turn in (middle - spread, middle + spread))
    arrow(axes, start, end, MOTION, 1.6, 11, connectionstyle="arc3,rad=0.06")
    label(axes, 0.86, -0.66, r"$\theta,\ \dot{\theta},\ \ddot{\theta}$", MOTION, 13, ha="left")
    label(axes, -0.07, 0.0, "pivot", size=9, ha="right", colour=style.GREY)
    arrow(axes, (-0.46, -0.44), (-0.46, -0.74), style.INK, 1.1)
    label(axes, -0.54, -0.58, r"$g$", size=12)


def _free_body(axes: Axes) -> None:
    weight, radius = 0.76, 0.1
    down, damping = np.array([0.0, -1.0]), style.COLOURS["load_coulomb"]
    axes.plot(
        *zip(radius * _ALONG, 0.78 * _ALONG, strict=True), color=style.FAINT, lw=0.8, ls=DOTTED, zorder=1
    )
    axes.plot(
        *zip(-0.7 * _ACROSS, 0.8 * _ACROSS, strict=True), color=style.FAINT, lw=0.8, ls=DOTTED, zorder=1
    )
    _bob(axes, (0, 0))
    arrow(axes, -radius * _ALONG, -0.52 * _ALONG, FORCE, 1.9, 12)
    label(axes, *xy(-0.36 * _ALONG + (-0.07, -0.01)), "tension $T$", FORCE, 11, ha="right")
    arrow(axes, (0, 0), weight * down, FORCE, 1.9, 12)
    label(axes, -0.06, -0.5, r"weight $m g$", FORCE, 11, ha="right")
    arrow(axes, -radius * _ACROSS, -0.56 * _ACROSS, damping, 1.9, 12)
    label(axes, -0.5, -0.13, "damping $F_d$", damping, 11)
    arrow(axes, 0.5 * _ACROSS, 0.8 * _ACROSS, MOTION, 1.6, 11)
    label(axes, 0.77, 0.29, r"$\dot{\theta} > 0$", MOTION, 12)
    # The weight's parts along the rod and across it.
    foot = weight * down
    corner = foot + weight * np.sin(_SWING) * _ACROSS
    arrow(axes, (0, 0), corner, FORCE, 0.9, 8, linestyle=(0, (3, 2)))
    arrow(axes, corner, foot, FORCE, 0.9, 8, linestyle=(0, (3, 2)))
    label(axes, 0.29, -0.3, r"$m g\,\cos\theta$", FORCE, 10, ha="left")
    label(axes, 0.23, -0.7, r"$m g\,\sin\theta$", FORCE, 10, ha="left")
    axes.add_patch(Arc((0, 0), 0.7, 0.7, theta1=-90, theta2=-90 + 33, color=style.INK, lw=0.9))
    label(axes, 0.43 * np.sin(_SWING / 2), -0.43 * np.cos(_SWING / 2), r"$\theta$", size=11)
    label(axes, 0.03, -0.91, r"across the rod:  $m L\,\ddot{\theta} = -\,m g\,\sin\theta - F_d$", size=11)


_SYMBOLS = {
    "over_shaft": r"$h_\mathrm{over}$",
    "shaft_diameter": r"$d_\mathrm{shaft}$",
    "bob_diameter": r"$d_\mathrm{bob}$",
    "arm": r"$l_\mathrm{arm}$",
    "tower": r"$h_\mathrm{cal}$",
}
_EQUATIONS = (
    r"$\theta = \arccos\,(\Delta h\,/\,l_\mathrm{arm})$",
    r"$\Delta h = h_\mathrm{shaft} - h_\mathrm{bob}$",
    r"$h_\mathrm{shaft} = h_\mathrm{over} - \frac{1}{2}\,d_\mathrm{shaft}$",
    r"$h_\mathrm{bob} = h_\mathrm{cal} + \frac{1}{2}\,d_\mathrm{bob}$",
)


@style.styled
def fig07(apparatus: Mapping[str, Any]) -> Figure:
    """Which lengths make the angle, and how well each is known (the paper's Figure 7).

    ``apparatus`` is an apparatus sheet as read: ``lengths`` (arm, shaft_diameter, over_shaft, bob_diameter; each with
    ``value`` and ``limit``, in m) and ``points`` (the tower's: a list of ``height`` and ``limit``, in m).
    """
    figure = style.new_figure(9.4)
    drawing, words = figure.subplots(1, 2, width_ratios=(2.05, 1))
    _layout(canvas(drawing, (-3.75, 2.75), (-0.35, 4.75)))
    canvas(words, (0, 1), (0, 1)).set_aspect("auto")
    _length_table(words, apparatus)
    return style.footnote(
        figure,
        style.emulated_note(apparatus),
        "drawn not to scale; ±: the limits within which each length lies",
    )


def _layout(axes: Axes) -> None:
    tilt, arm, shaft_radius, bob_radius = np.radians(-44), 2.7, 0.34, 0.4
    shaft = np.array([0.35, 3.7])
    reach = np.array([np.sin(tilt), -np.cos(tilt)])
    bob = shaft + arm * reach
    base, top = bob[1] - bob_radius, shaft[1] + shaft_radius
    ground(axes, -3.6, 2.6, 0, 0.25)
    edge(Rectangle((bob[0] - 0.33, 0), 0.66, base, facecolor="#f0e3bd"), axes)
    axes.plot([shaft[0]] * 2, [shaft[1], bob[1]], color=style.GREY, lw=0.8, ls=DASHED, zorder=3)
    axes.plot(*zip(shaft, bob, strict=True), color=ROD, lw=3, zorder=3)
    for centre, radius, shade in ((shaft, shaft_radius, "#e9edf1"), (bob, bob_radius, STEEL)):
        edge(Circle(xy(centre), radius, facecolor=shade), axes, 4)
        axes.plot(*centre, "+", color=style.INK, ms=7, mew=0.9, zorder=6)
    axes.add_patch(
        Arc(xy(shaft), 2.1, 2.1, theta1=-90 + np.degrees(tilt), theta2=-90, color=MOTION, lw=1.2, zorder=5)
    )
    label(axes, *xy(shaft + 1.27 * np.array([np.sin(tilt / 2), -np.cos(tilt / 2)])), r"$\theta$", MOTION, 14)
    measured = style.COLOURS["quadratic_drag"]
    across = np.array([-reach[1], reach[0]]) * -1
    dimension(axes, shaft, bob, r"$l_\mathrm{arm}$", 0.6 * across, reach=0.12, colour=measured)
    left = -3.3
    axes.plot([left - 0.12, bob[0]], [base, base], color=measured, lw=0.5, zorder=1)
    axes.plot([left - 0.12, bob[0]], [base + 2 * bob_radius] * 2, color=measured, lw=0.5, zorder=1)
    dimension(axes, (left, 0), (left, base), r"$h_\mathrm{cal}$", colour=measured)
    dimension(axes, (left, base), (left, base + 2 * bob_radius), r"$d_\mathrm{bob}$", colour=measured)
    axes.plot([shaft[0], 2.42], [top, top], color=measured, lw=0.5, zorder=1)
    dimension(axes, (2.3, 0), (2.3, top), r"$h_\mathrm{over}$", colour=measured)
    for side in (-1, 1):
        axes.plot([shaft[0] + side * shaft_radius] * 2, [shaft[1], 4.42], color=measured, lw=0.5, zorder=1)
    dimension(axes, (shaft[0] - shaft_radius, 4.32), (shaft[0] + shaft_radius, 4.32), "", colour=measured)
    label(axes, shaft[0] + shaft_radius + 0.1, 4.38, r"$d_\mathrm{shaft}$", size=12, ha="left")
    axes.plot([shaft[0], 1.67], [shaft[1]] * 2, color=style.GREY, lw=0.5, zorder=5)
    axes.plot([bob[0], 1.02], [bob[1]] * 2, color=style.GREY, lw=0.8, ls=DASHED, zorder=5)
    dimension(axes, (1.55, 0), (1.55, shaft[1]), r"$h_\mathrm{shaft}$")
    dimension(axes, (0.9, bob[1]), (0.9, shaft[1]), r"$\Delta h$")
    dimension(axes, (-0.75, 0), (-0.75, bob[1]), r"$h_\mathrm{bob}$")


def _length_table(axes: Axes, apparatus: Mapping[str, Any]) -> None:
    rows = [(name, entry["value"], entry["limit"]) for name, entry in apparatus["lengths"].items()]
    rows += [("tower", point["height"], point["limit"]) for point in apparatus["points"]]
    axes.text(0, 0.985, "measured (mm)", color=style.COLOURS["quadratic_drag"], va="top")
    y, step = 0.88, min(0.062, 0.5 / len(rows))
    for name, mark in _SYMBOLS.items():
        for value, limit in ((1e3 * value, 1e3 * limit) for length, value, limit in rows if length == name):
            number, sign, bound = plus_minus(value, limit, "limit").partition("±")
            axes.text(0.0, y, mark, va="center", size=11)
            axes.text(0.62, y, number.strip(), va="center", ha="right", size=9)
            axes.text(0.65, y, sign + bound, va="center", ha="left", size=9)
            mark, y = "", y - step
    axes.text(0, y - 0.03, "follows", color=style.GREY, va="center")
    for line, equation in enumerate(_EQUATIONS):
        axes.text(0, y - 0.13 - 0.088 * line, equation, va="center", size=11)
