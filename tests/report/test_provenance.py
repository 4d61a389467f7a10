"""What a result rests on is told by versions and checksums that are the same in another folder."""

import hashlib
import platform

import numpy as np

from swingdown.paths import PROJECT
from swingdown.report.provenance import checksums, versions


def test_versions_begin_with_the_seed_and_name_what_computes():
    told = dict(versions(150))
    assert list(told)[0] == "seed" and told["seed"] == "150"
    assert (
        told["python"] == platform.python_version() and told["numpy"] == np.__version__ and told["swingdown"]
    )
    if "commit" in told:
        commit, *changed = told["commit"].split(" ", 1)
        assert len(commit) == 40 and changed in ([], ["with changes"])


def test_files_are_named_from_the_working_directory_or_the_project(tmp_path, monkeypatch):
    here, elsewhere = tmp_path / "here", tmp_path / "elsewhere"
    for folder in (here / "data", elsewhere):
        folder.mkdir(parents=True)
        (folder / "a.csv").write_bytes(b"abc")
    monkeypatch.chdir(here)
    told = checksums(
        ["data/a.csv", here / "data" / "a.csv", elsewhere / "a.csv", PROJECT / "config" / "recordings.csv"]
    )
    assert [name for name, _ in told] == ["data/a.csv", "data/a.csv", "a.csv", "config/recordings.csv"]
    assert {digest for _, digest in told[:3]} == {hashlib.sha256(b"abc").hexdigest()}
