"""The page of others' recordings is what its script writes: a table that is renewed loses no word of it."""

from importlib import import_module


def test_the_page_of_the_corpus_is_what_its_rows_and_its_head_make(root, monkeypatch):
    monkeypatch.syspath_prepend(root / "tests/benchmarks/corpus")
    fates = import_module("fates")
    assert (root / "docs/corpus.md").read_text(encoding="utf-8") == fates.page(list(fates.kept().values()))
