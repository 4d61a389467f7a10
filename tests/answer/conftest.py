"""A folder to type the command in, and the command's first answer."""

import pandas as pd
import pytest

from swingdown.__main__ import main


@pytest.fixture
def here(tmp_path, monkeypatch):
    """An empty folder, and the process in it."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def first(tmp_path, monkeypatch):
    """A function that asks the command for its first answer on a file, and gives the row of the table."""
    monkeypatch.chdir(tmp_path)

    def ask(*arguments):
        assert main([*map(str, arguments), "--quick", "--into", "study"]) == 0
        return pd.read_csv("study/first_answer.csv").iloc[-1]

    return ask
