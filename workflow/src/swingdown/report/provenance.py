"""What a result rests on: versions, commit, checksums."""

import hashlib
import importlib.metadata
import platform
import subprocess
from collections.abc import Iterable
from pathlib import Path

from ..paths import PROJECT

_PACKAGES = ("swingdown", "numpy", "scipy", "pandas", "xarray", "netCDF4", "matplotlib", "sympy", "snakemake")


def versions(seed: int) -> list[tuple[str, str]]:
    """Pairs of name and version: seed, commit (where the project is a git clone), Python and the packages used."""
    pairs = [("seed", str(seed))]
    if commit := _commit():
        pairs.append(("commit", commit))
    pairs.append(("python", platform.python_version()))
    for name in _PACKAGES:
        try:
            pairs.append((name, importlib.metadata.version(name)))
        except importlib.metadata.PackageNotFoundError:
            continue
    return pairs


def checksums(paths: Iterable[str | Path]) -> list[tuple[str, str]]:
    """Pairs of name and SHA-256 of the files, named from the working directory or the project, and one elsewhere by its name alone.

    So the same study in another folder tells the same.
    """
    homes = [Path.cwd(), PROJECT]
    pairs = []
    for path in map(Path, paths):
        home = next((one for one in homes if path.absolute().is_relative_to(one)), path.absolute().parent)
        name = path.absolute().relative_to(home).as_posix()
        pairs.append((name, hashlib.sha256(path.read_bytes()).hexdigest()))
    return pairs


def _commit() -> str:
    def git(*words: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(["git", "-C", str(PROJECT), *words], capture_output=True, text=True, timeout=20)

    try:
        if git("rev-parse", "--show-toplevel").stdout.strip() != str(PROJECT):
            return ""
        changed = git("status", "--porcelain", "--untracked-files=no").stdout.strip()
        return git("rev-parse", "HEAD").stdout.strip() + (" with changes" if changed else "")
    except (OSError, subprocess.TimeoutExpired):
        return ""
