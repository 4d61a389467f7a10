"""The package by itself: built as a wheel, put into an environment of its own, used where no project is around it."""

import os
import shutil
import subprocess
import sys
import sysconfig
import zipfile
from pathlib import Path

import pytest

from swingdown.engine import prebuilt

SOURCES = ("pyproject.toml", "README.md", "LICENSE", "workflow/src")
USE = """
from pathlib import Path

import numpy as np
import pandas as pd
import snakemake_logger_plugin_swingdown

import swingdown
from swingdown import paths, schema
from swingdown.discovery.verdict import GUARD
from swingdown.engine.trajectory import simulate
from swingdown.errors import InputError
from swingdown.fitting.least_squares import fit_trajectory
from swingdown.measurement.sheet import read_sheet
from swingdown.pendulum.model import Model
from swingdown.report import contents, page, provenance, trace
from swingdown.study.settings import complete

print("package", Path(swingdown.__file__).parent)
assert paths.PROJECT is None
assert all(path.read_text(encoding="utf-8") for path in (*trace.STYLE, *trace.PROGRAM))
assert paths.find("config/config.yaml") == Path("config/config.yaml")

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
page.write("report.html", contents.sections(material), **contents.head(material))
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
    assert {".c", ".h", ".yaml", ".j2", ".typed"} <= {Path(name).suffix for name in wanted}
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


@pytest.mark.slow("a wheel is built")
@pytest.mark.skipif(not prebuilt.levels(), reason="engines are carried for Linux on x86-64 alone")
def test_a_wheel_that_carries_the_engine_needs_no_compiler(root, tmp_path):
    build = [str(root / "tools/build-wheel"), str(tmp_path / "dist")]
    done = subprocess.run(build, env=os.environ | {"PYTHON": sys.executable}, text=True, capture_output=True)
    assert done.returncode == 0, done.stdout + done.stderr
    (wheel,) = (tmp_path / "dist").iterdir()
    assert wheel.name.endswith("-py3-none-linux_x86_64.whl")
    (python, _), clean = installed(wheel, tmp_path / "environment"), without_python(tmp_path)
    clean = {key: value for key, value in clean.items() if key != "CC"} | {"PATH": str(tmp_path)}
    done = subprocess.run([python, "-c", FIT], cwd=tmp_path, env=clean, text=True, capture_output=True)
    assert done.returncode == 0, done.stdout + done.stderr
    here = subprocess.run([sys.executable, "-c", FIT], text=True, capture_output=True)
    assert done.stdout == here.stdout and done.stdout.endswith("fitted True\n")
    assert not list((tmp_path / "cache").glob("engine-*"))
