"""Swings with their fits as numbers in the page, so that a reader can look at a stretch of them closely."""

import base64
import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

from ..arrays import Floats, Shown, extremes
from ..language import IN_ENGLISH, Language
from ..own_unit import axis
from ..own_unit import shown as told

MOST = 15_000  # samples of all traces of a page: 16 bytes each
_FOLDER = Path(__file__).parent
STYLE = (_FOLDER / "uplot" / "uPlot.min.css", _FOLDER / "trace.css")
PROGRAM = (_FOLDER / "uplot" / "uPlot.iife.min.js", _FOLDER / "trace.js")


# What ``trace.js`` says.
WORDS = (
    "measured", "fit", "model, held out", "data − fit", "data − model, held out", "time (s)", "time (s) since the first sample", "recording",
    "all", "all of it", "closer", "farther", "earlier", "later", "drag over a stretch to see it closely, click twice for all of it",
    "grey: ± 2 standard deviations of the noise", "the samples that the fit misses most", "angle (°)", "angular rate (°/s)",
    "data − fit (°)", "data − fit (°/s)",
)  # fmt: skip


def trace(
    shown: Sequence[Shown],
    noise: float | None,
    most: int = MOST,
    unit: str = "rad",
    spoken: Language = IN_ENGLISH,
) -> Markup:
    """The JSON of swings and fits that ``trace.js`` draws: by recording time (s), angle and fit (degrees), and the parts held out.

    ``spoken`` is the language of what stands beside them. ``noise`` is the noise's standard deviation; angles, fits and noise are in ``unit``: ``rad``, ``rad/s`` where a rate is read, or a reading's own.
    Of more than ``most`` samples those stay that leave most of the fit, to both sides, in columns of equal width: ``kept`` tells
    how many of ``samples``.
    """
    parts = Shown.by_recording(shown)
    recordings = [_recording(name, own, most // len(parts)) for name, own in parts.items()]
    content = {
        "what": axis(unit),
        "left": f"data − fit ({told(0.0, unit)[1]})",
        "noise": float(told(noise, unit)[0]) if noise else None,
        "words": {one: text for one in WORDS if (text := spoken.text(one)) != one},
        "decimal": spoken.decimal,
        "recordings": recordings,
    }
    return Markup(json.dumps(content).replace("<", "\\u003c"))


def _recording(name: str, parts: Sequence[Shown], most: int) -> dict[str, object]:
    begin = float(parts[0].times[0])
    samples = sum(one.times.size for one in parts)
    kept = [_kept(one.angle - one.fit, max(2, most * one.times.size // samples)) for one in parts]
    pairs = list(zip(parts, kept, strict=True))
    return {
        "name": name,
        "samples": samples,
        "kept": sum(rows.size for rows in kept),
        "parts": [[int(rows.size), one.held_out] for one, rows in pairs],
        "time": _packed(np.concatenate([one.times[rows] - begin for one, rows in pairs])),
        "angle": _packed(np.concatenate([told(one.angle[rows], one.unit)[0] for one, rows in pairs])),
        "fit": _packed(np.concatenate([told(one.fit[rows], one.unit)[0] for one, rows in pairs])),
    }


def _kept(residual: Floats, most: int) -> NDArray[np.intp]:
    """The indices of all samples, or of so many: of each column the one with the least and with the greatest residual."""
    if residual.size <= most:
        return np.arange(residual.size)
    return extremes(residual, max(1, most // 2))


def _packed(values: Floats) -> str:
    """The numbers as 32-bit floats, little-endian, in base 64."""
    return base64.b64encode(values.astype("<f4").tobytes()).decode()
