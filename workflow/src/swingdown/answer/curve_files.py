"""What the command writes beside the first answers: curves against the amplitude, what each law of damping leaves, and a picture of both."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from ..curves import dataset, laws, resonance
from ..errors import InputError
from ..extras import has
from ..language import IN_ENGLISH, Language
from ..paths import write_csv
from ..studies.pendulums import NOT_DYING
from .result import Answer

CURVES, LAWS, RESONANCE = "curves", "laws", "resonance"
_FEW = 3  # pendulums that have pictures


def write_beside(
    answers: Mapping[str, Answer], folder: Path, drives: Sequence[float] = (), spoken: Language = IN_ENGLISH
) -> list[str]:
    """What is said of the files written, and of a few pendulums whether their decay is exponential.

    ``curves.csv`` and ``laws.csv`` have all pendulums, the pictures are of a few. Those with too few swings, or that do not die away, have neither.
    What is said and the pictures are in the language ``spoken``. Under ``drives`` (rad/s²) their steady swings are foretold, in ``resonance.csv`` and a picture.
    """
    drawing = has("matplotlib") and len(answers) <= _FEW
    if drawing:
        from ..plots import save  # drawing takes a second to load
        from ..plots.style import in_language

    curves, compared, told = [], [], []
    driven: list[pd.DataFrame] = []
    for campaign, one in answers.items():
        if one.label == NOT_DYING:  # a motor's swings say nothing of damping, and have one amplitude
            continue
        drawn: xr.Dataset | None = None
        with suppress(InputError):
            drawn = one.curves()
            curves.append(dataset.table(drawn).assign(campaign=campaign))
        if drives and drawn is not None:
            told += _foretold(drawn, drives, folder, campaign if len(answers) > 1 else "", driven, spoken)
        found: list[laws.Laws] = []
        with suppress(InputError, ArithmeticError, np.linalg.LinAlgError):
            found = one.laws()
            compared.append(laws.table(found, campaign))
        if len(answers) > _FEW:
            continue
        prefix = f"{campaign}-" if len(answers) > 1 else ""
        if found:
            sentence = spoken.text(laws.exponential_words(found, drawn))
            told.append(f"{campaign}: {sentence}" if prefix else sentence)
        for name, figure in _pictures(drawn, found, one) if drawing else ():
            save(in_language(figure, spoken), folder / f"{prefix}{name}.png")
    tables = [(CURVES, curves, dataset.COLUMNS), (LAWS, compared, laws.COLUMNS)]
    tables += [(RESONANCE, driven, resonance.COLUMNS)] if driven else []
    for name, parts, columns in tables:
        whole = pd.concat(parts, ignore_index=True) if parts else pd.DataFrame(columns=columns)
        write_csv(whole, folder / f"{name}.csv", float_format="%.9g")
    pictures = ", with a picture of each" if told and drawing else ""
    return [*told, f"against the amplitude: {CURVES}.csv; what each law of damping leaves: {LAWS}.csv{pictures}"] if compared or curves else told  # fmt: skip


def _foretold(
    curves: xr.Dataset,
    drives: Sequence[float],
    folder: Path,
    name: str,
    tables: list[pd.DataFrame],
    spoken: Language,
) -> list[str]:
    """What is said of the steady swings of a pendulum under drives: drawn, and added to the ``tables``."""
    before = f"{name}: " if name else ""
    try:
        found = resonance.resonance(curves, drives)
    except InputError as problem:
        return [before + spoken.text(f"no resonance curve: {problem.problem}; expected: {problem.expected}")]
    tables.append(resonance.table(found))
    if has("matplotlib"):
        from ..plots import save
        from ..plots.curves import resonances
        from ..plots.style import in_language

        picture = in_language(resonances(found), spoken)
        save(picture, folder / (f"{name}-{RESONANCE}.png" if name else f"{RESONANCE}.png"))
    return [before + spoken.text(line) for line in resonance.words(found, "free")]


def _pictures(curves: xr.Dataset | None, found: list[laws.Laws], one: Answer) -> Iterator[tuple[str, Any]]:
    """The pictures of a pendulum, each after its name."""
    from ..plots.curves import backbone, envelopes

    if curves is not None:
        yield CURVES, backbone(curves)
    if found:
        with suppress(InputError):
            yield LAWS, envelopes(laws.envelopes(found, curves, str(one.row["emulated"])))
