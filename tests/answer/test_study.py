"""A study by its config: what Snakemake stumbles over before it reads the Snakefile is told in one message, with the mend."""

import pytest

from swingdown import __main__
from swingdown.answer import study as by_config
from swingdown.answer.study import study
from swingdown.errors import InputError

GOOD = "recordings: sheet.csv\nsimulation: {simulated: []}\n"


@pytest.fixture
def ran(monkeypatch):
    """What the workflow would be started with."""
    calls = []
    monkeypatch.setattr(by_config, "run_workflow", lambda *given: calls.append(given) or 0)
    return calls


@pytest.mark.parametrize(
    "text, where, words",
    [
        ("recordings: sheet.csv\nseed: [3\nrounds: 4\n", "line 3", "begins in line 2"),
        ("recordings: sheet.csv\n\tseed: 3\n", "line 2", "tab"),
        ("recordings: 'sheet.csv\nseed: 3\n", "line 3", "begins in line 1"),
        ("recordings: a: b\n", "line 1", "mapping values are not allowed"),
        ("recording,file\n1,plain.csv\n", "mine.yaml", "no settings"),
        ("", "mine.yaml", "no settings"),
    ],
)
def test_a_broken_config_is_told_with_its_line(tmp_path, ran, text, where, words):
    config = tmp_path / "mine.yaml"
    config.write_text(text)
    with pytest.raises(InputError) as told:
        study(str(config))
    assert where in str(told.value.where) and words in told.value.problem and told.value.mend
    assert not ran


def test_a_config_that_is_not_there_is_told_with_one_that_is(tmp_path, ran):
    (tmp_path / "mine.yaml").write_text(GOOD)
    with pytest.raises(InputError, match="no such config file.*mine.yaml"):
        study(str(tmp_path / "mien.yaml"))
    assert not ran


def test_latin_1_is_told(tmp_path, ran):
    (tmp_path / "mine.yaml").write_bytes("recordings: Jürgen.csv\n".encode("latin-1"))
    with pytest.raises(InputError, match="UTF-8"):
        study(str(tmp_path / "mine.yaml"))


@pytest.mark.parametrize(
    "folder, words", [("/proc", "cannot be written"), ("/no/such/folder", "no such folder")]
)
def test_a_folder_that_cannot_be_written_is_told(tmp_path, ran, folder, words):
    (tmp_path / "mine.yaml").write_text(GOOD)
    with pytest.raises(InputError, match=words):
        study(str(tmp_path / "mine.yaml"), directory=folder)
    assert not ran


def test_a_study_runs_where_its_config_lies_with_the_targets_asked_for(tmp_path, ran, monkeypatch):
    (tmp_path / "mine.yaml").write_text(GOOD)
    monkeypatch.chdir(tmp_path)
    assert __main__.main(["mine.yaml", "discover"]) == 0
    ((project, config, folder, cores, targets),) = ran
    assert (project / "Snakefile").is_file()
    assert (config.name, folder, cores, list(targets)) == ("mine.yaml", tmp_path, 2, ["discover"])


def test_numbers_that_end_in_yaml_are_a_recording(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "log.yaml").write_text("# a board's\n0.1 2\n0.2 3\n0.3 1\n")
    with pytest.raises(SystemExit):
        __main__.main(["log.yaml", "--quick"])
    assert "3 passages" in capsys.readouterr().err
