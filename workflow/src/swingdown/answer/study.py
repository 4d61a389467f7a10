"""A study by its config file: what Snakemake would stumble over before it reads the Snakefile is looked at first."""

import tempfile
from collections.abc import Sequence
from pathlib import Path

from ..errors import InputError
from ..extras import needed
from ..paths import PROJECT
from ..study.settings import check_config
from .command import run_workflow
from .hand_in import PDF, printed


def study(
    config: str,
    targets: Sequence[str] = (),
    directory: str | None = None,
    cores: int = 2,
    handed_in: Sequence[str] = (),
) -> int:
    """The exit code of the workflow with this config file, run in ``directory`` (by default the folder that the config lies in).

    Its report is printed, where ``pdf`` is to be ``handed_in``. InputError for a config that is not there or no YAML (with the line), for a folder that
    cannot be written, and PackageError where Snakemake is not installed.
    """
    path = Path(config)
    check_config(path)
    folder = Path(directory) if directory else path.resolve().parent
    check_writable(folder)
    if lost := [f"--{kind}" for kind in handed_in if kind != "pdf"]:
        raise InputError(lost[0], "the tables of a config's study are results/tables", "files of recordings", "leave it out")  # fmt: skip
    needed("snakemake")
    code = run_workflow(PROJECT, path, folder, cores, targets)
    if handed_in and not code:
        print(printed(folder / "results" / "report.html", folder / PDF), flush=True)
    return code


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
