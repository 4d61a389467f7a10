"""A study by its config file: what Snakemake would stumble over before it reads the Snakefile is looked at first."""

import tempfile
from collections.abc import Sequence
from pathlib import Path

from ..errors import InputError
from ..extras import needed
from ..language import language
from ..paths import PROJECT
from ..planning.settings import check_config, with_defaults
from ..schema import read_yaml
from .command import run_workflow
from .hand_in import check_able, hand_in, studied


def study(
    config: str,
    targets: Sequence[str] = (),
    directory: str | None = None,
    cores: int = 2,
    handed_in: Sequence[str] = (),
) -> int:
    """The exit code of the workflow with this config file, run in ``directory`` (by default the folder that the config lies in).

    What is to be ``handed_in`` (``hand_in.KINDS``) is written into that folder afterwards. InputError for a config that is not there or no YAML (with the line), for a folder that
    cannot be written, and PackageError where Snakemake is not installed.
    """
    path = Path(config)
    check_config(path)
    folder = Path(directory) if directory else path.resolve().parent
    check_writable(folder)
    check_able(handed_in)
    needed("snakemake")
    code = run_workflow(PROJECT, path, folder, cores, targets)
    if handed_in and not code:
        settings = with_defaults(read_yaml(path, path))
        found = studied(folder / "results", settings)
        for line in hand_in(handed_in, found, folder, language(settings["lang"])):
            print(line, flush=True)
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
            folder, f"it cannot be written ({error.strerror})", "a folder of your own",
            "name another with --directory; relative paths in the config start from it",
        ) from error  # fmt: skip
