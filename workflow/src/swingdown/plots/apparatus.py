"""Figure 6: the apparatus, as the paper describes it, from the front and from the side."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Circle, FancyBboxPatch, Polygon, Rectangle

from ..arrays import Floats
from . import style
from .drawing import BRASS, DASHED, PLASTIC, STEEL, callout, canvas, edge, label, threads, xy


@style.styled
def fig06() -> Figure:
    """The apparatus with the calibration tower, from the front and from the side (for the paper's Figure 6)."""
    figure = style.new_figure(9.3)
    front, side = figure.subplots(1, 2, width_ratios=(6.1, 5.15))
    front.set_title("(a) front: the bob rests on the calibration tower")
    side.set_title("(b) side: shaft and encoder")
    _front(canvas(front, (-3.1, 3.0), (-0.95, 4.85)))
    _side(canvas(side, (-2.1, 3.05), (-0.95, 4.85)))
    return style.footnote(figure, "drawn after the paper's description; not to scale")


SHAFT_HEIGHT, ARM, TILT, BOB = 3.7, 2.75, np.radians(-41), 0.27
BOB_HEIGHT = SHAFT_HEIGHT - ARM * np.cos(TILT)


def _table(axes: Axes, x0: float, x1: float) -> None:
    edge(Rectangle((x0, -0.36), x1 - x0, 0.36, facecolor="#cfd5db"), axes)
    for x in np.arange(x0 + 0.2, x1, 0.4):
        axes.plot([x, x], [-0.12, 0.0], color=style.GREY, lw=1.6, solid_capstyle="butt", zorder=3)


def _tower(axes: Axes, x: float) -> tuple[float, float]:
    """The calibration tower under the bob: a base with its magnets, and cylinders stacked to the height wanted."""
    top, half = BOB_HEIGHT - BOB, 0.24
    for side in (-0.3, 0.14):
        edge(Rectangle((x + side, 0), 0.16, 0.09, facecolor="#b5473c"), axes, 4)
    edge(Rectangle((x - 0.42, 0), 0.84, 0.26, facecolor="#f0e3bd"), axes, 3)
    edges = np.linspace(0.26, top, 4)
    for low, high in zip(edges, edges[1:], strict=False):
        edge(Rectangle((x - half, low), 2 * half, high - low, facecolor=BRASS), axes)
        axes.plot(
            [x - half + 0.07] * 2, [low + 0.06, high - 0.06], color="white", lw=1.6, alpha=0.6, zorder=3
        )
    return x, 0.5 * (edges[1] + edges[2])


def _front(axes: Axes) -> None:
    shaft = np.array([0.95, SHAFT_HEIGHT])
    arm = np.array([np.sin(TILT), -np.cos(TILT)])
    bob = shaft + ARM * arm
    _table(axes, -2.95, 2.95)
    x = shaft[0]
    edge(Polygon([(x - 1.1, 0), (x + 1.1, 0), (x + 1.1, 0.24), (x + 0.82, 0.24), (x + 0.5, 4.2), (x - 0.5, 4.2),
                   (x - 0.82, 0.24), (x - 1.1, 0.24)], facecolor=PLASTIC, joinstyle="round"), axes)  # fmt: skip
    edge(Polygon([(x - 0.47, 0.6), (x + 0.47, 0.6), (x + 0.3, 2.7), (x - 0.3, 2.7)], facecolor="white"), axes)
    tower = _tower(axes, bob[0])
    axes.plot([x, x], [SHAFT_HEIGHT - 0.3, 0.75], color=style.GREY, lw=0.7, ls=DASHED, zorder=3)
    threads(axes, shaft, bob)
    axes.add_patch(_clamp(shaft, arm))
    axes.plot(
        *zip(shaft - 0.33 * arm[::-1] * (1, -1), shaft + 0.33 * arm[::-1] * (1, -1), strict=True),
        color=style.INK,
        lw=0.8,
        zorder=7,
    )
    edge(Circle(xy(shaft), 0.14, facecolor=STEEL), axes, 8)
    edge(Circle(xy(bob), BOB, facecolor=STEEL), axes, 6)
    axes.add_patch(
        Arc(xy(shaft), 2.0, 2.0, theta1=-90 + np.degrees(TILT), theta2=-90, color=style.INK, lw=0.9, zorder=6)
    )
    label(axes, *xy(shaft + 1.18 * np.array([np.sin(TILT / 2), -np.cos(TILT / 2)])), r"$\theta$", size=11)
    callout(axes, shaft + (0.1, 0.09), "shaft", (2.1, 4.3))
    callout(axes, shaft + 0.27 * arm[::-1] * (1, -1) + (0.0, 0.05), "split collar", (-0.2, 4.45), "right")
    callout(axes, shaft + 1.75 * arm, "threaded rod\n(aluminium)", (-1.15, 3.35), "right")
    callout(axes, bob + (-0.12, 0.1), "bob (steel)", (-1.75, 2.45), "right")
    callout(
        axes,
        (tower[0] - 0.12, tower[1]),
        "calibration tower:\nexchangeable\ncylinders",
        (-1.62, 1.05),
        "right",
    )
    callout(axes, (tower[0] - 0.24, 0.05), "magnets", (-1.75, 0.3), "right")
    callout(axes, (x + 0.62, 1.6), "pedestal\n(printed ABS)", (2.0, 2.1))
    callout(axes, (-1.6, -0.24), "optical table", (-1.2, -0.72))


def _clamp(shaft: Floats, arm: Floats) -> Polygon:
    half, across = 0.3, arm[::-1] * (1, -1)
    corners = [shaft + half * (i * arm + j * across) for i, j in ((-0.8, -1), (-0.8, 1), (0.8, 1), (0.8, -1))]
    return Polygon(corners, facecolor="#eceff2", edgecolor=style.INK, lw=0.9, zorder=6, joinstyle="round")


def _side(axes: Axes) -> None:
    _table(axes, -1.95, 2.75)
    edge(Polygon([(-0.1, 0), (1.4, 0), (1.4, 0.24), (1.1, 0.24), (1.1, 4.2), (0.3, 4.2), (0.3, 0.24), (-0.1, 0.24)],
                  facecolor=PLASTIC, joinstyle="round"), axes)  # fmt: skip
    y = SHAFT_HEIGHT
    edge(
        Polygon([(1.1, 2.75), (2.45, 2.75), (2.45, 2.95), (1.3, 2.95), (1.1, 2.95)], facecolor=PLASTIC), axes
    )
    edge(Polygon([(1.1, 2.75), (1.1, 2.15), (1.75, 2.75)], facecolor=PLASTIC), axes, 1)
    edge(Rectangle((1.85, 2.95), 0.5, 0.22, facecolor=PLASTIC), axes)
    edge(Rectangle((-0.95, y - 0.13), 2.4, 0.26, facecolor=STEEL), axes, 4)
    for x in (0.3, 0.9):
        for low in (y - 0.35, y + 0.13):
            edge(Rectangle((x, low), 0.2, 0.22, facecolor="white"), axes, 4)
            axes.plot([x, x + 0.2], [low, low + 0.22], color=style.INK, lw=0.6, zorder=5)
            axes.plot([x, x + 0.2], [low + 0.22, low], color=style.INK, lw=0.6, zorder=5)
    edge(Rectangle((1.33, y - 0.22), 0.4, 0.44, facecolor="#eceff2"), axes, 5)
    for x in (1.43, 1.53, 1.63):
        axes.plot([x, x], [y - 0.22, y + 0.22], color=style.INK, lw=0.9, zorder=6)
    edge(Rectangle((1.73, y - 0.09), 0.14, 0.18, facecolor=STEEL), axes, 4)
    edge(
        FancyBboxPatch(
            (1.9, y - 0.48), 0.58, 0.96, boxstyle="round,pad=0.03,rounding_size=0.08", facecolor="#5b6672"
        ),
        axes,
        5,
    )
    axes.plot([2.5, 2.75, 2.75], [y - 0.2, y - 0.2, y - 1.0], color=style.INK, lw=1.6, zorder=3)
    rod = -0.7
    tower = _tower(axes, rod)
    threads(axes, (rod, y), (rod, BOB_HEIGHT))
    edge(Rectangle((rod - 0.17, y - 0.3), 0.34, 0.6, facecolor="#eceff2"), axes, 6)
    axes.plot([rod - 0.17, rod + 0.17], [y, y], color=style.INK, lw=0.8, zorder=7)
    edge(Rectangle((rod - 0.3, BOB_HEIGHT - BOB), 0.6, 2 * BOB, facecolor=STEEL), axes, 6)
    callout(axes, (rod - 0.1, y + 0.2), "split collar", (-1.2, 4.45), "center")
    callout(axes, (0.4, y + 0.24), "bearings", (0.36, 4.5), "center")
    callout(axes, (1.53, y + 0.15), "flexible\ncollar", (1.5, 4.55), "center")
    callout(axes, (2.2, y + 0.3), "rotary\nencoder", (2.42, 4.55), "center")
    callout(axes, (rod - 0.2, BOB_HEIGHT), "bob", (-1.55, 2.3), "center")
    callout(axes, (rod - 0.15, tower[1]), "tower", (-1.6, 1.15), "center")
    callout(axes, (0.9, 1.4), "pedestal", (1.55, 1.4))
    label(axes, 2.72, 2.4, "voltage", size=9, ha="center")
    for x, text in ((-1.95, "front"), (2.75, "rear")):
        label(axes, x, -0.62, text, style.GREY, 9, ha="left" if x < 0 else "right")
