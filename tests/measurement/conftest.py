"""A file of somebody's, taken as a recording."""

import pytest

from swingdown.measurement.recording import ingest
from swingdown.measurement.sheet import read_sheet


@pytest.fixture
def take(tmp_path, monkeypatch):
    """A function that writes bytes as a file and ingests it by a sheet that says no more than its name."""
    monkeypatch.chdir(tmp_path)

    def take(content, file="swing.csv", encoding="utf-8", **cells):
        if content is not None:
            (tmp_path / file).write_bytes(content if isinstance(content, bytes) else content.encode(encoding))
        cells = {"recording": "a", "file": file, **cells}
        (tmp_path / "sheet.csv").write_text(
            ",".join(cells) + "\n" + ",".join(map(str, cells.values())) + "\n"
        )
        return ingest(read_sheet("sheet.csv").loc["a"], "sheet.csv")

    return take
