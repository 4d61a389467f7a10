"""What schematics are drawn with: arrows, dimension lines, hatched ground, labelled parts."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import FancyArrowPatch, Patch, Polygon, Rectangle
from matplotlib.text import Text
from numpy.typing import ArrayLike

from . import style

STEEL, BRASS, PLASTIC, ROD = "#aeb8c2", "#d9b65c", "#dfe4ea", "#8d98a3"
FORCE, MOTION = style.COLOURS["quadratic_drag"], style.COLOURS["viscous"]
DASHED, DOTTED = (0, (5, 4)), (0, (2, 3))


def canvas(axes: Axes, x: tuple[float, float], y: tuple[float, float]) -> Axes:
    """The axes as a sheet to draw on: the same scale both ways, no frame, from ``x`` to ``y`` limits."""
    axes.set(xlim=x, ylim=y, aspect="equal")
    axes.axis("off")
    return axes


def xy(point: ArrayLike) -> tuple[float, float]:
    """A point of the drawing as matplotlib takes it."""
    x, y = np.asarray(point, float)
    return float(x), float(y)


def arrow(
    axes: Axes,
    start: ArrayLike,
    end: ArrayLike,
    colour: str = style.INK,
    width: float = 1.3,
    head: float = 9,
    both: bool = False,
    **kwargs: Any,
) -> None:
    """An arrow from ``start`` to ``end`` (points of the drawing), with a head at its end or at both."""
    shape = "<|-|>" if both else "-|>"
    axes.add_patch(
        FancyArrowPatch(xy(start), xy(end), arrowstyle=shape, mutation_scale=head, lw=width, color=colour, shrinkA=0, shrinkB=0,
                        joinstyle="miter", **kwargs)
    )  # fmt: skip


def label(
    axes: Axes, x: float, y: float, text: str, colour: str = style.INK, size: float = 10, **kwargs: Any
) -> Text:
    """A text centred on a point."""
    usual: dict[str, Any] = {"ha": "center", "va": "center", "zorder": 9}
    return axes.text(x, y, text, color=colour, fontsize=size, **usual | kwargs)


def dimension(
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
    arrow(axes, start + offset, end + offset, colour, width=0.8, head=7, both=True)
    x, y = offset + (start + end) / 2
    label(axes, x, y, text, size=12, bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.2})


def ground(axes: Axes, x0: float, x1: float, y: float, depth: float, colour: str = style.GREY) -> None:
    """Hatched ground with its upper (depth > 0: solid below) or lower (depth < 0) edge at ``y``."""
    low = min(y, y - depth)
    axes.add_patch(
        Rectangle(
            (x0, low), x1 - x0, abs(depth), facecolor="white", edgecolor=style.FAINT, hatch="////", lw=0
        )
    )
    axes.plot([x0, x1], [y, y], color=colour, lw=1.3, solid_capstyle="butt")


def edge(patch: Patch, axes: Axes, z: float = 2) -> Patch:
    """The patch, outlined in ink and added to the axes at height ``z`` above the sheet."""
    patch.set(edgecolor=style.INK, lw=0.9, zorder=z)
    return axes.add_patch(patch)


def callout(axes: Axes, point: ArrayLike, text: str, at: ArrayLike, ha: str = "left") -> None:
    """A text with a thin line to the point it names."""
    axes.annotate(
        text, xy(point), xy(at), ha=ha, va="center", fontsize=9, zorder=9, linespacing=1.15,
        arrowprops={"arrowstyle": "-", "color": style.GREY, "lw": 0.6, "shrinkA": 2, "shrinkB": 0},
    )  # fmt: skip
    axes.plot(*xy(point), "o", color=style.GREY, ms=2.2, zorder=8)


def threads(axes: Axes, start: ArrayLike, end: ArrayLike, half: float = 0.05, pitch: float = 0.075) -> None:
    """A threaded rod between two points."""
    start, end = np.asarray(start, float), np.asarray(end, float)
    length = np.hypot(*(end - start))
    along = (end - start) / length
    across = np.array([-along[1], along[0]])
    edge(
        Polygon(
            [start + half * across, end + half * across, end - half * across, start - half * across],
            facecolor=STEEL,
        ),
        axes,
        4,
    )
    for place in np.arange(pitch, length, pitch):
        middle = start + place * along
        axes.plot(
            *zip(middle - half * across, middle + half * (across + 0.5 * along), strict=True),
            color=style.GREY,
            lw=0.4,
            zorder=5,
        )
