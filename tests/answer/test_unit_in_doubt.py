"""Degrees and radians: what is stated is taken, what large swings tell is taken, and the rest is asked about."""

import numpy as np
import pytest

import swingdown
from swingdown.engine.trajectory import simulate
from swingdown.errors import InputError
from swingdown.pendulum.model import Model


def in_degrees(release=2.2, effects="viscous+load_coulomb", **values):
    """The times, and the angles in degrees, of a pendulum that swings a little."""
    values = {"natural_frequency": 6.2, "viscous_ratio": 0.004} | values
    times, model = np.arange(1500) / 60, Model(effects, values | {"load_friction": 1e-5})
    angle = np.degrees(simulate(model, times, np.radians(release)))
    return times, angle + 0.004 * np.random.default_rng(6).standard_normal(times.size)


@pytest.mark.parametrize("call", [swingdown.fit, swingdown.explain])
@pytest.mark.parametrize("release", [0.4, 2.2])
def test_degrees_without_a_word_are_asked_about_however_small(call, release):
    with pytest.raises(InputError, match="no unit is stated, and the unit is in doubt") as caught:
        call(*in_degrees(release))
    assert "in rad or in deg" in caught.value.expected and "write restoring='linear'" in caught.value.mend
    assert swingdown.fit(*in_degrees(release), unit="deg").table["remark"].tolist() == [""]


@pytest.mark.slow("a search")
@pytest.mark.parametrize("scale", [1.0, np.radians(1) ** 2])
def test_a_stated_unit_is_never_overruled_and_nothing_is_named_whose_work_is_that_of_another(scale):
    """Degrees that are called rad, and rad that are called degrees."""
    times, angle = in_degrees(release=2.2 if scale == 1 else 60)
    found = swingdown.explain(
        times, angle if scale == 1 else np.radians(angle), unit="rad" if scale == 1 else "deg"
    )
    assert found.verdict["status"] == "unknown" and not found.verdict["effects"]
    assert str(found).startswith("What stops it is not established")
    assert "\nBeware: the unit is in doubt" in str(found)
    assert "57.3 times" in found.verdict["sentence"] and "57.3 times" in found.row["remark"]


@pytest.mark.slow("a search")
def test_what_is_found_in_the_stated_unit_where_another_would_leave_more_settles_it():
    """24 notches a turn change the period with the amplitude, as another unit would; that leaves 15 times the noise, and they nothing."""
    times, values = np.arange(0, 20, 0.01), {"natural_frequency": 5.0, "viscous_ratio": 0.005}
    model = Model(
        "viscous+detent", values | {"detent_torque": 0.15, "detent_order": 24.0, "detent_phase": -2.736}
    )
    draws = np.random.default_rng(2)
    angles = [
        simulate(model, times, release) + 1e-3 * draws.standard_normal(times.size) for release in (0.5, 0.3)
    ]
    assert "the unit is in doubt" in swingdown.fit([times] * 2, angles, unit="rad").table["remark"].iloc[-1]
    found = swingdown.explain([times] * 2, angles, unit="rad")
    assert [one["name"] for one in found.verdict["effects"]] == ["detent"] and "in doubt" not in str(found)


def test_degrees_without_a_word_that_no_model_follows_are_asked_about():
    """Two coupled pendulums: their beats are of no damping, in any unit."""
    times = np.arange(0, 45, 0.025)
    beat = 2.7 * np.cos(4.06 * times) + 0.2 * np.cos(3.9 * times + 1)
    with pytest.raises(InputError, match="no unit is stated, and the unit is in doubt"):
        swingdown.fit(times, beat * np.exp(-0.004 * times))


def test_swings_too_small_to_tell_their_unit_say_so_where_nobody_does():
    times, degrees = in_degrees(release=0.5)
    told = "no unit is stated: taken for rad, and the swings are too small to tell it from deg"
    assert told in str(swingdown.fit(times, np.radians(degrees)))
    assert "no unit" not in str(swingdown.fit(times, np.radians(degrees), unit="rad"))


def test_large_swings_in_rad_need_no_word():
    times, degrees = in_degrees(release=50)
    assert swingdown.fit(times, np.radians(degrees)).remarks == []


@pytest.mark.parametrize(
    ("header", "doubt"),
    [
        ("", "No unit is stated, and as angles these are not a pendulum's."),
        ("t (s)\tangle (deg)", "The unit is in doubt ("),
    ],
)
def test_of_a_file_in_no_unit_of_an_angle_only_what_amplitudes_tell_is_asserted(tmp_path, header, doubt):
    """Pixels of a bob, which swing as no pendulum of so many degrees does, and die as in air."""
    times = np.arange(0, 20, 1 / 30)
    pixels = 60 * np.exp(-0.05 * times) * np.cos(6.3 * times)
    pixels += 0.3 * np.random.default_rng(4).standard_normal(times.size)
    file = tmp_path / "pixels.txt"
    columns = np.column_stack((times, pixels))
    np.savetxt(file, columns, fmt="%.4f", delimiter="\t", header=header, comments="")
    found = swingdown.explain(file, base=("load_coulomb",))
    assert ("PERIOD AND DECAY ALONE" in found.table["remark"].item()) == (not header)
    (told,) = found.verdict["effects"]
    assert told["name"] == "viscous" and told["parameters"]["viscous_ratio"]["value"] is None
    assert found.verdict["sentence"].startswith(doubt)
    assert ". Viscous is missing (P " in found.verdict["sentence"]
    assert [one["doubt"] for one in found.verdict["stand_ins"]] == ["another unit would explain it as well"]
