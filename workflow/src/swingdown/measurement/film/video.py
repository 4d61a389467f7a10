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
from scipy.optimize import least_squares

from ...arrays import Bools, Floats
from ...errors import InputError
from ...extras import needed
from ..files.elements import Columns
from ..positions import TIGHT
from .bob import Blob, Look, Pictures, looks_of

# px in which the bob is looked for: blocks of pixels, averaged, have the same centre of mass
LONGEST_SIDE = 640
WINDOWS, OF_EACH = 12, 5  # parts of the film, and frames of each that tell the background and the bob
AREA = 0.15  # share by which the area may differ from the usual one; beyond, some of the bob is hidden or something is added
GAIN = 0.05  # share by which angles are wrong at most from a camera two lengths of the pendulum away, held square by eye to within 10°
TRIPLES = 300  # of points that propose a circle: of half of them wrong, 37 are still right
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
    *better, last = looks_of(cv2, samples, name)
    for looks in better:
        try:
            return _followed(cv2, path, name, first, looks)
        except InputError:
            continue
    return _followed(cv2, path, name, first, last)


def _followed(cv2: Any, path: str, name: str, first: Pictures, looks: Sequence[Look]) -> Track:
    """The Track of the bobs with these looks, without those that are on no circle; InputError where none is."""
    times, found = [], [list[Blob]() for _ in looks]
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
    stated, rate = _stated(cv2, path)
    seconds = _increasing(times, rate, name)
    drawn = _drawn(cv2, first.copy(), np.concatenate(places))
    return Track(seconds, places[0], (width, height), drawn, stated, tuple(places[1:]))


def _places(found: Sequence[Blob], look: Look, factor: int, name: str) -> Floats:
    """Where a bob is in each frame (px of the film), NaN where it was not seen; InputError where it is on no circle."""
    xy = np.array([one[:2] for one in found])
    hidden = ~_of_usual_area(xy, np.array([one.area for one in found]) / look.area)
    xy[hidden | np.r_[False, hidden[:-1]] | np.r_[hidden[1:], False]] = np.nan
    xy = (xy + 0.5) * factor - 0.5
    xy[~_on_circle(xy, factor * math.sqrt(look.area), name)] = np.nan
    return xy


def _of_usual_area(xy: Floats, areas: Floats) -> Bools:
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
        problem = "no frame of it can be read"
        raise InputError(name, problem, FILM, "copy it anew from the camera, or save it as MP4")


def _stated(cv2: Any, path: str) -> tuple[int, float]:
    """How many frames the container states, and how many a second; 0 for neither."""
    reader = cv2.VideoCapture(path)
    try:
        return int(max(reader.get(cv2.CAP_PROP_FRAME_COUNT), 0)), float(reader.get(cv2.CAP_PROP_FPS))
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
    total, _ = _stated(cv2, path)
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
    frames = _frames(cv2, path, name, frozenset([0, *chosen, *(k + 1 for k in chosen)]))
    return chosen, {k: _smaller(cv2, frame) if k else frame for k, _, frame in frames}


def _on_circle(xy: Floats, size: float, name: str) -> Bools:
    """Which places lie on the circle that holds most of them: others are not the bob's. InputError where these are not most.

    Places nearer to each other than the bob's ``size`` count once: what stands still in many frames proposes no circle.
    """
    seen = np.flatnonzero(np.isfinite(xy[:, 0]))
    apart = seen[np.unique(xy[seen] // size, axis=0, return_index=True)[1]]
    best, most = np.zeros(len(xy), bool), 0
    draws = np.random.default_rng(0)
    for _ in range(TRIPLES if len(apart) > 2 else 0):
        found = _near_circle(xy, size, *xy[draws.choice(apart, 3, replace=False)])
        if (count := int(np.count_nonzero(found[apart]))) > most:
            best, most = found, count
    if not (2 * most > len(apart) and 2 * best.sum() > len(xy)):
        raise InputError(
            name,
            f"what moves most lies on a circle in only {best.sum()} of {len(xy)} frames ({most} of {len(apart)} places)",
            "a bob that swings in most of the film, before a camera that stands still",
            "cut the film to the swing, keep all else that moves out of it, or follow the bob with Tracker",
        )
    return best


def _near_circle(xy: Floats, size: float, a: Floats, b: Floats, c: Floats) -> Bools:
    """Which points are near to the circle through three points, by no more than the bob's ``size``: else a circle so large that it is nearly
    a line holds all. None where the three lie on a line.
    """
    points, (first, second, third) = _complex(xy), map(_complex, (a, b, c))
    corner = (third - first) / (second - first)
    if corner.imag == 0:
        return np.zeros(len(xy), bool)
    centre = first + (second - first) * (corner - abs(corner) ** 2) / (2j * corner.imag)
    radius = abs(first - centre)
    return np.abs(np.abs(points - centre) - radius) < min(TIGHT * radius, size)


def _complex(xy: Floats) -> Any:
    """Places as complex numbers."""
    return xy[..., 0] + 1j * xy[..., 1]


def _increasing(times: Sequence[float], rate: float, name: str) -> Floats:
    """The frames' times (s) from the container, or from its rate where it has none."""
    found = np.array(times)
    if len(found) > 1 and np.all(np.diff(found) > 0):
        return found
    if rate > 0:
        return np.arange(len(found)) / rate
    raise InputError(name, "it states neither the times of its frames nor their rate", "a film with times", "save it anew as MP4")  # fmt: skip
