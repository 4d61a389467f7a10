"""Files that a program saved in a form of its own, by their endings: those that are read, and those that have to be exported."""

from collections.abc import Callable, Mapping
from pathlib import PurePath
from typing import BinaryIO

from ...errors import InputError
from .cassy import measurements, table
from .elements import Columns
from .matlab import arrays
from .saved_arrays import saved_arrays
from .tracker import tracks
from .vernier import data_sets

FILMS = (".mp4", ".mov", ".m4v", ".avi", ".mkv", ".webm", ".mpg", ".mts", ".3gp", ".wmv")


def _film(source: BinaryIO, name: str) -> dict[str, Columns]:
    from ..film.video import film  # what else is read needs nothing of it

    return film(source, name)


READERS: Mapping[str, Callable[[BinaryIO, str], dict[str, Columns]]] = {
    ".trk": tracks, ".trz": tracks, ".labx": measurements, ".lab": table, ".cmbl": data_sets, ".mat": arrays,
    ".npy": saved_arrays, ".npz": saved_arrays, ".json": saved_arrays,
    **dict.fromkeys(FILMS, _film),
}  # fmt: skip

# What is closed, whose it is, and the way to a CSV file in the words of its menu.
CLOSED: Mapping[str, tuple[str, str]] = {
    ".cap": ("PASCO Capstone", "File > Export Data…"),
    ".sparklab": ("PASCO SPARKvue", "Export Data in its menu"),
    ".spklab": ("PASCO SPARKvue", "Export Data in its menu"),
    ".ambl": ("Vernier Graphical Analysis", "File > Export > CSV"),
    ".gambl": ("Vernier Graphical Analysis", "File > Export > CSV"),
    ".qmbl": ("Vernier LabQuest", "File > Export in the LabQuest App"),
}


def saved_by_program(source: BinaryIO, name: str) -> dict[str, Columns]:
    """The Columns of each recording in a program's own file, by its name ("" for the only one); none for another kind of file.

    InputError for one that cannot be read, and for one that only its program reads.
    """
    ending = PurePath(name).suffix.lower()
    if ending in CLOSED:
        program, way = CLOSED[ending]
        problem = f"only {program} reads what it saves as {ending}"
        expected = "a table of numbers, such as a CSV file"
        raise InputError(name, problem, expected, f"export the table there: {way}")
    found = READERS[ending](source, name) if ending in READERS else {}
    return dict(zip([""], found.values(), strict=True)) if len(found) == 1 else found
