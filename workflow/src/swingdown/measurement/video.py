"""A film of a pendulum as a recording: what moves most is followed from frame to frame (the optional extra ``video``, OpenCV).

The picture without the bob, the background, is the median of frames from the whole film. In each frame the bob is what differs from it
over the usual area. A pixel counts by the share of it that has the bob's colour instead of the background's: so neither blur by motion
nor what is behind the bob changes the area and its centre. A frame in which the bob is hidden, or joined with something else, has
another area and is left out, with its neighbours.
"""

import math
import shutil
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.optimize import least_squares

from ..arrays import Floats
from ..errors import InputError
from ..extras import needed
from .elements import Columns
from .positions import TIGHT

LONGEST_SIDE = (
    640  # px in which the bob is looked for: blocks of pixels, averaged, have the same centre of mass
)
WINDOWS, OF_EACH = 12, 5  # parts of the film, and frames of each that tell the background and the bob
CLEAR = 6.0  # times the noise of a pixel: none of a picture's is beyond by chance
EDGE = 0.25  # of the bob's contrast: where its edge is taken for its own
STRONG = 0.4  # of the contrast of the BRIGHTEST pixels of a frame: what differs less is a shadow, or light that changes
BRIGHTEST = 50
ALWAYS = 0.8  # of the frames in which a region has something that moves, if it is a bob's
SIMILAR = 0.25  # times as large as the largest: what is smaller beside it is no second bob
MOST = 4  # bobs that are followed in one film
LEAST = 12  # px of the smaller picture that a bob covers; the centre of fewer is that of their noise
AREA = 0.15  # share by which the area may differ from the usual one; beyond, some of the bob is hidden or something is added
GAIN = 0.05  # share by which angles are wrong at most from a camera two lengths of the pendulum away, held square by eye to within 10°
TRIPLES = 300  # of points that propose a circle: of half of them wrong, 37 are still right
Pictures = NDArray[np.uint8]
FILM = "a film such as MP4, MOV, AVI or WebM"


class Track(NamedTuple):
    """Where the bob is in each frame: times (s), places (frames, 2) in px of the film, NaN where it was not seen."""

    times: Floats
    places: Floats
    size: tuple[int, int]  # of the film: width, height
    picture: bytes  # a PNG of the places over the first frame: a dot each, from yellow to blue
    stated: int = 0  # frames that the container states
    others: tuple[Floats, ...] = ()  # places of further bobs


def film(source: BinaryIO, name: str) -> dict[str, Columns]:
    """The columns of a film, time (s) and x and y of the bob's centre (px), over the frames in which it was seen.

    Parameters
    ----------
    source
        An open film. Of a film that breaks off it is what can be read.
    name
        What an error names.

    Raises
    ------
    InputError
        Without OpenCV, for a file that is no film, and where nothing moves as a bob on a circle does.
    """
    with _on_disk(source, name) as path:
        found = tracked(path, name)
    each = (found.places, *found.others)
    if len(each) == 1:
        return {"film": _columns(found, found.places)}
    middles = np.argsort([np.nanmean(places[:, 0]) for places in each])
    return {f"bob {k + 1} from the left": _columns(found, each[at]) for k, at in enumerate(middles)}


def _columns(found: Track, places: Floats) -> Columns:
    """The Columns of one bob of a film."""
    seen = np.isfinite(places[:, 0])
    x, y = places[seen].T
    width, height = found.size
    short = len(seen) < found.stated - max(2, found.stated // 100)
    told = (
        f"the bob was followed in {np.count_nonzero(seen)} of {len(seen)} frames"
        + (f"; THE FILE STATES {found.stated} FRAMES, of which the last cannot be read" if short else ""),
        f"a camera up to 10° askew leaves angles right within {GAIN:.0%} (⟨gain_tolerance⟩ says otherwise)",
    )
    table = pd.DataFrame({"t (s)": found.times[seen], "x (px)": x, "y (px)": y})
    layout = f"film of {width} × {height} px"
    return Columns(table, layout, about={"source": "a film"}, remarks=told, usual={"gain_tolerance": GAIN})


def tracked(path: str | Path, name: str = "") -> Track:
    """The Track of a film on disk, kept for who asks again; errors as of ``film``."""
    where = Path(path).resolve()
    about = where.stat()
    return _tracked(str(where), name or str(path), about.st_size, about.st_mtime_ns)


@contextmanager
def _on_disk(source: BinaryIO, name: str) -> Iterator[str]:
    """A path to an open file: its own, or that of a copy."""
    own = getattr(source, "name", None)
    if isinstance(own, str) and Path(own).is_file():
        yield own
        return
    with tempfile.NamedTemporaryFile(suffix=Path(name).suffix) as copy:
        shutil.copyfileobj(source, copy)
        copy.flush()
        yield copy.name


@lru_cache(maxsize=64)
def _tracked(path: str, name: str, size: int, changed: int) -> Track:
    cv2 = needed("cv2")
    first, samples = _samples(cv2, path, name)
    *better, last = _looks(cv2, samples, name)
    for looks in better:
        try:
            return _followed(cv2, path, name, first, looks)
        except InputError:
            continue
    return _followed(cv2, path, name, first, last)


def _followed(cv2: Any, path: str, name: str, first: Pictures, looks: Sequence["_Look"]) -> Track:
    """The Track of the bobs with these looks, without those that are on no circle; InputError where none is."""
    times, found = [], [list[_Blob]() for _ in looks]
    for _, time, frame in _frames(cv2, path, name):
        times.append(time)
        smaller = _smaller(cv2, frame)
        for look, own in zip(looks, found, strict=True):
            own.append(look.bob(smaller))
    places, problems = list[Floats](), list[InputError]()
    for look, own in zip(looks, found, strict=True):
        try:
            places.append(_places(own, look, _factor(first), name))
        except InputError as problem:
            problems.append(problem)
    if not places:
        raise problems[0]
    height, width = first.shape[:2]
    seconds = _increasing(times, _rate(cv2, path), name)
    drawn = _drawn(cv2, first.copy(), np.concatenate(places))
    return Track(seconds, places[0], (width, height), drawn, _stated_in(cv2, path), tuple(places[1:]))


def _places(found: Sequence["_Blob"], look: "_Look", factor: int, name: str) -> Floats:
    """Where a bob is in each frame (px of the film), NaN where it was not seen; InputError where it is on no circle."""
    xy = np.array([one[:2] for one in found])
    hidden = ~_of_usual_area(xy, np.array([one.area for one in found]) / look.area)
    xy[hidden | np.r_[False, hidden[:-1]] | np.r_[hidden[1:], False]] = np.nan
    xy = (xy + 0.5) * factor - 0.5
    xy[~_on_circle(xy, factor * math.sqrt(look.area), name)] = np.nan
    return xy


def _of_usual_area(xy: Floats, areas: Floats) -> NDArray[np.bool_]:
    """Which areas are within ``AREA`` of what is usual at their places, or within three times how far most are from it.

    Light and perspective change the area from side to side; a bob that shines or is not round changes it as it turns.
    """
    seen = np.isfinite(areas) & (areas > 0)
    across = (xy[:, 0] - np.nanmean(xy[:, 0])) / np.nanstd(xy[:, 0])
    terms = np.column_stack([np.ones(len(xy)), across])
    fit = least_squares(lambda p: terms[seen] @ p - areas[seen], [1.0, 0.0], loss="cauchy", f_scale=AREA / 3)
    off = np.abs(areas / (terms @ fit.x) - 1)
    return off < max(AREA, 3 * 1.4826 * float(np.nanmedian(off)))


def _drawn(cv2: Any, picture: Pictures, places: Floats) -> bytes:
    points = places[np.isfinite(places[:, 0])]
    for k, (x, y) in enumerate(points):
        late = k / len(points)
        colour = (255 * late, 255 * (1 - late), 255 * (1 - late))
        cv2.circle(picture, (round(x), round(y)), _factor(picture), colour, -1, cv2.LINE_AA)
    return bytes(cv2.imencode(".png", picture)[1])


def _frames(
    cv2: Any, path: str, name: str, wanted: frozenset[int] | None = None
) -> Iterator[tuple[int, float, Pictures]]:
    """Number, time (s) and picture of each frame, or of those wanted, as far as it can be read. InputError for no film."""
    reader = cv2.VideoCapture(path)
    try:
        count = 0
        while reader.grab():
            if wanted is None or count in wanted:
                read, frame = reader.retrieve()
                if not read:
                    break
                yield count, reader.get(cv2.CAP_PROP_POS_MSEC) / 1000, frame
            count += 1
    finally:
        reader.release()
    if not count:
        raise InputError(
            name, "no frame of it can be read", FILM, "copy it anew from the camera, or save it as MP4"
        )


def _stated(cv2: Any, reader: Any) -> int:
    return int(max(reader.get(cv2.CAP_PROP_FRAME_COUNT), 0))


def _stated_in(cv2: Any, path: str) -> int:
    reader = cv2.VideoCapture(path)
    try:
        return _stated(cv2, reader)
    finally:
        reader.release()


def _rate(cv2: Any, path: str) -> float:
    reader = cv2.VideoCapture(path)
    try:
        return float(reader.get(cv2.CAP_PROP_FPS))
    finally:
        reader.release()


def _factor(frame: Pictures) -> int:
    return math.ceil(max(frame.shape[:2]) / LONGEST_SIDE)


def _smaller(cv2: Any, frame: Pictures) -> Pictures:
    """The picture in averages over square blocks, so that its longer side is ``LONGEST_SIDE`` at most."""
    by = _factor(frame)
    height, width = frame.shape[0] // by, frame.shape[1] // by
    if by == 1:
        return frame
    return cv2.resize(frame[: by * height, : by * width], (width, height), interpolation=cv2.INTER_AREA)


def _samples(cv2: Any, path: str, name: str) -> tuple[Pictures, list[list[Pictures]]]:
    """The first frame, and of each window of the film some smaller pictures, by twos that follow each other."""
    reader = cv2.VideoCapture(path)
    total = _stated(cv2, reader)
    reader.release()
    if not total:  # such as a stream that was saved: it has to be counted
        total = sum(1 for _ in _frames(cv2, path, name))
    chosen, read = _chosen(cv2, path, name, total)
    if chosen[-1] not in read:  # it breaks off, or states a number that it has not
        chosen, read = _chosen(cv2, path, name, sum(1 for _ in _frames(cv2, path, name)))
    first = read[0]
    read[0] = _smaller(cv2, first)
    windows = [
        [read[k + j] for k in chosen[w * OF_EACH : (w + 1) * OF_EACH] for j in (0, 1) if k + 1 in read]
        for w in range(WINDOWS)
    ]
    return first, [window for window in windows if window]


def _chosen(cv2: Any, path: str, name: str, total: int) -> tuple[list[int], dict[int, Pictures]]:
    """The numbers of the frames that are looked at, of so many, and those that can be read, with their followers, smaller; the first as it is."""
    chosen = [int((k + 0.5) / (WINDOWS * OF_EACH) * total) for k in range(WINDOWS * OF_EACH)]
    wanted = frozenset([0, *chosen, *(k + 1 for k in chosen)])
    return chosen, {
        k: _smaller(cv2, frame) if k else frame for k, _, frame in _frames(cv2, path, name, wanted)
    }


class _Blob(NamedTuple):
    """A piece of a picture that differs from the background: centre and area (px), colour, and contrast."""

    x: float
    y: float
    area: float
    colour: Floats
    contrast: float


class _Look:
    """How the bob is found in a picture: by the background, the noise of a pixel, and the bob's usual colour and area."""

    def __init__(self, cv2: Any, background: Pictures, clear: float, region: Pictures | None = None) -> None:
        self.cv2, self.background, self.clear, self.area = cv2, background, clear, 1.0
        self.brightness = float(np.mean(background))
        self.apart: Floats | None = None  # the bob's colour less the background's
        self.strength = 0.0  # the bob's usual contrast
        self.region = region  # 255 where this bob moves, beside others

    def bob(self, frame: Pictures) -> _Blob:
        """What has the usual area most nearly; NaN where nothing is clear of the background."""
        nowhere = _Blob(math.nan, math.nan, math.nan, np.zeros(3), 0.0)
        return min(self.blobs(frame), key=lambda one: abs(math.log(one.area / self.area)), default=nowhere)

    def _even(self, frame: Pictures) -> Pictures:
        """The frame as bright as the background: a camera that sets its exposure anew makes all of the picture brighter."""
        return self.cv2.convertScaleAbs(
            frame, alpha=self.brightness / max(sum(self.cv2.mean(frame)[:3]) / 3, 1.0)
        )

    def _apart(self, even: Pictures) -> Pictures:
        blue, green, red = self.cv2.split(self.cv2.absdiff(even, self.background))
        return self.cv2.max(self.cv2.max(blue, green), red)

    def contrast(self, frame: Pictures) -> Pictures:
        """How much each pixel of a frame differs from the background."""
        return self._apart(self._even(frame))

    def blobs(self, frame: Pictures, most: int = 5) -> list[_Blob]:
        """The largest pieces that differ from the background, that of most area first."""
        cv2 = self.cv2
        even = self._even(frame)
        contrast = self._apart(even)
        if self.region is not None:
            contrast = cv2.bitwise_and(contrast, self.region)
        clear = cv2.threshold(contrast, self.clear, 255, cv2.THRESH_BINARY)[1]
        mask = cv2.morphologyEx(clear, cv2.MORPH_OPEN, np.ones((3, 3), np.uint8))  # a string is no bob
        _, labels, stats, _ = cv2.connectedComponentsWithStats(mask, connectivity=8)
        order = np.argsort(-stats[1:, cv2.CC_STAT_AREA], kind="stable")[:most] + 1
        large = [k for k in order if stats[k, cv2.CC_STAT_AREA] >= LEAST]
        found = [self._weighed(even, contrast, labels, stats[k], k) for k in large]
        return sorted((one for one in found if one.area > 0), key=lambda one: -one.area)

    def _weighed(self, frame: Pictures, contrast: Pictures, labels: Any, stat: Any, label: int) -> _Blob:
        """A piece with its soft edge: each pixel counts by its share of the bob."""
        left, top, width, height = (int(value) for value in stat[:4])
        x, y = max(left - 2, 0), max(top - 2, 0)
        box = slice(y, top + height + 2), slice(x, left + width + 2)
        core = labels[box] == label
        own = self.cv2.dilate(core.astype(np.uint8), np.ones((5, 5), np.uint8)).astype(bool)
        share = own * self._share(frame[box], contrast[box], box)
        area, down, across = float(share.sum()), share.sum(axis=1), share.sum(axis=0)
        if not area > 0:
            return _Blob(math.nan, math.nan, 0.0, np.zeros(3), 0.0)
        strong = core & (contrast[box] >= np.median(contrast[box][core]))
        return _Blob(
            x + float(across @ np.arange(len(across))) / area,
            y + float(down @ np.arange(len(down))) / area,
            area,
            np.median(frame[box][strong], axis=0),
            float(np.median(contrast[box][strong])),
        )

    def _share(self, frame: Pictures, contrast: Pictures, box: tuple[slice, slice]) -> Floats:
        """The share of each pixel that has the bob's colour instead of the background's; before that is known, all that is clear."""
        if self.apart is None:
            return np.asarray(contrast > self.clear, dtype=float)
        apart = self.apart[box]
        moved = frame.astype(np.float32) - self.background[box]
        square = np.maximum((apart * apart).sum(axis=2), self.clear**2)
        return np.clip((moved * apart).sum(axis=2) / square, 0.0, 1.0)


def _looks(cv2: Any, windows: Sequence[Sequence[Pictures]], name: str) -> list[list[_Look]]:
    """The look for each bob of a film, from its samples, in other ways after the first where that follows none: InputError where nothing moves in most of them.

    The background is taken where most moves, since a bob that is nearly at rest hides it: where at least half as much does as in the
    fourth of the windows by that: in three of the twelve a hand may move.
    """
    pairs = [list(zip(one[::2], one[1::2], strict=True)) for one in windows]
    energy = np.array([np.mean([cv2.norm(a, b, cv2.NORM_L1) for a, b in one]) for one in pairs])
    energy -= energy.min()
    frames = [a for one in pairs for a, _ in one]
    enough = np.sort(energy)[-min(4, len(energy))] / 2
    moving = [a for one, much in zip(pairs, energy, strict=True) if much >= enough for a, _ in one]
    background = np.median(moving, axis=0).astype(np.uint8)
    steps = np.array([cv2.absdiff(a, b)[::4, ::4] for one in pairs for a, b in one])
    noise = max(1.4826 * float(np.median(steps)) / math.sqrt(2), 0.5)  # below, it is that of rounding
    start = CLEAR * noise
    regions = _regions(cv2, _Look(cv2, background, start), frames)
    if len(regions) < 2:
        look = _at_bob(_Look(cv2, background, start), frames, name)
        if not regions or look.strength > regions[0].clear:
            return [[look]]
    strong = [
        _at_bob(_Look(cv2, background, max(start, one.clear), one.where), frames, name) for one in regions
    ]
    return [strong, [look]] if len(regions) == 1 else [strong]


class _Region(NamedTuple):
    """Where one bob moves: a picture of 255 within it, from which contrast on it is clear, and how many pixels are so as a rule."""

    where: Pictures
    clear: float
    usual: float


def _regions(cv2: Any, look: _Look, frames: Sequence[Pictures]) -> list[_Region]:
    """Where bobs move: what moves clearly in one place in nearly all frames, the largest first.

    The two sides of a stand before a bob are not: it is on one of them at a time.
    """
    contrasts = [look.contrast(frame) for frame in frames]
    strong = STRONG * float(
        np.median([np.partition(one.ravel(), -BRIGHTEST)[-BRIGHTEST] for one in contrasts])
    )
    square = np.ones((3, 3), np.uint8)
    masks = [
        cv2.morphologyEx((one > max(strong, look.clear)).astype(np.uint8), cv2.MORPH_OPEN, square)
        for one in contrasts
    ]
    swept = cv2.morphologyEx(np.maximum.reduce(masks), cv2.MORPH_CLOSE, np.ones((5, 5), np.uint8))
    count, labels = cv2.connectedComponents(swept, connectivity=8)
    pixels = np.array([np.bincount(labels[one > 0], minlength=count) for one in masks])
    usual, always = np.median(pixels, axis=0), np.mean(pixels >= LEAST, axis=0) >= ALWAYS
    usual[0] = 0.0  # the background
    bobs = [k for k in np.argsort(-usual)[:MOST] if always[k] and usual[k] >= SIMILAR * usual.max() > 0]
    edge = np.ones((7, 7), np.uint8)
    return [
        _Region(cv2.dilate(np.where(labels == k, 255, 0).astype(np.uint8), edge), strong, float(usual[k]))
        for k in bobs
    ]


def _at_bob(look: _Look, frames: Sequence[Pictures], name: str) -> _Look:
    """The look with the colour and area of the bob; InputError where nothing moves in most frames."""
    largest = _largest(look, frames)
    if 2 * len(largest) > len(frames):
        look.clear = max(look.clear, EDGE * float(np.median([one.contrast for one in largest])))
        largest = _largest(look, frames)
    if not 2 * len(largest) > len(frames):
        raise InputError(
            name,
            f"in {len(frames) - len(largest)} of {len(frames)} frames looked at nothing moves that is large and clear enough to be a bob",
            "a bob that differs from what is behind it, before a camera that stands still",
            "film it anew before a plain wall with the camera on a stand, or follow the bob with Tracker",
        )
    look.strength = float(np.median([one.contrast for one in largest]))
    look.apart = np.median([one.colour for one in largest], axis=0).astype(np.float32) - look.background
    look.area = float(np.median([one.area for one in _largest(look, frames)]))
    return look


def _largest(look: _Look, frames: Sequence[Pictures]) -> list[_Blob]:
    return [found[0] for frame in frames if (found := look.blobs(frame))]


def _on_circle(xy: Floats, size: float, name: str) -> NDArray[np.bool_]:
    """Which places lie on the circle that holds most of them: others are not the bob's. InputError where these are not most.

    Places nearer to each other than the bob's ``size`` count once: what stands still in many frames proposes no circle.
    """
    seen = np.flatnonzero(np.isfinite(xy[:, 0]))
    apart = seen[np.unique(xy[seen] // size, axis=0, return_index=True)[1]]
    best, most = np.zeros(len(xy), bool), 0
    draws = np.random.default_rng(0)
    for _ in range(TRIPLES if len(apart) > 2 else 0):
        found = _near_circle(xy, *xy[draws.choice(apart, 3, replace=False)])
        if (count := int(np.count_nonzero(found[apart]))) > most:
            best, most = found, count
    if not (2 * most > len(apart) and 2 * best.sum() > len(xy)):
        raise InputError(
            name,
            f"what moves most lies on a circle in {best.sum()} of {len(xy)} frames, at {most} of {len(apart)} places",
            "a bob that swings in most of the film, before a camera that stands still",
            "cut the film to the swing, keep all else that moves out of it, or follow the bob with Tracker",
        )
    return best


def _near_circle(xy: Floats, a: Floats, b: Floats, c: Floats) -> NDArray[np.bool_]:
    """Which points are near to the circle through three points; none where these lie on a line."""
    (bx, by), (cx, cy) = b - a, c - a
    twice = 2 * (bx * cy - by * cx)
    if twice == 0:
        return np.zeros(len(xy), bool)
    u = (cy * (bx * bx + by * by) - by * (cx * cx + cy * cy)) / twice
    v = (bx * (cx * cx + cy * cy) - cx * (bx * bx + by * by)) / twice
    radius = math.hypot(u, v)
    away = np.hypot(xy[:, 0] - a[0] - u, xy[:, 1] - a[1] - v) - radius
    return np.abs(np.nan_to_num(away, nan=np.inf)) < TIGHT * radius


def _increasing(times: Sequence[float], rate: float, name: str) -> Floats:
    """The frames' times (s) from the container, or from its rate where it has none."""
    found = np.array(times)
    if len(found) > 1 and np.all(np.diff(found) > 0):
        return found
    if rate > 0:
        return np.arange(len(found)) / rate
    raise InputError(name, "it states neither the times of its frames nor their rate", "a film with times", "save it anew as MP4")  # fmt: skip
