"""Where a file named in the config or a sheet is found: in the working directory, else in the project."""

from pathlib import Path

PROJECT = Path(__file__).resolve().parents[3]
_SCHEMES = ("http://", "https://", "file://")


def is_url(name):
    """True for an http, https or file address, False for a path."""
    return str(name).startswith(_SCHEMES)


def find(name):
    """The path of ``name``: in the working directory (or absolute) if it is there, else in the project's
    folder.

    A study run with ``--directory elsewhere`` finds its own files first and the shipped ones after. A name
    found in neither place comes back unchanged, so that the caller's message shows what was written.
    """
    path = Path(name)
    if not path.is_absolute() and not path.exists() and (PROJECT / path).exists():
        return PROJECT / path
    return path
