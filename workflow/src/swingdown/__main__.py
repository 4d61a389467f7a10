"""What is asked of the package at the command line: ``swingdown VERB …``, or ``python -m swingdown VERB …``."""

import sys
from collections.abc import Callable, Sequence

from . import console
from .manifest import verify


def verify_results(arguments: Sequence[str]) -> int:
    """verify RESULTS: hold a study's files against its manifest; 0 where all are as they were written, else 1."""
    if len(arguments) != 1:
        return _usage()
    with console.job():
        differences, count = verify(arguments[0])
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


VERBS: dict[str, Callable[[Sequence[str]], int]] = {"verify": verify_results}


def _usage() -> int:
    print("\n".join(f"swingdown {verb.__doc__}" for verb in VERBS.values()), file=sys.stderr)
    return 2


def main(arguments: Sequence[str] | None = None) -> int:
    """The exit code of the verb that the first argument names; 2, with the verbs told, where it names none."""
    given = list(sys.argv[1:] if arguments is None else arguments)
    return VERBS[given[0]](given[1:]) if given and given[0] in VERBS else _usage()


if __name__ == "__main__":
    sys.exit(main())
