"""How the bob of a film is found in a picture: where bobs move, the colour and the area of each, and the pieces that differ from the background."""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Floats
from ...errors import InputError

CLEAR = 6.0  # times the noise of a pixel: none of a picture's is beyond by chance
EDGE = 0.25  # of the bob's contrast: where its edge is taken for its own
STRONG = 0.4  # of the contrast of the BRIGHTEST pixels of a frame: what differs less is a shadow, or light that changes
BRIGHTEST = 50
ALWAYS = 0.8  # of the frames in which a region has something that moves, if it is a bob's
SIMILAR = 0.25  # times as large as the largest: what is smaller beside it is no second bob
MOST = 4  # bobs that are followed in one film
LEAST = 12  # px of the smaller picture that a bob covers; the centre of fewer is that of their noise
Pictures = NDArray[np.uint8]


class Blob(NamedTuple):
    """A piece of a picture that differs from the background: centre and area (px), colour, and contrast."""

    x: float
    y: float
    area: float
    colour: Floats
    contrast: float


class Look:
    """How the bob is found in a picture: by the background, the noise of a pixel, and the bob's usual colour and area."""

    def __init__(self, cv2: Any, background: Pictures, clear: float, region: Pictures | None = None) -> None:
        self.cv2, self.background, self.clear, self.area = cv2, background, clear, 1.0
        self.brightness = float(np.mean(background))
        self.apart: Floats | None = None  # the bob's colour less the background's
        self.strength = 0.0  # the bob's usual contrast
        self.region = region  # 255 where this bob moves, beside others

    def bob(self, frame: Pictures) -> Blob:
        """What has the usual area most nearly; NaN where nothing is clear of the background."""
        nowhere = Blob(math.nan, math.nan, math.nan, np.zeros(3), 0.0)
        return min(self.blobs(frame), key=lambda one: abs(math.log(one.area / self.area)), default=nowhere)

    def _even(self, frame: Pictures) -> Pictures:
        """The frame as bright as the background: a camera that sets its exposure anew makes all of the picture brighter. Of a background
        darker than a step of the picture there is nothing to tell that by."""
        brightness = sum(self.cv2.mean(frame)[:3]) / 3
        return self.cv2.convertScaleAbs(frame, alpha=max(self.brightness, 1.0) / max(brightness, 1.0))

    def _apart(self, even: Pictures) -> Pictures:
        blue, green, red = self.cv2.split(self.cv2.absdiff(even, self.background))
        return self.cv2.max(self.cv2.max(blue, green), red)

    def contrast(self, frame: Pictures) -> Pictures:
        """How much each pixel of a frame differs from the background."""
        return self._apart(self._even(frame))

    def blobs(self, frame: Pictures) -> list[Blob]:
        """The largest five pieces that differ from the background, that of most area first."""
        cv2 = self.cv2
        even = self._even(frame)
        contrast = self._apart(even)
        if self.region is not None:
            contrast = cv2.bitwise_and(contrast, self.region)
        clear = cv2.threshold(contrast, self.clear, 255, cv2.THRESH_BINARY)[1]
        mask = cv2.morphologyEx(clear, cv2.MORPH_OPEN, np.ones((3, 3), np.uint8))  # a string is no bob
        _, labels, stats, _ = cv2.connectedComponentsWithStats(mask, connectivity=8)
        order = np.argsort(-stats[1:, cv2.CC_STAT_AREA], kind="stable")[:5] + 1
        large = [k for k in order if stats[k, cv2.CC_STAT_AREA] >= LEAST]
        found = [self._weighed(even, contrast, labels, stats[k], k) for k in large]
        return sorted((one for one in found if one.area > 0), key=lambda one: -one.area)

    def _weighed(self, frame: Pictures, contrast: Pictures, labels: Any, stat: Any, label: int) -> Blob:
        """A piece with its soft edge: each pixel counts by its share of the bob."""
        left, top, width, height = (int(value) for value in stat[:4])
        x, y = max(left - 2, 0), max(top - 2, 0)
        box = slice(y, top + height + 2), slice(x, left + width + 2)
        core = labels[box] == label
        own = self.cv2.dilate(core.astype(np.uint8), np.ones((5, 5), np.uint8)).astype(bool)
        share = own * self._share(frame[box], contrast[box], box)
        area, down, across = float(share.sum()), share.sum(axis=1), share.sum(axis=0)
        if not area > 0:
            return Blob(math.nan, math.nan, 0.0, np.zeros(3), 0.0)
        strong = core & (contrast[box] >= np.median(contrast[box][core]))
        return Blob(
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


def looks_of(cv2: Any, windows: Sequence[Sequence[Pictures]], name: str) -> list[list[Look]]:
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
    regions = _regions(cv2, Look(cv2, background, start), frames)
    if len(regions) < 2:
        look = _at_bob(Look(cv2, background, start), frames, name)
        if not regions or look.strength > regions[0].clear:
            return [[look]]
    strong = [
        _at_bob(Look(cv2, background, max(start, one.clear), one.where), frames, name) for one in regions
    ]
    return [strong, [look]] if len(regions) == 1 else [strong]


class _Region(NamedTuple):
    """Where one bob moves: a picture of 255 within it, from which contrast on it is clear, and how many pixels are so as a rule."""

    where: Pictures
    clear: float
    usual: float


def _regions(cv2: Any, look: Look, frames: Sequence[Pictures]) -> list[_Region]:
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


def _at_bob(look: Look, frames: Sequence[Pictures], name: str) -> Look:
    """The look with the colour and area of the bob; InputError where nothing moves in most frames."""
    largest = _largest(look, frames)
    if 2 * len(largest) > len(frames):
        look.clear = max(look.clear, EDGE * float(np.median([one.contrast for one in largest])))
        largest = _largest(look, frames)
    if not 2 * len(largest) > len(frames):
        raise InputError(
            name,
            f"in {len(frames) - len(largest)} of {len(frames)} frames nothing moves that is large and clear enough to be the bob",
            "a bob that differs from what is behind it, before a camera that stands still",
            "film it anew before a plain wall with the camera on a stand, or follow the bob with Tracker",
        )
    look.strength = float(np.median([one.contrast for one in largest]))
    look.apart = np.median([one.colour for one in largest], axis=0).astype(np.float32) - look.background
    look.area = float(np.median([one.area for one in _largest(look, frames)]))
    return look


def _largest(look: Look, frames: Sequence[Pictures]) -> list[Blob]:
    return [found[0] for frame in frames if (found := look.blobs(frame))]
