"""What several tests share: where the recordings of real pendulums lie, a run of the workflow, and the slow switch."""

import ctypes
import fcntl
import os
import shutil
import signal
import socket
import subprocess
import sys
from itertools import count
from pathlib import Path

import pytest

from swingdown import prefork

ROOT = Path(__file__).resolve().parents[1]


def pytest_collection_modifyitems(config, items):
    """Slow tests are left out unless SWINGDOWN_SLOW is set or they are asked for by mark; each says what it is that takes long."""
    wanted = os.environ.get("SWINGDOWN_SLOW") or "slow" in (config.option.markexpr or "")
    for item in items:
        for mark in item.iter_markers("slow"):
            if not mark.args:
                raise pytest.UsageError(
                    f"{item.nodeid}: slow, but what is it? Mend: @pytest.mark.slow('a search')"
                )
            if not wanted:
                item.add_marker(pytest.mark.skip(reason=f"slow, {mark.args[0]}: make test-all runs it"))
    if wanted:  # what takes longest begins first, so that no core waits for it at the end
        long = {item.path for item in items if item.get_closest_marker("slow")}
        items.sort(key=lambda item: item.path not in long)


@pytest.fixture(scope="session")
def shared_data():
    """The folder of recordings and published cases that come beside the project, not with it."""
    folder = Path(os.environ.get("SWINGDOWN_SHARED", ROOT.parent / "shared" / "data"))
    if not folder.is_dir():
        pytest.skip(
            f"NOT TESTED: no folder {folder} with recordings and published cases (set SWINGDOWN_SHARED)"
        )
    return folder


@pytest.fixture(autouse=True)
def environment_as_it_was():
    """A study that is planned in this process sets variables (``SWINGDOWN_PREFORK``): no later test starts its processes with them."""
    before = dict(os.environ)
    yield
    for name in os.environ.keys() - before.keys():
        del os.environ[name]
    os.environ.update(before)


@pytest.fixture(scope="session")
def certified():
    """The folder of published cases with known answers."""
    return ROOT / "resources/certified"


@pytest.fixture(scope="session")
def root():
    """The project's folder."""
    return ROOT


CHROMIUM = os.environ.get("SWINGDOWN_CHROMIUM") or shutil.which("chromium") or "/usr/bin/chromium"
QUIET = ["--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"]  # fmt: skip


@pytest.fixture(scope="module")
def browser():
    """A real browser, that asks nobody anything by itself; closed after each module, for its event loop forbids others."""
    if not Path(CHROMIUM).exists():
        pytest.skip(
            f"NOT TESTED: no browser at {CHROMIUM} (tools/install-test-tools, or set SWINGDOWN_CHROMIUM)"
        )
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        flags = ["--headless", "--no-sandbox", "--disable-gpu", *QUIET]
        started = playwright.chromium.launch(executable_path=CHROMIUM, args=flags)
        yield started
        started.close()


def ends_with_its_parent():
    """What a process that tests start does first, where Linux can: it is told to stop when they are killed, and no orphan goes on."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGTERM)


_PR_SET_PDEATHSIG = 1  # of <sys/prctl.h>


RUN = """\
import atexit
import os
import sys

from snakemake.cli import main

os.environ.update({environment!r})
sys.argv[1:] = {arguments!r}
try:
    main()
finally:
    atexit._run_exitfuncs()
"""


@pytest.fixture(scope="session")
def forked(tmp_path_factory):
    """A function that runs snakemake in a fork of a process which has imported it, as it has what the jobs import (``swingdown.prefork``).

    To import all that takes as long as most of the runs, and a run of its own imports it twice. Returns what was printed and the code.
    """
    before = dict(os.environ)
    prefork.start()
    added = {name: value for name, value in os.environ.items() if before.get(name) != value}
    for name in added:
        del os.environ[name]
    os.environ.update(before)
    folder, numbers = tmp_path_factory.mktemp("forked"), count()

    def run(arguments):
        script = folder / f"run-{next(numbers)}.py"  # threads run some at once
        script.write_text(RUN.format(environment=added, arguments=arguments))
        printed = script.with_suffix(".txt")
        with socket.socket(socket.AF_UNIX) as connection:
            connection.connect(added[prefork.ADDRESS])
            with open(printed, "wb") as told, open(os.devnull) as nothing:
                streams = [nothing.fileno(), told.fileno(), told.fileno()]
                prefork.send(connection, str(script), str(ROOT), streams)
            connection.settimeout(900)
            code = connection.recv(1)
        return printed.read_text(), code[0] if code else -signal.SIGKILL

    return run


@pytest.fixture(scope="session")
def snakemake(forked):
    """A function that runs snakemake in the project's folder on other files; returns what it printed and its code.

    With an ``environment`` of its own it is a process of its own.
    """

    def run(*arguments, directory, cores=2, check=True, environment=None):
        arguments = [f"-c{cores}", "--nolock", "--directory", directory, *arguments]
        arguments = list(map(str, arguments))
        command = [sys.executable, "-m", "snakemake", *arguments]
        if environment is None:
            printed, code = forked(arguments)
            done = subprocess.CompletedProcess(command, code, printed)
        else:
            done = subprocess.run(
                command,
                cwd=ROOT,
                text=True,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                timeout=900,
                preexec_fn=ends_with_its_parent,
                env=os.environ | environment,
            )
        if check and done.returncode:
            pytest.fail(f"{' '.join(command)} ended with {done.returncode}:\n{done.stdout}")
        return done

    return run


SMALL = """\
recordings: small.csv
apparatus: config/apparatus.yaml
simulation: {realizations: 2}
calibration: {draws: 2000}
"""


@pytest.fixture(scope="session")
def small_study(snakemake, tmp_path_factory, worker_id):
    """The folder of a run of the whole study on two swings of the bench, with few draws and realisations.

    Made once, by whichever of the processes that share the tests asks first.
    """
    top = tmp_path_factory.getbasetemp()
    folder = (top if worker_id == "master" else top.parent) / "study"
    folder.mkdir(exist_ok=True)
    with (folder / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (folder / "made").exists():
            header, *rows = (ROOT / "config/recordings.csv").read_text().splitlines()
            kept = [row for row in rows if row.startswith(("swing_01", "swing_02")) or "static" in row]
            (folder / "small.csv").write_text("\n".join([header, *kept, ""]))
            (folder / "small.yaml").write_text(SMALL)
            snakemake("--configfile", folder / "small.yaml", directory=folder)
            (folder / "made").touch()
    return folder
