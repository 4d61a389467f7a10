"""Curves over the amplitude, envelopes and resonances as they are drawn, of datasets made by hand."""

import numpy as np
import pytest
import xarray as xr

from swingdown.plots import style
from swingdown.plots.curves import backbone, envelopes, resonances

pytestmark = pytest.mark.usefixtures("frozen")
AMPLITUDE = np.linspace(0.05, 0.4, 12)
SPEED, ANGLE = np.linspace(0, 2, 15), np.linspace(0, 0.4, 15)


def curves(swings=20, friction=True, timed=True, units="rad", **attrs):
    """What a pendulum of 7.2 rad/s loses and how long it takes, free of a model, with a model and by the model alone."""
    shares = {"free": 1.0, "model": 1.02, "alone": 0.97}
    frequency = 7.2 / (2 * np.pi) * (1 - AMPLITUDE**2 / 16)
    known = {
        "frequency": ("amplitude", frequency if timed else np.nan * frequency),
        "period": ("amplitude", 1 / frequency if timed else np.nan * frequency),
        "loss": ("amplitude", 0.05 + 0.1 * AMPLITUDE),
        "damping_ratio": ("amplitude", 0.004 + 0.008 * AMPLITUDE),
        "friction": ("speed", (0.1 + 0.05 * SPEED**2) if friction else np.nan * SPEED),
        "restoring": ("angle", 52 * np.sin(ANGLE)),
    }
    made = {}
    for name, (over, value) in known.items():
        scale = 1e-3 if name in ("frequency", "period") else 1.0
        for end, width in (("", 0.0), ("_low", -0.05), ("_high", 0.05)):
            each = [value * (1 + scale * (share - 1)) * (1 + scale * width) for share in shares.values()]
            made[name + end] = (("source", over), each)
    size = np.linspace(0.06, 0.39, swings)
    made |= {
        "swing_amplitude": ("swing", size),
        "swing_loss": ("swing", 0.05 + 0.1 * size + 0.002 * np.sin(9 * np.arange(swings))),
        "swing_loss_u": ("swing", np.full(swings, 0.002)),
        "swing_period": (
            "swing",
            2 * np.pi / 7.2 * (1 + size**2 / 16 + 1e-4 * np.sin(9 * np.arange(swings))),
        ),
        "swing_period_u": ("swing", np.full(swings, 1e-4)),
    }
    coords = {"source": list(shares), "amplitude": AMPLITUDE, "speed": SPEED, "angle": ANGLE}
    data = xr.Dataset(made, coords, {"model": "viscous+quadratic_drag", "emulated": "no"} | attrs)
    data["amplitude"].attrs["units"] = units
    return data


def test_all_that_is_known_against_the_amplitude_has_its_panel():
    figure = backbone(curves())
    frequency, loss, ratio, restoring, friction = figure.axes
    labels = [(axes.get_xlabel(), axes.get_ylabel()) for axes in figure.axes]
    assert labels == [
        ("frequency (Hz)", "amplitude (°)"), ("amplitude (°)", "loss a swing (%)"), ("amplitude (°)", "damping ratio (%)"),
        ("angle (°)", "restoring torque (rad/s²)"), ("speed (rad/s)", "friction (rad/s²)"),
    ]  # fmt: skip
    free = loss.lines[0]
    np.testing.assert_allclose(free.get_xdata(), np.degrees(AMPLITUDE))
    np.testing.assert_allclose(free.get_ydata(), 100 * (0.05 + 0.1 * AMPLITUDE))
    np.testing.assert_allclose(restoring.lines[0].get_ydata(), 52 * np.sin(ANGLE))
    assert friction.get_ylim()[0] == 0
    (quality,) = ratio.child_axes
    marks = quality.get_yticks()
    low, high = ratio.get_ylim()
    assert all(50 / high <= mark <= 50 / low for mark in marks) and len(marks) >= 3
    assert "viscous + quadratic" in figure.get_supxlabel()


def test_single_swings_have_bars_of_two_standard_uncertainties():
    frequency, loss = backbone(curves()).axes[:2]
    for axes, part, half in ((loss, 1, 100 * 2 * 0.002), (frequency, 0, 2 * 1e-4 * (7.2 / 2 / np.pi) ** 2)):
        (bars,) = [one for one in axes.collections if hasattr(one, "get_segments")]
        reach = [abs(one[1][part] - one[0][part]) / 2 for one in bars.get_segments()]
        assert np.median(reach) == pytest.approx(half, rel=0.02)


@pytest.mark.parametrize(("swings", "shown"), [(60, 60), (61, 16)])
def test_of_many_swings_means_of_neighbours_are_drawn(swings, shown):
    loss = backbone(curves(swings)).axes[1]
    (drawn,) = loss.containers
    assert len(drawn[0].get_xdata()) == shown
    assert drawn.get_label() == ("single swings" if shown == swings else "means of single swings")


def test_what_is_not_known_has_no_panel():
    assert len(backbone(curves(friction=False)).axes) == 3
    figure = backbone(curves(timed=False, model=""))
    for axes in (figure.axes[0], figure.axes[3]):
        assert [text.get_text() for text in axes.texts] == ["no times"]
    lengths = backbone(curves(units="mm", emulated="yes"))
    assert lengths.axes[1].get_xlabel() == "amplitude (mm)" and style.EMULATED in lengths.get_supxlabel()
    np.testing.assert_allclose(lengths.axes[1].lines[0].get_xdata(), AMPLITUDE)


@pytest.mark.parametrize("units", ["rad", "mm"])
def test_each_law_has_its_envelope_and_what_it_leaves(units):
    times = np.linspace(0, 30, 25)
    measured = 0.4 * np.exp(-times / 20)
    laws = ["viscous", "viscous+load_coulomb", "viscous+presliding"]
    fitted = np.stack([measured * (1 + 0.01 * k * np.cos(times)) for k in range(3)])
    data = xr.Dataset(
        {"amplitude": ("time", measured, {"units": units}), "fitted": (("law", "time"), fitted)},
        {"time": times, "law": laws},
        {"best": "viscous+load_coulomb", "said": "one thing; and another", "emulated": "no"},
    )
    figure = envelopes(data)
    upper, lower = figure.axes
    scale, unit = (180 / np.pi, "°") if units == "rad" else (1.0, "mm")
    assert upper.get_ylabel() == f"amplitude ({unit})" and lower.get_ylabel() == f"measured − law ({unit})"
    np.testing.assert_allclose(upper.lines[0].get_ydata(), scale * measured)
    for k in range(3):
        np.testing.assert_allclose(lower.lines[k].get_ydata(), scale * (measured - fitted[k]), atol=1e-12)
    widths = [line.get_linewidth() for line in lower.lines[:3]]
    assert widths[1] > widths[0] == widths[2]  # the best one stands out
    assert figure.get_supxlabel() == "one thing · and another"


def resonance(kind, cut):
    """Two drives of a hardening swing, the larger one with a part where no pendulum stays."""
    size = np.linspace(0.02, 0.4, 10)
    middle = 1.1 + 0.1 * size
    width = np.array([0.02, 0.05])[:, None] / (size + 0.05)
    frequency = np.stack([middle - width, middle + width], axis=1)
    stable = np.ones((2, 2, 10))
    stable[1, 1, 4:7] = 0
    dims = ("source", "drive", "side", "amplitude_step")
    made = {
        "frequency": (dims, frequency[None]),
        "frequency_low": (dims, 0.99 * frequency[None]),
        "frequency_high": (dims, 1.01 * frequency[None]),
        "phase": (dims, np.broadcast_to(np.linspace(0.3, 1.5, 10), (1, 2, 2, 10))),
        "stable": (dims, stable[None]),
        "amplitude": (("source", "drive", "amplitude_step"), np.broadcast_to(size, (1, 2, 10))),
        "peak_amplitude": (("source", "drive"), [[0.3, np.nan if cut else 0.39]]),
        "backbone_frequency": (("source", "amplitude_step"), middle[None]),
        "backbone_amplitude": ("amplitude_step", size),
    }
    coords = {"source": ["free"], "drive": [0.5, 1.5], "side": ["below", "above"]}
    return xr.Dataset(made, coords, {"kind": kind, "emulated": "no"})


@pytest.mark.parametrize(
    ("kind", "cut", "told"),
    [("torque", True, "torque over inertia"), ("pivot", False, "acceleration of the pivot")],
)
def test_a_resonance_is_dashed_where_no_pendulum_stays(kind, cut, told):
    figure = resonances(resonance(kind, cut))
    upper, lower = figure.axes
    assert f"drive: {told}" in figure.get_supxlabel() and "no pendulum stays there" in figure.get_supxlabel()
    assert ("peaks beyond the ring-down" in figure.get_supxlabel()) is cut
    words = [line.get_label() for line in upper.lines if not line.get_label().startswith("_")]
    assert words == ["backbone (ring-down)", "drive 0.5 rad/s²", "drive 1.5 rad/s²" + ", cut" * cut]
    dashed = [line for line in lower.lines if line.get_linestyle() == "--"]
    there = [int(np.isfinite(line.get_xdata()).sum()) for line in dashed]
    assert there == [0, 0, 0, 5]  # the part and a step to either side of it
    assert lower.get_ylim() == (0, 180) and upper.get_ylim()[0] == 0
