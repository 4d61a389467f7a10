"""What is raised when something cannot be done: told to people in four parts, and to programs by class and code.

A text names a setting by its cell in the sample sheet, in brackets: ⟨signal_unit⟩, ⟨in signal_unit⟩ or ⟨signal_unit=deg⟩. Whoever is told
reads it as they say it: as a cell, as an option of the command, or as an argument of a call.
"""

import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import _GeneratorContextManager, contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from typing import TypeVar

MAKE_ANEW = "delete it and give the same command again, which makes it anew"  # the mend of a damaged result


_T = TypeVar("_T")
_SETTING = re.compile(r"⟨(in )?(\w+)(?:=([^⟩]*))?⟩")


@dataclass(frozen=True)
class Audience:
    """How those who are told of a setting say it.

    ``names``: what they call a setting, by the name of its cell; any other is a cell to them, too. ``inside`` and ``pair`` are the patterns
    of ⟨in NAME⟩ and ⟨NAME=value⟩; values that are no numbers are put in quotes if ``quoted``.
    """

    names: Mapping[str, str] = field(default_factory=dict)
    inside: str = "with {}"
    pair: str = "{} {}"
    quoted: bool = False

    def said(self, text: str) -> str:
        """The text with each setting in brackets as they say it."""
        return _SETTING.sub(self._one, text)

    def _one(self, found: re.Match[str]) -> str:
        inside, name, value = found.groups()
        if name not in self.names and self is not SHEET:
            return SHEET._one(found)
        called = self.names.get(name, name)
        if value is not None:
            bare = not self.quoted or re.fullmatch(r"[-+.\deE]+", value)
            return self.pair.format(called, value if bare else repr(value))
        return self.inside.format(called) if inside else called


SHEET = Audience({"sheet": "`sheet`"}, inside="in the cell {} of the sheet", pair="{}: {}")
_TOLD: ContextVar[Audience] = ContextVar("told", default=SHEET)


def as_told(text: str) -> str:
    """The text as those say it who are told."""
    return _TOLD.get().said(text)


@contextmanager
def within(variable: ContextVar[_T], value: _T) -> Iterator[None]:
    """A block, or a function, in which a variable of the context has this value."""
    before = variable.set(value)
    try:
        yield
    finally:
        variable.reset(before)


def told_to(audience: Audience) -> "_GeneratorContextManager[None]":
    """A block, or a function, in which refusals and remarks are told to this audience."""
    return within(_TOLD, audience)


class Refusal(Exception):
    """Something that cannot be done: where, what is wrong, what was expected, the mend.

    Parameters
    ----------
    where
        The file, row, column or key.
    problem, expected, mend
        Plain sentences without a final full stop.
    code
        What a program goes by, "" where none needs to: no text is searched for what it means.

    Attributes
    ----------
    settings
        The settings that the mend names, by their cells in the sample sheet, with the value that it gives them ("" where it gives none).
    """

    heading = "This cannot be done."
    labels: Mapping[str, str] = {part: part for part in ("where", "problem", "expected", "mend")}

    def __init__(
        self, where: object, problem: str, expected: str = "", mend: str = "", code: str = ""
    ) -> None:
        self.settings = {name: value or "" for _, name, value in _SETTING.findall(mend)}
        problem, expected, mend = map(as_told, (problem, expected, mend))
        self.where, self.problem, self.expected, self.mend = str(where), problem, expected, mend
        self.code = code
        parts = [f"{where}: {problem}.", expected and f"Expected: {expected}.", mend and f"Mend: {mend}."]
        super().__init__(" ".join(filter(None, parts)))

    def told_by(self, say: Callable[[str], str]) -> "Refusal":
        """The same refusal with its words as ``say`` has them, for a person; what it is told by as an exception stays."""
        self.heading, self.labels = say(self.heading), {part: say(part) for part in self.labels}
        self.problem, self.expected, self.mend = map(say, (self.problem, self.expected, self.mend))
        return self


class InputError(Refusal, ValueError):
    """An input that cannot be used: where, what is wrong, what was expected, the mend.

    Attributes
    ----------
    where
        The file, row, column or key.
    problem, expected, mend
        Plain sentences without a final full stop; empty where there is nothing to say.
    code
        What a program goes by, "" where none needs to.
    """

    heading = "This input cannot be used."


class EngineError(Refusal, RuntimeError):
    """An engine that cannot be built or loaded; its parts are those of a ``Refusal``."""

    heading = "The engine cannot be built."


class Unwritten(OSError):
    """A result that cannot be written, for want of room or of leave; it has the errno, and tells in words where, and the mend."""


class PackageError(Refusal, ImportError):
    """A package that is needed and not installed; its parts are those of a ``Refusal``."""

    heading = "A package is not installed."
