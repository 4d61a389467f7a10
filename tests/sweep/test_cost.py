"""What a sweep will take is told before it is run: counted, timed, and with the cells that cannot be made."""

from types import SimpleNamespace

import pytest

from swingdown.errors import InputError
from swingdown.planning.settings import complete
from swingdown.sweep import cost
from swingdown.sweep.chunks import deal
from swingdown.sweep.table import sweeps


def sweep(computes="identification", axes=None, **entry):
    axes = axes or {"simulation.simulated": ["viscous", "load_coulomb"], "simulation.snr": [20, 50]}
    entry = {"computes": computes, "axes": axes, "realizations": 12, "chunk": 10} | entry
    return sweeps(complete({"sweeps": {"small": entry}}))["small"]


class Clocked:
    """A computation of a known price: seconds a cell, and seconds a draw, on a clock that goes by nothing else."""

    def __init__(self, monkeypatch, a_cell, a_draw, dimension):
        self.a_cell, self.a_draw, self.DIMENSION, self.now, self.cells = a_cell, a_draw, dimension, 0.0, []
        monkeypatch.setattr(cost, "time", SimpleNamespace(process_time=lambda: self.now))

    def results(self, settings, first, count):
        shared = self.DIMENSION and settings in self.cells  # what the draws of a cell share is kept
        self.cells.append(settings)
        self.now += (0.0 if shared else self.a_cell) + count * self.a_draw

    def foresee(self, settings):
        self.now += 0.1
        if settings["simulation.snr"] == 20:
            raise InputError("engine", "no such swing", "another")


@pytest.mark.parametrize("dimension", ["fitted", None])
def test_a_trial_tells_the_time_of_a_cell_and_of_a_draw(monkeypatch, dimension):
    a_cell, a_draw = cost.seconds(sweep(), Clocked(monkeypatch, 0.02, 0.003, dimension))
    assert a_draw == pytest.approx(0.003)
    assert a_cell == pytest.approx(0.02, abs=0.0031 if dimension else 1e-9)


def test_draws_that_take_no_time_take_none(monkeypatch):
    assert cost.seconds(sweep(), Clocked(monkeypatch, 0.02, 0.0, None)) == pytest.approx((0.02, 0.0))


def test_a_trial_of_slow_cells_ends_with_the_first(monkeypatch):
    slow = Clocked(monkeypatch, 0.5, 0.4, None)
    assert cost.seconds(sweep(), slow) == pytest.approx((0.0, 0.9))
    assert len(slow.cells) == 1


def test_a_trial_ends_when_its_time_is_over(monkeypatch):
    some = Clocked(monkeypatch, 0.2, 0.01, None)  # 0.43 s a cell
    cost.seconds(sweep(), some)
    assert len(some.cells) == 4  # two cells of the four, twice each


def told(of, plan, missing=None):
    return list(cost.estimate(of, plan, list(plan.missing) if missing is None else missing))


def test_what_is_to_be_computed_is_counted_in_fits_chunks_and_bytes(tmp_path, monkeypatch):
    of = sweep(settings={"simulation.fitted": ["viscous", "load_coulomb"]})
    monkeypatch.setattr(cost, "seconds", lambda *_: (1.0, 0.5))
    plan = deal(of, tmp_path / "plan.jsonl")
    first, second = told(of, plan)
    assert first == "sweep small: 4 cells × 12 draws = 96 fits in 5 chunks (0.0 MB)"
    parts = sum(len(chunk.parts) for chunk in plan.chunks.values())
    assert second == (
        f"  to compute: 96 fits in 5 chunks, {parts + 24:g} s of CPU at {1e3 * (parts + 24) / 96:.3g} ms a fit (timed just now), "
        f"{(parts + 24) / 5:.3g} s a chunk"
    )
    assert told(of, plan, [])[1:] == ["  every chunk is there"]


def test_a_large_sweep_tells_how_much_disk_it_takes(tmp_path, monkeypatch):
    """26 bytes a fit: of 4 cells, 50 000 draws and two models."""
    of = sweep(settings={"simulation.fitted": ["viscous", "load_coulomb"]}, realizations=50_000, chunk=20_000)
    monkeypatch.setattr(cost, "seconds", lambda *_: (1.0, 0.5))
    first, _ = told(of, deal(of, tmp_path / "plan.jsonl"))
    assert first.startswith("sweep small: 4 cells × 50,000 draws = 400,000 fits") and first.endswith(
        "(10.4 MB)"
    )


def test_verdicts_are_called_so_and_long_times_are_told_in_minutes_and_hours(tmp_path, monkeypatch):
    of = sweep("detection", {"detection.size": [0, 2]}, realizations=100, chunk=50)
    plan = deal(of, tmp_path / "plan.jsonl")
    monkeypatch.setattr(cost, "foreseen", lambda *_: [])
    for a_draw, took in ((0.5, "100 s"), (1.0, "3.33 min"), (60.0, "3.33 h")):
        monkeypatch.setattr(cost, "seconds", lambda *_, a_draw=a_draw: (0.0, a_draw))
        assert f"200 verdicts in 4 chunks, {took} of CPU" in told(of, plan)[1]


def test_chunks_of_other_code_are_told_with_the_way_to_compute_them_again(tmp_path, monkeypatch):
    of = sweep()
    plan = deal(of, tmp_path / "plan.jsonl")
    assert list(cost.outdated(plan)) == []
    names = list(plan.chunks)
    (line,) = cost.outdated(SimpleNamespace(chunks=plan.chunks, outdated={names[0]: "0123abcd", names[1]: ""}))  # fmt: skip
    assert line.startswith("  2 of 5 chunks were computed by other code (0123abcd, unknown) and are kept")
    assert "recompute=true" in line


def test_cells_that_cannot_be_made_are_told_with_their_reason_and_the_first_of_them(monkeypatch):
    of = sweep(axes={"simulation.simulated": ["viscous"], "simulation.snr": [20, 50]})
    (line,) = cost.foreseen(of, Clocked(monkeypatch, 0.0, 0.0, "fitted"))
    assert line.startswith("  cannot be made: 1 of 2 cells tried (2 in all): no such swing (the first: ")
    assert "simulation.snr 20.0" in line


def test_cells_are_tried_for_half_a_second_those_of_the_largest_effects_first(monkeypatch):
    sizes = list(range(1, 21))
    tried = []
    of = sweep("detection", {"detection.size": sizes})
    clocked = Clocked(monkeypatch, 0.0, 0.0, None)

    def foresee(settings):
        clocked.now += 0.1
        tried.append(settings["detection.size"])

    clocked.foresee = foresee
    assert list(cost.foreseen(of, clocked)) == []
    assert tried == [float(size) for size in sizes[:-7:-1]]
