"""The error rates that docs/files.md tells hold on a few of the same swings."""

import re
import sys

import pytest


@pytest.mark.slow("many draws")
def test_the_questions_err_as_seldom_as_is_told(root, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(sys, "path", [*sys.path, str(root / "tests/benchmarks")])
    import questions

    questions.main(20)
    found = re.findall(r"\| (.*) \| (\d+) of 20 \|", capsys.readouterr().out)
    page = (root / "docs/files.md").read_text().partition("## How often the questions err")[2]
    told = re.findall(r"^\| (.*) \| (\d+) \|$", page.partition("\n## ")[0], re.MULTILINE)
    assert len(found) == len(told) == len(questions.SPOILT) + 1
    for (what, count), (words, of_300) in zip(found[:-1], told[:-1], strict=True):
        assert what.lower().startswith(words[:20].lower())
        assert int(count) >= 20 * int(of_300) / 300 - 5, what  # 20 draws scatter by less than that
    assert found[-1][1] == told[-1][1] == "0"
