"""Chunks as one dataset: what it says of draws that are alike, of sets of ten, of cells not made; and how little memory it takes."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from made_up import verdicts, write

from swingdown.planning.settings import complete
from swingdown.plots import sweep as plots
from swingdown.sweep.combine import combine, read_maps
from swingdown.sweep.summary import interval, table
from swingdown.sweep.table import sweeps


def sweep(**entry):
    return sweeps(complete({"sweeps": {"one": entry}}))["one"]


def combined(chosen, folder, results):
    combine(chosen, write(chosen, folder, results), folder / "sweep.nc")
    return read_maps(folder / "sweep.nc")


def fits(alike=False, none=()):
    """Made-up fits: the model that was simulated is the best in three of four draws; ``alike``: all draws are the first."""

    def made(settings, first, count):
        fitted = settings["simulation.fitted"]
        at = fitted.index(settings["simulation.simulated"][0])
        draws = np.zeros(count, int) if alike else np.arange(first, first + count)
        found = {
            name: np.full((count, len(fitted)), 2.0) + 1e-6 * draws[:, None]
            for name in ("norm", "residual_norm", "bic")
        }
        for name in ("norm", "bic"):
            found[name][draws % 4 != 3, at] -= 1
            found[name][draws % 4 == 3, at - 1] -= 1
        found["converged"] = np.ones((count, len(fitted)), bool)
        if settings["simulation.snr"] in none:
            return {
                name: values * np.nan if values.dtype.kind == "f" else ~values
                for name, values in found.items()
            }, "no such swing"
        return found, ""

    return made


IDENTIFY = {
    "computes": "identification",
    "axes": {"simulation.simulated": ["viscous"], "simulation.snr": [20, 50]},
    "chunk": 37,
}
DETECT = {"computes": "detection", "axes": {"detection.effect": ["quadratic_drag", "detent"], "detection.size": [0, 1, 5], "detection.noise_rad": [0.001, 0.002]},
          "chunk": 90}  # fmt: skip


def test_draws_that_are_all_alike_count_as_one(tmp_path):
    free = table(combined(sweep(**IDENTIFY, realizations=100), tmp_path / "free", fits()))
    alike = table(combined(sweep(**IDENTIFY, realizations=100), tmp_path / "alike", fits(alike=True)))
    assert free["independent"].tolist() == [100, 100] and alike["independent"].tolist() == [1, 1]
    assert alike["made"].tolist() == [100, 100] and alike["sets_of_ten"].tolist() == [1, 1]
    assert free["true_by_norm"].tolist() == [0.75, 0.75]
    assert (
        free["true_by_norm_low_95"][0]
        == pytest.approx(interval(75, 100)[0])
        == pytest.approx(0.657, abs=1e-3)
    )
    assert alike["true_by_norm_low_95"][0] < 0.25  # one draw says as good as nothing


def test_a_probability_of_sets_of_ten_is_counted_in_sets(tmp_path):
    maps = combined(sweep(**IDENTIFY, realizations=125), tmp_path, fits())
    rows = table(maps)
    assert rows["sets_of_ten"].tolist() == [12, 12] and rows["true_by_ten"].tolist() == [1, 1]
    assert rows["true_by_ten_low_95"][0] == pytest.approx(interval(12, 12)[0])
    assert "12 sets of ten draws a cell" in words(plots.MAPS["by_ten"](maps)) and "125 draws a cell" in words(
        plots.MAPS["by_norm"](maps)
    )


def test_a_cell_that_was_not_made_is_counted_with_its_reason_and_crossed_out(tmp_path):
    maps = combined(sweep(**IDENTIFY, realizations=20), tmp_path / "fits", fits(none=(50,)))
    rows = table(maps)
    assert rows["made"].tolist() == [20, 0] and rows["reason"].tolist() == ["", "no such swing"]
    assert rows["true_by_bic"].isna().tolist() == [False, True] and rows["unconverged"].isna().tolist() == [
        False,
        True,
    ]
    assert "×" in words(plots.MAPS["by_norm"](maps)) and "cannot be made" in words(
        plots.MAPS["by_norm"](maps)
    )
    maps = combined(
        sweep(**DETECT, realizations=20),
        tmp_path / "verdicts",
        verdicts(lambda settings: {"named": 1}, none=("detent",)),
    )
    rows = table(maps).set_index(["effect", "size", "noise_rad"])
    assert rows.loc["detent", 5.0, 0.001]["made"] == 0 and rows.loc["detent", 0.0, 0.001]["made"] == 20
    assert "fewer than twice" in rows.loc["detent", 5.0, 0.001]["reason"]
    assert "cannot be made" in words(plots.detection(maps))


@pytest.mark.parametrize(("share", "reached"), [(0.96, 1), (0.94, 0), (1.04, 1), (1.06, 0)])
def test_a_size_is_reached_by_what_leaves_it_to_a_twentieth(tmp_path, share, reached):
    left = verdicts(lambda settings: {"named": 1}, left=lambda settings: share * settings["detection.size"])
    rows = table(combined(sweep(**DETECT, realizations=20), tmp_path, left))
    assert (rows.loc[rows["size"] > 0, "reached"] == reached).all() and (rows["size"] > 0).any()


def test_the_map_of_verdicts_has_a_panel_for_every_value_and_marks_what_was_not_reached(tmp_path):
    left = verdicts(
        lambda settings: {"nothing": 0.5, "named": 0.5},
        left=lambda settings: min(settings["detection.size"], 4.3),
    )
    maps = combined(sweep(**DETECT, realizations=40), tmp_path, left)
    drawn = plots.detection(maps)
    titles = [panel.get_title("left") for panel in drawn.axes if panel.get_visible()]
    assert titles == [
        f"{effect}\nnoise {noise} rad" for effect in ("quadratic drag", "detent") for noise in (0.001, 0.002)
    ]
    assert words(drawn).count("4.3") == 4 and "no size of the effect leaves as much" in words(drawn)
    assert (table(maps)["reached"] == 0).sum() == 4
    bars = drawn.axes[0].containers
    ends = next(one for one in bars if type(one).__name__ == "ErrorbarContainer").lines[2][0].get_segments()
    low, high = ends[0][:, 1]
    assert low == pytest.approx(0) and high > 5  # none of 40 named is no proof that none ever is


@pytest.mark.parametrize(
    ("start", "said"), [("rest", "fits start at rest"), ("free", "the release is fitted too")]
)
def test_how_fits_start_stands_on_the_map(tmp_path, start, said):
    maps = combined(
        sweep(**IDENTIFY, realizations=10, settings={"simulation.start": start}), tmp_path, fits()
    )
    assert said in words(plots.MAPS["by_norm"](maps))


def test_no_label_of_a_small_map_lies_on_another(tmp_path):
    """Rows of words above narrow maps, on a figure of every kind of size."""
    axes = {"simulation.simulated": ["viscous", "quadratic_drag", "load_coulomb"], "simulation.noise": ["proportional", "additive"],
            "simulation.sampling_rate_hz": [100, 200], "simulation.snr": [5, 10, 20, 50, 100, 200, 500, 1000]}  # fmt: skip
    for name, chosen in {
        "wide": axes,
        "tiny": {"simulation.simulated": ["viscous"], "simulation.snr": [20]},
    }.items():
        maps = combined(
            sweep(computes="identification", axes=chosen, realizations=1, chunk=1000), tmp_path / name, fits()
        )
        drawn = plots.MAPS["by_norm"](maps)
        drawn.canvas.draw()
        for panel in drawn.axes:
            ticks = [
                label
                for label in (*panel.get_xticklabels(), *panel.get_yticklabels())
                if label.get_text() and label.get_visible()
            ]
            boxes = [label.get_window_extent() for label in ticks if label.get_window_extent().width]
            pairs = [(a, b) for k, a in enumerate(boxes) for b in boxes[k + 1 :]]
            assert not any(a.shrunk(0.9, 0.9).overlaps(b.shrunk(0.9, 0.9)) for a, b in pairs), name


def test_what_an_effect_leaves_stands_between_its_bar_and_the_title(tmp_path):
    """Numbers above neighbouring bars of many sizes lie neither on one another nor on the title, in whatever panel they are."""
    sizes = [0, 0.05, 0.1, 0.2, 0.3, 0.5, 1, 2, 5]
    axes = {"detection.effect": ["quadratic_drag", "detent", "backlash"], "detection.size": sizes}
    left = verdicts(
        lambda settings: {"named": 1.0},
        left=lambda settings: (
            settings["detection.size"] * (1.113 if settings["detection.effect"] == "detent" else 1)
        ),
    )
    drawn = plots.detection(
        combined(sweep(computes="detection", axes=axes, realizations=1, chunk=100), tmp_path, left)
    )
    drawn.canvas.draw()
    panel = next(one for one in drawn.axes if one.get_title("left") == "detent")
    numbers = [one.get_window_extent() for one in panel.texts if one.get_text() not in ("", "×")]
    boxes = [*numbers, panel.title.get_window_extent(), panel._left_title.get_window_extent()]
    boxes = [one for one in boxes if one.width]
    assert len(numbers) == 8
    assert not any(a.overlaps(b) for k, a in enumerate(boxes) for b in boxes[k + 1 :])
    assert "1 campaign a bar" in words(drawn)


def test_keys_that_change_together_are_told_together(tmp_path):
    axes = {
        "simulation.simulated": ["viscous"],
        "simulation.release_angle_deg, simulation.duration_s": [[5, 20], [40, 5]],
    }
    maps = combined(sweep(computes="identification", axes=axes, realizations=10, chunk=40), tmp_path, fits())
    assert maps["duration_s"].dims == ("release_angle_deg",) and maps["duration_s"].values.tolist() == [20, 5]
    assert table(maps)[["release_angle_deg", "duration_s"]].values.tolist() == [[5, 20], [40, 5]]


def words(figure):
    """All text of a figure."""
    found = [text.get_text() for text in figure.findobj(lambda one: hasattr(one, "get_text"))]
    return "\n".join(found)


BIG = """
import sys
sys.path.insert(0, {tests!r})
import numpy as np
from pathlib import Path
from made_up import write
from swingdown.planning.settings import complete
from swingdown.sweep.combine import combine
from swingdown.sweep.table import sweeps
entry = {{"computes": "identification", "axes": {{"simulation.simulated": ["viscous"]}}, "realizations": {draws}, "chunk": 200000,
          "settings": {{"simulation.fitted": ["viscous"]}}}}
one = sweeps(complete({{"sweeps": {{"one": entry}}}}))["one"]
folder = Path({folder!r})
if sys.argv[1] == "write":
    def made(settings, first, count):
        draws = np.arange(first, first + count) % 4
        values = 1.0 + (draws == 3)[:, None]
        return {{"norm": values, "residual_norm": values, "bic": values, "converged": np.ones((count, 1), bool)}}, ""
    write(one, folder, made)
else:
    combine(one, sorted((folder / "chunks").glob("*.nc")), folder / "sweep.nc")
    # ru_maxrss would be that of the process which began this one, where it was larger
    status = dict(line.split(":", 1) for line in open("/proc/self/status") if line.startswith("VmHWM"))
    print(int(status["VmHWM"].split()[0]) // 1024)
"""


@pytest.mark.slow("a sweep")
def test_ten_times_the_draws_are_combined_in_the_same_memory(tmp_path):
    """Three doubles a draw: held at once, the larger number would take 41 MB more than the smaller."""
    took = {}
    for draws in (100_000, 1_800_000):
        folder = tmp_path / str(draws)
        script = BIG.format(tests=str(Path(__file__).parent), folder=str(folder), draws=draws)
        subprocess.run([sys.executable, "-c", script, "write"], check=True)
        done = subprocess.run(
            [sys.executable, "-c", script, "combine"], check=True, text=True, capture_output=True
        )
        took[draws] = int(done.stdout)
    assert max(took.values()) < 300 and took[1_800_000] < took[100_000] + 20, took
    with xr.open_dataset(folder / "sweep.nc") as data:
        assert data.sizes["realization"] == draws
        assert float(data["true_by_norm"].squeeze()) == 1 and int(data["independent"].squeeze()) == draws
        assert int(data["realization"][-1]) == draws - 1
        assert float(data["norm"].isel(realization=slice(-4, None)).sel(fitted="viscous").sum()) == 5.0
