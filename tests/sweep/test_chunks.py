"""How work is dealt does not matter to the numbers, and what is dealt stays dealt when the table grows."""

import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from swingdown import dataset
from swingdown.errors import InputError
from swingdown.planning.settings import complete
from swingdown.sweep.chunks import add_to_book, deal, find_chunk
from swingdown.sweep.combine import combine, read_maps
from swingdown.sweep.compute import _took
from swingdown.sweep.job import record
from swingdown.sweep.job import work as job
from swingdown.sweep.summary import intervals, table
from swingdown.sweep.table import sweeps


def sweep(snr=(20, 50), realizations=12, chunk=10, axes=None):
    """A small sweep of identification: two terms, short swings."""
    axes = {"simulation.simulated": ["viscous", "load_coulomb"], "simulation.snr": list(snr)} | (axes or {})
    settings = {
        key: value
        for key, value in {"simulation.duration_s": 2.5, "simulation.start": "free"}.items()
        if key not in axes
    }
    entry = {
        "computes": "identification",
        "axes": axes,
        "realizations": realizations,
        "chunk": chunk,
        "settings": settings,
    }
    return sweeps(complete({"sweeps": {"small": entry}}))["small"]


def work(chosen, folder):
    """The combined dataset of a sweep run in a folder, and the names of the chunks that had to be computed."""
    book, computed = folder / "plan.jsonl", []
    dealt = deal(chosen, book)
    add_to_book(book, dealt.new)
    paths = [folder / "chunks" / f"{name}.nc" for name in dealt.chunks]
    for path in paths[::-1]:  # in another order than that of the book
        if not path.exists():
            job(book, path.stem, path)
            computed.append(path.stem)
    combine(chosen, paths, folder / "sweep.nc")
    return xr.load_dataset(folder / "sweep.nc"), computed


@pytest.fixture(scope="module")
def reference(tmp_path_factory):
    """The small sweep in chunks of ten draws."""
    return work(sweep(), tmp_path_factory.mktemp("ten"))


@pytest.mark.parametrize("chunk", [1000, 7, 1])
def test_the_numbers_are_the_same_to_the_bit_for_any_chunk_length(reference, tmp_path, chunk):
    xr.testing.assert_identical(work(sweep(chunk=chunk), tmp_path)[0], reference[0])


def test_every_draw_is_dealt_once_in_chunks_of_the_length_asked_for(reference, tmp_path):
    dealt = deal(sweep(), tmp_path / "none")
    assert [chunk.draws for chunk in dealt.chunks.values()] == [10, 10, 10, 10, 8]
    draws = [
        (key, k)
        for chunk in dealt.chunks.values()
        for _, key, first, count in chunk.cells()
        for k in range(first, first + count)
    ]
    assert len(draws) == len(set(draws)) == 48


@pytest.mark.parametrize(
    ("wider", "draws"),
    [
        ({"realizations": 20}, 32),
        ({"snr": (20, 35, 50)}, 24),
        ({"snr": (5, 20, 50), "realizations": 15}, 42),
        ({"axes": {"simulation.duration_s": [2.5, 3.0]}}, 48),
        ({"chunk": 3}, 0),
        ({"snr": (50, 20)}, 0),
    ],
)
def test_a_wider_table_computes_only_what_is_new(tmp_path, wider, draws):
    folder, fresh = tmp_path / "grown", tmp_path / "fresh"
    before, _ = work(sweep(), folder)
    grown = sweep(**wider)
    new = deal(grown, folder / "plan.jsonl").new
    assert sum(chunk.draws for chunk in new) == draws
    after, computed = work(grown, folder)
    assert len(computed) == len(new)
    xr.testing.assert_identical(after, work(grown, fresh)[0])
    shared = after.sel(snr=before["snr"]).isel(realization=slice(0, 12))
    shared = shared.sel(duration_s=2.5) if "duration_s" in shared.dims else shared
    assert np.array_equal(shared["norm"].values, before["norm"].values)


def test_a_lost_chunk_is_the_only_one_computed_again(tmp_path, reference):
    _, first = work(sweep(), tmp_path)
    (tmp_path / "chunks" / f"{first[2]}.nc").unlink()
    again, computed = work(sweep(), tmp_path)
    assert computed == [first[2]]
    xr.testing.assert_identical(again, reference[0])


def test_a_table_made_smaller_before_it_was_computed_leaves_no_work_that_nobody_wants(tmp_path):
    book = tmp_path / "plan.jsonl"
    large = deal(sweep(snr=(5, 20, 50), realizations=30), book)
    add_to_book(book, large.new)
    small = deal(sweep(), book)
    assert sum(chunk.draws for chunk in small.chunks.values()) == 48
    add_to_book(book, small.new)
    assert deal(sweep(), book).new == () and set(deal(sweep(), book).chunks) == set(small.chunks)
    made, _ = work(sweep(), tmp_path)
    again, _ = work(
        sweep(snr=(5, 20, 50), realizations=30), tmp_path
    )  # and large once more: nothing twice, nothing lost
    assert np.array_equal(again["norm"].sel(snr=[20, 50]).values[:, :, :12], made["norm"].values)


def test_the_dataset_has_axes_for_dimensions_units_settings_and_seeds(reference):
    data = reference[0]
    assert data["norm"].dims == ("simulated", "snr", "realization", "fitted")
    assert data["norm"].notnull().all() and data["converged"].all()
    assert data["snr"].attrs["config_key"] == "simulation.snr" and data["snr"].attrs["units"] == "1"
    for name, variable in data.variables.items():
        assert variable.dtype.kind != "f" or variable.attrs["units"], name
    assert "simulation.duration_s: 2.5" in data.attrs["settings"] and data.attrs["seed"] == 150
    assert len(set(data["noise_key"].values.ravel())) == 4
    assert data.attrs["complete"] == 1


def test_a_draw_can_be_made_again_from_what_the_file_says(reference):
    """By numpy alone: the seed, the cell's key, the draw's index; then the noise's formula and the fit."""
    from swingdown.engine.trajectory import simulate
    from swingdown.fitting.least_squares import fit_trajectory
    from swingdown.pendulum.model import Model

    cell = reference[0].sel(simulated="load_coulomb", snr=20)
    key = str(cell["noise_key"].values)
    words = [int(key[k : k + 8], 16) for k in range(0, 32, 8)]
    normals = np.random.default_rng(np.random.SeedSequence(150, spawn_key=(*words, 7))).standard_normal(251)
    times = np.arange(251) / 100
    truth = simulate(
        Model("load_coulomb", {"natural_frequency": 7.25, "load_friction": 0.012}), times, np.radians(20)
    )
    fit = fit_trajectory("load_coulomb", times, truth + np.abs(truth) / 20 * normals)
    told = cell.sel(fitted="load_coulomb", realization=7)
    assert np.degrees(fit.rms) == pytest.approx(float(told["residual_norm"]), rel=1e-8)
    assert np.degrees(np.sqrt(np.mean((fit.angle - truth) ** 2))) == pytest.approx(
        float(told["norm"]), rel=1e-4
    )
    assert fit.bic == pytest.approx(float(told["bic"]), rel=1e-8)


def test_a_larger_model_never_leaves_more(reference):
    left = reference[0]["residual_norm"]
    for larger, smaller in (
        ("viscous+load_coulomb", "viscous"),
        ("viscous+quadratic_drag+load_coulomb", "viscous+load_coulomb"),
    ):
        assert (left.sel(fitted=larger) <= left.sel(fitted=smaller) * (1 + 1e-8)).all()


def test_the_probabilities_are_counts_of_the_draws(tmp_path, reference):
    data = reference[0].sel(simulated="viscous", snr=20)
    lowest = data["fitted"].values[data["norm"].argmin("fitted").values]
    assert float(data["true_by_norm"]) == np.mean(lowest == "viscous")
    four = ["viscous", "quadratic_drag", "load_coulomb", "quadratic_drag+load_coulomb"]
    of_ten = data["norm"].sel(fitted=four).isel(realization=slice(0, 10)).mean("realization")
    assert float(data["true_by_ten"]) == (of_ten.values.argmin() == 0)
    assert float(data["lowest_bic"].sum()) == pytest.approx(1)
    work(sweep(), tmp_path)
    rows = table(read_maps(tmp_path / "sweep.nc"))
    assert len(rows) == 4 and (rows["draws"] == 12).all()
    row = rows.set_index(["simulated", "snr"]).loc[("viscous", 20.0)]
    assert row["true_by_norm_low_95"] < row["true_by_norm"] + 1e-12 < row["true_by_norm_high_95"] + 2e-12
    assert (
        (rows["made"] == 12).all() and (rows["independent"] == 12).all() and (rows["sets_of_ten"] == 1).all()
    )


def test_an_interval_is_of_95_per_cent_and_open_at_its_ends():
    low, high = intervals(np.array([0.0, 1.0, 0.5, np.nan]), 100)
    z = 1.959964
    assert low[0] == pytest.approx(0, abs=1e-12) and high[0] == pytest.approx(z**2 / (100 + z**2))
    assert low[2] == pytest.approx(0.5 - z / 2 / np.sqrt(100 + z**2)) and high[1] == pytest.approx(1)
    assert np.isnan(low[3]) and np.isnan(high[3])
    assert intervals(0.5, 2)[1] - intervals(0.5, 2)[0] > 0.8


def test_missing_and_doubled_draws_are_refused_by_name(tmp_path):
    chosen = sweep()
    _, names = work(chosen, tmp_path)
    paths = [tmp_path / "chunks" / f"{name}.nc" for name in names]
    with pytest.raises(
        InputError, match=r"10 of 48 draws are in no chunk, first draw \d+ of simulated viscous, snr"
    ):
        combine(chosen, paths[:-1], tmp_path / "none.nc")
    with pytest.raises(InputError, match="are in another chunk too"):
        combine(chosen, [*paths, paths[0]], tmp_path / "none.nc")
    assert not (tmp_path / "none.nc").exists() and not list(tmp_path.glob(".*"))


def test_more_jobs_than_a_workflow_bears_are_refused_with_the_length_that_fits(tmp_path):
    with pytest.raises(InputError) as told:
        deal(sweep(realizations=100_000, chunk=10), tmp_path / "none")
    assert "at most 2000" in str(told.value) and "`chunk: 400`" in told.value.mend
    assert len(deal(sweep(realizations=100_000, chunk=400), tmp_path / "none").chunks) <= 2000


def test_a_damaged_book_is_told_by_line(tmp_path):
    book = tmp_path / "plan.jsonl"
    add_to_book(book, deal(sweep(), book).new)
    book.write_text(book.read_text().replace("20.0", "21.0", 1))
    with pytest.raises(InputError, match="plan.jsonl, line 1"):
        deal(sweep(), book)
    with pytest.raises(InputError, match="no chunk"):
        find_chunk(book, "0" * 16)


def test_what_an_earlier_release_computed_is_kept_and_told_as_of_unknown_code(tmp_path):
    _, names = work(sweep(), tmp_path)
    book = tmp_path / "plan.jsonl"
    dealt = deal(sweep(), book, "01234567")
    assert dealt.missing == () and set(dealt.outdated) == set(names) and dealt.files[names[0]] == names[0]
    again = deal(sweep(), book, "01234567", again=True)
    assert set(again.missing) == set(names) and again.files[names[0]] == f"{names[0]}-01234567"
    (tmp_path / "chunks" / f"{names[0]}.nc").rename(tmp_path / "chunks" / f"{names[0]}-01234567.nc")
    assert deal(sweep(), book, "01234567").files[names[0]] == f"{names[0]}-01234567"
    assert set(deal(sweep(), book, "01234567").outdated) == set(names[1:])


def test_the_first_of_two_jobs_with_one_chunk_is_kept(tmp_path):
    """As where a run resumes beside jobs of the one before it."""
    _, names = work(sweep(), tmp_path)
    path = tmp_path / "chunks" / f"{names[0]}.nc"
    before = path.stat()
    data = dataset.read(path)
    with pytest.raises(FileExistsError):
        dataset.write(data, path, replace=False)
    assert (path.stat().st_ino, path.stat().st_mtime_ns) == (before.st_ino, before.st_mtime_ns)
    dataset.write(data, path.with_name("other.nc"), replace=False)
    assert sorted(one.name for one in path.parent.iterdir()) == sorted(
        [*(f"{name}.nc" for name in names), "other.nc"]
    )


def test_code_that_changes_under_a_run_stops_its_jobs(tmp_path):
    dealt = deal(sweep(), tmp_path / "plan.jsonl", "01234567")
    add_to_book(tmp_path / "plan.jsonl", dealt.new)
    said = set()
    for stem in dealt.files.values():
        with pytest.raises(InputError, match="the code was changed since the run began") as caught:
            job(tmp_path / "plan.jsonl", stem, tmp_path / "chunks" / f"{stem}.nc")
        said.add(str(caught.value))
    assert len(dealt.files) > 1 and len(said) == 1  # so that a run tells it once
    assert not (tmp_path / "chunks").exists()


def test_a_job_finds_a_chunk_that_is_whole_and_its_record_says_what_it_took(tmp_path):
    chunk = tmp_path / "0123456789abcdef-0a1b2c3d.nc"
    dataset.write(xr.Dataset(attrs={"computes": "identification", "code": "0a1b2c3d", "cpu_s": 1.5}), chunk)
    assert job(tmp_path / "no-book.jsonl", chunk.stem, chunk) == f"{chunk.stem} is whole already"
    text = Path(record(chunk, tmp_path / "jobs" / "record.json")).read_text()
    told = json.loads(text)
    assert (told["computes"], told["code"], told["cpu_s"]) == ("identification", "0a1b2c3d", 1.5)
    assert "swingdown" not in told and text.startswith("{") and text.split("}", 1)[1].startswith("\n")


def test_what_a_chunk_took_is_told_for_each_fit():
    chunk, fits = SimpleNamespace(draws=40), SimpleNamespace(DIMENSION="model")
    assert _took(chunk, 4, 80, 0.2, fits).startswith(
        "4 cells, 40 draws, 80 fits: 0.20 s of CPU, 2.5 ms each, "
    )
    assert "10 verdicts: 0.20 s of CPU, 20 ms each" in _took(chunk, 4, 10, 0.2, SimpleNamespace(DIMENSION=""))
