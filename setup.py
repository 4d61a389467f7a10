"""What pyproject.toml cannot say: the workflow lies in the package, so that an installed `swingdown FILE` runs it.

In a clone there is one copy of it, laid out as Snakemake's catalogue expects, and an editable install runs that. Where
SWINGDOWN_CARRY is set, the engine goes into the package as well, compiled (tools/build-wheel).
"""

import os
import shutil
import sys
from pathlib import Path

from setuptools import Distribution, setup
from setuptools.command.bdist_wheel import bdist_wheel
from setuptools.command.build_py import build_py

HERE = Path(__file__).resolve().parent
CARRY = bool(os.environ.get("SWINGDOWN_CARRY"))
# What a study of somebody's own files needs. The paper's recordings and published cases are those of a clone.
WORKFLOW = (
    "Snakefile",
    "config/config.yaml",
    "config/sweeps.yaml",
    "profiles/*/*.yaml",
    "resources/paper/*.csv",
    "workflow/report/*",
    "workflow/rules/*.smk",
    "workflow/scripts/*.py",
)


class WithWorkflow(build_py):
    """The package's files, and in its folder ``project`` the workflow's."""

    def run(self):
        super().run()
        if self.editable_mode:
            return
        package = Path(self.build_lib) / "swingdown"
        for pattern in WORKFLOW:
            for path in sorted(HERE.glob(pattern)):
                target = package / "project" / path.relative_to(HERE)
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(path, target)
        if CARRY:
            sys.path.insert(0, str(package.parent.resolve()))
            from swingdown.engine import build, prebuilt
            from swingdown.pendulum.catalogue import SHIPPED

            known = SHIPPED.whole
            build.carry(prebuilt.FOLDER, known.known, tuple(known.gravity.values()))


class Carrying(Distribution):
    """The distribution, which with an engine in it is one for a kind of machine."""

    def has_ext_modules(self):
        return CARRY


class ForAnyPython(bdist_wheel):
    """A wheel that goes by the machine alone: cffi loads the engine, whichever Python it is."""

    def get_tag(self):
        return ("py3", "none", super().get_tag()[2])


setup(distclass=Carrying, cmdclass={"bdist_wheel": ForAnyPython, "build_py": WithWorkflow})
