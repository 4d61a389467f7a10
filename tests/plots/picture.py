"""What a figure is to the eye, panel by panel, in a few letters: they change with every line, mark, word, colour, size and place in it.

It is what the code asks for, to three digits: neither the fonts nor the way in which a version of matplotlib lays it out. Where a script of
matplotlib's own compares hashes of the pixels, every version has others.
"""

import hashlib

import matplotlib.colors
import numpy as np
from matplotlib.axis import Axis
from matplotlib.collections import Collection
from matplotlib.image import AxesImage
from matplotlib.legend import Legend
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.spines import Spine
from matplotlib.text import Text
from matplotlib.ticker import FixedLocator

from swingdown.plots import style

_SKEW = 0.137  # so that no number as people write it lies where rounding goes either way


@style.styled  # ticks are made where they are first asked for
def panels(figure):
    """By name, of the whole figure and of each of its axes, eight letters that stand for what is seen in it."""
    layout = figure.get_layout_engine()
    room = sorted(layout.get().items()) if hasattr(layout, "get") else []
    seen = {
        "whole": [
            _rounded(figure.get_size_inches()),
            figure.dpi,
            room,
            *map(_artist, [*figure.texts, *figure.legends]),
        ]
    }
    for k, axes in enumerate(figure.axes):
        seen[f"{k}"] = list(_axes(axes))
    return {name: hashlib.sha256(repr(one).encode()).hexdigest()[:8] for name, one in seen.items()}


def _axes(axes, beside=False):
    place = axes.get_subplotspec()
    if place is not None:
        grid = place.get_gridspec()
        yield place.num1, place.num2, grid.get_geometry(), grid.get_width_ratios(), grid.get_height_ratios()
    yield (
        _rounded(axes.get_xlim()),
        _rounded(axes.get_ylim()),
        axes.get_xscale(),
        axes.get_yscale(),
        axes.axison,
    )
    yield [text.get_text() for text in axes.get_children() if isinstance(text, Text)], axes.get_aspect()
    for axis in (axes.xaxis, axes.yaxis):
        yield axis.label.get_text(), axis.get_label_position(), axis.get_ticks_position()
        for tick in () if beside else (*axis.get_major_ticks()[:1], *axis.get_minor_ticks()[:1]):
            label, line, grid = tick.label1, tick.tick1line, tick.gridline
            yield label.get_size(), label.get_visible(), label.get_rotation(), _colour(label.get_color())
            yield [
                (
                    _colour(one.get_color()),
                    one.get_markersize(),
                    one.get_markeredgewidth(),
                    one.get_visible(),
                    one.get_linewidth(),
                )
                for one in (line, grid)
            ]
        if isinstance(axis.get_major_locator(), FixedLocator):
            yield _rounded(axis.get_major_locator().locs), [_artist(one) for one in axis.get_ticklabels()]
    for artist in axes.get_children():
        if not isinstance(artist, Axis):
            yield _artist(artist)
    for child in axes.child_axes:
        yield list(_axes(child, beside=True))


def _artist(artist):
    common = type(artist).__name__, artist.get_zorder(), artist.get_alpha(), artist.get_visible()
    if isinstance(artist, Line2D):
        ink = map(_colour, (artist.get_color(), artist.get_markerfacecolor(), artist.get_markeredgecolor()))
        form = artist.get_linestyle(), artist.get_marker(), artist.get_drawstyle(), artist.get_label().strip("_0123456789")  # fmt: skip
        sizes = artist.get_linewidth(), artist.get_markersize(), artist.get_markeredgewidth()
        return *common, *ink, *form, sizes, _rounded(artist.get_xdata()), _rounded(artist.get_ydata())
    if isinstance(artist, Spine):
        return *common, artist.get_linewidth(), _colour(artist.get_edgecolor())
    if isinstance(artist, Patch):
        path = artist.get_patch_transform().transform(artist.get_path().vertices)
        ink = _colour(artist.get_facecolor()), _colour(artist.get_edgecolor()), artist.get_hatch()
        return *common, *ink, artist.get_linewidth(), artist.get_linestyle(), _rounded(path)
    if isinstance(artist, Collection):
        ink = (
            _rounded(one) for one in (artist.get_facecolor(), artist.get_edgecolor(), artist.get_linewidth())
        )
        paths = [_rounded(path.vertices) for path in artist.get_paths()]
        return *common, *ink, paths, _rounded(artist.get_offsets()), _values(artist)
    if isinstance(artist, Text):
        beside = *getattr(artist, "xyann", ()), *getattr(artist, "xy", ())
        form = (
            artist.get_ha(),
            artist.get_va(),
            artist.get_rotation(),
            artist.get_weight(),
            artist.get_style(),
        )
        return *common, artist.get_text(), artist.get_fontsize(), _colour(artist.get_color()), *form, _rounded(artist.get_position()), _rounded(beside)  # fmt: skip
    if isinstance(artist, AxesImage):
        return *common, _values(artist), _rounded(artist.get_extent())
    if isinstance(artist, Legend):
        room = (
            artist.handlelength,
            artist.borderaxespad,
            artist.columnspacing,
            artist.handletextpad,
            artist.borderpad,
        )
        form = (
            artist._loc,
            artist._ncols,
            artist.get_frame_on(),
            artist.get_bbox_to_anchor()._bbox.bounds if artist._bbox_to_anchor else (),
        )
        return *common, room, form, [_artist(one) for one in (*artist.get_texts(), *artist.legend_handles)]
    return common


def _values(artist):
    shown = artist.get_array()
    return (
        None
        if shown is None
        else (_rounded(np.ma.filled(shown, np.nan)), artist.get_clim(), artist.get_cmap().name)
    )


def _colour(colour):
    return "none" if str(colour) == "none" else matplotlib.colors.to_hex(colour, keep_alpha=True)


def _rounded(values):
    """The shape of some numbers, and they to three digits of the largest; of points along and across by themselves."""
    values = np.asarray(values, dtype=object)
    try:
        numbers = values.astype(float)
    except (TypeError, ValueError):
        return str(values.tolist())
    if numbers.ndim == 2 and numbers.shape[1] == 2:
        return _rounded(numbers[:, 0]), _rounded(numbers[:, 1])
    finite = numbers[np.isfinite(numbers)]
    largest = float(np.abs(finite).max(initial=0.0))
    unit = 10.0 ** (np.floor(np.log10(largest)) - 2) if largest > 0 else 1.0
    steps = np.where(np.isfinite(numbers), np.floor(numbers / unit + 0.5 + _SKEW), np.inf)
    return numbers.shape, unit, hashlib.sha256(np.ascontiguousarray(steps).tobytes()).hexdigest()[:12]
