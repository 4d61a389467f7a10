"""Figure 7: which lengths make the angle. Drawn, not plotted."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Circle, FancyArrowPatch, Patch, Rectangle
from matplotlib.text import Text
from numpy.typing import ArrayLike

from ..rounding import plus_minus
from . import style

STEEL, ROD, MOTION = "#aeb8c2", "#8d98a3", style.COLOURS["viscous"]
DASHED = (0, (5, 4))
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
    _layout(_canvas(drawing, (-3.75, 2.75), (-0.35, 4.75)))
    _canvas(words, (0, 1), (0, 1)).set_aspect("auto")
    _length_table(words, apparatus)
    limits = "drawn not to scale; ±: the limits within which each length lies"
    return style.footnote(figure, style.emulated_note(apparatus), limits)


def _layout(axes: Axes) -> None:
    tilt, arm, shaft_radius, bob_radius = np.radians(-44), 2.7, 0.34, 0.4
    shaft = np.array([0.35, 3.7])
    reach = np.array([np.sin(tilt), -np.cos(tilt)])
    bob = shaft + arm * reach
    base, top = bob[1] - bob_radius, shaft[1] + shaft_radius
    _ground(axes)
    _edge(Rectangle((bob[0] - 0.33, 0), 0.66, base, facecolor="#f0e3bd"), axes)
    axes.plot([shaft[0]] * 2, [shaft[1], bob[1]], color=style.GREY, lw=0.8, ls=DASHED, zorder=3)
    axes.plot(*zip(shaft, bob, strict=True), color=ROD, lw=3, zorder=3)
    for centre, radius, shade in ((shaft, shaft_radius, "#e9edf1"), (bob, bob_radius, STEEL)):
        _edge(Circle(_xy(centre), radius, facecolor=shade), axes, 4)
        axes.plot(*centre, "+", color=style.INK, ms=7, mew=0.9, zorder=6)
    begin = -90 + np.degrees(tilt)
    axes.add_patch(Arc(_xy(shaft), 2.1, 2.1, theta1=begin, theta2=-90, color=MOTION, lw=1.2, zorder=5))
    inside = shaft + 1.27 * np.array([np.sin(tilt / 2), -np.cos(tilt / 2)])
    _label(axes, *_xy(inside), r"$\theta$", MOTION, 14)
    measured = style.COLOURS["quadratic_drag"]
    across = np.array([-reach[1], reach[0]]) * -1
    _dimension(axes, shaft, bob, r"$l_\mathrm{arm}$", 0.6 * across, reach=0.12, colour=measured)
    left = -3.3
    axes.plot([left - 0.12, bob[0]], [base, base], color=measured, lw=0.5, zorder=1)
    axes.plot([left - 0.12, bob[0]], [base + 2 * bob_radius] * 2, color=measured, lw=0.5, zorder=1)
    _dimension(axes, (left, 0), (left, base), r"$h_\mathrm{cal}$", colour=measured)
    _dimension(axes, (left, base), (left, base + 2 * bob_radius), r"$d_\mathrm{bob}$", colour=measured)
    axes.plot([shaft[0], 2.42], [top, top], color=measured, lw=0.5, zorder=1)
    _dimension(axes, (2.3, 0), (2.3, top), r"$h_\mathrm{over}$", colour=measured)
    for side in (-1, 1):
        axes.plot([shaft[0] + side * shaft_radius] * 2, [shaft[1], 4.42], color=measured, lw=0.5, zorder=1)
    _dimension(axes, (shaft[0] - shaft_radius, 4.32), (shaft[0] + shaft_radius, 4.32), "", colour=measured)
    _label(axes, shaft[0] + shaft_radius + 0.1, 4.38, r"$d_\mathrm{shaft}$", size=12, ha="left")
    axes.plot([shaft[0], 1.67], [shaft[1]] * 2, color=style.GREY, lw=0.5, zorder=5)
    axes.plot([bob[0], 1.02], [bob[1]] * 2, color=style.GREY, lw=0.8, ls=DASHED, zorder=5)
    _dimension(axes, (1.55, 0), (1.55, shaft[1]), r"$h_\mathrm{shaft}$")
    _dimension(axes, (0.9, bob[1]), (0.9, shaft[1]), r"$\Delta h$")
    _dimension(axes, (-0.75, 0), (-0.75, bob[1]), r"$h_\mathrm{bob}$")


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


def _canvas(axes: Axes, x: tuple[float, float], y: tuple[float, float]) -> Axes:
    """The axes as a sheet to draw on: the same scale both ways, no frame, from ``x`` to ``y`` limits."""
    axes.set(xlim=x, ylim=y, aspect="equal")
    axes.axis("off")
    return axes


def _xy(point: ArrayLike) -> tuple[float, float]:
    """A point of the drawing as matplotlib takes it."""
    x, y = np.asarray(point, float)
    return float(x), float(y)


def _label(
    axes: Axes, x: float, y: float, text: str, colour: str = style.INK, size: float = 10, **kwargs: Any
) -> Text:
    """A text centred on a point."""
    usual: dict[str, Any] = {"ha": "center", "va": "center", "zorder": 9}
    return axes.text(x, y, text, color=colour, fontsize=size, **usual | kwargs)


def _dimension(
    axes: Axes,
    start: ArrayLike,
    end: ArrayLike,
    text: str,
    offset: ArrayLike = (0, 0),
    reach: float = 0.0,
    colour: str = style.GREY,
) -> None:
    """A dimension line from ``start`` to ``end`` moved by ``offset``, with thin lines back to what it measures."""
    start, end, offset = np.asarray(start, float), np.asarray(end, float), np.asarray(offset, float)
    if offset.any():
        past = offset * (1 + reach)
        for point in (start, end):
            axes.plot(*zip(point, point + past, strict=True), color=colour, lw=0.5, zorder=1)
    ends = _xy(start + offset), _xy(end + offset)
    axes.add_patch(
        FancyArrowPatch(*ends, arrowstyle="<|-|>", mutation_scale=7, lw=0.8, color=colour, shrinkA=0, shrinkB=0, joinstyle="miter")
    )  # fmt: skip
    x, y = offset + (start + end) / 2
    _label(axes, x, y, text, size=12, bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.2})


def _ground(axes: Axes) -> None:
    """Hatched ground below the height 0."""
    area = Rectangle((-3.6, -0.25), 6.2, 0.25, facecolor="white", edgecolor=style.FAINT, hatch="////", lw=0)
    axes.add_patch(area)
    axes.plot([-3.6, 2.6], [0, 0], color=style.GREY, lw=1.3, solid_capstyle="butt")


def _edge(patch: Patch, axes: Axes, z: float = 2) -> Patch:
    """The patch, outlined in ink and added to the axes at height ``z`` above the sheet."""
    patch.set(edgecolor=style.INK, lw=0.9, zorder=z)
    return axes.add_patch(patch)
