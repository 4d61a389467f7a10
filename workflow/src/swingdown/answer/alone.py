"""Verdicts and report of recordings without the workflow: one pendulum after another, in the process of the command.

Verdict, values and tables are those of the workflow, and the report shows them with the swings and their fits. All other figures,
the rounds of the search as files, and what follows a change between recordings are left to the workflow.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path

import pandas as pd

from ..engine.trajectory import TrajectoryError
from ..errors import InputError
from ..extras import lacking
from ..manifest import write_manifest
from ..planning import own
from ..planning.settings import with_defaults
from ..report import contents, page
from ..schema import read_yaml
from ..sealed import read_csv, write_csv, write_json
from ..studies.left_out import left_out
from ..studies.pendulums import judged
from . import Answer, explained


def alone(
    kept: Sequence[own.Taken],
    searched: Sequence[str],
    answers: Mapping[str, Answer],
    config: Path,
    restoring: str,
) -> str:
    """What is said of the results when they have been written beside the config: verdicts, tables, report, manifest.

    ``answers`` are the first ones, by campaign; ``searched`` those campaigns that are long enough for a verdict.
    """
    results = config.parent / "results"
    ended, lost = dict(answers), []
    for campaign in searched:
        members = [one for one in kept if one.row["campaign"] == campaign]
        try:
            ended[campaign] = _with_verdict(answers[campaign], members, restoring)
        except (InputError, TrajectoryError) as problem:
            why = InputError(campaign, f"the search did not end ({problem})")
            why = problem if isinstance(problem, InputError) else why
            lost += [own.refused(one.row, why) for one in members]
            continue
        write_json(results / "discovery" / campaign / "verdict.json", ended[campaign].verdict)
    verdicts = [dict(one.verdict) for one in ended.values() if one.verdict]
    before = config.parent / own.LEFT_OUT
    known = [*([read_csv(before)] if before.exists() else []), pd.DataFrame(lost)]
    names = {one.row["recording"] for one in kept}
    tables = {"left_out": left_out([], [], pd.concat(known, ignore_index=True), names)}
    rows = [row for one in answers.values() for row in one.table.to_dict("records")]
    tables["pendulums"] = judged(rows, verdicts, tables["left_out"])
    for name, table in tables.items():
        write_csv(table, results / "tables" / f"{name}.csv")
    material = contents.Material(
        tables=tables,
        figures={},
        recordings=[one.recording.attrs for one in kept],
        settings=with_defaults(read_yaml(config, config)),
        inputs=[str(config), str(config.parent / own.SHEET)],
        verdicts=verdicts,
        swings={campaign: list(one.shown) for campaign, one in ended.items() if one.shown},
    )
    page.write(results / "report.html", contents.sections(material), contents.head(material))
    write_manifest(results, results / "manifest.json")
    return f"the workflow adds its figures and the search round by round: {lacking('snakemake').mend}, and give the same command again"


def _with_verdict(first: Answer, members: Sequence[own.Taken], restoring: str) -> Answer:
    """The first answer on a pendulum with its verdict; errors as of ``explained``, and InputError where something was changed between its recordings."""
    campaign = members[0].row["campaign"]
    if any(one.row.get("changed") for one in members):
        raise InputError(campaign, "only the workflow finds which effect follows a change between recordings", mend=lacking("snakemake").mend)  # fmt: skip
    found = explained([one.angle for one in members], restoring=restoring)
    named = {"campaign": campaign, "recordings": [one.row["recording"] for one in members]}
    return first.with_verdict(dict(found.verdict or {}) | named, found.shown)
