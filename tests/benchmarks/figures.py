"""The engine's own figures: Table 2's fits, a long record, Monte-Carlo batches, threads, first use, memory, the limit."""

import os
import resource
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
from swings import CASES, TIMES

from swingdown.engine import build, compiler, interface
from swingdown.engine.trajectory import effort, sensitivities, simulate
from swingdown.fitting.batch import fit_batch
from swingdown.fitting.least_squares import fit_trajectory
from swingdown.pendulum.catalogue import SHIPPED
from swingdown.pendulum.model import PAPER_MODELS, Model
from swingdown.studies.noise import RStream, add_noise

PAPER = {
    "natural_frequency": 7.25,
    "viscous_ratio": 0.03,
    "quadratic_coefficient": 0.05,
    "load_friction": 0.012,
}
TABLE_2 = {  # the twelve cells: simulated, fitted
    "viscous": ("viscous", "quadratic_drag", "load_coulomb", "quadratic_drag+load_coulomb"),
    "quadratic_drag": ("viscous", "quadratic_drag", "load_coulomb", "viscous+load_coulomb"),
    "load_coulomb": ("viscous", "quadratic_drag", "load_coulomb", "viscous+quadratic_drag"),
}


def values(label):
    """The paper's values of a model's parameters."""
    return {name: PAPER[name] for name in Model(label).parameters}


def clocked(work, repeats=5):
    """Median CPU time and wall time (s) of a call, and what it returned."""
    cpu, wall = [], []
    for _ in range(repeats):
        begun = time.process_time(), time.perf_counter()
        result = work()
        cpu.append(time.process_time() - begun[0])
        wall.append(time.perf_counter() - begun[1])
    return float(np.median(cpu)), float(np.median(wall)), result


def table_2():
    """CPU seconds of the 120 fits behind Table 2, from rest at the first noisy sample as in the paper, one core, warm."""
    times, draws = np.arange(501) / 100, RStream(150)
    swings = {}
    for label in TABLE_2:
        truth = simulate(Model(label, values(label)), times, np.radians(20))
        swings[label] = [
            add_noise("proportional", truth, 50, draws.standard_normal(times.size)) for _ in range(10)
        ]

    def all_fits():
        return [
            fit_trajectory(fitted, times, y, start="rest")
            for label in TABLE_2
            for fitted in TABLE_2[label]
            for y in swings[label]
        ]

    all_fits()
    cpu, _, fits = clocked(all_fits, 3)
    assert len(fits) == 120 and all(fit.converged for fit in fits)
    return cpu


def long_record():
    """CPU seconds to fit all seven models to a 120 s swing at 1 kHz of about 100 periods, and to compute them once."""
    times = np.arange(120_000) / 1000
    truth = values("viscous+quadratic_drag+load_coulomb") | {
        "natural_frequency": 5.3,
        "viscous_ratio": 1e-3,
        "quadratic_coefficient": 2e-3,
        "load_friction": 1e-3,
    }
    angle = simulate(Model("viscous+quadratic_drag+load_coulomb", truth), times, 0.7)
    angle = angle + 1e-3 * np.random.default_rng(1).standard_normal(times.size)
    once = [Model(label, {name: truth[name] for name in Model(label).parameters}) for label in PAPER_MODELS]
    trajectories = clocked(lambda: [simulate(model, times, 0.7) for model in once], 3)[0]
    cpu, _, fits = clocked(lambda: [fit_trajectory(label, times, angle) for label in PAPER_MODELS], 1)
    assert all(fit.converged for fit in fits)
    return cpu, trajectories


def batch(workers, count, seed=0):
    """Whether five-parameter fits of ``count`` fresh noisy swings all converge, shared out to so many threads."""
    case = CASES["five"]
    clean = case.clean()
    noise = np.random.default_rng([seed, count]).standard_normal((count, TIMES.size))
    series = clean + noise * (np.sqrt(np.mean(clean**2)) / 50)
    release = (case.release_angle, case.release_velocity)
    with ThreadPoolExecutor(workers) as pool:
        parts = np.array_split(series, 8 * workers)
        return all(pool.map(lambda part: fit_batch(case.model, TIMES, part, release).converged.all(), parts))


def monte_carlo(count=8000, chunk=2000):
    """Wall seconds for 1e5 five-parameter fits on two threads, projected from ``count``; and of one thread over two."""
    batch(2, 64)

    def run(workers):
        begun = time.perf_counter()
        for k in range(count // chunk):
            assert batch(workers, chunk, k)
        return time.perf_counter() - begun

    one, two, again_one, again_two = run(1), run(2), run(1), run(2)
    return min(two, again_two) * 1e5 / count, min(one, again_one) / min(two, again_two)


FIRST_USE = """
import time; begun = time.perf_counter()
from swingdown.pendulum.model import Model
from swingdown.engine.trajectory import simulate
simulate(Model("viscous", {"natural_frequency": 7.0, "viscous_ratio": 0.01}), [0.0, 1.0], 0.5)
print(time.perf_counter() - begun)
"""


def first_use():
    """Wall seconds to the first trajectory in a new process: on a new machine (compiling), and later."""
    with tempfile.TemporaryDirectory() as cache:
        variables = os.environ | {"SWINGDOWN_CACHE": cache}
        command = [sys.executable, "-c", FIRST_USE]
        told = [
            subprocess.run(command, env=variables, capture_output=True, text=True, check=True).stdout
            for _ in range(6)
        ]
    return float(told[0]), float(np.median([float(text) for text in told[1:]]))


# not ru_maxrss, in which a child starts with its parent's
MEMORY = """
from figures import batch
batch(1, 2000)
print(next(int(line.split()[1]) for line in open("/proc/self/status") if line.startswith("VmHWM")) / 1024)
"""


def memory():
    """Most memory (MB) of a worker process that fits a batch of 2000 series."""
    variables = os.environ | {"PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
    done = subprocess.run(
        [sys.executable, "-c", MEMORY], env=variables, capture_output=True, text=True, check=True
    )
    return float(done.stdout)


LIMIT = """
#include <stdio.h>
#include <time.h>
#include "engine.c"
/* CPU seconds for one whole right-hand side at all nodes of a panel: values, and values with all slopes. */
void cost(const Model *m, const double *p, double angle, double velocity, double *values, double *slopes) {
    System s;
    static Panel b;
    double out[BLOCKS * N], sum = 0.0;
    const MotionPoints nodes = nodes_of(&b);
    set_up_system(&s, m, p, m->n_parameters);
    s.direction = 1.0;
    for (int i = 0; i < N; i++) { b.th[i] = angle * cos(0.2 * i); b.v[i] = velocity * sin(0.2 * i); b.t[i] = 0.01 * i; }
    clock_t begun = clock();
    for (int k = 0; k < 200000; k++) { b.th[0] += 1e-12; right_hand_side(&s, &nodes, out, NULL); sum += out[k % N]; }
    *values = (double)(clock() - begun) / CLOCKS_PER_SEC / 200000;
    begun = clock();
    for (int k = 0; k < 50000; k++) { b.th[0] += 1e-12; partials_at_nodes(&s, &b); sum += b.by[k % N]; }
    *slopes = (double)(clock() - begun) / CLOCKS_PER_SEC / 50000;
    if (sum == 0.12345) puts("");
}
"""


def limit():
    """CPU seconds of one trajectory with slopes of the full paper model, and what its right-hand sides alone cost."""
    import ctypes

    from swingdown.engine.trajectory import Compiled

    case = CASES["seven"]
    files = build.sources() | {
        "catalogue.h": build.header(SHIPPED.known, tuple(SHIPPED.gravity.values())),
        "limit.c": LIMIT,
    }
    with tempfile.TemporaryDirectory() as work:
        work = Path(work)
        for name, text in files.items():
            (work / name).write_text(text)
        compiler.compile_library("limit.c", work / "limit.so", work)
        library = ctypes.CDLL(str(work / "limit.so"))
        compiled, p = Compiled(case.model, 10.0), np.array(case.model.vector())
        plain, slopes = ctypes.c_double(), ctypes.c_double()
        library.cost(
            ctypes.c_void_p(int(interface.ffi().cast("uintptr_t", compiled.c))),
            ctypes.c_void_p(p.ctypes.data),
            ctypes.c_double(0.5),
            ctypes.c_double(3.0),
            ctypes.byref(plain),
            ctypes.byref(slopes),
        )
    arguments = case.model, TIMES, case.release_angle, case.release_velocity
    took = effort(*arguments)
    cpu = clocked(lambda: [sensitivities(*arguments) for _ in range(50)], 5)[0] / 50
    bare = clocked(lambda: [simulate(*arguments) for _ in range(50)], 5)[0] / 50
    return (
        cpu,
        bare,
        took.evaluations * plain.value + took.panels * slopes.value,
        took.evaluations * plain.value,
    )


def figures():
    """Rows (figure, value, unit, at_least, goal, note), told as they are measured."""
    rows = []

    def row(figure, value, unit, at_least="", goal="", note=""):
        rows.append(
            {
                "figure": figure,
                "value": f"{value:.4g}",
                "unit": unit,
                "at_least": at_least,
                "goal": goal,
                "note": note,
            }
        )
        wanted = f"   wanted {at_least} (goal {goal})" if at_least else ""
        print(f"  {figure:60s} {value:10.4g} {unit:4s}{wanted}  {note}", flush=True)

    print("\nThe engine's own figures")
    row("120 fits of Table 2, warm, one core, CPU", table_2(), "s", "<= 0.3", "0.06")
    fits, trajectories = long_record()
    row("seven models fitted to 120 s at 1 kHz, CPU", fits, "s", "<= 2", "0.3")
    row("the seven trajectories of that record, CPU", trajectories, "s")
    projected, ratio = monte_carlo()
    row(
        "1e5 five-parameter fits, two threads, wall",
        projected,
        "s",
        "<= 90",
        "25",
        "projected from 8000, noise drawn in between",
    )
    row("two threads against one", ratio, "", ">= 1.6", "1.95")
    first, later = first_use()
    row("first use, compiling, wall", first, "s", "<= 15", "10")
    row("later starts, wall", later, "s", "<= 1", "0.5")
    row("memory of a worker on 2000 series", memory(), "MB", "<= 250", "")
    slopes, bare, slopes_limit, bare_limit = limit()
    row(
        "one trajectory, 10 s, full model, CPU",
        bare * 1e6,
        "us",
        note=f"right-hand sides alone {bare_limit * 1e6:.1f} us",
    )
    row(
        "the same with six slopes, CPU",
        slopes * 1e6,
        "us",
        note=f"right-hand sides and their slopes alone {slopes_limit * 1e6:.1f} us",
    )
    row("memory of this process", resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024, "MB")
    return rows
