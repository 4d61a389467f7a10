"""An answer as it is handed in: the report as PDF, the table for LaTeX and as a spreadsheet."""

import math
import os
import re
import shutil
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from math import degrees
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import pandas as pd

from ..errors import InputError
from ..extras import has, lacking
from ..language import Language, capital
from ..paths import for_spreadsheets, write_text, written_whole
from ..pendulum.catalogue import catalogue
from ..sealed import read_csv, read_json
from ..studies.pendulums import REFUSED, quantities_of
from ..studies.words import EMULATED, damping_words, headline, quantity_rows

if TYPE_CHECKING:
    from .result import Answer

PDF, TABLE = "report.pdf", "answer"
KINDS = ("pdf", "latex", "xlsx")
_BROWSERS = (
    "chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome", "microsoft-edge", "msedge", "brave-browser",
    "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome", "/Applications/Microsoft Edge.app/Contents/MacOS/Microsoft Edge",
    "/Applications/Chromium.app/Contents/MacOS/Chromium",
)  # fmt: skip
_WAIT = 120  # s, for a page
_CLASS = ("period", "quality", "decay_time", "natural_frequency", "g")  # of many pendulums, a column each


class Studied(NamedTuple):
    """What a study's tables tell of a pendulum, as an ``Answer`` does: its row of ``studies.pendulums``, the verdict, the sentence, and what
    is to be known of it."""

    row: Mapping[str, Any]
    verdict: Mapping[str, Any] | None
    sentence: str
    remarks: list[str]


Told: TypeAlias = "Answer | Studied"  # what is handed in of a pendulum


def studied(results: Path, settings: Mapping[str, Any]) -> dict[str, Studied]:
    """What the results of a study tell of each pendulum, by campaign; nothing where it has no table of them."""
    table = results / "tables" / "pendulums.csv"
    if not table.exists():
        return {}
    known, restoring = catalogue(settings["effects"]), settings["model"]["restoring"]
    found = {}
    for one in read_csv(table).to_dict("records"):
        row = {key: cell for key, cell in one.items() if key.endswith("rad") or not pd.isna(cell)}
        if row.get("verdict") == REFUSED:
            continue
        campaign = str(row["campaign"])
        place = results / "discovery" / campaign / "verdict.json"
        verdict = read_json(place) if place.exists() else None
        remarks = [str(row["remark"])] if "remark" in row else []
        found[campaign] = Studied(row, verdict, headline(row, verdict, known, restoring), remarks)
    return found


def check_able(kinds: Sequence[str], quick: bool = False) -> None:
    """None where these of ``KINDS`` can be made; InputError or PackageError, before anything is computed, where not."""
    if "pdf" in kinds and quick:
        raise InputError("--pdf", "--quick ends before the report", "a report to print", "leave out one of the two")  # fmt: skip
    if "xlsx" in kinds and not has("openpyxl"):
        raise lacking("openpyxl")


def hand_in(kinds: Sequence[str], answers: Mapping[str, Told], folder: Path, spoken: Language) -> list[str]:
    """What is said of the files written into the folder, a line each."""
    told = []
    if not answers and (tables := [f"--{kind}" for kind in kinds if kind != "pdf"]):
        place = folder / "results" / "tables"
        told.append(f"no {' or '.join(tables)}: this study has no pendulums; its tables are {place}")
        kinds = [kind for kind in kinds if kind == "pdf"]
    if "latex" in kinds:
        told.append(f"the table for LaTeX: {write_text(folder / f'{TABLE}.tex', latex(answers, spoken))}")
    if "xlsx" in kinds:
        told.append(f"the table as a spreadsheet: {spreadsheet(answers, folder / f'{TABLE}.xlsx', spoken)}")
    if "pdf" in kinds:
        told.append(printed(folder / "results" / "report.html", folder / PDF))
    return told


def printed(report: Path, pdf: Path) -> str:
    """What is said of a report that was printed into a file; where no browser can, how to print it by hand."""
    if not report.exists():
        return "no PDF: there is no report"
    browser = os.environ.get("SWINGDOWN_CHROMIUM") or next(filter(None, map(shutil.which, _BROWSERS)), None)
    if not browser:
        return f"no PDF: that takes Chromium, Chrome or Edge; open {report} and print it into a file"
    with tempfile.TemporaryDirectory() as profile, written_whole(pdf) as partial:
        made = Path(profile) / "page.pdf"
        root = ["--no-sandbox"] if hasattr(os, "geteuid") and os.geteuid() == 0 else []
        command = [
            browser, "--headless", *root, "--disable-gpu", "--no-first-run", "--disable-background-networking", "--virtual-time-budget=5000",
            f"--user-data-dir={profile}", "--no-pdf-header-footer", "--generate-pdf-document-outline", f"--print-to-pdf={made}", report.resolve().as_uri(),
        ]  # fmt: skip
        try:
            subprocess.run(command, capture_output=True, timeout=_WAIT, check=True)
            shutil.copyfile(made, partial)
        except (OSError, subprocess.SubprocessError) as problem:
            raise InputError(pdf, f"{browser} printed no page ({problem})", "a PDF of the report", f"open {report} and print it into a file") from problem  # fmt: skip
    return f"the report as PDF: {pdf}"


def latex(answers: Mapping[str, Told], spoken: Language) -> str:
    """A table for LaTeX with the package booktabs: of one pendulum a row for each quantity, of several a row for each pendulum."""
    if len(answers) == 1:
        (one,) = answers.values()
        head = [spoken.text(word) for word in ("quantity", "value", "unit", "amplitude")]
        rows = [
            [spoken.text(each.words), spoken.number(_number(each.text, each.unit)), _unit(each.unit), spoken.text(each.condition)]
            for each in quantity_rows(one.row, one.verdict)
        ]  # fmt: skip
        caption = spoken.text(one.sentence)
    else:
        head, rows = _side_by_side(answers, spoken)
        caption = spoken.text(_CAPTION)
    if any(one.row["emulated"] == "yes" for one in answers.values()):
        caption = f"{caption.rstrip('.')}. {capital(spoken.text(EMULATED))}."
    body = [" & ".join(map(_escaped, row)) + r" \\" for row in rows]
    lines = [
        r"% \usepackage{booktabs}",
        r"\begin{table}",
        r"\centering",
        rf"\caption{{{_escaped(caption)}}}",
        rf"\begin{{tabular}}{{{'l' * len(head)}}}",
        r"\toprule",
        " & ".join(map(_escaped, head)) + r" \\",
        r"\midrule",
        *body,
        r"\bottomrule",
        r"\end{tabular}",
        r"\end{table}",
    ]
    return "\n".join(lines) + "\n"


_CAPTION = "In parentheses the standard uncertainty in units of the last digits."


def _side_by_side(answers: Mapping[str, Told], spoken: Language) -> tuple[list[str], list[list[str]]]:
    """Head and rows of a table with a row for each pendulum."""
    found = {name: quantities_of(one.row) for name, one in answers.items()}
    shown = [key for key in _CLASS if any(key in own for own in found.values())]
    words = {row.name: (row.words, row.unit) for one in answers.values() for row in quantity_rows(one.row)}
    head = [spoken.text("pendulum")]
    for key in shown:
        name, unit = words[key]
        head.append(spoken.text(name) + ("" if unit == "1" else f" ({_unit(unit)})"))
    rows = []
    for name, one in answers.items():
        own = found[name]
        cells = [_number(str(own[key]), own[key].unit) if key in own else "–" for key in shown]
        at = degrees(one.row["amplitude_rad"])
        rows.append(
            [name, *map(spoken.number, cells), spoken.number(f"{at:.3g}°" if math.isfinite(at) else "–"), spoken.text(damping_words(one.row))]
        )  # fmt: skip
    return [*head, spoken.text("amplitude"), spoken.text("model")], rows


def _number(text: str, unit: str) -> str:
    """A value with its uncertainty, without its unit; a power of ten as such."""
    bare = text if unit == "1" else text.removesuffix(f" {unit}")
    return re.sub(r"e(-?\d+)$", lambda power: f" × 10^{power[1]}", bare)


def _unit(unit: str) -> str:
    return "" if unit == "1" else unit


_LATEX = {
    "\\": r"\textbackslash{}", "&": r"\&", "%": r"\%", "$": r"\$", "#": r"\#", "_": r"\_", "{": r"\{", "}": r"\}", "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}", "<": r"\textless{}", ">": r"\textgreater{}", "°": r"\textdegree{}", "±": r"$\pm$", "×": r"$\times$", "−": "$-$",
    "–": "--", "²": r"\textsuperscript{2}", "π": r"$\pi$", "“": "``", "”": "''",
}  # fmt: skip


def _escaped(text: str) -> str:
    """A text as LaTeX prints it; ``s^2`` and ``10^-7`` have their powers raised."""
    parts = re.split(r"\^(-?\d+)", text)
    made = ["".join(_LATEX.get(one, one) for one in part) for part in parts[::2]]
    for k, power in enumerate(parts[1::2]):
        made[k] += rf"\textsuperscript{{{power.replace('-', '$-$')}}}"
    return "".join(made)


def spreadsheet(answers: Mapping[str, Told], path: Path, spoken: Language) -> Path:
    """The path written: a workbook with a sheet of the quantities, a row each, and one of what is said; numbers are numbers, and units
    have a column of their own. What begins as a formula does is text."""
    rows, said = [], []
    for name, one in answers.items():
        for each in quantity_rows(one.row, one.verdict):
            rows.append(
                [name, spoken.text(each.words), each.value, each.uncertainty if math.isfinite(each.uncertainty) else None, _unit(each.unit), spoken.text(each.condition), each.name]
            )  # fmt: skip
        told = [one.sentence, *one.remarks, *([EMULATED] if one.row["emulated"] == "yes" else [])]
        said += [[name, spoken.text(line)] for line in told]
    heads = ["pendulum", "quantity", "value", "standard uncertainty", "unit", "amplitude", "name in files"]
    sheets = {
        spoken.text("quantities"): pd.DataFrame(rows, columns=list(map(spoken.text, heads))),
        spoken.text("answer"): pd.DataFrame(said, columns=list(map(spoken.text, ("pendulum", "answer")))),
    }
    with written_whole(path) as partial, pd.ExcelWriter(partial, engine="openpyxl") as book:
        for title, table in sheets.items():
            for_spreadsheets(table).to_excel(book, sheet_name=title, index=False)
            for column, cells in zip(book.sheets[title].columns, table, strict=True):
                longest = max([len(str(cells)), *table[cells].map(lambda cell: len(str(cell)))])
                book.sheets[title].column_dimensions[column[0].column_letter].width = min(longest + 2, 90)
    return path
