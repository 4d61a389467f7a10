"""From a recording to angles: the right number, and uncertainties whose parts say what they are."""

import copy
import importlib.util
from functools import cache

import numpy as np
import pytest
import xarray as xr
import yaml
from scipy.signal import lfilter

from swingdown import dataset
from swingdown.calibration import MODES, calibrate
from swingdown.errors import InputError
from swingdown.measurement.angle import to_angle
from swingdown.measurement.apparatus import read_apparatus
from swingdown.measurement.recording import ingest
from swingdown.measurement.sheet import read_sheet
from swingdown.measurement.slack import of_angles, zero_unstated
from swingdown.measurement.swings.noise_level import noise_level, noise_of


@cache
def shipped(kind="systematic"):
    sheet = read_sheet("config/recordings.csv")
    apparatus = copy.deepcopy(read_apparatus("config/apparatus.yaml"))
    apparatus["encoder"]["kind"] = kind
    return sheet, calibrate(apparatus, ingest(sheet.loc["rest"]), draws=50_000)[0]


@pytest.fixture
def swing():
    return ingest(shipped()[0].loc["swing_12"])


@pytest.fixture
def calibration():
    return shipped()[1].copy(deep=True)


def record(signal, unit, time=None, **attrs):
    time = np.arange(len(signal)) / 100 if time is None else time
    attrs = {
        "recording": "a",
        "campaign": "b",
        "role": "",
        "file": "a.csv",
        "sha256": "",
        "source": "",
        **attrs,
    }
    signal = ("time", np.asarray(signal, dtype=float), {"units": unit, "long_name": "signal"})
    time = ("time", time, {"units": "s", "long_name": "time"})
    return xr.Dataset({"signal": signal}, {"time": time}, {"emulated": "no", **attrs})


@pytest.mark.parametrize("mode", MODES)
def test_the_angle_of_an_emulated_swing_is_the_true_one_within_its_bound(root, swing, calibration, mode):
    spec = importlib.util.spec_from_file_location("emulate", root / "resources/bench/emulate.py")
    emulate = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(emulate)
    truth = yaml.safe_load((root / "resources/bench/truth.yaml").read_text())["records"]["swing_12"]
    late = truth["released_before_first_sample_s"]
    true = emulate.motion(swing["time"].values + late, np.radians(truth["release_angle_deg"]))
    found = to_angle(swing, calibration, mode)
    miss = np.abs(found["angle"].values - true)
    assert np.mean(miss <= found["angle_bound"].values) > 0.95
    assert (
        np.sqrt(np.mean(miss**2)) > found["angle_random_uncertainty"].values.mean()
    )  # the line's error is shared


def test_at_the_vertical_the_uncertainty_is_neither_zero_nor_infinite(swing, calibration):
    found = to_angle(swing, calibration, "gum")
    crossing = np.argmin(np.abs(found["angle"].values))
    u = found["angle_standard_uncertainty"].values
    assert 1e-4 < u[crossing] < u.max()


def test_random_and_systematic_parts_make_the_whole(swing, calibration, tmp_path):
    found = to_angle(swing, calibration, "gum")
    random, systematic = found["angle_random_uncertainty"], found["angle_systematic_uncertainty"]
    assert np.hypot(random, systematic).values == pytest.approx(found["angle_standard_uncertainty"].values)
    slope = float(calibration["line"].sel(mode="gum", coefficient="slope"))
    assert random.values == pytest.approx(slope * 0.00203, rel=0.02)  # 2 mV of noise and a step of 1.2 mV
    bound = found.attrs["coverage_factor"] * found["angle_standard_uncertainty"].values
    assert found["angle_bound"].values == pytest.approx(bound)
    assert found.attrs["mode"] == "gum" and found.attrs["emulated"] == "yes"
    xr.testing.assert_equal(dataset.read(dataset.write(found, tmp_path / "a.nc")), found)


def test_an_encoder_declared_random_moves_its_share_to_the_random_part(swing):
    systematic, random = (to_angle(swing, shipped(kind)[1], "gum") for kind in ("systematic", "random"))
    total = "angle_standard_uncertainty"
    assert random[total].values == pytest.approx(systematic[total].values, rel=1e-6)
    assert np.all(random["angle_random_uncertainty"] > 3 * systematic["angle_random_uncertainty"])


def test_eq_11_is_the_propagation_through_the_whole_chain(swing, calibration):
    """Monte Carlo of one sample, all inputs drawn, against the formula (away from the encoder's jump at 5 V)."""
    found = to_angle(swing, calibration, "monte-carlo")
    volts = swing["signal"].values
    clear = np.abs(volts - 5) > 0.15
    u = np.interp(volts, calibration["grid"].values, calibration["grid_uncertainty"].values)
    assert found["angle_standard_uncertainty"].values[clear] == pytest.approx(u[clear], rel=0.02)
    angle = np.interp(volts, calibration["grid"].values, calibration["grid_angle"].values)
    assert found["angle"].values == pytest.approx(angle, abs=2e-5)


def test_volts_without_a_calibration_are_refused(swing):
    with pytest.raises(InputError, match=r"swing_12\.csv.*in volts.*no calibration"):
        to_angle(swing)


def test_volts_of_another_campaign_are_refused(swing, calibration):
    swing.attrs["campaign"] = "elsewhere"
    with pytest.raises(InputError, match=r"swing_12\.csv.*does not serve its campaign 'elsewhere'.*bench"):
        to_angle(swing, calibration)


def test_volts_beyond_the_encoder_are_refused(swing, calibration):
    with pytest.raises(InputError, match=r"swing_12.*beyond the encoder's range"):
        to_angle(swing.assign(signal=swing["signal"] * 2), calibration)


def test_an_unknown_mode_is_refused(swing, calibration):
    with pytest.raises(InputError, match=r"unknown mode 'gun'.*monte-carlo"):
        to_angle(swing, calibration, "gun")


def test_counts_become_radians_with_the_resolution_for_uncertainty():
    counts = np.round(500 * np.cos(np.arange(400) / 14))
    found = to_angle(record(counts, "counts", counts_per_revolution=4000.0))
    assert found["angle"].values == pytest.approx(counts * 2 * np.pi / 4000)
    assert found["angle_standard_uncertainty"].values == pytest.approx(2 * np.pi / 4000 / 12**0.5)
    assert found["angle_bound"].values == pytest.approx(0.95 * np.pi / 4000)
    assert found.attrs["mode"] == "resolution" and "not known" in found.attrs["systematic"]


def test_degrees_in_steps_are_known_to_their_step():
    degrees = np.round(20 * np.cos(np.arange(4000) / 14), 1)
    found = to_angle(record(degrees, "deg"))
    assert found["angle"].values == pytest.approx(np.radians(degrees))
    assert found["angle_random_uncertainty"].values == pytest.approx(np.radians(0.1) / 12**0.5)
    assert found.attrs["mode"] == "resolution"


@pytest.mark.parametrize("rate", [60, 100, 1000])
@pytest.mark.parametrize("sigma", [2e-5, 2e-3])
def test_elsewhere_the_noise_is_read_from_the_recording(rate, sigma):
    time = np.arange(30 * rate) / rate
    swing = 0.5 * np.exp(-time / 40) * np.cos(7.25 * time) + 0.002 * np.cos(21.75 * time)
    noisy = swing + sigma * np.random.default_rng(3).standard_normal(time.size)
    assert noise_level(time, noisy) == pytest.approx(sigma, rel=0.1)
    found = to_angle(record(noisy, "rad", time))
    assert found["angle_random_uncertainty"].values == pytest.approx(sigma, rel=0.1)
    assert found.attrs["mode"] == "residual noise" and np.all(found["angle_systematic_uncertainty"] == 0)


def test_too_few_samples_for_the_noise():
    with pytest.raises(InputError, match="at least 64"):
        noise_level(np.arange(20), np.arange(20))


@pytest.mark.parametrize(
    ("name", "mode", "u"),
    [
        ("dynamicslab_single/free_swing_small", "resolution", 2 * np.pi / 40000 / 12**0.5),
        ("jensen_rotary/rel45", "resolution", 2 * np.pi / 4000 / 12**0.5),
        ("jensen_rotary/rel90", "resolution", 2 * np.pi / 4000 / 12**0.5),
        ("jensen_rotary/rel135", "resolution", 2 * np.pi / 4000 / 12**0.5),
        ("dynamicslab_single/free_swing_large", "residual noise", 3.9e-5),  # an independent estimate: 3.6e-5
    ],
)
def test_real_recordings_tell_their_resolution(shared_data, tmp_path, name, mode, u):
    sheet = tmp_path / "sheet.csv"
    sheet.write_text(f"recording,file\na,{shared_data / 'real' / name}.csv\n")
    found = to_angle(ingest(read_sheet(sheet).loc["a"]))
    assert found.attrs["mode"] == mode
    assert found["angle_random_uncertainty"].values[0] == pytest.approx(u, rel=0.03)


@pytest.mark.parametrize("correlation", [0.0, 0.5, 0.9])
def test_coloured_noise_is_told_with_its_colour(correlation):
    """Beside a swing; white noise of the band's level would be a quarter of it. Two minutes tell it, twenty seconds to a third."""
    time = np.arange(12000) / 100
    swing = 0.5 * np.exp(-0.01 * time) * np.cos(7.25 * time)
    found = []
    for number in range(20):
        white = np.random.default_rng([6, number]).standard_normal(time.size + 300)
        noise = lfilter([np.sqrt(1 - correlation**2)], [1, -correlation], white)[300:]
        found.append(noise_of(time, swing + 2e-3 * noise))
    assert np.median([one.deviation for one in found]) == pytest.approx(2e-3, rel=0.15)
    assert np.median([one.correlation for one in found]) == pytest.approx(correlation, abs=0.07)


def test_an_angle_s_random_uncertainty_is_that_of_the_coloured_noise():
    time = np.arange(2000) / 100
    white = np.random.default_rng(3).standard_normal(time.size + 300)
    noise = lfilter([np.sqrt(1 - 0.81)], [1, -0.9], white)[300:]
    angle = to_angle(record(0.5 * np.cos(7.25 * time) + 2e-3 * noise, "rad", time))
    assert float(angle["angle_random_uncertainty"][0]) == pytest.approx(
        2e-3, rel=0.5
    )  # one record tells it to 35 %
    assert angle.attrs["noise_correlation"] == pytest.approx(0.9, abs=0.08)


def test_lines_of_the_mains_are_no_colour():
    time = np.arange(2000) / 100
    white = np.random.default_rng(5).standard_normal(time.size)
    found = noise_of(time, 0.5 * np.cos(7.25 * time) + 1e-3 * white + 1e-3 * np.cos(2 * np.pi * 30 * time))
    assert found.correlation == 0
    assert found.deviation == pytest.approx(1e-3, rel=0.1)


def test_what_the_calibration_leaves_open_goes_with_the_angle(swing, calibration):
    slack = of_angles([to_angle(swing, calibration)])
    assert slack.names == ("sensor_gain", "sensor_zero", "sensor_curvature")
    gain, zero, _ = slack.deviations.values()
    line = calibration.sel(mode="gum")
    slope = float(line["line"].sel(coefficient="slope"))
    u_slope = np.sqrt(float(line["line_covariance"].sel(coefficient="slope", coefficient_2="slope")))
    assert gain == pytest.approx(u_slope / slope, rel=1e-6)
    assert zero == pytest.approx(slope * float(line["rest_voltage_uncertainty"]), rel=1e-6)
    # of opposite signs to the errors of slope and rest voltage that they come from
    expected = -slope * float(line["slope_rest_covariance"]) / slope
    assert slack.covariance[0, 1] == pytest.approx(expected, rel=1e-6)
    assert "arm" in slack.sources
    assert slack.clock == pytest.approx(5e-5 / 3**0.5)


def test_tolerances_of_a_sheet_are_limits_and_reach_the_angle():
    time = np.arange(2000) / 100
    values = 0.5 * np.cos(7.25 * time) + 1e-3 * np.random.default_rng(1).standard_normal(time.size)
    stated = {"gain_tolerance": 0.01, "zero_tolerance_rad": 0.002, "clock_tolerance": 0.005}
    angle = to_angle(record(values, "rad", time, **stated))
    slack = of_angles([angle])
    assert slack.deviations == pytest.approx({"sensor_gain": 0.01 / 3**0.5, "sensor_zero": 0.002 / 3**0.5})
    assert slack.clock == pytest.approx(0.005 / 3**0.5)
    expected = np.hypot(0.01 * values, 0.002) / 3**0.5
    assert angle["angle_systematic_uncertainty"].values == pytest.approx(expected)
    assert "sample sheet" in angle.attrs["systematic"]


def test_a_zero_that_nobody_states_is_told_by_fits_and_is_no_uncertainty_of_the_angle():
    """A tenth of a radian for a reading good to a milliradian: bounds as wide would hold any model's residual."""
    time = np.arange(2000) / 100
    values = 0.05 * np.cos(7.25 * time) + 1e-3 * np.random.default_rng(1).standard_normal(time.size)
    angle = to_angle(record(values, "rad", time, gain_tolerance=0.01, **zero_unstated({}, "rad")))
    assert angle["angle_systematic_uncertainty"].values == pytest.approx(0.01 * np.abs(values) / 3**0.5)
    assert float(angle["angle_bound"].max()) < 3e-3
    assert "zero, which fits tell" in angle.attrs["systematic"]
    assert of_angles([angle]).deviations["sensor_zero"] == pytest.approx(0.1 / 3**0.5)


def test_where_nothing_is_stated_only_the_clock_is_open():
    slack = of_angles([to_angle(record(np.cos(np.arange(500) / 14), "rad"))])
    assert slack.names == () and slack.clock > 0


def test_the_paper_s_bound_does_not_say_that_it_holds_95(swing, calibration):
    told = {mode: to_angle(swing, calibration, mode)["angle_bound"].attrs["long_name"] for mode in MODES}
    assert [mode for mode in MODES if "95 %" in told[mode]] == ["gum", "monte-carlo"]
    assert "90 %" in told["paper"]


@pytest.mark.parametrize("samples", [16, 40, 63])
def test_a_recording_too_short_for_a_spectrum_has_the_noise_about_its_swing(samples):
    time = np.arange(samples) / 20
    noise = 0.002 * np.random.default_rng(samples).standard_normal(samples)
    found = to_angle(record(0.3 * np.cos(4 * time) + noise, "rad", time))
    assert float(found["angle_random_uncertainty"][0]) == pytest.approx(0.002, rel=0.6)
