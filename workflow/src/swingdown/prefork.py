"""A process that imports once what jobs need, and forks for each of them.

numpy, pandas and xarray take longer to import than most jobs take to work. While a study runs on one machine, the workflow
keeps such a process (``start``). Python is shown a ``sitecustomize`` (folder ``early``) that hands each script of the workflow over before
its first line: a fork of the process, which has by then imported what the script imports, runs it with the script's own streams, folder
and environment, and the script ends as that does. A script that finds no such process (on a cluster's node, or by hand) does
its own imports and works as any other.
"""

import os
import sys
from functools import cache
from typing import Any, NoReturn

_EARLY = os.path.join(os.path.dirname(__file__), "early")
ADDRESS = "SWINGDOWN_PREFORK"  # the environment variable with the path of the process's socket
_PATH = "PYTHONPATH"
# Linear algebra decides when it is imported how many threads it takes, and several gain nothing on matrices as small as these; jobs that
# ask for more do their own imports.
THREADS = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")


def start() -> None:
    """The process is started, and ends with this one; from now on scripts that are run from here find it."""
    if os.path.exists(os.environ.get(ADDRESS, "")):
        return
    import atexit
    import shutil
    import socket
    import subprocess
    import tempfile

    folder = tempfile.mkdtemp(prefix="swingdown-")  # for this user alone
    path = os.path.join(folder, "prefork")
    with socket.socket(socket.AF_UNIX) as listening:
        listening.bind(path)
        listening.listen(64)
        command = [sys.executable, "-P", "-m", "swingdown.prefork", str(listening.fileno())]
        # it ends when its standard input does, however this process comes to end
        process = subprocess.Popen(
            command, stdin=subprocess.PIPE, pass_fds=[listening.fileno()], env=os.environ | THREADS
        )
    os.environ[ADDRESS] = path
    os.environ[_PATH] = os.pathsep.join([_EARLY, *filter(None, [os.environ.get(_PATH)])])

    def stop() -> None:
        os.environ.pop(ADDRESS, None)
        _forget_early()
        if process.stdin:
            process.stdin.close()
        process.wait()
        shutil.rmtree(folder, ignore_errors=True)

    atexit.register(stop)


def _forget_early() -> None:
    """The folder is taken out of the places where Python looks."""
    others = [folder for folder in os.environ.pop(_PATH, "").split(os.pathsep) if folder not in ("", _EARLY)]
    if others:
        os.environ[_PATH] = os.pathsep.join(others)


def hand_over() -> None:
    """Does not return if the job of this process, which is a script of the workflow, has been done elsewhere."""
    if ADDRESS not in os.environ or any(os.environ.get(k) != v for k, v in THREADS.items()):
        return
    import signal
    import socket

    signal.signal(signal.SIGINT, signal.SIG_DFL)  # it is the job that says something at Ctrl-C
    with socket.socket(socket.AF_UNIX) as connection:
        try:
            connection.connect(os.environ[ADDRESS])
        except OSError:
            return
        send(connection, sys.argv[0], os.getcwd(), [0, 1, 2])
        ended = connection.recv(1)  # were this process to be killed, its end of the line tells the other
    if not ended:
        print("The process that ran this job was killed.", file=sys.stderr, flush=True)
    os._exit(ended[0] if ended else 1)


def send(connection: Any, script: str, folder: str, streams: list[int]) -> None:
    """A job is asked for: the script in that folder with these three streams and the present environment. Its code comes back as one byte."""
    import json
    import socket

    text = json.dumps({"script": script, "folder": folder, "environment": dict(os.environ)}).encode()
    socket.send_fds(connection, [len(text).to_bytes(4, "big")], streams)
    connection.sendall(text)


def _serve(listening: Any) -> None:
    """Jobs are taken, each in a fork of this process, until its standard input ends; a fork tells its script itself how it ended."""
    import json
    import select
    import signal
    import socket

    signal.signal(signal.SIGCHLD, signal.SIG_IGN)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the jobs
    while 0 not in select.select([0, listening], [], [])[0]:
        connection, _ = listening.accept()
        head, streams, _, _ = socket.recv_fds(connection, 4, 3)
        if text := connection.makefile("rb").read(int.from_bytes(head, "big")):
            job = json.loads(text)
            _import_what_is_imported_by(job["script"])
            if not os.fork():
                listening.close()
                _work(job, streams, connection)
        for stream in streams:
            os.close(stream)
        connection.close()


def _import_what_is_imported_by(script: str) -> None:
    """The modules that the script imports at its top, for all the jobs to come. What fails here fails in the job and is told."""
    import ast
    import gc
    import importlib
    from contextlib import suppress
    from pathlib import Path

    names: list[str] = []
    for node in ast.parse(Path(script).read_text(encoding="utf-8")).body:
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            names += [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
    for name in [*names, "snakemake.io"]:  # the last for what Snakemake hands to a script
        with suppress(Exception):
            importlib.import_module(name)
    if "xarray" in sys.modules:
        with suppress(Exception):
            _use_xarray()
    gc.freeze()  # forks share the memory until they write to it, as a collection would


@cache
def _use_xarray() -> None:
    """A first dataset is written and read, for which xarray imports and looks up much: a tenth of a second, here once for all jobs."""
    import tempfile

    import xarray as xr

    with tempfile.TemporaryDirectory(prefix="swingdown-") as folder:
        path = os.path.join(folder, "first.nc")
        first = xr.Dataset({"first": ("time", [0.0, 1.0])}, coords={"time": [0.0, 1.0]})
        first.to_netcdf(path, engine="netcdf4")
        xr.load_dataset(path, engine="netcdf4").min()


def _work(job: dict[str, Any], streams: list[int], connection: Any) -> NoReturn:
    """The script run from its beginning; the process ends with it."""
    import runpy
    import signal
    import tempfile
    import threading
    import traceback
    from contextlib import suppress

    def end_with_the_script() -> None:
        connection.recv(1)  # nothing comes but the end: the script was killed, or its run was stopped
        os.kill(os.getpid(), signal.SIGTERM)

    code = 1
    try:
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        signal.signal(signal.SIGINT, signal.default_int_handler)
        threading.Thread(target=end_with_the_script, daemon=True).start()
        for stream, own in zip(streams, (0, 1, 2), strict=True):
            os.dup2(stream, own)
        os.chdir(job["folder"])
        os.environ.clear()
        os.environ.update(job["environment"])
        _forget_early()
        tempfile.tempdir = None
        sys.argv = [job["script"]]
        runpy.run_path(job["script"], run_name="__main__")
        code = 0
    except SystemExit as stopped:
        code = stopped.code if isinstance(stopped.code, int) else int(stopped.code is not None)
        if isinstance(stopped.code, str):
            print(stopped.code, file=sys.stderr)
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        with suppress(OSError):
            connection.send(bytes([code & 255]))
        os._exit(code & 255)


if __name__ == "__main__":
    import socket

    _serve(socket.socket(fileno=int(sys.argv[1])))
