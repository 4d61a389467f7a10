"""A model of a gyroscope reads the angular velocity: against the second pendulum, its slopes, its fits, what it refuses."""

import numpy as np
import pytest

from swingdown.engine.trajectory import sensitivities, simulate
from swingdown.errors import InputError
from swingdown.fitting.batch import fit_batch
from swingdown.fitting.least_squares import fit_trajectory
from swingdown.pendulum.catalogue import SHIPPED
from swingdown.pendulum.model import Model
from swingdown.pendulum.model_file import read_model, write_model
from swingdown_trials.second_pendulum import trajectory

TIMES = np.arange(0, 20, 0.01)
VALUES = {"natural_frequency": 7.0, "viscous_ratio": 0.004, "load_friction": 0.003}
WRONG = {"sensor_gain": 0.02, "sensor_zero": 0.05, "clock_drift": 0.01}
DAMPED = ("viscous", "load_coulomb")


@pytest.mark.parametrize("release", [(0.5, 0.0), (2.4, -0.5), (0.02, 0.0)])
def test_the_reading_is_that_of_the_second_pendulum(release):
    names = (*DAMPED, *WRONG)
    model = Model(names, VALUES | WRONG, catalogue=SHIPPED.of("rate"))
    other = trajectory(names, VALUES | WRONG, TIMES, *release, reading="rate")
    np.testing.assert_allclose(simulate(model, TIMES, *release), other.reading, atol=2e-7)


def test_the_slopes_are_those_of_differences():
    model = Model((*DAMPED, *WRONG), VALUES | WRONG, catalogue=SHIPPED.of("rate"))
    release = {"release_angle": 0.5, "release_velocity": 0.3}
    free = [*model.parameters, *release]
    _, slopes = sensitivities(model, TIMES, 0.5, 0.3)
    for name, slope in zip(free, slopes, strict=True):
        step = 1e-5 * max(0.1, abs((model.values | release)[name]))
        above, below = (_moved(model, release, name, way * step) for way in (1, -1))
        np.testing.assert_allclose(slope, (above - below) / (2 * step), atol=5e-6 * np.abs(slope).max())


def _moved(model, release, name, step):
    values, at = ({k: v + step * (k == name) for k, v in one.items()} for one in (model.values, release))
    return simulate(model.with_values(values), TIMES, *at.values())


@pytest.mark.parametrize("release, zero", [((0.5, 0.0), 0.0), ((2.4, 0.0), 0.05), ((-0.8, 3.0), -0.1)])
def test_a_fit_finds_the_pendulum_from_its_rate(release, zero):
    names, values = (*DAMPED, "sensor_zero"), VALUES | {"sensor_zero": zero}
    exact = trajectory(names, values, TIMES, *release, reading="rate").reading
    noise = np.random.default_rng(1).normal(0, 0.02, TIMES.size)
    fit = fit_trajectory(Model(names, catalogue=SHIPPED.of("rate")), TIMES, exact + noise)
    truth = np.array([*(values[name] for name in fit.model.parameters), *release])
    assert fit.converged
    assert np.all(np.abs(fit.values - truth) < 4 * fit.standard_errors)


@pytest.mark.parametrize("names", [("viscous",), DAMPED])
def test_a_batch_of_rates_gives_what_single_fits_give(names):
    model = Model(names, {name: VALUES[name] for name in VALUES if name in Model(names).parameters}).of(
        "rate"
    )
    noise = np.random.default_rng(2).normal(0, 0.02, (3, TIMES.size))
    series = simulate(model, TIMES, 0.5) + noise
    found = fit_batch(model, TIMES, series, (0.5, 0.0))
    for one, values in zip(series, found.values, strict=True):
        fit = fit_trajectory(model, TIMES, one)
        np.testing.assert_allclose(values, fit.values, atol=1e-3 * np.max(fit.standard_errors))


def test_a_release_at_rest_is_not_told_by_a_rate():
    with pytest.raises(InputError, match="angular rate"):
        fit_trajectory(Model("viscous").of("rate"), TIMES, np.cos(7 * TIMES), start="rest")


def test_an_error_of_angle_sensors_is_refused_by_name():
    with pytest.raises(InputError, match="'backlash'.*it belongs to a sensor of angles"):
        Model(("viscous", "backlash")).of("rate")
    with pytest.raises(InputError, match="gyroscope"):
        trajectory(("eccentricity",), VALUES, TIMES, 0.5, reading="rate")


def test_a_model_file_keeps_what_is_read(tmp_path):
    model = Model((*DAMPED, "sensor_zero"), VALUES | {"sensor_zero": 0.1}, catalogue=SHIPPED.of("rate"))
    again = read_model(write_model(model, tmp_path / "model.yaml"))
    assert (again.reading, again.units["sensor_zero"], again.values) == ("rate", "rad/s", model.values)
    assert "reading" not in write_model(Model(DAMPED, VALUES), tmp_path / "angle.yaml").read_text()


def test_the_motion_behind_a_rate_is_an_angle():
    model = Model((*DAMPED, "sensor_gain"), VALUES | {"sensor_gain": 0.1}, catalogue=SHIPPED.of("rate"))
    assert (model.motion.names, model.motion.reading) == (DAMPED, "angle")
    assert simulate(model.motion, TIMES, 0.5)[0] == 0.5
