"""What is asked of the package at the command line: ``swingdown FILE…``, ``swingdown verify RESULTS``."""

import argparse
import difflib
import gc
import os
import re
import sys
from collections.abc import Callable, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any, NoReturn

from . import console
from .errors import InputError
from .language import ENGLISH, languages
from .manifest import verify
from .paths import printable
from .prefork import THREADS

COMMANDS = ("verify",)


def verify_results(results: str) -> int:
    """0 where a study's files are as its manifest lists them, else 1, with what differs told."""
    with console.job():
        differences, count = verify(results)
    for kind, paths in differences.items():
        for path in paths:
            print(printable(f"{kind}: {path}"))
    if any(differences.values()):
        each = ", ".join(f"{len(paths)} {kind}" for kind, paths in differences.items() if paths)
        print(f"{each}; {count} files are listed")
        if differences["missing"] or differences["changed"]:
            print("Mend: delete what was changed, and give the study's command again")
        return 1
    print(f"{count} files, all as they were written")
    return 0


STOPPED = 130  # the exit code of a process that Ctrl-C ended


class _Parser(argparse.ArgumentParser):
    """A parser that asks after what a mistyped option may have meant."""

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        found, more = super().parse_known_args(args, namespace)
        if more:
            known = list(self._option_string_actions)
            near = [difflib.get_close_matches(one.split("=")[0], known, 1) for one in more]
            names = ", ".join(name for each in near for name in each)
            meant = f"; did you mean {names}?" if names else ""
            self.error(f"unrecognized arguments: {' '.join(more)}{meant}")
        return found, more

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {message}\n(swingdown --help lists all options)\n")


def _among(choices: Sequence[str]) -> Callable[[str], str]:
    """What takes an option's value that is one of these, and refuses any other with the one that may be meant."""

    def chosen(text: str) -> str:
        if text in choices:
            return text
        near = difflib.get_close_matches(text, choices, 1, 0.4)
        meant = f"; did you mean {near[0]}?" if near else ""
        known = ", ".join(choices)
        raise argparse.ArgumentTypeError(f"invalid choice: {text!r} (choose from {known}){meant}")

    return chosen


class _Version(argparse.Action):
    """The version is asked for when it is wanted: the site is built where the package is not installed."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        print(f"swingdown {version('swingdown')}")
        parser.exit()


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        "swingdown",
        usage="swingdown FILE… [FOLDER…] [options]\n       swingdown CONFIG.yaml [TARGET…] [--directory FOLDER]\n"
        "       swingdown verify RESULTS",
        description="From recordings of a swinging pendulum to its period, its damping, and what a model of it still lacks. "
        "A config file is run as a study; `verify` compares a study's files with its manifest.",
    )
    # a length that is refused, as -20cm, is no option
    parser._negative_number_matcher = re.compile(r"-\.?\d")
    add = parser.add_argument

    def flag(name: str, told: str) -> None:
        add(name, action="store_true", help=told)

    def text(name: str, what: str, told: str) -> None:
        add(name, metavar=what, help=told)

    def number(name: str, what: str, told: str) -> None:
        add(name, type=float, metavar=what, help=told)

    def one_of(name: str, choices: Sequence[str], told: str, usual: str | None = None) -> None:
        add(name, type=_among(choices), choices=choices, default=usual, help=told)

    add("--version", action=_Version, nargs=0, help="show program's version number and exit")
    told = "language of the lines and of the report (default: en); JSON and CSV files stay English"
    one_of("--lang", languages(), told, ENGLISH)
    flag("--pdf", "the report as report.pdf, too; Chromium, Chrome or Edge prints it")
    flag("--latex", "the table as answer.tex, for booktabs")
    flag("--xlsx", "the table as answer.xlsx")
    flag("--json", "the answers as JSON on stdout, and all other lines on stderr")
    told = "recordings, or folders of them: each file is a pendulum of its own"
    add("given", nargs="*", metavar="FILE", help=told)
    flag("--together", "all files are recordings of one pendulum")
    flag("--quick", "stop after the first answer: no search for what is missing, no report")
    text("--into", "FOLDER", "the study's folder (default: beside the first file, named after it)")
    told = "unit of the angle, angular rate or position, if the file does not state it"
    one_of("--unit", ["rad", "deg", "counts", "rad/s", "deg/s", "m", "cm", "mm", "px"], told)
    number("--counts-per-revolution", "N", "counts of an encoder for a turn")
    told = "degrees for one unit of raw readings or volts; or two readings at known angles: 512=0,700=30"
    text("--scale", "DEG", told)
    told = "how far the zero of an angle may be off, in rad (default: 0.1, and the swings tell it)"
    number("--zero-tolerance", "RAD", told)
    told = (
        "distance from the pivot to the middle of the bob: 0.583±0.001 (m), 58.3(1)cm. It gives g, and the angle if one coordinate "
        "was recorded (350px)"
    )
    text("--length", "L", told)
    text("--bob-diameter", "D", "diameter of a ball, to correct g for its inertia: 30.0(1)mm")
    text("--bob-density", "RHO", "density of the bob, to correct g for the air: 7800 (kg/m^3), 7.8g/cm3")
    told = "g from two recordings of a rigid body about two pivots: the distance from each pivot to the centre of mass"
    add("--kater", nargs=2, metavar=("H1", "H2"), help=told)
    told = (
        "a series by length, mass, area, current, group or a column of your own, in the sheet, in a CSV file beside the recordings with a "
        "column `file`, or in their names (l=0.40, 500g); length±1mm gives each value that uncertainty"
    )
    text("--by", "COLUMN", told)
    text("--values", "FILE", "the CSV file of a series, with a column `file`, if it lies elsewhere")
    told = "resonance curves under torques of these amplitudes over the inertia, in rad/s^2, predicted from the ring-down"
    add("--drive", nargs="+", type=float, default=[], metavar="A", help=told)
    text("--column", "NAME", "column of the angle, if the file has several")
    text("--sheet", "NAME", "sheet of a workbook, or file in an archive, if there are several")
    told = "column of a drive that was measured; it acts in the model, and the swing need not be free"
    text("--input", "COLUMN", told)
    told = "what the input is: a torque, the pivot's horizontal acceleration or position, or the angle of the other end of a wheel's spring"
    one_of("--input-kind", ["torque", "pivot_acceleration", "pivot_position", "pivot_angle"], told)
    text("--input-unit", "UNIT", "unit of the input: any of a torque, m/s^2 or g, m or mm, rad or deg")
    text("--input-free", "WHAT", "what of the input's sensor is fitted: gain, delay, gain,delay, nothing")
    told = "what the input does between its samples (default: a smooth curve)"
    one_of("--input-between", ["curve", "line", "hold"], told)
    told = (
        "what the values are: samples of the motion, its turning points of one side (one a period), or of both (each half-swing); "
        "passages through a light gate (two a period), or periods (one a period); by default the values decide"
    )
    one_of("--kind", ["swing", "turning_points", "half_swings", "passages", "periods"], told)
    one_of("--time-unit", ["s", "ms", "us", "ns"], "unit of the time, if the file does not state it")
    text("--time-column", "NAME", "column of the time")
    number("--rate", "HZ", "samples a second of a file without times (one number a line)")
    told = "what pulls it back: the sine of the angle, as weight does (default), or linear, as the spring of a wheel or torsion pendulum does"
    one_of("--restoring", ["sine", "linear"], told, "sine")
    number("--start", "S", "leave out all before this time, in s (start_s of the sheet)")
    number("--stop", "S", "leave out all after this time, in s (stop_s of the sheet)")
    text("--directory", "FOLDER", "where a config's study is run (default: where the config lies)")
    add("--cores", type=int, default=2, metavar="N", help="processes at a time (default: 2)")
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """The exit code of what is asked: 0 where all went well, 1 where something could not be used or differs, 2 for a wrong call, 130 after Ctrl-C."""
    try:
        return _main(list(sys.argv[1:] if arguments is None else arguments))
    except KeyboardInterrupt:
        print("\nstopped; the same command goes on with what is finished", file=sys.stderr, flush=True)
        return STOPPED
    except BrokenPipeError:  # who reads it has seen enough, as `| head` has; nothing can be told any more
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0


def _main(given: Sequence[str]) -> int:
    if given[:1] == ["verify"]:
        if len(given) != 2:
            print("swingdown verify RESULTS", file=sys.stderr)
            return 2
        return verify_results(given[1])
    if not given:
        _parser().print_usage(sys.stderr)
        return 2
    options = (parser := _parser()).parse_args(given)
    if not options.given:
        parser.error("the following arguments are required: FILE")
    with console.job():
        meant = difflib.get_close_matches(options.given[0], COMMANDS, 1)
        if meant and not Path(options.given[0]).exists():  # no file, and nearly a command
            mend = f"did you mean swingdown {meant[0]}?"
            raise InputError(options.given[0], "there is no such file", "a file or a folder of files", mend)
    handed_in = tuple(kind for kind in ("pdf", "latex", "xlsx") if getattr(options, kind))
    if _is_config(Path(options.given[0])):
        from .answer.study import study

        with console.job():
            return study(options.given[0], options.given[1:], options.directory, options.cores, handed_in)
    os.environ |= THREADS | os.environ  # before linear algebra is imported
    from .answer.command import Wishes, answer  # some seconds of imports, which `verify` need not wait for
    from .answer.lengths import PIVOTS
    from .answer.options import CELLS
    from .studies.gravity import PIVOT

    told = {cell: getattr(options, name[2:].replace("-", "_")) for cell, name in CELLS.items()}
    told[PIVOTS] = told.pop(PIVOT)
    wished = {
        name: value for name, value in vars(options).items() if name in Wishes._fields and value is not None
    }
    wishes = Wishes(**wished, drives=tuple(options.drive), handed_in=handed_in)
    gc.freeze()  # what was imported stays to the end, and need not be looked through for what is left over
    with console.job():
        return answer(options.given, told, wishes)


def _is_config(path: Path) -> bool:
    """True for a study's settings: YAML, unless its first line is no key, as of a log that a program saved under that ending."""
    if path.suffix.lower() not in (".yaml", ".yml"):
        return False
    if not path.is_file():
        return True
    with path.open(encoding="utf-8", errors="replace") as file:
        first = next((line for line in file if line.strip() and not line.startswith(("#", "---"))), "")
    return not first or bool(re.match(r"""\s*[{"']{0,2}[A-Za-z_]\w*["']?\s*:""", first))


if __name__ == "__main__":
    sys.exit(main())
