"""What is asked of the package at the command line: ``swingdown FILE…``, ``swingdown verify RESULTS``."""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from . import console
from .manifest import verify


def verify_results(results: str) -> int:
    """0 where a study's files are as its manifest lists them, else 1, with what differs told."""
    with console.job():
        differences, count = verify(results)
    for kind, paths in differences.items():
        for path in paths:
            print(f"{kind}: {path}")
    if any(differences.values()):
        print(
            ", ".join(f"{len(paths)} {kind}" for kind, paths in differences.items() if paths)
            + f"; {count} files are listed"
        )
        return 1
    print(f"{count} files, all as they were written")
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        "swingdown",
        usage="swingdown FILE… [FOLDER…] [options]\n       swingdown CONFIG.yaml [TARGET…] [--directory FOLDER]\n"
        "       swingdown verify RESULTS",
        description="From recordings of a swinging pendulum to its period, its damping, and what a model of it still lacks. "
        "A config file is a study of one's own, which is run; `verify` holds a study's files against its manifest.",
    )
    add = parser.add_argument
    add(
        "given",
        nargs="+",
        metavar="FILE",
        help="recordings, or folders of them: each file is a pendulum of its own",
    )
    add("--together", action="store_true", help="all files are recordings of one pendulum")
    add(
        "--quick",
        action="store_true",
        help="stop after the first answer: no search for what is missing, no report",
    )
    add(
        "--into", metavar="FOLDER", help="the study's folder (default: beside the first file, named after it)"
    )
    add(
        "--unit",
        choices=["rad", "deg", "counts", "rad/s", "deg/s"],
        help="of the angle or the angular rate, where the file does not say it",
    )
    add("--counts-per-revolution", type=float, metavar="N", help="of an encoder in counts")
    add("--column", metavar="NAME", help="of the angle, where the file has several")
    add("--time-unit", choices=["s", "ms", "us"], help="of the time, where the file does not say it")
    add("--time-column", metavar="NAME", help="of the time")
    add(
        "--restoring",
        choices=["sine", "linear"],
        default="sine",
        help="what pulls it back: sine of the angle, as weight does (default), or linear, as a spring does: of a wheel, a torsion pendulum",
    )
    add(
        "--start",
        type=float,
        metavar="S",
        help="leave out what is before this time, in s (start_s of the sheet)",
    )
    add(
        "--stop",
        type=float,
        metavar="S",
        help="leave out what is after this time, in s (stop_s of the sheet)",
    )
    add(
        "--directory", metavar="FOLDER", help="where a config's study is run (default: where the config lies)"
    )
    add("--cores", type=int, default=2, metavar="N", help="processes at a time (default: 2)")
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """The exit code of what is asked: 0 where all went well, 1 where something could not be used or differs, 2 for a wrong call."""
    given = list(sys.argv[1:] if arguments is None else arguments)
    if given[:1] == ["verify"]:
        if len(given) != 2:
            print("swingdown verify RESULTS", file=sys.stderr)
            return 2
        return verify_results(given[1])
    if not given:
        _parser().print_usage(sys.stderr)
        return 2
    options = _parser().parse_args(given)
    if Path(options.given[0]).suffix.lower() in (".yaml", ".yml"):
        from .answer.study import study

        with console.job():
            return study(options.given[0], options.given[1:], options.directory, options.cores)
    from .answer.command import answer  # some seconds of imports, which `verify` need not wait for

    told = {
        "time_column": options.time_column,
        "time_unit": options.time_unit,
        "signal_column": options.column,
        "signal_unit": options.unit,
        "start_s": options.start,
        "stop_s": options.stop,
        "counts_per_revolution": options.counts_per_revolution,
    }
    with console.job():
        return answer(
            options.given,
            told,
            options.into,
            options.together,
            options.quick,
            options.cores,
            options.restoring,
        )


if __name__ == "__main__":
    sys.exit(main())
