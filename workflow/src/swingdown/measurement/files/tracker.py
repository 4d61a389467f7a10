"""Projects of Tracker (Open Source Physics), ``.trk`` and ``.trz``: the positions of each point mass, frame by frame.

Tracker saves what was marked in pixels of the picture, beside the axes, the scale and the clip. Here they become what its own
table shows: times since the clip's first frame, positions along the axes in its unit of length. Written after its sources
(OpenSourcePhysics/tracker and osp: ``PointMass``, ``ImageCoordSystem``, ``VideoClip``, ``StepperClipControl``).
"""

from collections.abc import Iterator
from typing import BinaryIO
from xml.etree.ElementTree import Element

import numpy as np
import pandas as pd

from ...arrays import Floats
from ...errors import InputError
from .elements import Columns, distinct, number, roots

PROGRAM = "Tracker"


def tracks(source: BinaryIO, name: str) -> dict[str, Columns]:
    """The Columns of each point mass by its name: time (s), x and y in the unit of length, or px where no scale was set.

    Frames in which the mass was not marked are left out. InputError for a file without a marked point mass, or without its clock.
    """
    found: dict[str, Columns] = {}
    for root in roots(source, name, PROGRAM, ".trk"):
        panels = [one for one in root.iter("object") if one.get("class", "").endswith(".TrackerPanel")]
        for panel in panels:
            part = dict(_masses(_Saved(panel), name))
            names = distinct([*found, *part], [""] * (len(found) + len(part)))
            found = dict(zip(names, [*found.values(), *part.values()], strict=True))
    if not found:
        problem = "it holds no point mass that was marked within the clip"
        mend = "track the bob as a point mass in Tracker and save the project"
        raise InputError(name, problem, "the track of the bob", mend)
    return found


class _Saved:
    """An object as Tracker writes it: its properties by their names."""

    def __init__(self, element: Element | None) -> None:
        inside = [] if element is None else element.findall("property")
        self.all = {one.get("name", ""): one for one in inside}

    def at(self, key: str) -> Element:
        """A property; an empty one where it is not there."""
        return self.all.get(key, Element("property"))

    def inside(self, key: str) -> "_Saved":
        """The object that a property is; one without properties where it is none."""
        return _Saved(self.at(key).find("object"))

    def text(self, key: str) -> str:
        return (self.at(key).text or "").strip()

    def number(self, key: str, default: float) -> float:
        found = number(self.text(key))
        return found if np.isfinite(found) else default

    def numbers(self, key: str) -> Floats:
        """An array of numbers, as it stands in one line between braces."""
        text = self.at(key).findtext("property") or ""
        return np.array([number(one) for one in text.strip().strip("{}").split(",") if one.strip()])

    def frames(self, key: str) -> "dict[int, _Saved]":
        """The objects of an array by their positions in it; those that are not there are left out."""
        return {
            int(one.get("name", "").strip("[]")): _Saved(inside)
            for one in self.at(key).findall("property")
            if (inside := one.find("object")) is not None
        }


def _masses(panel: _Saved, name: str) -> Iterator[tuple[str, Columns]]:
    clip, clock = panel.inside("videoclip"), panel.inside("clipcontrol")
    objects = panel.at("tracks").findall("property/object")
    masses = [_Saved(one) for one in objects if one.get("class", "").endswith(".PointMass")]
    called = distinct([one.text("name") or "point mass" for one in masses], [""] * len(masses))
    for mass, title in zip(masses, called, strict=True):
        marks = {frame: one for frame, one in mass.frames("framedata").items() if _is_step(frame, clip)}
        if not marks:
            continue
        frames = np.array(sorted(marks))
        pixels = np.array([[marks[frame].number(key, np.nan) for key in "xy"] for frame in frames])
        x, y, unit = _along_axes(frames, pixels, panel)
        written = f" ({unit})" if unit else ""
        times = _times(frames, clip, clock, name)
        table = pd.DataFrame({"t (s)": times, f"x{written}": x, f"y{written}": y})
        version = f" {panel.text('semantic_version')}".rstrip()
        yield title, Columns(table, f"point mass `{title}`", about={"source": f"{PROGRAM}{version}"})


def _is_step(frame: int, clip: _Saved) -> bool:
    """True for a frame of Tracker's own table: marks between its steps or outside of the clip are from other settings."""
    start, size = clip.number("startframe", 0), max(clip.number("stepsize", 1), 1)
    count = clip.number("stepcount", np.inf)
    return frame >= start and (frame - start) % size == 0 and (frame - start) / size < count


def _times(frames: np.ndarray, clip: _Saved, clock: _Saved, name: str) -> Floats:
    """Seconds since the clip began: from the times that the video has, stretched to the interval that is set, else by that."""
    interval = clock.number("delta_t", np.nan)
    if not interval > 0:
        raise InputError(name, "the project states no time between frames (delta_t)", "a clip with its clock", "set the frame rate in the clip settings of Tracker and save again")  # fmt: skip
    start = int(clip.number("startframe", 0))
    video = clip.inside("video").numbers("start_times")
    elapsed = (frames - start) * interval
    if len(video) > frames.max() and start < len(video) - 1:
        size = max(clip.number("stepsize", 1), 1)
        last = min(start + size * (clip.number("stepcount", np.inf) - 1), len(video) - 1)
        mean = (video[int(last)] - video[start]) / max(last - start, 1)
        if mean > 0:
            elapsed = (video[frames] - video[start]) * interval / mean
    return np.asarray(clip.number("starttime", 0) + elapsed) / 1000


def _along_axes(frames: np.ndarray, pixels: Floats, panel: _Saved) -> tuple[Floats, Floats, str]:
    """x and y along the axes of each frame, and their unit.

    A frame without axes of its own has those of the last one before it that has.
    """
    systems = [
        one for one in panel.at("coords").iter("object") if one.get("class", "").endswith("CoordSystem")
    ]
    saved = _Saved(systems[0] if systems else None).frames("framedata")
    keys = sorted(saved) or [0]
    rows = [
        [one.number(key, default) for key, default in (("xorigin", 0), ("yorigin", 0), ("angle", 0), ("xscale", 1), ("yscale", 1))]
        for one in (saved.get(key, _Saved(None)) for key in keys)
    ]  # fmt: skip
    of = np.clip(np.searchsorted(keys, frames, "right") - 1, 0, None)
    x0, y0, degrees, per_x, per_y = np.array(rows)[of].T
    across, up = (pixels[:, 0] - x0) / per_x, -(pixels[:, 1] - y0) / per_y
    cos, sin = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    scaled = bool(np.any(np.array(rows)[:, 3:] != 1))
    return (across * cos + up * sin, up * cos - across * sin, (panel.text("length_unit") if scaled else "px"))
