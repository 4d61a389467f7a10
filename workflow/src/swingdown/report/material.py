"""What a report is made from."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pandas as pd

from ..arrays import Shown
from ..language import Language, language
from ..sealed import read_csv
from . import sweeps as swept
from .page import Figure


@dataclass(frozen=True)
class Material:
    """What a report is made from.

    ``tables``: name of a file in ``results/tables`` without ending: DataFrame. ``figures``: name (``fig08``): path of
    the picture and caption. ``recordings``: the attributes of each recording. ``settings``: the complete config.
    ``sweeps``: those whose results are there, as ``sweeps.made`` returns them.
    """

    tables: dict[str, pd.DataFrame]
    figures: dict[str, tuple[str, str]]
    recordings: list[dict[str, Any]]
    settings: dict[str, Any]
    inputs: list[str] = field(default_factory=list)  # files whose checksums are told
    verdicts: list[dict[str, Any]] = field(default_factory=list)  # contents of each campaign's verdict.json
    # paths of their figures, discovery/{campaign}/figures/{name}.svg
    seen: list[str] = field(default_factory=list)
    sweeps: dict[str, swept.Made] = field(default_factory=dict)
    # by campaign, beside what the last model makes of them
    swings: dict[str, list[Shown]] = field(default_factory=dict)

    @property
    def own(self) -> bool:
        """True for a study of recordings without the paper's simulations: somebody's own, in which the paper has no part."""
        return bool(self.recordings) and not self.settings["simulation"]["simulated"]

    @property
    def spoken(self) -> Language:
        """The language of the report, as the setting ``lang`` says; the paper's is in English."""
        return language(self.settings.get("lang", "en") if self.own else "en")

    @property
    def emulated(self) -> list[str]:
        """The campaigns that come from an emulated apparatus, each once."""
        return list(dict.fromkeys(r["campaign"] for r in self.recordings if r.get("emulated") == "yes"))

    def shown(self, *names: str) -> list[Figure]:
        """The figures of those names that were made."""
        found = []
        for name in names:
            if name not in self.figures:
                continue
            label, of = f"Figure {int(name.removeprefix('fig'))}", self.emulated if name >= "fig08" else ()
            found.append(Figure(label, *self.figures[name], f"figures/{name}.svg", name, tuple(of)))
        return found


def read_tables(paths: Iterable[str | Path]) -> dict[str, pd.DataFrame]:
    """The tables of the given CSV files by name without ending."""
    return {Path(path).stem: read_csv(path) for path in paths}
