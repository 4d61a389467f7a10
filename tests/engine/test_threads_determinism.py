"""The same numbers, to the bit: for repeated runs, any number of threads, any order and any chunking."""

import os
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor

import cases
import numpy as np
from swings import CASES, TIMES

from swingdown.engine.trajectory import sensitivities
from swingdown.fitting.batch import fit_batch
from swingdown.fitting.least_squares import fit_jointly, fit_trajectory


def batch(workers=1, count=64, order=None):
    """Fits whose series are shared out to so many threads: values, sums of squares, evaluations, whether converged."""
    case = CASES["five"]
    clean = case.clean()
    series = np.stack(
        [clean + 0.005 * np.random.default_rng([1, k]).standard_normal(clean.size) for k in range(count)]
    )
    if order is not None:
        series = series[order]
    release = (case.release_angle, case.release_velocity)
    with ThreadPoolExecutor(workers) as pool:
        fits = pool.map(
            lambda part: fit_batch(case.model, TIMES, part, release), np.array_split(series, workers)
        )
        each = [(fit.values, fit.rss, fit.evaluations, fit.converged) for fit in fits]
    return [np.concatenate(parts) for parts in zip(*each, strict=True)]


def test_threads_do_not_change_a_bit():
    one = batch()
    for workers in (2, 3, 8, 100):
        assert all(map(np.array_equal, one, batch(workers)))


def test_neither_the_order_nor_the_company_matters():
    one, order = batch(), np.random.default_rng(0).permutation(64)
    assert np.array_equal(batch(2, order=order)[0], one[0][order])
    assert np.array_equal(batch(2, order=[5])[0], one[0][[5]])


def test_other_threads_go_on_while_one_fits():
    """Eight thousand fits take a quarter of a second and more; a window that is redrawn meanwhile must not wait for them."""
    case = CASES["five"]
    series = case.clean() + 0.005 * np.random.default_rng(1).standard_normal((8000, TIMES.size))
    with ThreadPoolExecutor(1) as pool:
        fits = pool.submit(fit_batch, case.model, TIMES, series, (case.release_angle, case.release_velocity))
        rounds = 0
        while not fits.done():
            time.sleep(0.001)
            rounds += 1
    assert rounds > 30


def test_trajectories_in_threads():
    """Every kind of effect at once from several threads: the engine keeps nothing between calls."""
    drawn = [cases.draw(label, 1) for label in [*cases.paper_models(), *cases.single_effects()]] * 3
    alone = [sensitivities(*case.arguments) for case in drawn]
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(lambda case: sensitivities(*case.arguments), drawn))
    for (angle, slopes), (angle_2, slopes_2) in zip(alone, together, strict=True):
        assert np.array_equal(angle, angle_2) and np.array_equal(slopes, slopes_2)


def test_fits_again():
    angle, _ = CASES["sticking"].noisy(3)
    label = CASES["sticking"].model.label
    first, second = (fit_trajectory(label, TIMES, angle) for _ in range(2))
    assert np.array_equal(first.values, second.values) and first.evaluations == second.evaluations
    swings = [(TIMES[:400], angle[:400]), (TIMES[:300], CASES["five"].noisy(4)[0][:300])]
    first, second = (fit_jointly("viscous", swings) for _ in range(2))
    assert np.array_equal(first.values, second.values)


PROGRAM = """
import sys
sys.path.insert(0, sys.argv[1])
from test_threads_determinism import batch, CASES
import hashlib
parts = *batch(int(sys.argv[2]))[:2], CASES["seven"].clean()
print(hashlib.sha256(b"".join(part.tobytes() for part in parts)).hexdigest())
"""


def test_another_process_gives_the_same_bits():
    """Also with other numbers of threads for BLAS and another hash seed."""
    here = os.path.dirname(__file__)
    found = set()
    for workers, threads in (("1", "1"), ("2", "4")):
        variables = os.environ | {
            "OPENBLAS_NUM_THREADS": threads,
            "OMP_NUM_THREADS": threads,
            "PYTHONHASHSEED": threads,
        }
        done = subprocess.run(
            [sys.executable, "-c", PROGRAM, here, workers],
            env=variables,
            capture_output=True,
            text=True,
            check=True,
        )
        found.add(done.stdout)
    assert len(found) == 1
