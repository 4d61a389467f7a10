"""Pairs of effects without a shape: what has no number to bend may, two at a time, be what one with a shape imitates."""

from collections.abc import Collection, Sequence
from itertools import combinations

import numpy as np

from ...arrays import Floats
from ...engine.trajectory import TrajectoryError
from ...pendulum.effect import Effect
from ..see.linear import Frame, bounded, columns_of
from .candidates import WIDEST, Start, additions, shifted
from .refit import widened


def plain(effect: Effect) -> bool:
    """True for an effect that a size alone describes."""
    return len(effect.with_role("size")) == 1 == len(effect.parameters) and effect.parameters[0].lower <= 0


def starts_of_pairs(
    frame: Frame, allowed: Collection[str] | None = None, least: float = 0.0, few: int = 4
) -> list[list[Start]]:
    """The ``Start``s of the ``few`` pairs that promise most, best first: of those whose linear step takes away at least so
    many squares (rad^2).

    As for one effect, the step keeps every value within the catalogue's bounds.
    """
    model, names, columns = frame.fit.model, [], []
    for name in additions(model, allowed):
        if not plain(model.catalogue[name]):
            continue
        size = model.catalogue[name].parameters[0].name
        try:
            columns.append(columns_of(frame, model.catalogue[name], {size: 0.0}, [size]))
        except TrajectoryError:
            continue
        names.append(name)
    if len(names) < 2:
        return []
    own = frame.slopes.shape[1]
    whole = np.hstack([frame.slopes, *map(frame.padded, columns)])
    scale = np.linalg.norm(whole, axis=0)
    scale[scale == 0] = 1.0
    # all that any step can do is in the span of these few columns: each pair is a small problem in it
    basis, triangle = np.linalg.qr(whole / scale)
    aim = basis.T @ frame.residual
    sizes = [model.catalogue[name].parameters[0] for name in names]
    low = np.concatenate([frame.room[0], [max(p.lower, -WIDEST * p.typical) for p in sizes]]) * scale
    high = np.concatenate([frame.room[1], [min(p.upper, WIDEST * p.typical) for p in sizes]]) * scale
    mine = [k for k in range(own) if high[k] > low[k]]
    found = []
    for pair in combinations(range(len(names)), 2):
        at = [*mine, *(own + k for k in pair)]
        x = bounded(triangle[:, at], aim, low[at], high[at])
        gain = float(aim @ aim - np.sum((aim - triangle[:, at] @ x) ** 2))
        if gain >= least:
            step = np.zeros(whole.shape[1])
            step[at] = x / scale[at]
            found.append((gain, pair, step))
    found.sort(key=lambda one: -one[0])
    return [_starts(frame, [names[k] for k in pair], [(sizes[k].name, step[own + k]) for k in pair], step[:own], gain)
            for gain, pair, step in found[:few]]  # fmt: skip


def _starts(
    frame: Frame, names: Sequence[str], sizes: Sequence[tuple[str, float]], own: Floats, gain: float
) -> list[Start]:
    """The starts of one pair: where the linear step leads, and with the model's own values as they are."""
    (first, one), (second, other) = zip(names, sizes, strict=True)
    starts = []
    for begin in (shifted(frame, own), frame.fit.begin):
        for name, (size, value) in ((first, one), (second, other)):
            begin = widened(begin, name, [{size: float(value)}] * len(begin.swings))
        starts.append(Start(first, None, begin, gain, (second,)))
    return starts
