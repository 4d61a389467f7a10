"""The pages for users are short, and so are their sentences."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGES = [
    ROOT / "README.md",
    ROOT / "CONTRIBUTING.md",
    ROOT / "config/README.md",
    *sorted((ROOT / "docs").glob("*.md")),
]
MOST_WORDS = 40  # of a sentence
MOST_OF_A_PAGE = 1500


def words(text):
    """How many words a text has: what stands between blanks and holds a letter or a digit."""
    return sum(1 for part in text.split() if re.search(r"[^\W_]", part))


def sentences(page):
    """The sentences of a page in Markdown: those of its paragraphs, of each entry of a list and of each cell of a table."""
    prose = re.sub(r"^ *```.*?^ *```$|<!--.*?-->|^    \S[^\n]*$", "\n", page, flags=re.DOTALL | re.MULTILINE)
    prose = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", prose)  # of a link what is read
    prose = re.sub(r"`[^`]+`", "CODE", prose)
    for block in re.split(r"\n\s*\n|\n(?= *(?:[-*>] |\d+\. |\||#))", prose):
        for part in block.split("|") if block.lstrip().startswith("|") else [block]:
            yield from re.split(r"(?<=[.!?])[*)\"]*\s+(?=\W*[A-Z0-9])", " ".join(part.split()))


def test_sentences_are_what_ends_with_a_stop():
    page = "    a command\n\n# A head\n\nOne two. Three `four five` [six](seven.md)!\n\n- eight\n- nine. Ten\n\n| a b | c. D |\n|---|---|\n```\nnot this. Nor this\n```\n"
    assert [found for found in sentences(page) if words(found)] == [
        "# A head", "One two.", "Three CODE six!", "- eight", "- nine.", "Ten", "a b", "c.", "D",
    ]  # fmt: skip


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_no_sentence_is_longer_than_a_breath(page):
    long = [found for found in sentences(page.read_text(encoding="utf-8")) if words(found) > MOST_WORDS]
    assert not long, "\n".join(f"{words(found)} words: {found}" for found in long)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_a_page_is_read_in_a_few_minutes(page):
    """All words count, those of tables and commands too."""
    assert words(page.read_text(encoding="utf-8")) <= MOST_OF_A_PAGE


def test_all_pages_together_are_read_in_an_hour_and_a_half():
    """At two hundred words a minute; CONTRIBUTING and the key's reference are looked up, not read."""
    pages = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
    assert sum(len(page.read_text(encoding="utf-8").split()) for page in pages) <= 18_000
