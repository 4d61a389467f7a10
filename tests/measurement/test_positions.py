"""Files of a bob's positions: an angle about a pivot that is fitted, or one coordinate, or refused."""

import numpy as np
import pytest
from exports import SWING, TIME, rows, video

from swingdown.errors import InputError
from swingdown.measurement.positions import metres


@pytest.mark.parametrize("tilt", [0.0, 0.3])
def test_positions_become_an_angle_about_a_fitted_pivot(take, tilt):
    draws = np.random.default_rng(3)
    x, y = video(tilt=tilt)
    x, y = x + 0.001 * draws.standard_normal(x.size), y + 0.001 * draws.standard_normal(x.size)
    made = take("t (s),x (m),y (m)\n" + rows(TIME, x, y))
    assert made["signal"].values == pytest.approx(SWING + tilt, abs=0.01)
    found = made.attrs
    for key, value in (("x", 0.31), ("y", 1.2), ("radius", 0.8)):
        assert abs(found[f"pivot_{key}"] - value) < 4 * found[f"pivot_u_{key}"] < 0.01
    assert found["pivot_residual"] == pytest.approx(0.001, rel=0.1)
    assert "the pivot was fitted" in found["remarks"]
    assert ("it swings about 0.3 rad" in found["remarks"]) == (tilt > 0)


def test_the_pivots_uncertainty_holds_it(take):
    """Two standard uncertainties hold the radius in 95 % of 400 draws (89 % would be six deviations away)."""
    from swingdown.measurement.positions import fit_circle

    draws, held = np.random.default_rng(8), 0
    for _ in range(400):
        x, y = (one + 0.002 * draws.standard_normal(one.size) for one in video())
        circle = fit_circle(x, y)
        held += abs(circle.radius - 0.8) < 1.96 * circle.u_radius
    assert 0.92 < held / 400 < 0.98


@pytest.mark.parametrize(
    ("x", "y"),
    [
        (np.random.default_rng(1).standard_normal(600), np.random.default_rng(2).standard_normal(600)),
        (np.ones(600), np.ones(600)),
    ],
)
def test_positions_on_no_arc_are_refused(take, x, y):
    with pytest.raises(InputError, match=r"columns x and y.*Mend"):
        take("t,x,y\n" + rows(TIME, x, y, digits=9))


@pytest.mark.parametrize("slope", [0.0, 0.5])
def test_positions_on_a_line_are_one_coordinate(take, slope):
    """A long pendulum's arc tells no pivot; of how far along it is period and decay are told."""
    made = take("t,x,y\n" + rows(TIME, 400 * SWING, 400 * slope * SWING))
    assert "the positions lie on a line" in made.attrs["remarks"] and made.attrs["scale"] == "unknown"
    along = made["signal"].values
    assert np.abs(np.corrcoef(along, SWING)[0, 1]) > 1 - 1e-9


def test_positions_without_names_are_asked_about(take):
    """Their second column is no angle, and taken for one it would give a number."""
    noise = 0.002 * np.random.default_rng(4).standard_normal((2, TIME.size))
    text = rows(TIME, *(np.array(video()) + noise), separator="\t")
    with pytest.raises(InputError, match=r"column 2 and column 3.*on a circle.*`t x y`"):
        take(text)
    assert "as positions" in take("t\tx\ty\n" + text).attrs["taken"]
    assert "`column 2` as rad" in take(text, signal_column="column 2").attrs["taken"]
    with pytest.raises(InputError, match="height of a bob.* twice a period"):
        take(text, signal_column="column 3")


@pytest.mark.parametrize("header", ["px", "Pixels"])
def test_a_column_that_is_called_after_its_unit_is_a_coordinate(take, header):
    made = take(f"t (s),{header}\n" + rows(TIME, 215 * SWING / np.abs(SWING).max()))
    assert f"`{header}` as one coordinate" in made.attrs["taken"]


def test_pictures_count_y_downwards(take):
    x, y = video()
    made = take("frame,t,x (px),y (px)\n" + rows(np.arange(600), TIME, 500 * x, 900 - 500 * y))
    assert made["signal"].values == pytest.approx(SWING, abs=1e-5)


@pytest.mark.parametrize("length", [120, 300])
def test_positions_in_whole_pixels_are_at_no_rail(take, length):
    """At a turning point several frames have the same place, and the angle that is computed of it the same last digit."""
    times = np.arange(3300) / 60
    swing = 0.2 * np.exp(-times / 60) * np.cos(4.05 * times + 1)
    places = np.round(271 + length * np.sin(swing)), np.round(440 + length * np.cos(swing))
    made = take("t (s),x (px),y (px)\n" + rows(times, *places))
    assert made["signal"].values == pytest.approx(swing, abs=0.03)  # as the pivot is known


@pytest.mark.parametrize(
    ("length", "unit", "factor"), [("350px", "", 1.0), ("350", "px", 1.0), ("58 cm", "mm", 10.0)]
)
def test_a_length_in_the_coordinates_unit(length, unit, factor):
    assert metres(length, unit, "here") == pytest.approx(float(length.strip("pxcm ")) * factor)


def test_a_length_beside_a_coordinate_without_a_unit_asks_for_that():
    with pytest.raises(InputError, match="write the coordinate's unit into its name"):
        metres("58cm", "", "here")


@pytest.mark.parametrize(
    ("columns", "taken"),
    [("x y z", "`x (mm)` and `y (mm)`"), ("x z", "`x (mm)` and `z (mm)`"), ("y z", "`y (mm)` and `z (mm)`")],
)
def test_of_three_coordinates_the_swing_is_in_the_plane_in_which_it_moves(take, columns, taken):
    swing = 0.5 * np.exp(-0.05 * TIME) * np.cos(6 * TIME)
    depth = 80 + np.random.default_rng(1).normal(0, 0.05, TIME.size)
    where = {"x": 500 + 900 * np.sin(swing), "z": 1200 - 900 * np.cos(swing), "y": depth}
    if "x" not in columns:
        where["y"] = where["x"]
    made = take(
        ",".join(["t (s)", *(f"{one} (mm)" for one in columns.split())]) + "\n"
        + "".join(f"{t:.3f}," + ",".join(f"{where[one][k]:.5f}" for one in columns.split()) + "\n" for k, t in enumerate(TIME))
    )  # fmt: skip
    assert taken in made.attrs["taken"] and made.attrs["pivot_radius"] == pytest.approx(900, rel=0.01)
    assert np.ptp(made["signal"].values) == pytest.approx(np.ptp(swing), rel=0.01)


def test_motion_capture_is_in_millimetres_by_its_markers(take):
    swing = 0.5 * np.exp(-0.05 * TIME) * np.cos(6 * TIME)
    head = f"NO_OF_FRAMES\t{TIME.size}\nFREQUENCY\t{1 / (TIME[1] - TIME[0]):.6g}\nDATA_INCLUDED\t3D\nMARKER_NAMES\tbob\n"
    depth = 80 + np.random.default_rng(1).normal(0, 0.05, TIME.size)
    rows = "".join(
        f"{500 + 900 * np.sin(a):.3f}\t{b:.3f}\t{1200 - 900 * np.cos(a):.3f}\n"
        for a, b in zip(swing, depth, strict=True)
    )
    for names in ("", "X\tY\tZ\n"):
        made = take(head + names + rows)
        assert made.attrs["pivot_radius"] == pytest.approx(900, rel=0.01) and "mm" in made.attrs["remarks"]


@pytest.mark.parametrize("unit", ["cm", ""])
def test_of_a_wide_swing_by_one_coordinate_the_length_is_asked(take, unit):
    """By RK4: a bob on a string of 55.6 cm from 1.2 rad, and a mass on a spring that goes as far."""
    step, far, speed, swing = 0.002, 1.2, 0.0, []
    for _ in range(15_000):
        swing.append(far)
        for share in (0.5, 0.5):  # symplectic
            speed -= share * step * (4.2**2 * np.sin(far) + 2 / 40 * speed)
            far += share * step * speed
    times, angle = step * np.arange(15_000)[::15], np.array(swing)[::15]
    header = f"t (s),x{f' ({unit})' if unit else ''}\n"
    for x, asked in ((55.6 * np.sin(angle), True), (46 * np.exp(-times / 40) * np.cos(4.2 * times), False)):
        text = header + rows(times, x + np.random.default_rng(1).normal(0, 0.05, times.size))
        if asked:
            with pytest.raises(InputError, match="arcsine over its length"):
                take(text)
        else:
            assert "one coordinate" in take(text).attrs["remarks"]
    length = {"cm": "56.5 cm", "": "56.5"}[unit]
    found = take(header + rows(times, 55.6 * np.sin(angle)), length=length)["signal"].values
    assert found == pytest.approx(np.arcsin(55.6 / 56.5 * np.sin(angle)), abs=2e-3)


@pytest.mark.parametrize(("columns", "swing"), [((TIME, SWING), "y"), ((SWING, TIME), "x")])
def test_beside_a_time_that_is_called_x_or_y_the_other_is_an_axis_of_a_graph(take, columns, swing):
    taken = take("x,y\n" + rows(*columns)).attrs["taken"]
    assert f"`{swing}` as rad" in taken and "coordinate" not in taken
