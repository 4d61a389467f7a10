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
    """Pairs of name and SHA-256 of the files; a file of the project is named from its folder."""
    pairs = []
    for path in map(Path, paths):
        name = path.relative_to(PROJECT) if PROJECT and path.is_relative_to(PROJECT) else path
        pairs.append((str(name), hashlib.sha256(path.read_bytes()).hexdigest()))
    return pairs


def _commit() -> str:
    if not PROJECT:
        return ""

    def git(*words: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(["git", "-C", str(PROJECT), *words], capture_output=True, text=True, timeout=20)

    try:
        if git("rev-parse", "--show-toplevel").stdout.strip() != str(PROJECT):
            return ""
        changed = (
            " with changes" if git("status", "--porcelain", "--untracked-files=no").stdout.strip() else ""
        )
        return git("rev-parse", "HEAD").stdout.strip() + changed
    except (OSError, subprocess.TimeoutExpired):
        return ""
