"""A process that imports once what jobs need, and forks for each of them.

numpy, pandas and xarray take longer to import than most jobs take to work. While a study runs on one machine, the workflow
keeps such a process (``start``). A script that imports this module before all else hands itself over: a fork of the process,
which has by then imported what the script imports, runs it from its beginning with the script's own streams, folder and
environment, and the script ends as that does. A script that finds no such process (on a cluster's node, or by hand) does
its own imports and works as any other. So that not even the lines which Snakemake puts before a script are run twice, Python is
shown a ``sitecustomize`` (folder ``early``) that hands over before them.
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
    import json
    import signal
    import socket

    signal.signal(signal.SIGINT, signal.SIG_DFL)  # it is the job that says something at Ctrl-C
    with socket.socket(socket.AF_UNIX) as connection:
        try:
            connection.connect(os.environ[ADDRESS])
        except OSError:
            return
        job = {"script": sys.argv[0], "folder": os.getcwd(), "environment": dict(os.environ)}
        text = json.dumps(job).encode()
        socket.send_fds(connection, [len(text).to_bytes(4, "big")], [0, 1, 2])
        connection.sendall(text)
        ended = connection.recv(1)  # were this process to be killed, its end of the line tells the other
    if not ended:
        print("The process that ran this job was killed.", file=sys.stderr, flush=True)
    os._exit(ended[0] if ended else 1)


class _Server:
    """Jobs under way: the process of each, and the line to the script that waits for it."""

    def __init__(self, listening: Any) -> None:
        import selectors
        import signal

        self.listening, self.waiting = listening, {}  # type: ignore[var-annotated]
        self.selector = selectors.DefaultSelector()
        self.selector.register(listening, selectors.EVENT_READ, self.take)
        self.selector.register(0, selectors.EVENT_READ, self.close)
        self.ended, wake = os.pipe()
        for end in (self.ended, wake):
            os.set_blocking(end, False)
        self.selector.register(self.ended, selectors.EVENT_READ, self.collect)
        signal.set_wakeup_fd(wake, warn_on_full_buffer=False)
        signal.signal(signal.SIGCHLD, lambda *_: None)
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the jobs
        self.open = True

    def run(self) -> None:
        """Until there are neither more jobs to come nor any under way."""
        while self.open or self.waiting:
            for key, _ in self.selector.select():
                key.data(key.fileobj)

    def close(self, _: Any) -> None:
        self.open = False
        self.selector.unregister(0)
        self.selector.unregister(self.listening)
        self.listening.close()

    def take(self, _: Any) -> None:
        """A job, in a fork of this process."""
        import json
        import selectors
        import socket

        connection, _ = self.listening.accept()
        head, streams, _, _ = socket.recv_fds(connection, 4, 3)
        text = connection.makefile("rb").read(int.from_bytes(head, "big")) if head else b""
        if not text or len(streams) < 3:
            connection.close()
            return
        job = json.loads(text)
        _import_what_is_imported_by(job["script"])
        process = os.fork()
        if not process:
            connection.close()
            self.listening.close()
            _work(job, streams)
        for stream in streams:
            os.close(stream)
        self.waiting[process] = connection
        self.selector.register(connection, selectors.EVENT_READ, self.abandon)

    def abandon(self, connection: Any) -> None:
        """The script is gone (killed, or its run was stopped), so its job has to go too."""
        import signal

        self.selector.unregister(connection)
        for process, line in self.waiting.items():
            if line is connection:
                os.kill(process, signal.SIGTERM)

    def collect(self, _: Any) -> None:
        """The jobs that have ended: their scripts are told how."""
        from contextlib import suppress

        with suppress(BlockingIOError):
            os.read(self.ended, 4096)
        while self.waiting:
            process, status = os.waitpid(-1, os.WNOHANG)
            if not process:
                break
            connection = self.waiting.pop(process)
            with suppress(KeyError, ValueError):
                self.selector.unregister(connection)
            code = os.waitstatus_to_exitcode(status)
            with suppress(OSError):
                if code >= 0:
                    connection.send(bytes([code]))
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


def _work(job: dict[str, Any], streams: list[int]) -> NoReturn:
    """The script run from its beginning; the process ends with it."""
    import runpy
    import signal
    import tempfile
    import traceback

    code = 1
    try:
        signal.set_wakeup_fd(-1)
        for number in (signal.SIGCHLD, signal.SIGINT):
            signal.signal(number, signal.default_int_handler if number == signal.SIGINT else signal.SIG_DFL)
        for stream, own in zip(streams, (0, 1, 2), strict=True):
            os.dup2(stream, own)
        os.chdir(job["folder"])
        os.environ.clear()
        os.environ.update(job["environment"])
        del os.environ[ADDRESS]
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
        os._exit(code & 255)


if __name__ == "__main__":
    import socket

    _Server(socket.socket(fileno=int(sys.argv[1]))).run()
elif hasattr(sys.modules["__main__"], "snakemake"):  # Snakemake puts it before a script
    hand_over()
