"""From files to an answer in one command: each is read, a first answer is told, and the workflow is run for the verdict."""

import json
import os
import signal
import subprocess
import sys
import warnings
from collections.abc import Mapping, Sequence
from contextlib import redirect_stdout
from contextvars import ContextVar
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd

from ..console import warnings_once
from ..engine.trajectory import TrajectoryWarning
from ..errors import InputError, Refusal, told_to, within
from ..extras import has
from ..language import IN_ENGLISH, Language, language
from ..measurement.files.programs import FILMS
from ..measurement.points.points_recording import POINTS_ALONE, are_points
from ..measurement.second_reading import cells as cells_again
from ..paths import PROJECT, printable, write_csv, written_whole
from ..planning import own
from ..sealed import read_json
from ..series import Series
from ..series.hand_table import OF_TIMES, hand_table, may_be_times
from ..studies.doubt import DoubtfulFit
from ..studies.gravity import Gravity
from ..studies.pendulums import in_order
from ..studies.words import damping_words, details, lines, quantity_rows, told_of
from . import Answer, of_swings, searchable
from .alone import alone
from .by_hand import by_hand
from .curve_files import write_beside
from .hand_in import check_able, hand_in
from .lengths import PIVOTS, with_g, with_lengths, written
from .options import TO_THE_COMMAND
from .series import as_cells, as_changed, series, varied, without_table
from .series import written as write_series

FIRST = "first_answer.csv"
_NO_VERDICT = "no verdict; results/logs has the reason"
_FEW = 3  # pendulums that are told at length; of more a line each


class Wishes(NamedTuple):
    """What is wished of a study: its folder, all files as one pendulum, the first answer alone, processes at a time, the setting
    ``model.restoring``, the answers as JSON on stdout, what a series goes by, the table of its values, drives (rad/s²) whose resonance curves are foretold,
    the language, and what is to be handed in (``hand_in.KINDS``)."""

    into: str | None = None
    together: bool = False
    quick: bool = False
    cores: int = 2
    restoring: str = "sine"
    json: bool = False
    by: str = ""
    values: str = ""
    drives: tuple[float, ...] = ()
    lang: str = "en"
    handed_in: tuple[str, ...] = ()

    @property
    def spoken(self) -> Language:
        """The language of what is told and of the report."""
        return language(self.lang)


class Found(NamedTuple):
    """What a study gave: its exit code, the answer on each pendulum by campaign, what was left out, its folder, what was read, g, the series;
    and the periods of a table that were timed by hand."""

    code: int
    answers: Mapping[str, Answer]
    left_out: Sequence[own.Refused]
    folder: Path
    read: Sequence[own.Taken]
    g: Mapping[str, Gravity]
    series: Sequence[Series]
    by_hand: Sequence[Mapping[str, Any]] = ()


def answer(given: Sequence[str], told: Mapping[str, Any], wishes: Wishes) -> int:
    """The exit code of the study of these files and folders, which is written into a folder and run; 0 where all went well.

    ``told`` are cells of the sample sheet that hold for every file. A file that cannot be used is told and left out; InputError
    where none can be used.
    """
    check_able(wishes.handed_in, wishes.quick)
    with within(_SPOKEN, wishes.spoken), told_to(TO_THE_COMMAND):
        try:
            if not wishes.json:
                return _handed_in(_study(given, told, wishes), wishes).code
            with redirect_stdout(sys.stderr):
                found = _handed_in(_study(given, told, wishes), wishes)
        except Refusal as problem:
            raise problem.told_by(wishes.spoken.text) from None
    print(json.dumps(_as_json(found), indent=1, ensure_ascii=False, allow_nan=False), flush=True)
    return found.code


def _handed_in(found: Found, wishes: Wishes) -> Found:
    """What was found, when it has been written as it is to be handed in."""
    if found.by_hand and wishes.handed_in:
        kinds = " or --".join(wishes.handed_in)
        _say(f"no --{kinds} of a table of periods: {found.folder} has what was made")
        return found
    _say(*hand_in(wishes.handed_in, found.answers, found.folder, wishes.spoken))
    return found


def _as_json(found: Found) -> dict[str, Any]:
    """What a study found as plain numbers, texts and lists."""
    report = found.folder / "results" / "report.html"
    return {
        "version": version("swingdown"),
        "pendulums": [{"pendulum": name, **one.to_dict()} for name, one in found.answers.items()],
        "read": [
            {"recording": one.row["recording"], "file": one.row["file"], **{key: one.recording.attrs.get(key, "") for key in ("taken", "remarks")}}
            for one in found.read
        ],
        "left_out": [
            {"recording": one.recording, "file": one.file, "problem": one.problem, "expected": one.expected, "mend": one.mend}
            for one in found.left_out
        ],
        "g": {name: one.to_dict() for name, one in found.g.items()},
        "series": [one.to_dict() for one in found.series],
        "periods_by_hand": list(found.by_hand),
        "folder": str(found.folder),
        "report": str(report) if found.code == 0 and report.exists() else None,
    }  # fmt: skip


def _study(given: Sequence[str], told: Mapping[str, Any], wishes: Wishes) -> Found:
    """What the study of these files gives; errors as of ``answer``."""
    restoring = wishes.restoring
    paths, passed = own.files(given)
    paths, beside = without_table(paths, wishes.values)
    folder = Path(wishes.into) if wishes.into else own.place(given)
    if len(paths) == 1 and (timed := by_hand(paths[0], folder, wishes.by, told, wishes.spoken)):
        _say(*timed.told)
        return Found(0, {}, passed, folder, [], timed.g, timed.series, timed.periods)
    about_one = {key: cell for key, cell in told.items() if key != PIVOTS}
    rows = own.rows(paths, folder, wishes.together, about_one)
    with_lengths(rows, about_one, told.get(PIVOTS))
    for problem in dict.fromkeys(one.problem for one in passed):
        _say(f"{', '.join(one.label for one in passed if one.problem == problem)}: {problem}")
    taken, left_out = _read(paths, rows, restoring)
    taken, left_out = own.apart(taken), left_out + passed
    if not taken:
        raise _none_of(left_out)
    with warnings_once(_say):
        for kind in (DoubtfulFit, TrajectoryWarning):  # in the row of each pendulum
            warnings.simplefilter("ignore", kind)
        answers, unfit = _first(taken, restoring)
    left_out += unfit
    lost = {one.recording for one in unfit}
    kept = [one for one in taken if one.row["recording"] not in lost]
    if not kept:
        raise unfit[0].error
    changed = varied(kept, beside, wishes.by)
    of_all, how = series(answers, changed)
    as_cells(kept, of_all)
    if wishes.together and changed.by:
        as_changed(kept, changed)
    answers, of_g = with_g(answers, kept)
    if any(one.row.get("changed") for one in kept):
        _say(
            f"\n{changed.by} was changed between the recordings: they share no period or quality; {FIRST} has a row for each"
        )
    else:
        _tell(answers)
    searched, short = _searched(kept)
    left_out += short
    for one in (*unfit, *(one for one in short if one.code != POINTS_ALONE)):  # that is told already
        _say(f"{one.recording}: {one.problem}. Mend: {one.mend}.")
    config = own.write(folder, [one.row for one in kept], left_out, searched, restoring, wishes.lang)
    table = pd.concat([one.table for one in answers.values()], ignore_index=True)
    write_csv(in_order(table), folder / FIRST)
    _say(f"\nwritten: {config}, {own.SHEET} and {FIRST} beside it")
    emulated = "yes" if (table["emulated"] == "yes").any() else "no"
    _say(*written(of_g, folder), *how, *write_series(of_all, folder, emulated, wishes.spoken))
    _say(*write_beside(answers, folder, wishes.drives, wishes.spoken))
    _draw_tracks(kept, folder)
    found = Found(0, answers, left_out, folder, kept, of_g, of_all)
    if wishes.quick:
        return found
    if not searched and not all(are_points(one.angle) for one in kept):
        _say("nothing here can be searched for what is missing; the first answer stands")
        return found
    _say("now looking for what is missing ...\n" if searched else "now writing the report ...\n")
    return _with_verdicts(found, searched, config, wishes)


def _with_verdicts(found: Found, searched: Sequence[str], config: Path, wishes: Wishes) -> Found:
    """What was found, with the verdicts and the report that the workflow makes of it."""
    kept, folder, restoring, spoken = found.read, found.folder, wishes.restoring, wishes.spoken
    answers, left_out = dict(found.answers), list(found.left_out)
    installed = has("snakemake")
    stated = {one.row["recording"]: one.row for one in kept}
    code = run_workflow(PROJECT, config, folder, wishes.cores) if installed else 0
    more = "" if installed else alone(kept, searched, answers, config, restoring)
    failed = [name for name in searched if not _verdict(folder, name).exists()]
    if code and failed and len(failed) < len(searched):
        _say(f"\nthe search did not end of {', '.join(failed)}; once more without")
        left_out += [
            own.Refused(one.row["recording"], one.row["file"], f"the search did not end; results/logs/discover/{one.row['campaign']} has the reason", "", "")
            for one in kept
            if one.row["campaign"] in failed
        ]  # fmt: skip
        rest = [name for name in searched if name not in failed]
        again = own.write(folder, [one.row for one in kept], left_out, rest, restoring, wishes.lang)
        code = run_workflow(PROJECT, again, folder, wishes.cores)
    for campaign in searched:
        path = _verdict(folder, campaign)
        verdict = read_json(path) if path.exists() else None
        _say(f"{campaign}: {told_of(verdict, spoken) if verdict else spoken.text(_NO_VERDICT)}")
        if not verdict:
            continue
        answers[campaign] = ended = answers[campaign].with_verdict(verdict).with_g(stated)[0]
        if verdict.get("conclusion") and len(searched) <= _FEW and not verdict.get("difference"):
            now = [spoken.text(ended.sentence), *details(ended.row, spoken=spoken)]
            _say("\n".join(f"  {line}" for line in now))
    of_g = with_g(answers, kept)[1]
    written(of_g, folder)
    if code == 0:
        _say(f"the report: {folder / 'results' / 'report.html'}")
    if more:
        _say(more)
    return found._replace(code=1 if code else 0, answers=answers, left_out=left_out, g=of_g)


def _none_of(refused: Sequence[own.Refused]) -> InputError:
    """The refusal of recordings of which none can be used: of several each was told, and here only how many."""
    if len(refused) == 1:
        return refused[0].error
    problem = f"none of {len(refused)} recordings can be used; the reasons are above, one by one"
    return InputError(refused[0].file, problem, "a recording of a swinging pendulum", "mend one of them")


def _read(
    paths: Sequence[Path], rows: Sequence[Mapping[str, Any]], restoring: str
) -> tuple[list[own.Taken], list[own.Refused]]:
    """What each file gives, told in a line each."""
    taken: list[own.Taken] = []
    left_out: list[own.Refused] = []
    alone, spoken = len(paths) == 1, _SPOKEN.get()
    for path, row in zip(paths, rows, strict=True):
        parts = own.take(row, path, restoring)
        if len(parts) > 1:
            _say(f"{path.name}: {_several(parts)}")
        for found in parts:
            label = found.label if isinstance(found, own.Refused) else found.row.get("label", "")
            name = path.name + (label.removeprefix(row.get("label", row["recording"])) if label else "")
            if isinstance(found, own.Refused):
                if hand_table(path):
                    problem = "it is a table of times that were taken by hand, not a recording"
                    expected = "recordings side by side, or such a table alone"
                    found = found._replace(problem=problem, expected=expected, mend=f"swingdown {path.name}")
                elif may_be_times(path):
                    found = found._replace(mend=f"{found.mend}; {OF_TIMES}")
                left_out.append(found)
                if alone and len(parts) == 1:  # it ends the command, and is told there
                    continue
                _say(f"{name}: NOT USED: {found.problem}. Expected: {found.expected}. Mend: {found.mend}.")
                continue
            taken.append(found)
            about = found.recording.attrs
            taken_as = f"{about['taken']}, {found.angle.sizes['time']} samples"
            _say(f"{name}: {spoken.text(taken_as)}")
            if about.get("remarks"):
                _say(f"    {about['remarks']}")
    return taken, left_out


def _draw_tracks(kept: Sequence[own.Taken], folder: Path) -> None:
    """Writes, for each film, the track of the bob over its first frame."""
    for one in kept:
        film = folder / one.row["file"]
        if film.suffix.lower() in FILMS:
            from ..measurement.film.video import tracked  # what else is read needs nothing of it

            drawn = folder / f"{one.row['recording']}-track.png"
            with written_whole(drawn) as partial:
                partial.write_bytes(tracked(film).picture)
            _say(f"the track of the bob: {drawn}; look whether it is the bob's")


def _several(parts: Sequence[own.Taken | own.Refused]) -> str:
    """What is said of a file that holds several recordings."""
    runs = {found.row["run"] for found in parts if isinstance(found, own.Taken) and "run" in found.row}
    if not runs and any(isinstance(found, own.Taken) for found in parts):
        return f"the pendulum is released {len(parts)} times in it; each is a recording"
    refused = sum(isinstance(found, own.Refused) for found in parts)
    return f"{len(parts)} runs; {'all' if not refused else len(parts) - refused} taken"


def _first(taken: list[own.Taken], restoring: str) -> tuple[dict[str, Answer], list[own.Refused]]:
    """The first answer on each pendulum, by campaign, and the files of those that cannot be fitted.

    What is read once more, as its longest free stretch, takes its place among the ``taken``.
    """
    found: dict[str, Answer] = {}
    unfit: list[own.Refused] = []
    for campaign, members in _campaigns(taken).items():
        answer, lost = _of_one(members, restoring)
        for angle in answer.swings if answer else ():
            if again := cells_again(angle):  # as the sheet is to read it
                place = [one.row["recording"] for one in taken].index(angle.attrs["recording"])
                taken[place] = taken[place]._replace(row=taken[place].row | again, angle=angle)
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


def _campaigns(taken: Sequence[own.Taken]) -> dict[str, list[own.Taken]]:
    """The recordings of each campaign."""
    names = dict.fromkeys(one.row["campaign"] for one in taken)
    return {name: [one for one in taken if one.row["campaign"] == name] for name in names}


def _searched(kept: Sequence[own.Taken]) -> tuple[list[str], list[own.Refused]]:
    """The campaigns long enough to hold a part of them out, and of the others why they are not."""
    searched, short = [], []
    for campaign, members in _campaigns(kept).items():
        try:
            searchable(campaign, [one.angle for one in members])
            searched.append(campaign)
        except InputError as problem:
            short += [own.refused(one.row, problem) for one in members]
    return searched, short


def _tell(answers: Mapping[str, Answer]) -> None:
    """The first answers: at length of a few pendulums, a line each of many."""
    spoken = _SPOKEN.get()
    for campaign, one in answers.items():
        if len(answers) <= _FEW:
            told = lines(one.row, None, one.catalogue, one.restoring, spoken)
            _say("\n".join(["", campaign, *(f"  {line}" for line in told)]))
            continue
        rows = {each.name: each for each in quantity_rows(one.row)}
        known = {name: each.number for name, each in rows.items()}
        at = rows["period"].condition if "period" in rows else ""
        _say(
            f"{campaign:20} T {spoken.number(known.get('period', '–'))} s   Q {spoken.number(known.get('quality', '–'))}"
            f"   {spoken.text('decay time (1/e)')} {spoken.number(known.get('decay_time', '–'))} s"
            f"   {spoken.text(at)}   {spoken.text(damping_words(one.row))}"
            + (f"   g {spoken.number(known['g'])} m/s²" if "g" in known else "")
        )
        if one.row["remark"]:
            _say(f"    Beware: {one.row['remark']}")


def _verdict(folder: Path, campaign: str) -> Path:
    return folder / "results" / "discovery" / campaign / "verdict.json"


def run_workflow(project: Path, config: Path, folder: Path, cores: int, targets: Sequence[str] = ()) -> int:
    """The exit code of the workflow on a study. What fails of one pendulum stops no other."""
    command = [
        sys.executable, "-m", "snakemake", "--snakefile", str(project / "Snakefile"), f"-c{cores}", "--keep-going",
        "--configfile", str(config.resolve()), "--directory", str(folder.resolve()), "--", *targets,
    ]  # fmt: skip
    sys.stdout.flush()
    # in a group of its own: what Ctrl-C makes of it is told in one line here, and not in its own many
    with subprocess.Popen(
        command, cwd=project, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace", process_group=0,
    ) as running:  # fmt: skip
        try:
            for line in running.stdout or ():
                print(line, end="", file=sys.stderr, flush=True)
        except KeyboardInterrupt:
            os.killpg(running.pid, signal.SIGINT)  # it ends by itself, and leaves no lock behind
            running.communicate()
            raise
    return running.returncode


_SPOKEN: ContextVar[Language] = ContextVar("spoken", default=IN_ENGLISH)


def _say(*texts: object) -> None:
    for text in texts:
        said = "\n".join(map(_SPOKEN.get().text, str(text).split("\n")))
        print(printable(said), flush=True)
