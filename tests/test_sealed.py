"""A result that was damaged or edited is refused where a later step reads it: never another number, never a traceback."""

import ast
import csv
import json
import os
import re
import shutil
import subprocess
import sys

import numpy as np
import pandas as pd
import pytest

from swingdown import dataset, sealed
from swingdown.errors import InputError
from swingdown.pendulum.model_file import read_model

TABLE = pd.DataFrame({"a": [1.5, -2.0], "b": ["x", "ü"]})


FORMULAS = ["=1+1", "@SUM(A1)", "+1+cmd|' /C calc'!A0", "-2+3", "-x", "\t=1", "=", "'=1", "'"]
PLAIN = ["-1.5", "+2e-3", "-0.36(12)", "-1.20(5)e-03", "a=b", "", "'quoted'"]


def test_a_name_is_no_formula_in_a_spreadsheet_and_the_same_when_read(tmp_path):
    table = pd.DataFrame({"label": FORMULAS + PLAIN, "x": -1.5, "=head": "-"})
    path = sealed.write_csv(table, tmp_path / "a.csv")
    with path.open(newline="") as file:
        header, *rows = csv.reader(file)
    assert header == ["label", "x", "'=head"]
    assert [row[0] for row in rows] == ["'" + one for one in FORMULAS[:-1]] + ["'"] + PLAIN
    assert {tuple(row[1:]) for row in rows} == {("-1.5", "'-")}
    pd.testing.assert_frame_equal(sealed.read_csv(path, keep_default_na=False, dtype={"label": str}), table)


def flipped(content, draws):
    at = int(draws.integers(len(content)))
    return content[:at] + bytes([content[at] ^ (1 << int(draws.integers(8)))]) + content[at + 1 :]


def cut(content, draws):
    return content[: int(draws.integers(len(content)))]


def test_what_was_written_is_read_and_is_plain(tmp_path):
    path = sealed.write_csv(TABLE, tmp_path / "a.csv")
    pd.testing.assert_frame_equal(pd.read_csv(path), TABLE)
    pd.testing.assert_frame_equal(sealed.read_csv(path), TABLE)
    path = sealed.write_json(tmp_path / "a.json", {"ü": [1, None]})
    assert json.loads(path.read_text(encoding="utf-8")) == sealed.read_json(path) == {"ü": [1, None]}
    done = subprocess.run(["sha256sum", "-c", ".a.csv.sha256", ".a.json.sha256"], cwd=tmp_path)
    assert done.returncode == 0
    assert sorted(one.name for one in tmp_path.iterdir()) == [
        ".a.csv.sha256",
        ".a.json.sha256",
        "a.csv",
        "a.json",
    ]


@pytest.mark.parametrize("change", [flipped, cut, lambda content, _: content + b"3,c\n"])
def test_damage_and_edits_are_refused_with_the_mend(tmp_path, change):
    path = sealed.write_csv(TABLE, tmp_path / "a.csv")
    whole, draws = path.read_bytes(), np.random.default_rng(1)
    for _ in range(20):
        path.write_bytes(change(whole, draws))
        with pytest.raises(InputError, match="damaged or edited.*Mend: delete it") as caught:
            sealed.read_csv(path)
        assert str(path) in str(caught.value)


def test_a_damaged_seal_is_refused_and_a_lost_one_is_not(tmp_path):
    path = sealed.write_csv(TABLE, tmp_path / "a.csv")
    seal = sealed.seal_of(path)
    seal.write_text("")
    with pytest.raises(InputError, match="damaged"):
        sealed.read_csv(path)
    seal.unlink()
    pd.testing.assert_frame_equal(sealed.read_csv(path), TABLE)


@pytest.mark.parametrize("content", [b"\xff\xfe\x00", b"{", b"[" * 100_000, b""])
def test_without_a_seal_what_is_no_json_is_refused(tmp_path, content):
    path = tmp_path / "a.json"
    path.write_bytes(content)
    with pytest.raises(InputError, match="cannot be read"):
        sealed.read_json(path)


@pytest.mark.parametrize("content", [b"\xff\xfe\x00", b'a,b\n1,2,3\n1,"', b""])
def test_without_a_seal_what_is_no_table_is_refused(tmp_path, content):
    path = tmp_path / "a.csv"
    path.write_bytes(content)
    with pytest.raises(InputError, match="cannot be read"):
        sealed.read_csv(path)
    with pytest.raises(InputError, match="no such file"):
        sealed.read_csv(tmp_path / "b.csv")


KILLED = """
import os, signal, sys
from swingdown import sealed
killed, count = int(sys.argv[2]), 0
def counted(function):
    def one(*given, **told):
        global count
        count += 1
        if count == killed:
            os.kill(os.getpid(), signal.SIGKILL)
        return function(*given, **told)
    return one
for name in ("replace", "fsync", "unlink"):
    setattr(os, name, counted(getattr(os, name)))
sealed.write_text(sys.argv[1], "new")
"""


def test_a_writer_killed_at_any_step_leaves_nothing_that_is_refused(tmp_path):
    path = tmp_path / "a.txt"
    seen = set()
    for step in range(1, 12):
        sealed.write_text(path, "old")
        subprocess.run([sys.executable, "-c", KILLED, path, str(step)])
        seen.add(sealed.read_text(path))
    assert seen == {"old", "new"}


def test_seals_of_what_is_gone_go_too(tmp_path):
    for name in ("a.csv", "b.csv"):
        sealed.write_csv(TABLE, tmp_path / "deep" / name)
    (tmp_path / "deep" / "a.csv").unlink()
    assert sealed.remove_orphans(tmp_path) == [tmp_path / "deep" / ".a.csv.sha256"]
    assert sealed.seal_of(tmp_path / "deep" / "b.csv").exists()


def test_what_is_carried_to_a_storage_has_no_seal(tmp_path):
    path = sealed.write_csv(TABLE, tmp_path / ".snakemake" / "storage" / "a.csv")
    assert not sealed.seal_of(path).exists()
    pd.testing.assert_frame_equal(sealed.read_csv(path), TABLE)


# What reads text that is no result: settings, sheets, recordings, code, published values, captions, its own lines with sums.
READS_OTHERS = {
    "engine", "measurement", "src/swingdown_trials/certified", "capture", "pendulum/catalogue", "discovery/judge/findings.py", "planning", "sweep/code.py", "sweep/chunks.py",
    "series/hand_table.py", "schema.py", "language.py", "sealed.py", "prefork.py", "manifest.py", "report/provenance.py", "report/page.py", "report/sweeps.py",
}  # fmt: skip
READERS = {"read_text", "read_bytes", "read_csv", "open_dataset", "load_dataset", "safe_load", "loads"}


def test_results_are_read_by_the_one_reader(root):
    """Nothing but the rooms that read other people's files opens a text file by itself."""
    found = []
    for path in sorted((root / "workflow").rglob("*.py")):
        name = path.relative_to(root / "workflow").as_posix().removeprefix("src/swingdown/")
        if any(name == one or name.startswith(f"{one}/") for one in READS_OTHERS):
            continue
        for node in ast.walk(ast.parse(path.read_text())):
            if not (isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute)):
                continue
            module = node.func.value
            if node.func.attr in READERS and not (isinstance(module, ast.Name) and module.id == "sealed"):
                found.append(f"{name}: {ast.unparse(node)}")
    allowed = [
        "answer/study.py: path.read_text(encoding='utf-8')",
        "answer/study.py: yaml.safe_load(path.read_text(encoding='utf-8'))",
        "dataset.py: xr.load_dataset(path, engine='netcdf4', decode_times=False, decode_timedelta=False)",
        "own_yaml.py: path.read_text(encoding='utf-8')",
        "pendulum/model.py: yaml.safe_load(read_text(path))",
        "scripts/report.py: Path(caption).read_text(encoding='utf-8')",
        "scripts/table2.py: pd.read_csv(files.published)",
        "scripts/table3.py: pd.read_csv(files.published)",
        "src/snakemake_logger_plugin_swingdown/__init__.py: Path(path).read_text(encoding='utf-8', errors='replace')",  # a log
        "sweep/combine.py: xr.open_dataset(path, engine='netcdf4', decode_times=False, decode_timedelta=False)",
        "sweep/compute.py: Path(partial).read_bytes()",
        "sweep/store.py: xr.open_dataset(path, engine='netcdf4', decode_times=False, decode_timedelta=False)",
        "sweep/noise_free.py: json.loads(settings)",  # a key of what is kept, and no file
    ]
    assert [one for one in found if one not in allowed] == []


READ = {
    ".csv": lambda path: sealed.read_csv(path).to_csv(),
    ".json": lambda path: json.dumps(sealed.read_json(path)),
    ".svg": sealed.read_text,
    ".yaml": lambda path: repr(read_model(path)),
    ".nc": lambda path: repr(dataset.read(path).to_dict()),
}


def test_a_byte_flipped_or_cut_in_any_result_is_refused_or_harmless(small_study, tmp_path):
    """In a whole study, every file that a step reads, at two places each."""
    draws = np.random.default_rng(20)
    shutil.copytree(small_study / "results", tmp_path / "results")
    harmless = refused = 0
    for path in sorted((tmp_path / "results").rglob("*")):
        kind = path.suffix if path.name != "manifest.json" and "logs" not in path.parts else ""
        if kind not in READ or path.name.startswith("."):
            continue
        if kind != ".nc":
            assert sealed.seal_of(path).is_file(), path
        whole, good = path.read_bytes(), READ[kind](path)
        for damage in (flipped, cut):
            path.write_bytes(damage(whole, draws))
            try:
                assert READ[kind](path) == good, path
                harmless += 1
            except InputError as error:
                assert error.mend and str(path) in str(error)
                refused += 1
        path.write_bytes(whole)
    assert refused > 100 and harmless < 0.02 * refused


@pytest.mark.slow("a whole study")
def test_a_run_on_damaged_results_is_refused_in_our_words(small_study, snakemake, tmp_path):
    """The damage is in what each of three jobs reads; the mend that is told mends it."""
    folder = tmp_path / "study"
    shutil.copytree(small_study, folder)
    damaged = {
        "results/tables/table2.csv": ("results/figures/fig03.svg", "fig03"),
        "results/angles/swing_01.nc": ("results/figures/fig09.svg", "fig09"),
        "results/discovery/bench/rounds.json": ("results/discovery/bench/verdict.json", "discover_verdict"),
    }  # fmt: skip
    for name in damaged:
        path = folder / name
        before = path.stat()
        path.write_bytes(flipped(path.read_bytes(), np.random.default_rng(3)))
        os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))
    arguments = ("--configfile", folder / "small.yaml", "--rerun-triggers", "mtime", "--keep-going")
    made = [made for made, _ in damaged.values()]
    rules = [rule for _, rule in damaged.values()]
    done = snakemake(*made, "--forcerun", *rules, *arguments, directory=folder, check=False)
    assert done.returncode
    assert "Traceback" not in done.stdout
    for name in damaged:
        assert len(re.findall(rf"where: +{re.escape(name)}", done.stdout)) == 1, done.stdout
        (folder / name).unlink()
    snakemake(*made, *arguments, directory=folder)
    for name in (*damaged, *made):
        assert (folder / name).read_bytes() == (small_study / name).read_bytes(), name


@pytest.mark.slow("runs of the workflow")
def test_snakemake_minds_no_seals(snakemake, tmp_path):
    """They are nobody's output: nothing is made again for them, and what deletes results can be followed by a run."""
    made = "results/figures/fig01.svg"
    snakemake(made, directory=tmp_path)
    seal = sealed.seal_of(tmp_path / made)
    assert seal.is_file()
    assert "Nothing to do" in snakemake(made, directory=tmp_path).stdout
    seal.unlink()
    assert "Nothing to do" in snakemake(made, directory=tmp_path).stdout
    sealed.write_text(tmp_path / "results/figures/lost.csv", "a")
    (tmp_path / "results/figures/lost.csv").unlink()
    snakemake(made, "--delete-all-output", directory=tmp_path)
    assert not (tmp_path / made).exists()
    snakemake(made, directory=tmp_path)
    assert seal.is_file() and not sealed.seal_of(tmp_path / "results/figures/lost.csv").exists()
