"""In a notebook: one object from a file to a simulation, units and masks as arrays bring them, and what a cell shows."""

import subprocess
import sys
import warnings

import numpy as np
import pandas as pd
import pint
import pytest
import xarray as xr

import swingdown
from swingdown.engine.trajectory import simulate as trajectory
from swingdown.errors import InputError
from swingdown.paths import PROJECT

EXAMPLE = PROJECT / "resources/example/anna.csv"
TIMES = np.arange(1201) / 100
VALUES = {"natural_frequency": 7.25, "viscous_ratio": 0.008}
UNITS = pint.UnitRegistry()
FEW = {"fitted": ["viscous"]}


@pytest.fixture(scope="module")
def swing():
    return swingdown.simulate("viscous", TIMES, 0.35, noise=0.002, seed=3, **VALUES)


@pytest.fixture(scope="module")
def plain(swing):
    return swingdown.fit(TIMES, swing.values, **FEW)


@pytest.fixture
def file(swing, tmp_path):
    path = tmp_path / "anna.csv"
    pd.DataFrame({"Time (s)": TIMES, "Angle (°)": np.degrees(swing.values)}).to_csv(path, index=False)
    return path


def test_one_object_goes_from_a_file_to_a_simulation(file, plain):
    recording = swingdown.read(file)
    assert "anna.csv: took `Angle (°)` as degrees" in repr(recording) and "1201 samples in 12 s" in repr(
        recording
    )
    answer = recording.fit(**FEW)
    assert answer["period"].value == pytest.approx(plain["period"].value, rel=1e-9)
    assert (
        answer.model.label == "viscous"
        and answer.model.values["viscous_ratio"] == answer["viscous_ratio"].value
    )
    assert answer.model.standard_errors["viscous_ratio"] == pytest.approx(answer["viscous_ratio"].u)
    again = answer.simulate()
    left = recording.to_xarray()["angle"].values - again.values
    assert np.std(left) == pytest.approx(0.002, rel=0.1)
    part = answer.simulate(TIMES[300:400])
    assert np.allclose(part.values, again.values[300:400], atol=1e-8)
    assert float(answer.simulate([0, 1], angle=0.1)[0]) == pytest.approx(0.1)
    assert (
        swingdown.fit(recording, **FEW)["period"] == swingdown.fit(file, **FEW)["period"] == answer["period"]
    )


def test_a_swing_goes_on_from_where_it_was_recorded_and_not_before(plain):
    with pytest.raises(InputError, match="before the recording does.*give an angle"):
        plain.simulate([-0.5, 1.0])
    assert plain.simulate([-0.5, 1.0], angle=0.1).values[0] == pytest.approx(0.1)


def test_after_an_explanation_the_simulation_is_that_of_the_model_it_ended_with(file):
    recording = swingdown.read(file)
    answer = recording.explain(base=["viscous"], rounds=1, **FEW)
    assert answer.verdict["status"] == "consistent"
    assert answer.model.values["natural_frequency"] == answer["natural_frequency"].value
    left = recording.to_xarray()["angle"].values - answer.simulate().values
    assert np.std(left) == pytest.approx(0.002, rel=0.1)


def test_several_files_are_one_pendulum_and_each_goes_on_as_it_began(tmp_path):
    for k, angle in enumerate((0.35, 0.2)):
        one = swingdown.simulate("viscous", TIMES, angle, noise=0.002, seed=k, **VALUES)
        pd.DataFrame({"t": TIMES, "Angle (rad)": one.values}).to_csv(tmp_path / f"{k}.csv", index=False)
    recording = swingdown.read([tmp_path / "0.csv", tmp_path / "1.csv"])
    answer = recording.fit(**FEW)
    assert answer.simulate(recording="0").values[0] == pytest.approx(0.35, abs=0.002)
    assert answer.simulate(recording="1").values[0] == pytest.approx(0.2, abs=0.002)
    table = recording.to_dataframe()
    assert list(table) == ["recording", "time_s", "angle_rad"] and list(table["recording"].unique()) == [
        "0",
        "1",
    ]
    with pytest.raises(InputError, match="none of that name"):
        answer.simulate(recording="anna")


def test_a_list_of_files_or_of_recordings_is_several_swings(tmp_path):
    files = [tmp_path / "a" / "0.csv", tmp_path / "b" / "0.csv"]
    for file, angle in zip(files, (0.35, 0.2), strict=True):
        one = swingdown.simulate("viscous", TIMES, angle, noise=0.002, seed=1, **VALUES)
        file.parent.mkdir()
        pd.DataFrame({"t": TIMES, "phi": np.degrees(one.values)}).to_csv(file, index=False)
    told = {"unit": "deg", "length": "0.1867±0.0001"}
    as_read = swingdown.read(files, **told).fit(**FEW)
    listed = swingdown.fit(list(map(str, files)), **told, **FEW)
    each = [swingdown.read(file, **told) for file in files]
    joined = swingdown.fit(each, **FEW)
    assert list(listed.table["recording"]) == list(joined.table["recording"]) == ["0", "0-2", "(joint)"]
    for name in ("period", "g"):
        assert listed[name] == joined[name] == as_read[name]
    assert (
        swingdown.fit(each[:1], **FEW)["period"] == swingdown.fit(tuple(files[:1]), **told, **FEW)["period"]
    )
    found = swingdown.explain(files, base=["viscous"], rounds=0, **told, **FEW)
    assert found.verdict["status"] == "consistent" and len(found.swings) == 2
    with pytest.raises(InputError, match="not all of them are of one kind.*read the files"):
        swingdown.fit([each[0], files[1]])
    wheel = swingdown.read(files[1], restoring="linear", **told)
    with pytest.raises(InputError, match="others of a wheel.*one restoring"):
        swingdown.fit([each[0], wheel])


def test_swings_without_names_are_numbered_where_there_are_several(plain, swing):
    lower = swingdown.simulate("viscous", TIMES, 0.25, noise=0.002, seed=4, **VALUES)
    both = swingdown.fit([TIMES, TIMES], [swing.values, lower.values], **FEW)
    assert list(plain.table["recording"]) == ["swing"]
    assert list(both.table["recording"]) == ["swing 1", "swing 2", "(joint)"]


def test_a_quantity_has_value_uncertainty_and_unit_and_prints_as_one_writes_it(plain):
    period = plain.quantities["period"]
    value, uncertainty, unit = period
    assert (period.value, period.u, period.unit) == (value, uncertainty, unit) and unit == "s"
    assert float(period) == value
    assert str(period) == repr(period) == f"{plain.row['period_s_text']} s"
    assert str(plain["quality"]) == plain.row["quality_text"]
    with pytest.raises(InputError, match="period, natural_frequency, quality"):
        plain["periode"]


def test_a_quantity_is_a_number_of_uncertainties_where_that_is_installed(plain):
    uncertainties = pytest.importorskip("uncertainties")
    found = 2 * plain["period"].ufloat
    assert isinstance(found, uncertainties.core.AffineScalarFunc)
    assert found.std_dev == pytest.approx(2 * plain["period"].u)


def as_array(swing, **attributes):
    return xr.DataArray(swing.values, {"time": ("time", 1e3 * TIMES, attributes)}, attrs={"units": "rad"})


@pytest.mark.parametrize(
    "given",
    [
        lambda s: (as_array(s, units="ms"),),
        lambda s: (as_array(s, units="milliseconds").to_dataset(name="angle"),),
        lambda s: (1e3 * TIMES * UNITS.ms, np.degrees(s.values) * UNITS.degree),
        lambda s: (TIMES / 60 * UNITS.minute, s.values * UNITS.radian),
        lambda s: (
            pd.Series(np.degrees(s.values), pd.Index(1e3 * TIMES, name="t (ms)"), name="angle (deg)"),
        ),
        lambda s: (pd.DataFrame({"t (us)": 1e6 * TIMES, "Angle (°)": np.degrees(s.values)}),),
        lambda s: (xr.DataArray(s.values * UNITS.radian, {"time": TIMES}),),
        lambda s: (s,),
    ],
    ids=["ms", "dataset", "pint", "minutes", "series", "frame", "pint-in-xarray", "simulated"],
)
def test_units_are_those_that_the_arrays_bring_along(swing, plain, given):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pint.UnitStrippedWarning)
        found = swingdown.fit(*given(swing), **FEW)
    for name, (value, error, _) in plain.quantities.items():
        assert abs(found[name].value - value) < 1e-3 * error, name


@pytest.mark.parametrize("of_times", [False, True])
def test_masked_samples_are_missing_samples(swing, plain, of_times):
    masked = np.zeros(TIMES.size, bool)
    masked[300:310] = True
    wrong = np.where(masked, 99.0, TIMES if of_times else swing.values)
    wrong = np.ma.masked_array(wrong, masked)
    found = swingdown.fit(wrong, swing.values, **FEW) if of_times else swingdown.fit(TIMES, wrong, **FEW)
    assert "10 of 1201 samples hold no number: missing" in found.remarks[0]
    assert "10 of 1201 samples are missing" not in str(found)  # it is said once
    assert abs(found["period"].value - plain["period"].value) < plain["period"].u


def test_gaps_of_a_table_are_missing_samples(swing, plain):
    series = pd.Series(swing.values, TIMES).astype("Float64")
    series.iloc[300:310] = pd.NA
    found = swingdown.fit(series, **FEW)
    assert "10 of 1201 samples hold no number" in found.remarks[0]


@pytest.mark.parametrize(
    ("given", "told"),
    [
        (lambda s: (TIMES * UNITS.metre, s.values), "the times: their unit is 'meter'. Expected: s"),
        (lambda s: (TIMES, s.values * UNITS.metre), "the angles: their unit is 'meter'"),
        (lambda s: (as_array(s, units="m"),), "the times: their unit is 'm'"),
        (lambda s: (TIMES, ["a"] * TIMES.size), "the angles: they are no numbers"),
        (lambda s: (TIMES, s.values * 1j), "complex"),
        (lambda s: ("nowhere.csv",), "there is no such file"),
        (lambda s: (TIMES, "anna.csv"), "swingdown.read"),
    ],
    ids=["metres", "metres-angle", "metres-xarray", "texts", "complex", "no-file", "path-as-angles"],
)
def test_what_cannot_be_taken_is_told_in_the_words_of_the_call(swing, given, told):
    with pytest.raises(InputError, match=told):
        swingdown.fit(*given(swing), **FEW)


def test_a_file_asks_for_arguments_and_not_for_cells_of_a_sheet(file, swing):
    bare = file.with_name("bare.txt")
    bare.write_text("\n".join(f"{x:.5f}" for x in swing.values) + "\n")
    with pytest.raises(InputError, match="rate=") as refused:
        swingdown.read(bare)
    assert "sheet" not in str(refused.value) and "--" not in str(refused.value)
    assert swingdown.read(bare, rate=100, unit="rad").fit(**FEW)["period"].value == pytest.approx(
        0.8733, abs=2e-3
    )
    with pytest.raises(InputError, match="say unit="):
        swingdown.read(file, units="deg")


@pytest.mark.parametrize(
    ("argument", "value", "mend"),
    [
        ("unit", "furlong", "use one of these"),
        ("unit", "degg", "write 'deg"),
        ("time_unit", "sec", "write 's'"),
        ("kind", "swings", "write 'swing'"),
    ],
)
def test_a_value_that_an_argument_cannot_have_is_refused_with_those_that_it_can(file, argument, value, mend):
    with pytest.raises(InputError, match=f"argument {argument}: it is '{value}'. Expected: .* Mend: {mend}"):
        swingdown.read(file, **{argument: value})


def test_a_file_with_several_runs_asks_which(file):
    part = pd.read_csv(file)
    table = pd.concat([part.add_suffix(f" Run #{k}") for k in (1, 2)], axis=1)
    table.to_csv(file, index=False)
    with pytest.raises(InputError, match="2 runs: Run #1, Run #2.*say run='Run #1'"):
        swingdown.read(file)
    assert len(swingdown.read(file, run="Run #2").swings) == 1


def test_a_stated_length_gives_g(file):
    found = swingdown.read(file, length="0.187±0.001").fit(**FEW)
    assert abs(found["g"].value - 0.187 * VALUES["natural_frequency"] ** 2) < found["g"].u
    assert found["g"].unit == "m/s^2" and found["g"].u == pytest.approx(0.053, rel=0.05)


def test_a_swing_of_ones_own_parameters_is_the_same_for_the_same_seed():
    def made(**more):
        return swingdown.simulate("viscous", TIMES, 0.35, **VALUES, **more)

    assert made().attrs["units"] == "rad" and made().time.attrs["units"] == "s"
    assert np.array_equal(made(noise=0.01, seed=5), made(noise=0.01, seed=5))
    assert np.std(made(noise=0.01, seed=5) - made()) == pytest.approx(0.01, rel=0.1)
    assert not np.array_equal(made(noise=0.01, seed=5), made(noise=0.01, seed=6))
    assert np.allclose(
        made(), swingdown.simulate("viscous", TIMES, 20.0535 * UNITS.degree, **VALUES), atol=1e-6
    )
    model = swingdown.Model("viscous", VALUES)
    assert np.array_equal(made(), trajectory(model, TIMES, 0.35)), "at rest and without noise"
    assert np.array_equal(made(), swingdown.simulate(model, TIMES, 0.35))
    with pytest.raises(InputError, match="no value for viscous_ratio"):
        swingdown.simulate("viscous", TIMES, 0.35, natural_frequency=7.25)
    with pytest.raises(InputError, match="no parameter 'viscosity'"):
        swingdown.simulate("viscous", TIMES, 0.35, **VALUES, viscosity=1)


def test_the_parameters_of_a_simulation_bring_their_units_along(plain):
    uncertainties = pytest.importorskip("uncertainties")
    times = np.arange(0, 3, 0.01)
    known = swingdown.simulate(
        "viscous", times, np.radians(20), velocity=0.1, natural_frequency=2 * np.pi, viscous_ratio=0.01
    )
    angle = xr.DataArray(20.0, attrs={"units": "deg"})
    again = swingdown.simulate(
        "viscous",
        UNITS.Quantity(1e3 * times, "ms"),
        angle,
        velocity=UNITS.Quantity(np.degrees(0.1), "deg/s"),
        natural_frequency=UNITS.Quantity(60, "turn/min"),
        viscous_ratio=uncertainties.ufloat(0.01, 0.001),
    )
    assert np.abs(known.values - again.values).max() < 1e-9
    assert swingdown.simulate(
        plain.model, times, 0.2, natural_frequency=plain["natural_frequency"]
    ).values == pytest.approx(swingdown.simulate(plain.model, times, 0.2).values, abs=1e-4)
    for more, told in (
        ({"natural_frequency": UNITS.Quantity(1, "m")}, "natural_frequency: their unit is 'meter'"),
        ({"viscous_ratio": "small"}, "viscous_ratio: 'small' is no number"),
    ):
        with pytest.raises(InputError, match=told):
            swingdown.simulate(plain.model, times, 0.2, **more)
    with pytest.raises(InputError, match=r"20 rad is more than half a turn.*np.radians\(20\)"):
        swingdown.simulate(plain.model, times, 20)


def test_what_a_cell_shows(plain, file):
    """Any notebook draws what has ``_repr_png_`` or ``_repr_html_``; a figure of matplotlib has neither by itself."""
    for figure in (plain.plot(), swingdown.read(file).plot()):
        assert figure._repr_png_().startswith(b"\x89PNG")
    assert plain.plot().legends[0].get_title().get_text() == f"T = {plain['period']}, Q = {plain['quality']}"
    html = plain._repr_html_()
    assert plain.sentence in html and html.count("<tr>") == len(plain.quantities)
    assert repr(plain).splitlines()[0] == plain.sentence


def test_an_answer_goes_to_a_table_and_to_labelled_arrays(plain, swing):
    table = plain.to_dataframe()
    assert list(table.index) == list(plain.quantities) and list(table) == [
        "value",
        "u",
        "unit",
        "text",
        "holds",
    ]
    assert table.loc["period", "u"] == plain["period"].u
    labelled = plain.to_xarray()
    assert np.allclose(labelled["angle"] - labelled["fit"], labelled["residual"])
    assert labelled["value"].sel(quantity="quality") == plain["quality"].value
    assert labelled["time"].attrs["units"] == "s" and labelled["fit"].attrs["units"] == "rad"


def test_loading_takes_no_part_of_the_workflow_the_bench_or_the_figures():
    heavy = ("snakemake", "serial", "zarr", "matplotlib")
    for first in ("", "; swingdown.read, swingdown.fit, swingdown.explain, swingdown.simulate"):
        code = f"import sys, swingdown{first}; print([one for one in {heavy} if one in sys.modules])"
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        assert done.stdout.strip() == "[]"


def test_what_a_notebook_shows_is_a_short_table():
    """Recording, answer, model and laws of damping: each a table, and what swings its picture."""
    recording = swingdown.read(EXAMPLE)
    answer = recording.fit(fitted=["viscous", "viscous+presliding"])
    (laws,) = answer.laws()
    shown = recording._repr_html_()
    assert "took `Angle (°)` as degrees" in shown and "<td>2001</td><td>20</td><td>0.349 rad</td>" in shown
    assert "data:image/png" in shown and "data:image/png" in answer._repr_html_()
    period = answer["period"]
    assert f"<td>{str(period).removesuffix(' s')}</td><td>s</td>" in answer._repr_html_()
    model = answer.model
    assert all(name.replace("_", " ") in model._repr_html_() for name in model.parameters)
    assert "<th>viscous</th>" in laws._repr_html_() and len(repr(laws).splitlines()) < 18
    assert list(laws.to_dataframe()["delta_bic"]) == sorted(laws.to_dataframe()["delta_bic"])


def test_an_answer_draws_its_curves_and_the_laws_of_damping_too():
    answer = swingdown.fit(EXAMPLE, fitted=["viscous"])
    assert "frequency (Hz)" in labels_of(answer.plot("curves"))
    assert any(label.startswith("time") for label in labels_of(answer.plot("laws")))
    with pytest.raises(InputError, match="no picture 'curve'"):
        answer.plot("curve")


def labels_of(figure):
    return {axes.get_xlabel() for axes in figure.axes}
