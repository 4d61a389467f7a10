"""From files to an answer in one command: each is read, a first answer is told, and the workflow is run for the verdict."""

import subprocess
import sys
from collections.abc import Mapping, Sequence
from math import degrees
from pathlib import Path
from typing import Any

import pandas as pd

from ..console import warnings_once
from ..errors import InputError
from ..paths import PROJECT, write_csv
from ..rounding import value_with_uncertainty
from ..sealed import read_json
from ..studies.pendulums import by_verdict, in_order
from ..studies.words import lines, model_words, quantity_rows, said
from ..study import own
from . import Answer, of_swings, searchable
from .options import as_options

FIRST = "first_answer.csv"
_FEW = 3  # pendulums that are told at length; of more a line each


def answer(
    given: Sequence[str],
    told: Mapping[str, Any],
    into: str | None = None,
    together: bool = False,
    quick: bool = False,
    cores: int = 2,
    restoring: str = "sine",
) -> int:
    """The exit code of the study of these files and folders, which is written into a folder and run; 0 where all went well.

    ``told`` are cells of the sample sheet that hold for every file, ``restoring`` the setting ``model.restoring``. A file that cannot be used is told and left out; InputError
    where none can be used.
    """
    paths = own.files(given)
    folder = Path(into) if into else own.place(given)
    rows = own.rows(paths, folder, together, told)
    taken, left_out = _read(paths, rows)
    if not taken:
        one = left_out[0]
        where = (
            one.file
            if len(left_out) == 1
            else f"none of {len(left_out)} files can be used; the first, {one.file}"
        )
        raise InputError(where, *map(as_options, (one.problem, one.expected, one.mend)))
    with warnings_once(_say):
        answers, unfit = _first(taken, restoring)
    left_out += unfit
    lost = {one.recording for one in unfit}
    kept = [one for one in taken if one.row["recording"] not in lost]
    if not kept:
        raise InputError(
            unfit[0].file, *map(as_options, (unfit[0].problem, unfit[0].expected, unfit[0].mend))
        )
    _tell(answers)
    searched, short = _searched(kept)
    left_out += short
    for one in (*unfit, *short):
        _say(f"{one.recording}: {one.problem}. Mend: {as_options(one.mend)}.")
    config = own.write(folder, [one.row for one in kept], left_out, searched, restoring)
    table = pd.concat([one.table for one in answers.values()], ignore_index=True)
    write_csv(in_order(table), folder / FIRST)
    _say(f"\nwritten: {config}, {own.SHEET} and {FIRST} beside it")
    if quick:
        return 0
    if not searched:
        _say("nothing here is long enough to be searched for what is missing; the first answer stands")
        return 0
    if PROJECT is None:
        _say("the search and the report need the project's folder (a clone of it); the first answer stands")
        return 0
    _say("now looking for what is missing ...\n")
    code = run_workflow(PROJECT, config, folder, cores)
    failed = [name for name in searched if not _verdict(folder, name).exists()]
    if code and failed and len(failed) < len(searched):
        _say(f"\nthe search did not end of {', '.join(failed)}; once more without")
        left_out += [
            own.Refused(one.row["recording"], one.row["file"], f"the search did not end; results/logs/discover/{one.row['campaign']} tells why", "", "")
            for one in kept
            if one.row["campaign"] in failed
        ]  # fmt: skip
        rest = [name for name in searched if name not in failed]
        again = own.write(folder, [one.row for one in kept], left_out, rest, restoring)
        code = run_workflow(PROJECT, again, folder, cores)
    for campaign in searched:
        path = _verdict(folder, campaign)
        found = read_json(path) if path.exists() else None
        _say(f"{campaign}: {'. '.join(said(found)) if found else 'no verdict; results/logs tells why'}")
        if found and found.get("conclusion") and len(searched) <= _FEW:
            row = by_verdict(answers[campaign].row, found)
            _say("\n".join(f"  {line}" for line in lines(row)))
    if code == 0:
        _say(f"the report: {folder / 'results' / 'report.html'}")
    return 1 if code else 0


def _read(
    paths: Sequence[Path], rows: Sequence[Mapping[str, Any]]
) -> tuple[list[own.Taken], list[own.Refused]]:
    """What each file gives, told in a line each."""
    taken: list[own.Taken] = []
    left_out: list[own.Refused] = []
    for path, row in zip(paths, rows, strict=True):
        parts = own.take(row, path)
        if len(parts) > 1:
            _say(f"{path.name}: the pendulum is released {len(parts)} times in it; each is a recording")
        for number, found in enumerate(parts, 1):
            name = path.name if len(parts) == 1 else f"{path.name}, release {number}"
            if isinstance(found, own.Refused):
                left_out.append(found)
                problem, expected, mend = map(as_options, (found.problem, found.expected, found.mend))
                _say(f"{name}: NOT USED: {problem}. Expected: {expected}. Mend: {mend}.")
                continue
            taken.append(found)
            about = found.recording.attrs
            _say(f"{name}: {about['taken']}, {found.angle.sizes['time']} samples")
            if about.get("remarks"):
                _say(f"    {as_options(about['remarks'])}")
    return taken, left_out


def _first(taken: Sequence[own.Taken], restoring: str) -> tuple[dict[str, Answer], list[own.Refused]]:
    """The first answer on each pendulum, by campaign, and the files of those that cannot be fitted."""
    found: dict[str, Answer] = {}
    unfit: list[own.Refused] = []
    campaigns: dict[str, list[own.Taken]] = {}
    for one in taken:
        campaigns.setdefault(one.row["campaign"], []).append(one)
    for campaign, members in campaigns.items():
        answer, lost = _of_one(members, restoring)
        found |= {campaign: answer} if answer else {}
        unfit += lost
    return found, unfit


def _of_one(members: Sequence[own.Taken], restoring: str) -> tuple[Answer | None, list[own.Refused]]:
    """The answer on one pendulum, and those of its recordings that cannot be fitted, told by trying each alone."""
    try:
        return of_swings([one.angle for one in members], restoring=restoring), []
    except InputError as problem:
        all_lost = [own.refused(one.row, problem) for one in members]
    if len(members) == 1:
        return None, all_lost
    alone = [_of_one([one], restoring) for one in members]
    sound = [one for one, (answer, _) in zip(members, alone, strict=True) if answer]
    lost = [one for _, refused in alone for one in refused]
    if not lost:  # each is a pendulum's, and all together are not one's
        return None, all_lost
    answer, more = _of_one(sound, restoring) if sound else (None, [])
    return answer, lost + more


def _searched(kept: Sequence[own.Taken]) -> tuple[list[str], list[own.Refused]]:
    """The campaigns long enough to hold a part of them out, and of the others why they are not."""
    campaigns: dict[str, list[own.Taken]] = {}
    for one in kept:
        campaigns.setdefault(one.row["campaign"], []).append(one)
    searched, short = [], []
    for campaign, members in campaigns.items():
        try:
            searchable(campaign, [one.angle for one in members])
            searched.append(campaign)
        except InputError as problem:
            short += [own.refused(one.row, problem) for one in members]
    return searched, short


def _tell(answers: Mapping[str, Answer]) -> None:
    """The first answers: at length of a few pendulums, a line each of many."""
    for campaign, one in answers.items():
        if len(answers) <= _FEW:
            _say("\n".join(["", campaign, *(f"  {line}" for line in lines(one.row))]))
            continue
        told = {
            each.name: value_with_uncertainty(each.value, each.uncertainty) for each in quantity_rows(one.row)
        }
        _say(
            f"{campaign:20} T {told.get('period', '–')} s   Q {told.get('quality', '–')}   decay {told.get('decay_time', '–')} s"
            f"   at {degrees(one.row['amplitude_rad']):.3g}°   {model_words(one.model)}"
        )


def _verdict(folder: Path, campaign: str) -> Path:
    return folder / "results" / "discovery" / campaign / "verdict.json"


def run_workflow(project: Path, config: Path, folder: Path, cores: int, targets: Sequence[str] = ()) -> int:
    """The exit code of the workflow on a study. What fails of one pendulum stops no other."""
    command = [
        sys.executable, "-m", "snakemake", "--snakefile", str(project / "Snakefile"), f"-c{cores}", "--keep-going",
        "--configfile", str(config.resolve()), "--directory", str(folder.resolve()), "--", *targets,
    ]  # fmt: skip
    sys.stdout.flush()
    return subprocess.run(command, cwd=project).returncode


def _say(text: object) -> None:
    print(text, flush=True)
