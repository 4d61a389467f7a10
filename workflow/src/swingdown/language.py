"""What people read, in their language: a text is looked up by its English one, whose values are put into the other.

Files, JSON and what calls return are in English; they are translated where they are shown. A catalogue is ``languages/{code}.yaml``: by each
English text, with its values as ``{value}``, that of the language. A sentence is translated as a whole, or stays English as a whole.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache, cached_property
from pathlib import Path

from .errors import InputError
from .own_yaml import read_own

_FOLDER = Path(__file__).with_name("languages")
ENGLISH = "en"
VERBATIM = ("name", "names", "file", "formula")  # placeholders whose content stays as it is
_NAMES = "names"  # of which none ends a part of a sentence
_NUMBER = "value"  # how those begin that stand for a number with what belongs to it
_JOINTS = (", or ", ", and ", "; ", ", ", " and ", " or ", " + ")
# A number with its unit, and a unit alone.
_UNIT = r"(?:[kmµu]?(?:rad|s|g|m|Hz|V|A|deg)|1)(?:/(?:s|m|rad))?(?:\^2|²)?|[°%]|°/s|counts"
_VALUE = rf"[-−<>≈ ]*\(?\d[-−+\d.()?±×⁻⁰¹²³⁴⁵⁶⁷⁸⁹e ]*(?:\s?(?:{_UNIT}))?"
_SIZE = re.compile(f"{_VALUE}|{_UNIT}")
_FIELD = re.compile(r"\{(\w+)\}")
_DECIMAL = re.compile(r"(?<![\w.])(\d+)\.(\d+)(?=e[-+]\d+(?!\.?\w)|(?![\w.]*\.?\d|[A-Za-z_]))")
_SENTENCES = re.compile(r"(?<=[.!?”])(?=\s+[A-ZΑ-Ωα-ω“±])")  # each has the space before it
_SYMBOL = re.compile(r"[α-ωg](?!\w)")


@cache
def languages() -> tuple[str, ...]:
    """The codes of the languages that there are, English first."""
    return (ENGLISH, *sorted(path.stem for path in _FOLDER.glob("*.yaml")))


@cache
def language(code: str = ENGLISH) -> "Language":
    """The ``Language`` of a code such as ``de``; InputError for one that has no catalogue."""
    if code not in languages():
        raise InputError(f"language {code!r}", "there is no catalogue of it", ", ".join(languages()), "choose one of these")  # fmt: skip
    if code == ENGLISH:
        return IN_ENGLISH
    content = read_own(_FOLDER / f"{code}.yaml")
    return Language(code, content["decimal"], content["texts"])


@dataclass(frozen=True)
class Language:
    """A language: its code, its decimal sign, and its texts by the English ones."""

    code: str
    decimal: str = "."
    texts: dict[str, str] = field(default_factory=dict, repr=False)

    def text(self, english: str) -> str:
        """The text in this language with its decimal sign; what the catalogue has not stays English, sentence by sentence."""
        if self.code == ENGLISH or not english.strip():
            return english
        if (found := self._known(english)) is not None:
            return found
        each = [(one, self._known(one)) for one in _SENTENCES.split(english)]
        return "".join(one if found is None else found for one, found in each)

    def number(self, text: str) -> str:
        """The text with its numbers' decimal points as this language has them."""
        return _DECIMAL.sub(rf"\1{self.decimal}\2", text) if self.decimal != "." else text

    def _known(self, english: str) -> str | None:
        """The translation of a whole text; None where the catalogue has none."""
        bare = " ".join(english.split())
        if _SIZE.fullmatch(bare) or not any(one.isalpha() for one in bare):
            return self.number(english)
        before, after = english[: len(english) - len(english.lstrip())], english[len(english.rstrip()) :]
        for found in self._ways(bare):
            if found is not None:
                return before + found + after
        return None

    def _ways(self, bare: str) -> Iterator[str | None]:
        yield self.texts.get(bare)
        lower = _small(bare)
        if lower != bare:
            yield _capital(self.texts.get(lower))
        yield self._filled(bare)
        yield self._joined(bare)
        if lower != bare:
            yield _capital(self._filled(lower))
        if bare[-1] in ".:,":
            shorter = self._known(bare[:-1])
            yield None if shorter is None else shorter + bare[-1]

    @cached_property
    def _patterns(self) -> list[tuple[re.Pattern[str], str]]:
        """The texts with values, as patterns; what says most in its own words first."""
        own = {key: text for key, text in self.texts.items() if _FIELD.search(key)}
        return [(_pattern(key), own[key]) for key in sorted(own, key=lambda key: -len(_FIELD.sub("", key)))]

    def _filled(self, bare: str) -> str | None:
        for pattern, text in self._patterns:
            if match := pattern.fullmatch(bare):
                given = match.groupdict()
                begins = {name: found for name, found in given.items() if name[0].isupper()}
                given |= {name.lower(): _small(found) for name, found in begins.items()}  # said elsewhere
                values = {name: self._value(name, found) for name, found in given.items()}
                told = {name: value for name, value in values.items() if value is not None}
                if len(told) == len(values):
                    return text.format(**told)
        return None

    def _value(self, name: str, found: str) -> str | None:
        if name.split("_")[0] in VERBATIM:
            return found
        return self.number(found) if name.startswith(_NUMBER) else self._known(found)

    def _joined(self, bare: str) -> str | None:
        """A list of texts that are all known."""
        for joint in _JOINTS:
            if joint not in bare:
                continue
            parts = [self._known(part) for part in bare.split(joint)]
            if None not in parts:
                word = joint.strip(", ")
                said = joint.replace(word, self.texts.get(word, word)) if word else joint
                return said.join(map(str, parts))
        return None


IN_ENGLISH = Language(ENGLISH)


def _pattern(key: str) -> re.Pattern[str]:
    """What finds the values of a text."""
    made = []
    for k, part in enumerate(_FIELD.split(key)):
        held = _VALUE if part.startswith(_NUMBER) else "(?:(?!: ).)+?" if part == _NAMES else ".+?"
        made.append(f"(?P<{part}>{held})" if k % 2 else re.escape(part))
    return re.compile("".join(made))


def _small(text: str) -> str:
    return text[:1].lower() + text[1:]


def capital(text: str) -> str:
    """The text as a sentence begins; a symbol there, as γ or g, stays as it is."""
    return text if _SYMBOL.match(text) else text[:1].upper() + text[1:]


def _capital(text: str | None) -> str | None:
    return None if text is None else capital(text)


def listed(words: Sequence[str]) -> str:
    """The words one after the other: ``a``, ``a and b``, ``a, b and c``."""
    return " and ".join(filter(None, [", ".join(words[:-1]), *words[-1:]]))
