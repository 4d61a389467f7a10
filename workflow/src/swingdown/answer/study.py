"""A study by its config file: what Snakemake would stumble over before it reads the Snakefile is looked at first."""

import tempfile
from collections.abc import Sequence
from pathlib import Path

import yaml

from ..errors import InputError
from ..paths import PROJECT
from ..schema import near
from .command import run_workflow

CONFIGS = (".yaml", ".yml")


def study(config: str, targets: Sequence[str] = (), directory: str | None = None, cores: int = 2) -> int:
    """The exit code of the workflow with this config file, run in ``directory`` (by default the folder that the config lies in).

    InputError for a config that is not there or no YAML (with the line), for a folder that cannot be written, and where there is no
    project to run.
    """
    path = Path(config)
    check_config(path)
    folder = Path(directory) if directory else path.resolve().parent
    check_writable(folder)
    if PROJECT is None:
        raise InputError(config, "the project's folder, which has the rules, is not around the package", "a clone of the project", "run it there")  # fmt: skip
    return run_workflow(PROJECT, path, folder, cores, targets)


def check_config(path: Path) -> None:
    """None for a config file that holds settings; InputError with the line for one that cannot be read as YAML."""
    if not path.is_file():
        there = (
            [one.name for one in path.parent.glob("*") if one.suffix in CONFIGS]
            if path.parent.is_dir()
            else []
        )
        raise InputError(
            path, "there is no such config file", f"a YAML file, in {Path.cwd()} or given by its whole path",
            near(path.name, there) if there else "correct the path",
        )  # fmt: skip
    try:
        content = yaml.safe_load(path.read_text(encoding="utf-8"))
    except UnicodeDecodeError as problem:
        raise InputError(
            path, "it is not text in UTF-8", "a YAML file in UTF-8", "save it in UTF-8"
        ) from problem
    except yaml.YAMLError as problem:
        mark, context = getattr(problem, "problem_mark", None), getattr(problem, "context_mark", None)
        where = f"{path}, line {mark.line + 1}, column {mark.column + 1}" if mark else str(path)
        said = (
            str(getattr(problem, "problem", None) or problem).replace("\t", "a tab").replace("'\\t'", "a tab")
        )
        since = (
            f", in what begins in line {context.line + 1}"
            if mark and context and context.line != mark.line
            else ""
        )
        raise InputError(
            where, f"it cannot be read as YAML: {said}{since}", "keys with a colon, indented by spaces, brackets and quotes closed",
            "mend that line, or the one before it",
        ) from problem  # fmt: skip
    if not isinstance(content, dict):
        raise InputError(path, "it holds no settings", "keys such as `recordings: sheet.csv`", "name the config, not another file")  # fmt: skip


def check_writable(folder: Path) -> None:
    """None for a folder in which results can be written; InputError otherwise."""
    if not folder.is_dir():
        raise InputError(folder, "there is no such folder", "the folder that results are to be written in", "create it, or correct --directory")  # fmt: skip
    try:
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise InputError(
            folder, f"it cannot be written ({error.strerror})", "a folder of one's own",
            "name another with --directory, in which the paths of the config are to be found",
        ) from error  # fmt: skip
