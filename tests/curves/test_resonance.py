"""A resonance curve foretold from a ring-down: against what can be worked out by hand, and against pendulums that are driven."""

import numpy as np
import pandas as pd
import pytest

import swingdown
from swingdown.__main__ import main
from swingdown.curves.resonance import COLUMNS, resonance, table, words
from swingdown.errors import InputError

TIMES = np.arange(0, 40, 0.02)
FREQUENCY, LIGHT = 6.0, 0.005  # rad/s, and a damping ratio that lets the curve bend over


def rung(release=0.6, restoring="linear", times=TIMES, ratio=0.01):
    """The curves of a ring-down."""
    values = {"natural_frequency": FREQUENCY, "viscous_ratio": ratio}
    swing = swingdown.simulate("viscous", times, release, restoring=restoring, noise=5e-4, seed=2, **values)
    return swingdown.fit(swing, restoring=restoring, fitted=["viscous"]).curves()


@pytest.fixture(scope="module")
def spring():
    return rung()


@pytest.fixture(scope="module")
def weight():
    return rung(1.2, "sine", np.arange(0, 120, 0.02), LIGHT)


def test_a_spring_with_viscous_damping_resonates_as_the_textbook_says(spring):
    """Amplitude a / sqrt((w0² - w²)² + (2 z w0 w)²), phase atan2(2 z w0 w, w0² - w²), peak a / (2 z w0² sqrt(1 - z²))."""
    found = resonance(spring, 0.2).sel(source="free").isel(drive=0)
    w, size = 2 * np.pi * found["frequency"].values, found["amplitude"].values
    by_hand = 0.2 / np.hypot(36 - w**2, 2 * 0.01 * 6 * w)
    assert np.nanmax(np.abs(by_hand / size - 1)) < 0.02
    assert np.allclose(found["phase"], np.arctan2(2 * 0.01 * 6 * w, 36 - w**2), atol=0.1)
    assert float(found["peak_amplitude"]) == pytest.approx(0.2 / (0.02 * 36), rel=0.01)
    assert float(found["peak_frequency"]) == pytest.approx(6 / (2 * np.pi), rel=1e-3)
    assert w[0, -1] == w[1, -1] and found["stable"].values.min() == 1  # the sides meet
    # the frequencies that hold each amplitude, by hand
    root = np.sqrt(np.maximum((0.2 / size) ** 2 - 4 * 0.01**2 * 36**2 * (1 - 0.01**2), 0))
    truth = np.sqrt(36 * (1 - 2 * 0.01**2) + np.array([-1, 1])[:, None] * root)
    low, high = (2 * np.pi * found[f"frequency_{end}"].values for end in ("low", "high"))
    away = size < 0.9 * float(found["peak_amplitude"])
    assert (np.abs(w - truth) < high - low)[:, away].all() and (high - low)[:, away].max() < 0.01


def steady(frequency, drive, amplitude=0.0, phase=0.0):
    """The amplitude (rad) that a shaken pendulum ends with, begun at rest or in a swing of that amplitude and phase."""
    times, w = np.arange(0, 300, 0.02), 2 * np.pi * frequency
    swing = swingdown.simulate(
        "viscous+base_vibration",
        times,
        amplitude * np.cos(phase),
        velocity=amplitude * w * np.sin(phase),
        natural_frequency=FREQUENCY,
        viscous_ratio=LIGHT,
        vibration_acceleration=drive,
        vibration_frequency=frequency,
        vibration_phase=0.0,
    ).values
    late = times > 300 - 10 / frequency
    return abs(2 * np.mean(swing[late] * np.exp(-1j * w * times[late])))


def test_a_shaken_pendulum_swings_as_its_ring_down_foretold(weight):
    """In the bend two swings are possible, and it ends in the one that it began beside; above the bend there is one."""
    found = resonance(weight, 0.3, "pivot").sel(source="free").isel(drive=0)
    below, above = (found.sel(side=side) for side in ("below", "above"))
    size, rising = found["amplitude"].values, below["frequency"].values
    folded = below["stable"].values < 0.5
    assert folded.any() and (above["stable"].values[:-1] > 0.5).all()
    between = (rising[folded].min() + rising[folded].max()) / 2
    lower = ~folded & (size < size[folded].min())
    small = float(np.interp(between, rising[lower], size[lower]))
    falling = above["frequency"].values[::-1]
    large, lag = (float(np.interp(between, falling, one[::-1])) for one in (size, above["phase"].values))
    assert large > 2 * small
    assert steady(between, 0.3) == pytest.approx(small, rel=0.02)
    assert steady(between, 0.3, large, lag) == pytest.approx(large, rel=0.02)
    faster = 1.03 * FREQUENCY / (2 * np.pi)
    assert steady(faster, 0.3) == pytest.approx(float(np.interp(faster, falling, size[::-1])), rel=0.02)


def test_beyond_the_ring_down_nothing_is_foretold(spring):
    found = resonance(spring, [0.1, 5.0]).sel(source="free")
    assert np.isfinite(found["peak_amplitude"].values).tolist() == [True, False]
    assert float(found["amplitude"].isel(drive=1).max()) <= float(spring["amplitude"].max())
    assert words(found.expand_dims(source=["free"]), "free")[1].endswith("wider than the ring-down shows")


def test_the_drives_that_nobody_named_peak_within_the_ring_down(spring):
    found = resonance(spring)
    assert np.isfinite(found["peak_amplitude"].values).all() and found.sizes["drive"] == 3
    rows = table(found)
    assert (
        list(rows) == COLUMNS and set(rows["side"]) == {"below", "above"} and rows["frequency_Hz"].min() > 0
    )


@pytest.mark.parametrize(
    ("drive", "kind", "told"),
    [*((one, "torque", "amplitudes above 0") for one in (-1.0, [], "weak")), (1e-9, "torque", "makes it swing less than the ring-down shows"), (0.1, "push", "torque or pivot")],
)  # fmt: skip
def test_what_cannot_be_foretold_is_refused(spring, drive, kind, told):
    with pytest.raises(InputError, match=told):
        resonance(spring, drive, kind)


def test_drives_that_nobody_named_are_strong_enough_for_a_model_that_is_wrong():
    """Friction in the place of air and friction damps small swings more than they are: the weakest drive is the model's."""
    damping = {"viscous_ratio": 0.004, "load_friction": 0.004}
    swing = swingdown.simulate(
        "viscous+load_coulomb", TIMES, 0.35, noise=1e-3, seed=1, natural_frequency=7.25, **damping
    )
    found = swingdown.fit(swing, fitted=["load_coulomb"]).resonance()
    assert 1 < found.sizes["drive"] <= 3 and np.isfinite(found["peak_amplitude"].sel(source="free")).all()


def test_an_answer_draws_it():
    swing = swingdown.simulate(
        "viscous", TIMES, 0.5, noise=1e-3, seed=1, natural_frequency=6, viscous_ratio=0.01
    )
    answer = swingdown.fit(swing, fitted=["viscous"])
    assert answer.resonance(0.1)["frequency"].attrs["units"] == "Hz"
    from swingdown.plots.curves import resonances

    figure = resonances(answer.resonance())
    assert [axes.get_ylabel() for axes in figure.axes] == ["amplitude (°)", "phase lag (°)"]
    assert figure._repr_png_().startswith(b"\x89PNG")


def test_the_command_foretells_it_too(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    swing = swingdown.simulate(
        "viscous", TIMES, 0.5, noise=1e-3, seed=1, natural_frequency=6, viscous_ratio=0.01
    )
    swing.to_series().rename("angle_rad").rename_axis("t_s").to_csv("a.csv")
    assert main(["a.csv", "--quick", "--drive", "0.1", "0.2"]) == 0
    told = capsys.readouterr().out
    assert "a drive of 0.1 rad/s²: 7.9" in told and "a drive of 0.2 rad/s²: 1" in told
    study = tmp_path / "a-swingdown"
    assert sorted(set(pd.read_csv(study / "resonance.csv")["drive_rad_per_s2"])) == [0.1, 0.2]
    assert (study / "resonance.png").stat().st_size > 10_000
    assert main(["a.csv", "--quick", "--drive", "1e-9", "--into", "b"]) == 0
    assert "no resonance curve: 1e-09 rad/s^2 makes it swing less" in capsys.readouterr().out
