"""How every figure looks: sizes, type, the models' colours, the small notes, and saving without a trace of the day."""

import io
from collections.abc import Callable, Mapping, Sequence
from functools import wraps
from pathlib import Path
from textwrap import wrap
from typing import Any, ParamSpec, TypeVar

import matplotlib
import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.legend import Legend
from matplotlib.lines import Line2D
from matplotlib.text import Text
from matplotlib.ticker import Formatter, FuncFormatter, LogLocator, NullFormatter
from numpy.typing import ArrayLike

from ..arrays import Floats
from ..language import ENGLISH, Language
from ..pendulum.model import symbol
from ..sealed import writing

_P = ParamSpec("_P")
_T = TypeVar("_T")
_F = TypeVar("_F", bound=Figure)
WIDTH_CM = 16.0
DPI = 200
_SCREEN_DPI = 110
_ALONG = 118  # letters along a figure's lower edge
_MANY = 10_000  # points of one line or band
TIME = "time $t$ since the first sample (s)"
EMULATED = "emulated bench: computed, not measured on a real apparatus"
INK, GREY, FAINT, PALE = "#1f2328", "#6b7177", "#c3c8cd", "#eef0f2"

# Okabe and Ito's colours (distinguishable with any colour vision); one model, one colour, in every figure.
COLOURS = {
    "viscous": "#0072B2",
    "quadratic_drag": "#D55E00",
    "load_coulomb": "#009E73",
    "viscous+quadratic_drag": "#CC79A7",
    "viscous+load_coulomb": "#56B4E9",
    "quadratic_drag+load_coulomb": "#E69F00",
    "viscous+quadratic_drag+load_coulomb": "#4d4d4d",
}
NAMES = {
    "viscous": "viscous",
    "quadratic_drag": "quadratic",
    "load_coulomb": "Coulomb",
    "constant_coulomb": "constant Coulomb",
}

# Only fonts that come with matplotlib, so that a figure looks the same, byte for byte, on every machine.
_TICKS = {
    "labelsize": 9,
    "color": GREY,
    "labelcolor": INK,
    "major.width": 0.7,
    "major.size": 3,
    "minor.size": 1.8,
}
RC: dict[str, Any] = {
    "font.family": "STIXGeneral",
    "mathtext.fontset": "stix",
    "font.size": 10,
    "axes.titlesize": 10,
    "axes.titlelocation": "left",
    "legend.fontsize": 9,
    "legend.frameon": False,
    "legend.handlelength": 1.8,
    "legend.borderaxespad": 0.2,
    "legend.columnspacing": 1.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.7,
    "axes.edgecolor": GREY,
    "axes.labelcolor": INK,
    "axes.axisbelow": True,
    "text.color": INK,
    **{f"{axis}tick.{key}": value for axis in "xy" for key, value in _TICKS.items()},
    "grid.color": "#e3e6e9",
    "grid.linewidth": 0.6,
    "lines.linewidth": 1.2,
    "lines.solid_capstyle": "round",
    "errorbar.capsize": 2,
    "hatch.linewidth": 0.6,
    "savefig.facecolor": "white",
    "svg.hashsalt": "swingdown",
    "svg.fonttype": "path",
}


def styled(function: Callable[_P, _T]) -> Callable[_P, _T]:
    """The function, run with this module's settings whatever the caller's matplotlib is set to."""

    @wraps(function)
    def run(*args: _P.args, **kwargs: _P.kwargs) -> _T:
        with matplotlib.rc_context():
            matplotlib.rcdefaults()
            matplotlib.rcParams.update(RC)  # type: ignore[arg-type]  # the stubs know its keys one by one
            return function(*args, **kwargs)

    return run


class Drawn(Figure):
    """A figure that a notebook draws though it belongs to no window: it is its own picture."""

    def _repr_png_(self) -> bytes:
        picture = io.BytesIO()
        self.savefig(picture, format="png", dpi=_SCREEN_DPI)
        return picture.getvalue()


class _Spoken(Formatter):
    """What another formatter writes at an axis, in a language: words as its catalogue has them, numbers with its decimal sign."""

    def __init__(self, inner: Formatter, spoken: Language) -> None:
        self.inner, self.spoken = inner, spoken

    def __call__(self, x: float, pos: int | None = None) -> str:
        written = self.inner(x, pos)
        spoken = self.spoken.text(written)
        return spoken if spoken != written else self.spoken.number(written)

    def get_offset(self) -> str:
        return self.spoken.number(self.inner.get_offset())

    def set_locs(self, locs: Any) -> None:
        self.inner.set_locs(locs)

    def set_axis(self, axis: Any) -> None:
        super().set_axis(axis)
        self.inner.set_axis(axis)


@styled
def in_language(figure: _F, spoken: Language) -> _F:
    """The figure with its texts and the decimal sign of its numbers in this language; a text that its catalogue has not stays English."""
    if spoken.code == ENGLISH:
        return figure
    figure.draw_without_rendering()  # an axis beside another has its limits from here on
    for axis in figure.findobj(Axis):
        axis.set_major_formatter(_Spoken(axis.get_major_formatter(), spoken))
        axis.set_label_text(spoken.text(axis.get_label_text()))
    ticks = {text for axis in figure.findobj(Axis) for text in axis.get_ticklabels(which="both")}
    for text in figure.findobj(Text):
        if text not in ticks:
            joint = " · "
            lines = [joint.join(map(spoken.text, line.split(joint))) for line in text.get_text().split("\n")]
            text.set_text("\n".join(lines))
    footnote(figure, *_remarks(figure))  # words of another language are longer
    _wrap_labels(figure)
    for legend in figure.findobj(Legend):
        while legend.get_window_extent().width > figure.bbox.width:
            for text in legend.get_texts():
                text.set_fontsize(0.92 * float(text.get_fontsize()))
            figure.draw_without_rendering()
    return figure


def _wrap_labels(figure: Figure) -> None:
    """Breaks before its unit each label of an axis that would reach beyond the figure, or into other words."""
    labels = [axis.label for axes in figure.axes for axis in (axes.xaxis, axes.yaxis)]
    broken = True
    while broken:  # one that is broken may leave its neighbours less room
        figure.draw_without_rendering()
        boxes = {one: one.get_window_extent() for one in (*labels, *figure.texts) if one.get_text()}
        broken = False
        for label in labels:
            if not (box := boxes.pop(label, None)):
                continue
            inside = box.x0 >= 0 <= box.y0 and box.x1 <= figure.bbox.width and box.y1 <= figure.bbox.height
            if " (" in label.get_text() and (not inside or any(map(box.overlaps, boxes.values()))):
                label.set_text(label.get_text().replace(" (", "\n(", 1))
                broken = True
            boxes[label] = box


def new_figure(height_cm: float) -> Drawn:
    """An empty figure as wide as the report's column (``WIDTH_CM``), laid out so that nothing overlaps."""
    layout = ConstrainedLayoutEngine(w_pad=0.06, h_pad=0.06, wspace=0.03, hspace=0.03)
    return Drawn(figsize=(WIDTH_CM / 2.54, height_cm / 2.54), dpi=DPI, layout=layout)


def colour(label: str) -> str:
    """The colour of a model, by its label; dark grey for a model that is not one of the paper's seven."""
    return COLOURS.get(label, COLOURS["viscous+quadratic_drag+load_coulomb"])


def name(label: str) -> str:
    """A model's name in words: ``viscous + Coulomb``."""
    return " + ".join(NAMES.get(term, term.replace("_", " ")) for term in label.split("+"))


def model_axis(axes: Axes, entries: Sequence[str | tuple[str, str]]) -> Axes:
    """The axes with one place a model: its symbol, and below it its effects in words, one a line.

    ``entries`` are model labels, or (head, words) for what is not a model.
    """
    pairs = [
        (symbol(e, mathtext=True), name(e).replace(" + ", " +\n")) if isinstance(e, str) else e
        for e in entries
    ]
    axes.set_xticks(range(len(pairs)), [head for head, _ in pairs], fontsize=11)
    axes.tick_params(axis="x", length=0)
    axes.set_xlim(-0.5, len(pairs) - 0.5)
    for place, (_, words) in enumerate(pairs):
        # line by line, so that all stand on the same baselines
        for line, text in enumerate(words.split("\n")):
            noted(axes, text, (place, 0), (0, -26 - 10.5 * line), xycoords=("data", "axes fraction"),
                  ha="center", va="baseline", fontsize=9, annotation_clip=False)  # fmt: skip
    return axes


def degrees(radians: ArrayLike) -> Floats:
    """Radians in degrees, as a plain array."""
    return np.degrees(np.asarray(radians, float))


def signed(number: str) -> str:
    """A number's text with the minus sign that the axes have."""
    return number.replace("-", "−")


def symmetric(axes: Axes, values: ArrayLike) -> Axes:
    """The axes with zero in the middle and all ``values`` in view."""
    sizes = np.abs(np.asarray(values, float))
    reach = 1.12 * float(np.max(sizes[np.isfinite(sizes)], initial=0.0)) or 1.0
    axes.set_ylim(-reach, reach)
    return axes


def dots(axes: Axes, x: ArrayLike, y: ArrayLike, size: float, colour: str, **more: Any) -> None:
    """Single points without edges, of this size (points)."""
    axes.plot(np.asarray(x), np.asarray(y), ".", ms=size, mew=0, color=colour, **more)


def noted(axes: Axes, text: str, at: tuple[Any, Any], away: tuple[float, float], **more: Any) -> None:
    """A text so many points away from a place."""
    axes.annotate(text, at, xytext=away, textcoords="offset points", **more)


def noise_band(axes: Axes, noise: float) -> None:
    """Two standard deviations of the noise to each side of zero."""
    words = "± 2 standard deviations of the noise"
    axes.axhspan(-2 * noise, 2 * noise, color=FAINT, alpha=0.7, lw=0, label=words)


def mark(marker: str, colour: str, label: str, hollow: bool = False) -> Line2D:
    """A legend entry: one marker without a line."""
    face = "white" if hollow else colour
    size = {".": 4.5, "D": 4.6}.get(marker, 5.5)
    return Line2D([], [], ls="", marker=marker, ms=size, color=colour, mfc=face, mew=1.0, label=label)


def legend_above(axes: Axes, handles: Sequence[Artist] | None = None) -> Legend:
    """A one-line legend above the axes, where it cannot cover data."""
    marks_only = handles is not None
    handles = axes.get_legend_handles_labels()[0] if handles is None else handles
    return axes.legend(
        handles=handles,
        loc="lower left",
        bbox_to_anchor=(0, 1.005),
        ncols=len(handles),
        handletextpad=0.5,
        borderpad=0.1,
        handlelength=1.0 if marks_only else 1.8,
    )


def handles_of(figure: Figure) -> list[Artist]:
    """What the axes of a figure have labelled, each label once: the entries of a legend that they share."""
    each = (one for axes in figure.axes for one in axes.get_legend_handles_labels()[0])
    return list({one.get_label(): one for one in each}.values())


def runs(axes: Axes, place: float, values: ArrayLike, colour: str, marker: str) -> None:
    """One model's runs on a category axis: a faint dot each, and their mean with a bar of ± one standard deviation.

    The dots are spread sideways by rank, not at random, so that a figure is the same each time.
    """
    values = np.sort(np.asarray(values, float)[np.isfinite(values)])
    if not values.size:
        return
    spread = 0.09 + 0.05 * (((np.arange(values.size) * 0.618034) % 1) - 0.5)
    dots(axes, place + spread, values, 4.5, colour, alpha=0.38, zorder=2)
    deviation = values.std(ddof=1) if values.size > 1 else np.nan
    axes.errorbar(
        place, values.mean(), deviation, fmt=marker, color=colour, mfc=colour, mec="white", mew=0.5,
        ms={"D": 4.6}.get(marker, 5.4), elinewidth=1.2, capthick=1.2, zorder=4,
    )  # fmt: skip


def published(axes: Axes, place: float, mean: float, deviation: float) -> None:
    """The paper's mean ± standard deviation as a hollow square, nothing where the paper gives none."""
    if np.isfinite(mean):
        axes.errorbar(
            place, mean, deviation, fmt="s", color=INK, mfc="white", mec=INK, mew=0.9, ms=4.8,
            elinewidth=0.9, capthick=0.9, zorder=3,
        )  # fmt: skip


def decimal_log(axis: Axis) -> None:
    """A logarithmic axis marked 0.1, 0.2, 0.5, 1 … instead of in powers of ten."""
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0), numticks=20))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_locator(LogLocator(subs=range(1, 10), numticks=20))
    axis.set_minor_formatter(NullFormatter())


def footnote(figure: _F, *parts: str) -> _F:
    """The figure with the given remarks (empty ones left out) in small type along its lower edge."""
    lines = [""]
    for part in filter(None, parts):
        joined = f"{lines[-1]} · {part}" if lines[-1] else part
        fits = len(joined) <= _ALONG or not lines[-1]
        lines[-1:] = wrap(joined, _ALONG) if fits else [lines[-1], *wrap(part, _ALONG)]
    if lines[0]:
        figure.supxlabel("\n".join(lines), x=0.012, ha="left", fontsize=8, color=GREY, linespacing=1.25)
    return figure


def _remarks(figure: Figure) -> list[str]:
    """The remarks along a figure's lower edge."""
    return figure.get_supxlabel().replace("\n", " · ").split(" · ")


def emulated_note(data: xr.Dataset | Mapping[str, Any]) -> str:
    """What is said of data that no real apparatus stands behind, where they say so of themselves; else nothing.

    ``data`` is a dataset, or a mapping such as an apparatus sheet.
    """
    stated = getattr(data, "attrs", data).get("emulated", "no")
    return EMULATED if str(stated).lower() in ("yes", "true", "1") else ""


@styled
def absent(message: str) -> Figure:
    """A figure that says why there is nothing to see, for a study that leaves a model out.

    Parameters
    ----------
    message
        The words.
    """
    figure = new_figure(4)
    figure.text(0.5, 0.5, message, ha="center", va="center", color=GREY)
    return figure


# What is left out of each format's metadata: it would differ from day to day or from version to version.
_NO_TRACE = {".svg": {"Date": None, "Creator": None}, ".png": {"Software": None}}


def _points(artist: Line2D | PolyCollection) -> int:
    if isinstance(artist, Line2D):
        return np.size(artist.get_xdata())
    return sum(np.shape(path.vertices)[0] for path in artist.get_paths())


@styled
def save(figure: Figure, path: str | Path, note: str = "") -> list[Path]:
    """The paths written, whole or not at all.

    A series of more samples than the page has room for is stored as pixels in an SVG, which would else be many megabytes.
    The same figure gives the same bytes each time. The layout is settled at the first call, so that all files of a
    figure show the same picture.

    Parameters
    ----------
    figure
        The figure.
    path
        Its suffix says whether it is an SVG or a PNG; without one of these both are written.
    note
        Stands along the lower edge, where the figure's own remarks do not say it (as ``emulated_note`` gives it).
    """
    path = Path(path)
    if note and note not in figure.get_supxlabel():
        footnote(figure, *_remarks(figure), note)
    if figure.axes and (layout := figure.get_layout_engine()):
        layout.execute(figure)
    figure.set_layout_engine(None)
    for artist in figure.findobj():
        if isinstance(artist, Line2D | PolyCollection) and _points(artist) > _MANY:
            artist.set_rasterized(True)
    both = [path.with_name(path.name + suffix) for suffix in _NO_TRACE]
    targets = [path] if path.suffix in _NO_TRACE else both
    for target in targets:
        with writing(target) as partial:
            figure.savefig(partial, format=target.suffix[1:], dpi=DPI, metadata=_NO_TRACE[target.suffix])
    return targets
