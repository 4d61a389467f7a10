"""Series of others: exponents of T over length, Q and γ over mass, γ over current, and g, of recordings in public repositories.

    .venv/bin/python tests/benchmarks/series_real.py FOLDER [NAME ...] [--mirrors FOLDER]

The recordings are fetched into FOLDER at the commit that is stated, as ``corpus/fetch.py`` does it; none is kept here. What was varied is what
their owners state: in names, in a script, or in a report. Each series is one call of the command with ``--quick``.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "corpus"))
from fetch import mirror, public

SERIES = {
    "BY-Chai": ("BY-Chai/PHY180-Projects", "a71b1d94b8ff634fd96307e8e4575215923ec03a", "length (cm)", "",
                {f"Pendulum Project/{k}cm.txt": k for k in range(10, 61, 10)}, ["--unit", "deg"]),
    "JWang1414 lengths": ("JWang1414/pendulum_project_final", "580db7c3e64515d39681eef279ea3a4271c3ed43", "length (cm)", "±0.5cm",
                {f"python/data/length{k}.csv": one for k, one in enumerate((52.1, 46.8, 38.0, 30.5, 21.2, 17.2), 1)}, ["--unit", "deg"]),
    "kyleyhw lengths": ("kyleyhw/PHY324_Pendulum_Project", "4a0cbf0c0b59618024475998c4c05cdb0e597006", "length (cm)", "",
                {f"pendulum_data/vary_l_{k}cm.txt": k for k in (15, 20, 25, 30, 35)}, []),
    "murdock-aubry": ("murdock-aubry/pendulum-analysis", "2395fda72eeb40fcaed88c6de7836628aeef0da3", "length (mm)", "±1mm",
                {f"Data 2/Varying L (m = 100g)/{k}mm.txt": k for k in (75, 100, 125, 150, 175, 190, 200)}, []),
    "zjs0221": ("zjs0221/PHY180-Pendulum-Project", "226ef8ebcd0e63231d15399891b51bc06b3bb73f", "length (m)", "±0.1mm",
                {f"report02/Amplitude vs Time {k:02}.txt": one for k, one in enumerate(
                    (0.0944, 0.1297, 0.1685, 0.2129, 0.2610, 0.3040, 0.3375, 0.3720, 0.4090, 0.4445, 0.5015), 1)}, ["--unit", "rad"]),
    "Hasi-7": ("Hasi-7/PythonGraph", "11353f7e62937297ff933dca56657d94edbf2029", "length (cm)", "±0.5mm",
                {f"QFactorGraph{k}({one}cm).txt": one for k, one in ((3, 71), (5, 67), (6, 64), (7, 59), (8, 55), (9, 48), (10, 43))}, ["--unit", "rad"]),
    "y-fysiks": ("y-fysiks/PHY180-Pendulum-datafit", "607a0fafc48f12cd7b45685ad47a92ae14e8dc61", "length (mm)", "±0.05mm",
                {f"Lab2/data2_{k}.csv": 527.01 - 40 * n for n, k in enumerate((10, 14, 15, 16, 17, 19, 20, 21, 25, 27, 29))}, ["--unit", "rad"]),
    "martin8ner": ("martin8ner/P1", "5b8f9cce73df58075f2114b178bea927040665fe", "current (mA)", "",
                {f"Resonanz/1.3_{k}mA.csv": k for k in (100, 200, 400, 700)}, ["--restoring", "linear", "--column", "Weg &b_A1 / rad"]),
    "JWang1414 masses": ("JWang1414/pendulum_project_final", "580db7c3e64515d39681eef279ea3a4271c3ed43", "mass (g)", "±0.2g",
                {f"python/data/{k}g.csv": k for k in (50, 100, 200, 300, 500)}, ["--unit", "deg"]),
    "kyleyhw masses": ("kyleyhw/PHY324_Pendulum_Project", "4a0cbf0c0b59618024475998c4c05cdb0e597006", "mass (g)", "",
                {f"pendulum_data/vary_m_{k}g.txt": k for k in (50, 100, 150, 200)}, []),
    "murdock-aubry masses": ("murdock-aubry/pendulum-analysis", "2395fda72eeb40fcaed88c6de7836628aeef0da3", "mass (g)", "",
                {f"Data 2/Varying m (L = 100mm)/{k}g.txt": k for k in (50, 100, 140, 150, 200, 250, 300, 400, 500)}, []),
}  # fmt: skip
"""By name: repository, commit, what was varied with its unit, its stated uncertainty, the value of each file, and what the files do not say."""


def fetched(repository, commit, paths, folder, mirrors):
    """The files of a series in a folder, each under its own name."""
    with tempfile.TemporaryDirectory() as clones:
        git = (mirror(mirrors, repository) if mirrors else None) or public(repository, commit, clones)
        for path in paths:
            blob = subprocess.run(["git", "--git-dir", git, "cat-file", "blob", f"{commit}:{path}"], check=True, capture_output=True)  # fmt: skip
            (folder / Path(path).name).write_bytes(blob.stdout)


def told(name, folder, mirrors):
    """Prints what the command makes of a series."""
    repository, commit, head, u, values, more = SERIES[name]
    place = Path(folder) / name
    place.mkdir(parents=True, exist_ok=True)
    fetched(repository, commit, values, place, mirrors)
    lines = [f"file,{head}", *(f'"{Path(path).name}",{value}' for path, value in values.items())]
    table = place.with_suffix(".values.csv")
    table.write_text("\n".join(lines) + "\n", encoding="utf-8")
    by = head.split(" ")[0] + u
    study = place.with_name(f"{name} study")
    command = [
        Path(sys.executable).with_name("swingdown"),
        place,
        "--quick",
        "--json",
        "--values",
        table,
        "--by",
        by,
        "--into",
        study,
        *more,
    ]
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True)  # fmt: skip
    if done.returncode:
        print(f"{name}: {done.stderr.strip().splitlines()[-1]}")
        return
    found = json.loads(done.stdout)
    doubted = sum("Beware" in line for line in done.stderr.splitlines())
    print(f"{name}: {len(found['pendulums'])} of {len(values)} recordings, {doubted} of them doubted")
    for one in found["left_out"]:
        print(f"    left out {one['recording']}: {one['problem'][:150]}")
    for one in found["series"]:
        print(f"    {one['sentence']}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    parser.add_argument("names", nargs="*")
    parser.add_argument("--mirrors")
    given = parser.parse_args()
    for name in given.names or SERIES:
        told(name, given.folder, given.mirrors)


if __name__ == "__main__":
    main()
