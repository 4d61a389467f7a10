"""What schematics are drawn with: arrows, dimension lines, hatched ground, labelled parts."""

import numpy as np
from matplotlib.patches import FancyArrowPatch, Polygon, Rectangle

from . import style

STEEL, BRASS, PLASTIC, ROD = "#aeb8c2", "#d9b65c", "#dfe4ea", "#8d98a3"
FORCE, MOTION = style.COLOURS["quadratic_drag"], style.COLOURS["viscous"]
DASHED, DOTTED = (0, (5, 4)), (0, (2, 3))


def canvas(axes, x, y):
    """The axes as a sheet to draw on: the same scale both ways, no frame, from ``x`` to ``y`` limits."""
    axes.set(xlim=x, ylim=y, aspect="equal")
    axes.axis("off")
    return axes


def arrow(axes, start, end, colour=style.INK, width=1.3, head=9, both=False, **kwargs):
    """An arrow from ``start`` to ``end`` (points of the drawing), with a head at its end or at both."""
    shape = "<|-|>" if both else "-|>"
    axes.add_patch(
        FancyArrowPatch(start, end, arrowstyle=shape, mutation_scale=head, lw=width, color=colour, shrinkA=0, shrinkB=0,
                        joinstyle="miter", **kwargs)
    )  # fmt: skip


def label(axes, x, y, text, colour=style.INK, size=10, **kwargs):
    """A text centred on a point."""
    kwargs = {"ha": "center", "va": "center", "zorder": 9} | kwargs
    return axes.text(x, y, text, color=colour, fontsize=size, **kwargs)


def dimension(
    axes, start, end, text, offset=(0, 0), at=0.5, reach=0.0, ha="center", va="center", size=10, line=None
):
    """A dimension line from ``start`` to ``end`` moved by ``offset``, with thin lines back to what it measures."""
    start, end, offset = np.asarray(start, float), np.asarray(end, float), np.asarray(offset, float)
    colour = line or style.GREY
    if offset.any():
        past = offset * (1 + reach)
        for point in (start, end):
            axes.plot(*zip(point, point + past, strict=True), color=colour, lw=0.5, zorder=1)
    arrow(axes, start + offset, end + offset, colour, width=0.8, head=7, both=True)
    x, y = start + offset + at * (end - start)
    box = {"facecolor": "white", "edgecolor": "none", "pad": 1.2}
    label(axes, x, y, text, size=size, ha=ha, va=va, bbox=box)


def ground(axes, x0, x1, y, depth, colour=style.GREY):
    """Hatched ground with its upper (depth > 0: solid below) or lower (depth < 0) edge at ``y``."""
    low = min(y, y - depth)
    axes.add_patch(
        Rectangle(
            (x0, low), x1 - x0, abs(depth), facecolor="white", edgecolor=style.FAINT, hatch="////", lw=0
        )
    )
    axes.plot([x0, x1], [y, y], color=colour, lw=1.3, solid_capstyle="butt")


def edge(patch, axes, z=2):
    """The patch, outlined in ink and added to the axes at height ``z`` above the sheet."""
    patch.set(edgecolor=style.INK, lw=0.9, zorder=z)
    return axes.add_patch(patch)


def callout(axes, point, text, at, ha="left"):
    """A text with a thin line to the point it names."""
    axes.annotate(
        text, point, at, ha=ha, va="center", fontsize=9, zorder=9, linespacing=1.15,
        arrowprops={"arrowstyle": "-", "color": style.GREY, "lw": 0.6, "shrinkA": 2, "shrinkB": 0},
    )  # fmt: skip
    axes.plot(*point, "o", color=style.GREY, ms=2.2, zorder=8)


def threads(axes, start, end, half=0.05, pitch=0.075):
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
