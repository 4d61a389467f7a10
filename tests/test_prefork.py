"""Jobs in forks of a process that has done their imports: they end, speak and fail as scripts of their own do."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from swingdown import prefork

HEAD = "import slow\n"  # what Snakemake puts before a script, and what that imports first
SCRIPT = Path(".snakemake/scripts/script.py")
STARTER = "from swingdown import prefork\nprefork.start()\nimport os\nprint(os.environ[prefork.ADDRESS], flush=True)\ninput()\n"


@pytest.fixture
def environment(tmp_path):
    """Linear algebra in one thread, as Snakemake has it, and a module whose imports are counted in a file."""
    (tmp_path / "slow.py").write_text("open('imported', 'a').write('once ')\n")
    return os.environ | prefork.THREADS | {"PYTHONPATH": str(tmp_path)}


@pytest.fixture
def starter(tmp_path, environment):
    """A process that has started the one that forks, and stands for a run of the workflow; its folder is that of the tests."""
    process = subprocess.Popen(
        [sys.executable, "-c", STARTER], stdin=subprocess.PIPE, stdout=subprocess.PIPE, cwd=tmp_path, text=True, env=environment,
    )  # fmt: skip
    process.address = process.stdout.readline().strip()
    yield process
    process.communicate("\n")


@pytest.fixture
def script(tmp_path, environment, starter):
    """A function that starts a script with these further lines and returns its process."""

    (tmp_path / SCRIPT).parent.mkdir(parents=True)
    given = environment | {
        prefork.ADDRESS: starter.address,
        "PYTHONPATH": os.pathsep.join([prefork._EARLY, str(tmp_path)]),
    }

    def run(text, **more):
        (tmp_path / SCRIPT).write_text(HEAD + text)
        return subprocess.Popen(
            [sys.executable, SCRIPT], cwd=tmp_path, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=given | more,
        )  # fmt: skip

    return run


def seen(condition, seconds=20):
    """Whether something comes to be."""
    end = time.monotonic() + seconds
    while not condition() and time.monotonic() < end:
        time.sleep(0.02)
    return condition()


def gone(process):
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return True
    return False


def test_what_scripts_import_is_imported_once(script, tmp_path):
    for number in range(3):
        told, _ = script(f"print({number}, __name__)").communicate()
        assert told == f"{number} __main__\n"
    assert (tmp_path / "imported").read_text() == "once "


def test_a_job_has_its_scripts_folder_environment_and_streams(script, tmp_path):
    job = script(
        "import os, sys\nprint(os.getcwd(), os.environ['MINE'])\nprint('said', file=sys.stderr)", MINE="yes"
    )
    assert job.communicate() == (f"{tmp_path} yes\n", "said\n")
    assert job.returncode == 0


@pytest.mark.parametrize(
    ("text", "code", "told"),
    [
        ("import sys\nsys.exit(3)", 3, ""),
        ("import sys\nsys.exit('no')", 1, "no\n"),
        ("1 / 0", 1, "ZeroDivisionError"),
        ("import no_such_module", 1, "ModuleNotFoundError"),
    ],
)
def test_a_job_fails_as_its_script_would(script, text, code, told):
    job = script(text)
    assert told in job.communicate()[1]
    assert job.returncode == code


def test_jobs_run_side_by_side(script, tmp_path):
    """Each waits for what only the other one does."""
    wait = "import os, time\nopen('{0}', 'w')\nwhile not os.path.exists('{1}'): time.sleep(0.01)\n"
    first = script(wait.format("a", "b"))
    assert seen((tmp_path / "a").exists)
    assert script(wait.format("b", "a")).wait(20) == first.wait(20) == 0


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
def test_a_script_that_is_stopped_takes_its_job_along(script, tmp_path, number):
    running = script("import os, time\nopen('job', 'w').write(str(os.getpid()) + ' ')\ntime.sleep(60)")
    assert seen(lambda: (tmp_path / "job").exists() and (tmp_path / "job").read_text().endswith(" "))
    job = int((tmp_path / "job").read_text())
    assert job != running.pid and not gone(job)
    running.send_signal(number)
    assert seen(lambda: gone(job))


def test_a_job_that_is_killed_is_told(script):
    job = script("import os, signal\nos.kill(os.getpid(), signal.SIGKILL)")
    assert "was killed" in job.communicate()[1]
    assert job.returncode == 1


def test_a_run_that_is_killed_leaves_no_process_behind(script, starter):
    told, _ = script("import os\nprint(os.getppid())").communicate()
    os.kill(starter.pid, signal.SIGKILL)
    assert seen(lambda: gone(int(told)))
    told, _ = script("print('done')").communicate()
    assert told == "done\n", "a script that finds nobody does its own imports"


@pytest.mark.parametrize("more", [{prefork.ADDRESS: "/nowhere"}, {"OPENBLAS_NUM_THREADS": "2"}])
def test_a_script_on_its_own_does_its_own_imports(script, tmp_path, more):
    for _ in range(2):
        assert script("print('done')", **more).communicate()[0] == "done\n"
    assert (tmp_path / "imported").read_text() == "once once "


def test_a_job_sees_the_environment_of_the_run_and_a_sitecustomize_of_the_users_own_is_read(script, tmp_path):
    asked = "import os\nprint(os.environ['PYTHONPATH'])\n"
    assert script(asked).communicate()[0] == f"{tmp_path}\n"
    (tmp_path / "sitecustomize.py").write_text("open('own', 'a').write('read ')\n")
    alone, complaint = script(asked, **{prefork.ADDRESS: "/nowhere"}).communicate()
    assert alone.endswith(f"{os.pathsep}{tmp_path}\n") and not complaint
    assert (tmp_path / "own").read_text().split() == ["read"]
