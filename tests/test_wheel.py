"""The package by itself: built as a wheel, put into an environment of its own, used where no project is around it."""

import os
import shutil
import subprocess
import sys
import sysconfig
import zipfile
from importlib.metadata import distribution, requires
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

SOURCES = (
    *("pyproject.toml", "setup.py", "README.md", "LICENSE", "Snakefile"),
    *("config", "profiles", "resources/paper", "workflow"),
)
USE = """
from pathlib import Path

import numpy as np
import pandas as pd
import snakemake_logger_plugin_swingdown

import swingdown
from swingdown import paths, schema
from swingdown.discovery.criterion import GUARD
from swingdown.engine.trajectory import simulate
from swingdown.errors import InputError
from swingdown.fitting.least_squares import fit_trajectory
from swingdown.measurement.sheet import read_sheet
from swingdown.pendulum.model import Model
from swingdown.report import contents, page, provenance, trace
from swingdown.planning.settings import complete

print("package", Path(swingdown.__file__).parent)
assert paths.PROJECT == Path(swingdown.__file__).parent / "project"
assert all(path.read_text(encoding="utf-8") for path in (*trace.STYLE, *trace.PROGRAM))
assert paths.find("config/config.yaml") == paths.PROJECT / "config/config.yaml"

truth = {"natural_frequency": 7.25, "viscous_ratio": 0.03, "load_friction": 0.012}
times = np.arange(501) / 100
angle = simulate(Model(("viscous", "load_coulomb"), truth), times, 0.35)
fit = fit_trajectory("viscous+load_coulomb", times, angle, start="rest")
for name, value in truth.items():
    print("fitted", name, fit.model.values[name] / value)

settings = complete({})
try:
    complete({"sead": 1})
except InputError as error:
    print("refused", error.mend)
Path("swing.csv").write_text("t_s,theta_rad\\n")
Path("sheet.csv").write_text("recording,file\\nswing,swing.csv\\n")
assert list(read_sheet("sheet.csv").index) == ["swing"]
assert GUARD["nulls"] > 0

table = pd.DataFrame([{
    "simulated": "viscous", "fitted": "viscous", "mean": 0.131, "std": 0.0996, "n": 10, "mean_least_squares": 0.13,
    "std_least_squares": 0.01, "published_mean": 0.13, "published_std": 0.01,
}])
inputs = [str(Path("sheet.csv").absolute())]
material = contents.Material({"table2": table}, {}, [], settings, inputs=inputs)
page.write("report.html", contents.sections(material), contents.head(material))
assert "commit" not in dict(provenance.versions(1))
"""


@pytest.fixture(scope="module")
def wheel(root, tmp_path_factory):
    """The wheel, built from a copy, so that nothing appears in the project's folder."""
    folder = tmp_path_factory.mktemp("wheel")
    for name in SOURCES:
        if (root / name).is_dir():
            ignored = shutil.ignore_patterns("__pycache__", "*.egg-info")
            shutil.copytree(root / name, folder / "copy" / name, ignore=ignored)
        else:
            (folder / "copy").mkdir(exist_ok=True)
            shutil.copy(root / name, folder / "copy" / name)
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check"]
    building = [
        *pip,
        "wheel",
        "--no-deps",
        "--no-build-isolation",
        "--no-index",
        "-w",
        folder,
        folder / "copy",
    ]
    done = subprocess.run(list(map(str, building)), text=True, capture_output=True)
    assert done.returncode == 0, done.stdout + done.stderr
    (made,) = folder.glob("swingdown-*.whl")
    return made


@pytest.mark.slow("a wheel is built")
def test_the_wheel_holds_every_file_of_the_package(root, wheel):
    source = root / "workflow/src"
    packages = ("swingdown", "snakemake_logger_plugin_swingdown")
    files = [path for name in packages for path in (source / name).rglob("*") if path.is_file()]
    wanted = {path.relative_to(source).as_posix() for path in files if "__pycache__" not in path.parts}
    for folder in ("rules", "scripts", "report"):
        wanted |= {
            f"swingdown/project/workflow/{folder}/{one.name}"
            for one in (root / "workflow" / folder).glob("*.*")
        }
    assert {".c", ".h", ".yaml", ".html", ".typed"} <= {Path(name).suffix for name in wanted}
    assert wanted <= set(zipfile.ZipFile(wheel).namelist())


def installed(wheel, environment):
    """The Python of a new environment with the wheel in it, and where that is.

    Its dependencies are those of the present environment, so that no network is asked; the package is its own.
    """
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(environment)], check=True)
    python = environment / "bin/python"
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "--python", python]
    subprocess.run(list(map(str, [*pip, "install", "-q", "--no-deps", "--no-index", wheel])), check=True)
    (site,) = environment.glob("lib/python*/site-packages")
    # a path in such a file is added, and the files of this kind that lie there (the editable install's) are not read
    (site / "dependencies.pth").write_text(
        f"{sysconfig.get_paths()['purelib']}\n{sysconfig.get_paths()['platlib']}\n"
    )
    return str(python), site


def without_python(tmp_path):
    """The environment's variables less Python's own, with a cache of the test's own."""
    clean = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
    return clean | {"SWINGDOWN_CACHE": str(tmp_path / "cache")}


@pytest.mark.slow("a wheel is built")
def test_the_wheel_works_where_no_project_is_around_it(wheel, tmp_path):
    (python, site), clean = installed(wheel, tmp_path / "environment"), without_python(tmp_path)
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    done = subprocess.run([python, "-c", USE], cwd=elsewhere, env=clean, text=True, capture_output=True)
    assert done.returncode == 0, done.stdout + done.stderr
    said = [line.split(maxsplit=1) for line in done.stdout.splitlines()]
    assert ["package", str(site / "swingdown")] in said
    assert ["refused", "write 'seed', if that is what was meant"] in said
    ratios = [float(text.split()[1]) for word, text in said if word == "fitted"]
    assert ratios == pytest.approx([1.0] * 3, abs=1e-6)
    report = (elsewhere / "report.html").read_text(encoding="utf-8")
    assert "0.13 ± 0.10" in report and "sheet.csv" in report
    assert list((tmp_path / "cache").glob("engine-*.so"))


FIT = """
import warnings

import numpy as np

warnings.simplefilter("error")
from swingdown.engine.trajectory import simulate
from swingdown.fitting.least_squares import fit_jointly
from swingdown.pendulum.model import Model

times = np.arange(501) / 100
values = {"natural_frequency": 7.25, "viscous_ratio": 0.03, "load_friction": 0.012}
angle = simulate(Model("viscous+load_coulomb", values), times, 0.35)
print("angle", angle.tobytes().hex())
print("fitted", fit_jointly("viscous+load_coulomb", [(times, angle)] * 2).converged)
"""


@pytest.fixture(scope="module")
def carrying(root, tmp_path_factory):
    """The wheel that carries the engine, as it is published."""
    folder = tmp_path_factory.mktemp("carrying") / "dist"
    build = [str(root / "tools/build-wheel"), str(folder)]
    done = subprocess.run(build, env=os.environ | {"PYTHON": sys.executable}, text=True, capture_output=True)
    assert done.returncode == 0, done.stdout + done.stderr
    (made,) = folder.iterdir()
    return made


@pytest.fixture(scope="module")
def whole(carrying, tmp_path_factory):
    """The Python of an environment with that wheel and all that the present one has."""
    return installed(carrying, tmp_path_factory.mktemp("whole") / "environment")[0]


@pytest.mark.slow("a wheel is built")
def test_a_wheel_that_carries_the_engine_needs_no_compiler(carrying, whole, tmp_path):
    system = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    assert carrying.name.endswith(f"-py3-none-{system}.whl")
    clean = {key: value for key, value in without_python(tmp_path).items() if key != "CC"}
    clean["PATH"] = str(tmp_path)
    done = subprocess.run([whole, "-c", FIT], cwd=tmp_path, env=clean, text=True, capture_output=True)
    assert done.returncode == 0, done.stdout + done.stderr
    here = subprocess.run([sys.executable, "-c", FIT], text=True, capture_output=True)
    assert done.stdout == here.stdout and done.stdout.endswith("fitted True\n")
    assert not list((tmp_path / "cache").glob("engine-*"))


def brought(name="swingdown"):
    """The distributions that an installation without extras brings, by name."""
    found, waiting = {}, [Requirement(one) for one in requires(name) or []]
    while waiting:
        one = waiting.pop()
        key = canonicalize_name(one.name)
        if key not in found and (one.marker is None or one.marker.evaluate({"extra": ""})):
            found[key] = distribution(one.name)
            waiting += [Requirement(more) for more in found[key].requires or []]
    return found


def test_an_installation_brings_few_packages():
    assert len(brought()) <= 12, sorted(brought())


@pytest.fixture(scope="module")
def bare(carrying, tmp_path_factory):
    """The Python of an environment that holds that wheel and what it brings, and nothing else."""
    python, site = installed(carrying, tmp_path_factory.mktemp("bare") / "environment")
    (site / "dependencies.pth").unlink()
    for one in brought().values():
        for name in {path.parts[0] for path in one.files or () if not path.parts[0].startswith("..")}:
            if name != "__pycache__" and not (site / name).exists():
                (site / name).symlink_to(Path(one.locate_file(name)).resolve())
    return python


@pytest.mark.slow("a search, by two ways")
def test_a_file_goes_to_its_report_with_and_without_the_workflow(root, bare, whole, tmp_path):
    clean = without_python(tmp_path)
    verdicts = {}
    for way, python in (("bare", bare), ("workflow", whole)):
        folder = tmp_path / f"at-{way}"
        folder.mkdir()
        shutil.copy(root / "resources/example/anna.csv", folder)
        command = [python, "-m", "swingdown", "anna.csv"]
        done = subprocess.run(command, cwd=folder, env=clean, text=True, capture_output=True)
        assert done.returncode == 0, done.stdout + done.stderr
        results = folder / "anna-swingdown/results"
        verdicts[way] = (results / "discovery/anna/verdict.json").read_bytes()
        page = (results / "report.html").read_text(encoding="utf-8")
        assert "Air drag (viscous) and friction that winds up before it slips (presliding) stop it" in page
        assert "data-trace" in page and '<span class="source">' in page
        assert ("<img" in page) == (way == "workflow")
        assert ("pip install 'swingdown[workflow]'" in done.stdout) == (way == "bare")
        check = [python, "-m", "swingdown", "verify", results]
        assert subprocess.run(check, env=clean, capture_output=True).returncode == 0
    assert verdicts["bare"] == verdicts["workflow"]


WITHOUT = """
from pathlib import Path
import swingdown

made = swingdown.fit("anna.csv")
print(made.sentence)
assert "<table>" in made._repr_html_()
for act in (made.plot, lambda: swingdown.fit("a.xlsx"), lambda: swingdown.fit("anna.csv", effects={"own": {"torque": "-k*theta**3", "parameters": {"k": {}}}})):
    try:
        act()
        print("done all the same")
    except ImportError as problem:
        print(problem)
"""


@pytest.mark.slow("a wheel is built")
def test_without_an_extra_it_is_named(root, bare, tmp_path):
    python, clean = bare, without_python(tmp_path)
    shutil.copy(root / "resources/example/anna.csv", tmp_path)
    with zipfile.ZipFile(tmp_path / "a.xlsx", "w") as book:
        book.writestr("xl/workbook.xml", "<workbook/>")
    done = subprocess.run([python, "-c", WITHOUT], cwd=tmp_path, env=clean, text=True, capture_output=True)
    assert done.returncode == 0, done.stdout + done.stderr
    sentence, *told = done.stdout.splitlines()
    assert "T = 0.87" in sentence
    assert [line.endswith("Mend: pip install 'swingdown[workflow]'.") for line in told] == [True] * 3, told
    config = [python, "-m", "swingdown", "study.yaml"]
    (tmp_path / "study.yaml").write_text("recordings: null\n")
    done = subprocess.run(config, cwd=tmp_path, env=clean, text=True, capture_output=True)
    assert done.returncode == 1 and "mend:      pip install 'swingdown[workflow]'" in done.stderr
