"""The work of a sweep dealt out in jobs, and the book that keeps how it was dealt.

A job (chunk) is a run of cells with a range of draws each. How work is dealt does not change a number in it, so what is
dealt stays dealt: the book (``plan.jsonl``, a line a chunk) is only added to. A wider table, or more draws, deals out
what no chunk of the book holds yet. A chunk's name stands for its content, and a file of that name for its results.
"""

import hashlib
import json
import os
from dataclasses import dataclass
from pathlib import Path

from ..errors import InputError
from ..paths import written_whole
from .draws import cell_key

MOST_JOBS = 2000  # beyond that the workflow's own time and the file system are what one waits for


@dataclass(frozen=True)
class Chunk:
    """One job of a sweep: what it ``computes``, the ``settings`` that its cells share, the axes' ``keys``, and its ``parts``, of which each is a
    cell's values, its first draw and the number of draws."""

    computes: str
    settings: dict
    keys: tuple
    parts: tuple

    @property
    def content(self):
        """The chunk as text (JSON)."""
        content = {name: getattr(self, name) for name in ("computes", "settings", "keys", "parts")}
        return json.dumps(content, separators=(",", ":"))

    @property
    def name(self):
        """16 hexadecimal digits that stand for the content."""
        return hashlib.sha256(self.content.encode()).hexdigest()[:16]

    @property
    def draws(self):
        """How many draws it holds over all its cells."""
        return sum(count for *_, count in self.parts)

    def cells(self):
        """(settings, key, first draw, number of draws) of each part."""
        for values, first, count in self.parts:
            settings = self.settings | dict(zip(self.keys, values, strict=True))
            yield settings, cell_key(self.computes, settings), first, count


@dataclass(frozen=True)
class Dealt:
    """What a sweep needs: its ``chunks`` by name, and their ``files``' names without the ending.

    ``new`` are those new in the book, ``missing`` those not computed, and ``outdated`` has the version of the code by the names of chunks
    whose results other code computed.
    """

    chunks: dict
    files: dict
    new: tuple
    missing: tuple
    outdated: dict


def made(folder):
    """The versions of the code whose results lie in a folder of chunks, oldest first, by the chunk's name.

    Results that an earlier release wrote without a version have "".
    """
    found = {}
    if Path(folder).is_dir():
        with os.scandir(folder) as files:
            for file in sorted(files, key=lambda file: file.stat().st_mtime_ns):
                stem, _, last = file.name.rpartition(".")
                if last == "nc" and not stem.startswith("."):
                    name, _, code = stem.partition("-")
                    found.setdefault(name, []).append(code)
    return found


def deal(sweep, book, code="", again=False):
    """The ``Dealt`` of a sweep: chunks of the book that hold what it wants, then new ones.

    Chunks with results, in the folder ``chunks`` beside the book, come first. One without results that holds more than is wanted
    is passed over. ``book`` is the path of the book, which need not exist, and ``code`` the version that computes what is missing; results
    of other code count as missing if it is to be ``again``. InputError for more than ``MOST_JOBS`` chunks.
    """
    there = made(Path(book).parent / "chunks")
    chunks, open_parts = _held(sweep, book, there)
    new = tuple(_dealt(sweep, open_parts))
    if len(chunks) + len(new) > MOST_JOBS:
        draws = sweep.cells * sweep.realizations
        raise InputError(
            f"config, key sweeps.{sweep.name}.chunk", f"{draws} draws in chunks of {sweep.chunk} are {len(chunks) + len(new)} jobs",
            f"at most {MOST_JOBS}", f"write `chunk: {-(-draws // (MOST_JOBS // 2))}`",
        )  # fmt: skip
    chunks |= {chunk.name: chunk for chunk in new}
    files, missing, outdated = {}, [], {}
    for name in chunks:
        versions = there.get(name, [])
        version = code if again or code in versions or not versions else versions[-1]
        files[name] = stem(name, version)
        if version not in versions:
            missing.append(name)
        elif version != code:
            outdated[name] = version
    return Dealt(chunks, files, new, tuple(missing), outdated)


def stem(name, code):
    """The name of a chunk's results, less the ending."""
    return f"{name}-{code}" if code else name


def _held(sweep, book, there):
    """The chunks of the book that a sweep needs, by name, and the parts that none of them holds.

    ``there`` has the names of those whose results are there.
    """
    if not Path(book).exists():
        return {}, [(list(values), 0, sweep.realizations) for values in sweep]
    wanted = {cell_key(sweep.computes, sweep.cell(values)): values for values in sweep}
    held, chunks = {}, {}
    for chunk in sorted(read_book(book), key=lambda chunk: chunk.name not in there):
        parts = [(key, first, first + count) for _, key, first, count in chunk.cells()]
        inside = [part for part in parts if part[0] in wanted and part[1] < sweep.realizations]
        whole = len(inside) == len(parts) and all(last <= sweep.realizations for *_, last in parts)
        twice = any(
            first < other and last > begin for key, first, last in parts for begin, other in held.get(key, ())
        )
        if not inside or twice or not (whole or chunk.name in there):
            continue
        for key, first, last in inside:
            held.setdefault(key, []).append((first, last))
        chunks[chunk.name] = chunk
    open_parts = [
        (list(values), first, last - first)
        for key, values in wanted.items()
        for first, last in uncovered(held.get(key, ()), sweep.realizations)
    ]
    return chunks, open_parts


def uncovered(ranges, end):
    """The (first, last) ranges below ``end`` that none of the given ones covers."""
    reached = 0
    for first, last in sorted(ranges):
        if first > reached:
            yield reached, min(first, end)
        reached = max(reached, last)
        if reached >= end:
            return
    if reached < end:
        yield reached, end


def _dealt(sweep, parts):
    """Chunks of about equal size, none longer than the sweep's."""
    total = sum(count for *_, count in parts)
    if not total:
        return
    size = -(-total // -(-total // sweep.chunk))
    taken, room = [], size
    for values, first, count in parts:
        while count:
            now = min(count, room)
            taken.append((values, first, now))
            first, count, room = first + now, count - now, room - now
            if not room:
                yield Chunk(sweep.computes, sweep.settings, sweep.keys, tuple(taken))
                taken, room = [], size
    if taken:
        yield Chunk(sweep.computes, sweep.settings, sweep.keys, tuple(taken))


def read_book(book):
    """The chunks of a book, one at a time; none where there is no book. InputError for a line that is none."""
    for line, where in _lines(book):
        yield _chunk(line, where)


def find_chunk(book, name):
    """The chunk of that name; InputError where the book has none. Other lines are not kept in memory."""
    for line, where in _lines(book):
        if line.startswith(name):
            return _chunk(line, where)
    mend = "run the sweep again: it writes the book before its jobs"
    raise InputError(book, f"no chunk {name}", "a book that lists it", mend)


def _lines(book):
    """The lines of a book and where each is, one at a time; none where there is no book."""
    if Path(book).exists():
        with Path(book).open(encoding="utf-8", errors="replace") as lines:
            yield from ((line, f"{book}, line {number}") for number, line in enumerate(lines, 1))


def add_to_book(book, chunks):
    """The path of the book with those of the chunks added that it lacks; it is replaced whole, so that a reader never sees half a line."""
    book = Path(book)
    known = {chunk.name for chunk in read_book(book)} if chunks else set()
    if chunks := [chunk for chunk in chunks if chunk.name not in known]:
        before = book.read_text(encoding="utf-8") if book.exists() else ""
        lines = "".join(f"{chunk.name} {chunk.content}\n" for chunk in chunks)
        with written_whole(book) as partial:
            partial.write_text(before + lines, encoding="utf-8")
    return book


def _chunk(line, where):
    try:
        name, _, content = line.partition(" ")
        content = json.loads(content)
        parts = tuple((values, first, count) for values, first, count in content["parts"])
        chunk = Chunk(content["computes"], content["settings"], tuple(content["keys"]), parts)
    except (ValueError, KeyError, TypeError):
        chunk = None
    if chunk is None or chunk.name != name:
        raise InputError(where, "not a line that a sweep has written", "a chunk a line",
                         "remove the line; its work will be dealt again")  # fmt: skip
    return chunk
