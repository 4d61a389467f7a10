"""Which recordings of a study were left out, and why."""

from collections.abc import Collection, Iterable, Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from ..console import framed
from ..measurement.refused import COLUMNS
from ..sealed import read_csv
from ..status import Status

OF_ALL, OF_SEARCH = "everything", "the search"


def explained(verdicts: Iterable[Mapping[str, Any]]) -> list[str]:
    """The campaigns on which there is a verdict."""
    return [str(one["campaign"]) for one in verdicts if one["status"] != Status.NO_VERDICT]


def left_out(
    lost: Iterable[Mapping[str, str]],
    verdicts: Iterable[Mapping[str, Any]] = (),
    before: pd.DataFrame | None = None,
    members: Collection[str] = (),
) -> pd.DataFrame:
    """A row for each recording that was left out, in the order of the study.

    Columns: campaign, recording, label, file, problem, expected, mend, and ``left_out_of``: ``everything``, or ``the search`` of a
    recording that holds no angle, or whose campaign could not be searched. ``lost`` are rows of ``measurement.refused.left_out``; ``verdicts`` the contents of
    verdict.json; ``before`` a table of what was left out before the study began, of which some are ``members`` of the study all the same.
    """
    found = []
    for row in [] if before is None else before.astype(object).where(before.notna(), "").to_dict("records"):
        part = OF_SEARCH if str(row["recording"]) in members else OF_ALL
        found.append({"campaign": row["recording"], "left_out_of": part} | row)
    found += [{"left_out_of": OF_ALL} | dict(row) for row in lost]
    for verdict in verdicts:
        where = {"left_out_of": OF_SEARCH, "campaign": verdict["campaign"], "file": ""}
        found += [where | {"label": row["recording"]} | row for row in verdict["left_out"]]
        if verdict["status"] == Status.NO_VERDICT:
            why = {key: verdict["no_verdict"][key] for key in ("problem", "expected", "mend")}
            found += [where | why | {"recording": name, "label": name} for name in verdict["recordings"]]
    table = pd.DataFrame(found, columns=[*COLUMNS, "left_out_of"])
    return table.drop_duplicates("recording", ignore_index=True)


def last_words(path: str | Path) -> str:
    """What a run ends with where recordings were left out, by the table at ``path``: each with its reason and the mend; else empty."""
    table = read_csv(path) if Path(path).exists() else pd.DataFrame()
    if table.empty:
        return ""
    lines = []
    for row in table.astype(object).fillna("").to_dict("records"):
        part, mend = "not searched: " if row["left_out_of"] == OF_SEARCH else "", row["mend"]
        lines.append(f"{row['recording']}: {part}{row['problem']}" + (f". Mend: {mend}" if mend else ""))
    return framed("Left out of these results; the report lists them:", *lines)
