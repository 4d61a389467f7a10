"""Logs that say before each number what it is."""

import numpy as np
import pytest

from swingdown.errors import InputError
from swingdown.measurement.recording import ingest
from swingdown.measurement.sheet import read_sheet

TIMES = np.arange(400) * 0.02
ANGLES = 20 * np.exp(-TIMES / 20) * np.cos(4.8 * TIMES)
WORDINGS = {
    "a board's": "Time: {ms:.0f} ms, Angle: {angle:.2f} deg, Raw: 512",
    "a bracket's": "[{t:8.3f}] angle={angle:.2f} deg temp=21.5",
    "JSON, a document a line": '{{"t": {t:.3f}, "angle_deg": {angle:.3f}}}',
    "a clock's": "12:03:{t:06.3f} -> angle (deg): {angle:.2f}",
    "ROS's": "INFO [{t:.3f}] [encoder_node]: angle_deg: {angle:.4f} velocity: 0.25",
    "colons alone": "t:{t:.2f},angle_deg:{angle:.2f},w:0.3",
    "words alone": "t {t:.2f} angle_deg {angle:.3f} battery 3.9",
    "stamps": '{{"time": "2024-03-01T11:00:{t:06.3f}Z", "angle_deg": {angle:.3f}}}',
}


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def read(here, text, ending):
    (here / f"swing.{ending}").write_text(text, encoding="utf-8")
    (here / "sheet.csv").write_text(f"recording,file\nswing,swing.{ending}\n")
    return ingest(read_sheet("sheet.csv").loc["swing"], "sheet.csv")


@pytest.mark.parametrize("wording", WORDINGS.values(), ids=WORDINGS)
def test_each_number_is_what_its_word_says(here, wording):
    lines = [wording.format(t=t, ms=1000 * t, angle=angle) for t, angle in zip(TIMES, ANGLES, strict=True)]
    ending = "json" if wording.startswith("{") else "log"
    found = read(here, "\n".join([*["booting ..."] * (ending == "log"), *lines]), ending)
    assert found.sizes["time"] == TIMES.size and "a word beside each number" in found.attrs["taken"]
    assert np.allclose(np.diff(found["time"]), 0.02, atol=2e-3)
    assert np.abs(found["signal"] - ANGLES).max() < 0.01


def test_a_line_that_was_cut_is_a_missing_sample(here):
    lines = [f"t={t:.2f} angle_deg={angle:.2f}" for t, angle in zip(TIMES, ANGLES, strict=True)]
    lines[100] = lines[100][:9]
    found = read(here, "\n".join(lines), "log")
    assert found.sizes["time"] == TIMES.size - 1 and "missing" in found.attrs["remarks"]


def test_all_words_before_a_number_name_it(here):
    """An acceleration is none of the positions, and the unit of the number before is no part of a name."""
    lines = [
        f"Time: {t:.2f}, Angular acceleration X: {a:.3f}, Angular acceleration y: 1.57"
        for t, a in zip(TIMES, ANGLES, strict=True)
    ]
    with pytest.raises(InputError, match="Angular acceleration X"):
        read(here, "\n".join(lines), "log")
    lines = [
        f"Time: {t:.2f} s Pendulum angle: {a:.3f} deg Battery level: 3.9"
        for t, a in zip(TIMES, ANGLES, strict=True)
    ]
    found = read(here, "\n".join(lines), "log")
    assert found.attrs["taken"].startswith("took `Pendulum angle (deg)` as degrees, `Time (s)` as s")


@pytest.mark.parametrize("lost", [slice(98, 99), slice(98, 100)], ids=["a line", "all but the first"])
def test_a_record_over_several_lines_is_a_row(here, lost):
    """As a library's example prints an inertial sensor: the words stand before the first axis, the unit behind the last."""
    rates = np.gradient(np.radians(ANGLES), 0.02)
    lines = ["Found!"]
    for angle, rate in zip(np.radians(ANGLES), rates, strict=True):
        lines += [
            f"Acceleration X: {9.81 * np.sin(angle):.2f}, Y: 0.11, Z: {9.81 * np.cos(angle):.2f} m/s^2",
            f"Rotation X: 0.01, Y: {rate:.3f}, Z: -0.02 rad/s",
            "Temperature: 24.5 degC",
            "",
        ]
    del lines[lost]  # of this record the rotation is lost
    (here / "swing.log").write_text("\n".join(lines))
    (here / "sheet.csv").write_text(
        "recording,file,rate_hz,signal_column\nswing,swing.log,50,Rotation Y (rad/s)\n"
    )
    found = ingest(read_sheet("sheet.csv").loc["swing"], "sheet.csv")
    assert "1 of 400 cells" in found.attrs["remarks"] and "an angular rate" in found.attrs["taken"]
    kept = np.delete(rates, 24)
    assert np.abs(found["signal"] - kept).max() < 1e-3


def test_what_stands_above_the_first_line_hides_no_names(here):
    lines = ["sensor ready", *(f"AcX = {a:.2f} | AcZ = {2 * a:.3f}" for a in ANGLES)]
    with pytest.raises(InputError, match="AcX, AcZ"):
        read(here, "\n".join(lines), "log")


def test_a_number_without_a_word_has_its_place_for_a_name(here):
    lines = [f"{t:.2f}, angle_deg: {a:.3f}" for t, a in zip(TIMES, ANGLES, strict=True)]
    found = read(here, "\n".join(lines), "log")
    assert found.attrs["taken"].startswith("took `angle_deg` as degrees, `column 1` as s")


@pytest.mark.parametrize(("others", "told"), [(90, True), (115, False)])
def test_lines_are_a_table_where_four_in_five_have_one_wording(here, others, told):
    """Of 400 lines that say what each number is, beside some that say it otherwise."""
    lines = [f"t={t:.2f} angle_deg={a:.3f}" for t, a in zip(TIMES, ANGLES, strict=True)]
    more = [f"{'watch battery level'[: 5 + k % 14]} {k % 7}: {k} percent" for k in range(others)]
    if told:
        assert read(here, "\n".join([*lines, *more]), "log").sizes["time"] == TIMES.size
    else:
        with pytest.raises(InputError):
            read(here, "\n".join([*lines, *more]), "log")
