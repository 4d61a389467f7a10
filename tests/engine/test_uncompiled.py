"""Where there is no C compiler: the same trajectories and fits of single swings, slowly, and the mend for all else."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest
from cases import draw

from swingdown.engine import uncompiled
from swingdown.engine.trajectory import TrajectoryError, sensitivities, simulate
from swingdown.fitting.least_squares import fit_trajectory
from swingdown.pendulum.catalogue import RATE, SHIPPED
from swingdown.pendulum.model import Model


def slowly(model, times, *release):
    """The readings and the report of the trajectory without the compiled engine."""
    return uncompiled.trajectory(model, float(times[-1] - times[0]), model.vector(), release, times)


@pytest.mark.parametrize("name", SHIPPED.names)
def test_every_effect_moves_the_pendulum_as_the_engine_says(name):
    case = draw(name, 0)
    assert slowly(*case.arguments)[0] == pytest.approx(simulate(*case.arguments), abs=1e-7)


@pytest.mark.parametrize("friction", [0.012, 0.2])
def test_it_sticks_where_the_engine_does(friction):
    model = Model(
        "viscous+load_coulomb", {"natural_frequency": 7.25, "viscous_ratio": 0.03, "load_friction": friction}
    )
    times = np.arange(1001) / 100
    found, report = slowly(model, times, 0.35, 0.0)
    assert found == pytest.approx(simulate(model, times, 0.35), abs=1e-8)
    assert 0 < report.stuck_after < 9 and np.ptp(found[-50:]) == 0.0


def test_it_tells_of_friction_that_drives():
    model = Model(
        "viscous+load_coulomb", {"natural_frequency": 7.25, "viscous_ratio": 0.01, "load_friction": 0.01}
    )
    times = np.arange(101) / 100
    assert slowly(model, times, 2.2, 0.0)[1].driven and not slowly(model, times, 1.2, 0.0)[1].driven


def test_a_support_that_shakes_frees_it():
    values = {"natural_frequency": 7.0, "constant_friction": 1.0, "vibration_acceleration": 2.0,
              "vibration_frequency": 0.7, "vibration_phase": 1.0}  # fmt: skip
    model, times = Model("constant_coulomb+base_vibration", values), np.arange(501) / 100
    assert slowly(model, times, 0.3, 0.0)[0] == pytest.approx(simulate(model, times, 0.3), abs=1e-7)


def test_rates_and_slopes():
    model = Model("viscous+sensor_gain", catalogue=SHIPPED.of(RATE))
    model = model.with_values({"natural_frequency": 7.0, "viscous_ratio": 0.02, "sensor_gain": 0.05})
    times = np.arange(201) / 100
    read, slopes = sensitivities(model, times, 0.4, 0.3)
    assert slowly(model, times, 0.4, 0.3)[0] == pytest.approx(read, abs=1e-8)
    found = uncompiled.slopes(model, 2.0, model.vector(), (0.4, 0.3), times, [0, 1, 2, -1, -2])
    assert found == pytest.approx(slopes, abs=1e-6)


def test_what_is_no_motion_of_a_pendulum_is_refused():
    model = Model("cubic_stiffness", {"natural_frequency": 5.0, "cubic_stiffness": -400.0})
    times = np.arange(501) / 100
    with pytest.raises(TrajectoryError):
        simulate(model, times, 1.5)
    with pytest.raises(uncompiled.Failure, match="RAN_AWAY|LOST_ACCURACY"):
        slowly(model, times, 1.5, 0.0)


USE = """
import json, sys, warnings

import numpy as np

from swingdown import explain
from swingdown.engine.trajectory import EngineWarning, simulate
from swingdown.errors import EngineError
from swingdown.fitting.batch import fit_batch
from swingdown.fitting.least_squares import fit_jointly, fit_trajectory
from swingdown.pendulum.model import Model

times, angle = np.array(json.load(sys.stdin))
with warnings.catch_warnings(record=True) as said:
    warnings.simplefilter("always")
    fit = fit_trajectory("viscous+load_coulomb", times, angle)
    again = simulate(fit.model, times, fit.only.release_angle, fit.only.release_velocity)
    held = fit_trajectory("viscous+quadratic_drag", times[:80], angle[:80], bounded=True, start="rest")
refused = []
swings = [(times, angle)] * 2
for more in (
    lambda: fit_jointly("viscous", swings),
    lambda: fit_batch(fit.model, times, angle[None], 0.3),
    lambda: explain(times, angle),
):
    try:
        more()
    except EngineError as error:
        refused.append(str(error))
print(json.dumps({
    "values": list(fit.values), "errors": list(fit.standard_errors), "converged": fit.converged, "refused": refused,
    "said": [str(one.message) for one in said if one.category is EngineWarning], "same": bool(np.array_equal(again, fit.angle)),
    "held": list(held.values),
}))
"""


def test_a_fit_without_any_compiler(tmp_path):
    """In a process of its own that finds no program and nothing compiled before."""
    truth = Model(
        "viscous+load_coulomb", {"natural_frequency": 7.25, "viscous_ratio": 0.02, "load_friction": 0.004}
    )
    times = np.arange(251) / 100
    angle = simulate(truth, times, 0.4) + 0.002 * np.random.default_rng(1).standard_normal(times.size)
    (tmp_path / "empty").mkdir()
    clean = {key: value for key, value in os.environ.items() if key != "CC"}
    clean |= {"PATH": str(tmp_path / "empty"), "SWINGDOWN_CACHE": str(tmp_path / "cache")}
    done = subprocess.run(
        [sys.executable, "-c", USE],
        input=json.dumps([list(times), list(angle)]),
        env=clean,
        text=True,
        capture_output=True,
    )
    assert done.returncode == 0, done.stderr
    slow, fit = json.loads(done.stdout), fit_trajectory(truth.label, times, angle)
    assert slow["values"] == pytest.approx(list(fit.values), rel=1e-6)
    assert slow["errors"] == pytest.approx(list(fit.standard_errors), rel=1e-4)
    assert slow["converged"] and slow["same"]
    held = fit_trajectory("viscous+quadratic_drag", times[:80], angle[:80], bounded=True, start="rest")
    assert slow["held"] == pytest.approx(list(held.values), rel=1e-4, abs=1e-8)
    (said,) = slow["said"]
    assert "take some thousand times as long" in said and "Mend: install gcc or clang" in said
    assert len(slow["refused"]) == 3
    assert all("no C compiler" in one and "Mend: install gcc or clang" in one for one in slow["refused"])


def test_a_studys_jobs_do_not_go_on_slowly(tmp_path):
    clean = {key: value for key, value in os.environ.items() if key != "CC"}
    clean |= {"PATH": "", "SWINGDOWN_CACHE": str(tmp_path), "SWINGDOWN_ENGINE": "compiled"}
    use = "from swingdown.engine.trajectory import simulate; from swingdown.pendulum.model import Model; "
    use += "simulate(Model('viscous', {'natural_frequency': 7.0, 'viscous_ratio': 0.01}), [0.0, 0.1], 0.3)"
    done = subprocess.run([sys.executable, "-c", use], env=clean, text=True, capture_output=True)
    assert (
        done.returncode == 1
        and "there is no C compiler" in done.stderr
        and "Mend: install gcc" in done.stderr
    )
