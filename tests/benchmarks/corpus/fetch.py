"""The recordings of files.csv in a folder: SPLIT/OWNER+NAME/PATH, each checked against its SHA-256.

    .venv/bin/python tests/benchmarks/corpus/fetch.py FOLDER [--split learn|apart|fresh] [--mirrors FOLDER]

Each file comes from its repository's public address at the commit that files.csv names; most of them state no licence,
so none is kept here. ``--mirrors`` takes them from git mirrors on this machine instead, OWNER+NAME/repo or OWNER+NAME.
"""

import argparse
import csv
import hashlib
import subprocess
import sys
import tempfile
from pathlib import Path

LIST = Path(__file__).with_name("files.csv")
SPLITS = ["learn", "apart", "fresh"]  # open while the reading was mended; apart at first; read once


def listed(split):
    """Return the rows of files.csv, as dicts: all of them, or those of one split."""
    with LIST.open(encoding="utf-8", newline="") as f:
        return [row for row in csv.DictReader(f) if split in (None, row["split"])]


def place(folder, row):
    """Return where a row's file lies below ``folder``."""
    return Path(folder) / row["split"] / row["repository"].replace("/", "+") / row["path"]


def mirror(folder, repository):
    """Return the git directory of a repository among the mirrors of ``folder``, or None where there is none."""
    name = repository.replace("/", "+")
    candidates = (f"{name}/repo/.git", f"{name}/repo", f"{name}/.git", name)
    return next((Path(folder) / c for c in candidates if (Path(folder) / c / "objects").is_dir()), None)


def public(repository, commit, folder):
    """Return a git directory below ``folder`` that holds one commit of a public repository."""
    git = Path(folder) / repository.replace("/", "+")
    if not git.exists():
        subprocess.run(["git", "init", "-q", "--bare", git], check=True)
        address = f"https://github.com/{repository}"
        subprocess.run(["git", "--git-dir", git, "fetch", "-q", "--depth", "1", address, commit], check=True)
    return git


def fetched(rows, folder, mirrors=None):
    """Return how many of these rows' files could not be had; the others lie in ``folder``, where ``place`` says."""
    failed = 0
    with tempfile.TemporaryDirectory() as clones:
        for row in rows:
            target = place(folder, row)
            try:
                git = mirror(mirrors, row["repository"]) if mirrors else None
                git = git or public(row["repository"], row["commit"], clones)
                blob = f"{row['commit']}:{row['path']}"
                data = subprocess.run(
                    ["git", "--git-dir", git, "cat-file", "blob", blob], check=True, capture_output=True
                )
            except subprocess.CalledProcessError as error:
                print(f"NOT FETCHED {row['repository']} {row['path']}: {error}", file=sys.stderr)
                failed += 1
                continue
            if hashlib.sha256(data.stdout).hexdigest() != row["sha256"]:
                print(
                    f"ANOTHER CONTENT {row['repository']} {row['path']}: its SHA-256 is not that of the list",
                    file=sys.stderr,
                )
                failed += 1
                continue
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(data.stdout)
    return failed


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    parser.add_argument("--split", choices=SPLITS)
    parser.add_argument("--mirrors")
    args = parser.parse_args(argv)
    rows = listed(args.split)
    failed = fetched(rows, args.folder, args.mirrors)
    print(f"{len(rows) - failed} of {len(rows)} files lie in {args.folder}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
