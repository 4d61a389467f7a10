"""A Slurm cluster of several nodes on this one machine, without accounting, for as long as a test takes."""

import os
import shutil
import signal
import socket
import subprocess
import time
from contextlib import contextmanager, suppress
from pathlib import Path

CONF = Path("/etc/slurm/slurm.conf")  # SLURM_CONF does not reach a job's step
MARK = "# made by swingdown's tests/slurm"
ASIDE = Path("/usr/libexec/slurm-aside")  # where tools/install-test-tools puts sinfo
PROGRAMS = ("slurmctld", "slurmd", "munged", "sbatch", "squeue", "scancel", "scontrol")


def lacking():
    """Why there can be no cluster here, or nothing."""
    path = os.environ["PATH"] + ":/usr/sbin:/sbin"
    lost = [name for name in PROGRAMS if shutil.which(name, path=path) is None]
    if lost:
        return f"no {', '.join(lost)} (tools/install-test-tools installs them; that takes root and apt-get)"
    if os.geteuid() != 0:
        return "starting slurmctld takes root"
    if CONF.exists() and not CONF.read_text().startswith(MARK):
        return f"{CONF} belongs to a Slurm of this machine"
    return ""


class Cluster:
    """Its daemons by name, the nodes' names, and an environment in which Slurm's commands are found."""

    def __init__(self, folder, nodes):
        self.folder, self.nodes, self.daemons = Path(folder), [f"n{k + 1}" for k in range(nodes)], {}
        self.environment = os.environ | {"PATH": f"{os.environ['PATH']}:/usr/sbin:/sbin:{ASIDE}"}
        for name in ("SLURM_CONF", "SLURM_JOB_ID"):
            self.environment.pop(name, None)

    def run(self, *command):
        """What a command of Slurm prints."""
        done = subprocess.run(command, env=self.environment, text=True, capture_output=True, timeout=30)
        return done.stdout + done.stderr

    def start(self):
        """The cluster with all its nodes idle; RuntimeError with the logs where it does not come up."""
        munge = self.folder / "munge"
        munge.mkdir()
        key = munge / "key"
        key.write_bytes(os.urandom(128))
        key.chmod(0o400)
        for path in (munge, key):
            shutil.chown(path, "munge", "munge")
        self.socket = munge / "socket"
        self._spawn(
            "munged", "setpriv", "--reuid", "munge", "--regid", "munge", "--clear-groups", shutil.which("munged", path=self.environment["PATH"]),
            "--foreground", f"--key-file={key}", f"--socket={self.socket}", f"--pid-file={munge}/pid", f"--log-file={munge}/log",
            f"--seed-file={munge}/seed",
        )  # fmt: skip
        CONF.parent.mkdir(exist_ok=True)
        CONF.write_text(self._conf())
        self._wait(self.socket.exists, 10, "munged does not come up")
        self._spawn("slurmctld", "slurmctld", "-D")
        for node in self.nodes:
            (self.folder / f"spool.{node}").mkdir()
            self._spawn(node, "slurmd", "-D", "-N", node)
        self._wait(lambda: self.states().count("IDLE") == len(self.nodes), 30, "the nodes do not become idle")
        return self

    def states(self):
        """The state of each node, as Slurm writes it."""
        text = self.run("scontrol", "-o", "show", "nodes")
        return [word.partition("=")[2] for word in text.split() if word.startswith("State=")]

    def running(self, node):
        """The ids of the jobs that run on a node."""
        return self.run("squeue", "-h", "-t", "R", "-w", node, "-o", "%i").split()

    def hold_at_work(self, nodes):
        """Whether a job is at work on each of the nodes; then none of them goes on or ends until ``go_on``."""
        for node in nodes:
            self._signal_jobs(node, signal.SIGSTOP)
        time.sleep(1)  # what had ended before is told by now
        if all(self.running(node) and self._workers(node) for node in nodes):
            return True
        self.go_on(nodes)
        return False

    def go_on(self, nodes):
        """The jobs of these nodes work on."""
        for node in nodes:
            self._signal_jobs(node, signal.SIGCONT)

    def _workers(self, node):
        """The processes of a node's jobs without their step daemons, which have to answer Slurm: none where a job only tells its end."""
        return [pid for pid in self._of(node) if b"slurmstepd" not in self._command(pid)]

    def _signal_jobs(self, node, number):
        for pid in self._workers(node):
            with suppress(ProcessLookupError):
                os.kill(pid, number)

    def kill(self, node):
        """A node dies at once: its daemon, and all that ran on it."""
        self.daemons[node].kill()
        self.daemons[node].wait()
        self._kill_of(node)

    def _kill_of(self, node):
        """The step daemons first: one that outlives its job tells Slurm of a failure, and a dead node tells nothing."""
        found = self._of(node)
        for pid in sorted(found, key=lambda pid: b"slurmstepd" not in self._command(pid)):
            with suppress(ProcessLookupError):  # it ended with its parent
                os.kill(pid, signal.SIGKILL)

    def _of(self, node):
        """The processes of a node's jobs, with the step daemons that watch them."""
        found = set()
        for process in Path("/proc").glob("[0-9]*"):
            try:
                environ = (process / "environ").read_bytes()
                command = (process / "cmdline").read_bytes()
                parent = int((process / "stat").read_text().rpartition(")")[2].split()[1])
            except (OSError, ValueError):
                continue
            if f"SLURMD_NODENAME={node}\0".encode() in environ:
                found.add(int(process.name))
                if command and b"slurmstepd" in self._command(parent):
                    found.add(parent)
        return found - {os.getpid()}

    @staticmethod
    def _command(pid):
        try:
            return Path(f"/proc/{pid}/cmdline").read_bytes()
        except OSError:
            return b""

    def stop(self):
        """Every daemon and job ended, the configuration removed."""
        if "slurmctld" in self.daemons:
            self.run("scancel", "--user=root")
        for node in self.nodes:
            self._kill_of(node)
        for daemon in reversed(self.daemons.values()):
            daemon.terminate()
            try:
                daemon.wait(10)
            except subprocess.TimeoutExpired:
                daemon.kill()
        if CONF.exists() and CONF.read_text().startswith(MARK):
            CONF.unlink()

    def _spawn(self, name, *command):
        log = (self.folder / f"{name}.log").open("w")
        self.daemons[name] = subprocess.Popen(
            command, env=self.environment, stdout=log, stderr=subprocess.STDOUT, cwd=self.folder
        )

    def _wait(self, ready, seconds, problem):
        until = time.monotonic() + seconds
        while not ready():
            if time.monotonic() > until or any(daemon.poll() is not None for daemon in self.daemons.values()):
                logs = "\n".join(
                    f"--- {path.name}\n{path.read_text()[-1500:]}" for path in self.folder.glob("*.log")
                )
                raise RuntimeError(f"{problem}\n{self.run('scontrol', 'show', 'nodes')}\n{logs}")
            time.sleep(0.2)

    def _conf(self):
        host = socket.gethostname().partition(".")[0]
        ports = _free_ports(len(self.nodes) + 1)
        nodes = "\n".join(
            f"NodeName={node} NodeHostname={host} NodeAddr=127.0.0.1 Port={port} CPUs=1 RealMemory=2000"
            for node, port in zip(self.nodes, ports, strict=False)
        )
        return f"""{MARK}
ClusterName=swingdown
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[-1]}
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket={self.socket}
CredType=cred/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
AccountingStorageType=accounting_storage/none
SlurmdParameters=config_overrides
ReturnToService=2
SlurmdTimeout=10
MinJobAge=300
StateSaveLocation={self.folder}/state
SlurmctldPidFile={self.folder}/slurmctld.pid
SlurmdSpoolDir={self.folder}/spool.%n
SlurmdPidFile={self.folder}/%n.pid
{nodes}
PartitionName=main Nodes={",".join(self.nodes)} Default=YES MaxTime=INFINITE State=UP
"""


def _free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for one in sockets:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


@contextmanager
def cluster(folder, nodes=3):
    """A running ``Cluster`` whose daemons end with the block, whatever happens in it."""
    made = Cluster(folder, nodes)
    try:
        yield made.start()
    finally:
        made.stop()
