"""Several recordings in one file, side by side: each is read as if it stood alone, and a row of the sheet says which."""

import numpy as np
import pytest

from swingdown.errors import InputError
from swingdown.measurement.files.runs import SeveralRuns
from swingdown.measurement.files.source import runs
from swingdown.measurement.recording import ingest
from swingdown.measurement.sheet import read_sheet
from swingdown.planning import own

SIZES = 600, 420, 510  # samples of three runs


def swing(run):
    """Times (s) and angle (rad) of a run."""
    times = np.arange(SIZES[run]) / 60
    return times, np.round((0.4 - 0.1 * run) * np.exp(-0.03 * times) * np.cos(7 * times + 0.1 * run), 6)


def text(header, *columns, separator=",", digits=6):
    """A file of these columns, each blank once it has ended."""
    lines = [header]
    for k in range(max(map(len, columns))):
        lines.append(
            separator.join(f"{column[k]:.{digits}f}" if k < len(column) else "" for column in columns)
        )
    return "\n".join(lines) + "\n"


def flat(*runs):
    """The columns of these runs, side by side."""
    return [column for run in runs for column in run]


def video(run):
    times, angle = swing(run)
    return 0.31 + 0.8 * np.sin(angle), 1.2 - 0.8 * np.cos(angle)


THREE = [swing(run) for run in range(3)]
# What each program writes of several runs: the file, and the names of the runs.
FORMS = {
    "capstone": (
        text(",".join(f"Time (s) Run #{k},Angle (rad) Run #{k}" for k in (1, 2, 3)), *flat(*THREE)),
        ["Run #1", "Run #2", "Run #3"],
    ),
    "capstone_one_time": (
        text("Time (s)," + ",".join(f'"Angle, Ch 1 (rad) Run #{k}"' for k in (1, 2, 3)), THREE[0][0], *[a for _, a in THREE]),
        ["Run #1", "Run #2", "Run #3"],
    ),
    "graphical_analysis": (
        text(",".join(f"Data Set {k}:Time(s),Data Set {k}:Angle(rad)" for k in (1, 2, 3)), *flat(*THREE)),
        ["Data Set 1", "Data Set 2", "Data Set 3"],
    ),
    "logger_pro": (
        text(",".join(f"{k}: Time (s),{k}: Angle (rad)" for k in ("Run 1", "Run 2", "Latest")), *flat(*THREE)),
        ["Run 1", "Run 2", "Latest"],
    ),
    "repeated": (
        text("\t".join(["t\tangle"] * 3), *flat(*THREE), separator="\t"),
        ["run 1", "run 2", "run 3"],
    ),
    "titled": (
        text("30 cm;;40 cm;;50 cm;\n" + ";".join(["t (s);angle (rad)"] * 3), *flat(*THREE), separator=";"),
        ["30 cm", "40 cm", "50 cm"],
    ),
    "tracker": (
        text(
            "\tmass A\t\tmass B\t\tmass C\t\nt" + "\tx\ty" * 3, THREE[0][0], *flat(*(video(run) for run in range(3))), separator="\t"
        ),
        ["mass A", "mass B", "mass C"],
    ),
    "numbered": (
        text("t1,theta1,t2,theta2,t3,theta3", *flat(*THREE)),
        ["run 1", "run 2", "run 3"],
    ),
    "numbered_positions": (
        text("t,x1,y1,x2,y2,x3,y3", THREE[0][0], *flat(*(video(run) for run in range(3)))),
        ["run 1", "run 2", "run 3"],
    ),
}  # fmt: skip


@pytest.mark.parametrize("form", FORMS)
def test_each_run_is_read_as_if_it_stood_alone(take, tmp_path, form):
    content, names = FORMS[form]
    for name, (times, angle) in zip(names, THREE, strict=True):
        made = take(content, run=name)
        assert made.sizes["time"] == times.size
        assert made["time"].values == pytest.approx(times, abs=1e-6)
        assert made["signal"].values == pytest.approx(angle, abs=1e-4)
    with (tmp_path / "swing.csv").open("rb") as source:
        assert runs(source, {"file": "swing.csv"}) == names


def test_a_file_of_several_runs_asks_for_rows_that_work(take, tmp_path):
    content, names = FORMS["capstone"]
    with pytest.raises(SeveralRuns, match="holds 3 runs: Run #1, Run #2, Run #3") as caught:
        take(content)
    rows = caught.value.mend.partition("\n")[2]
    (tmp_path / "sheet.csv").write_text(rows)
    made = read_sheet("sheet.csv")
    assert list(made.index) == ["a-1", "a-2", "a-3"] and list(made["run"]) == names
    assert ingest(made.loc["a-3"])["signal"].values == pytest.approx(THREE[2][1], abs=1e-6)


def test_a_column_names_its_run(take):
    made = take(FORMS["capstone"][0], signal_column="Angle (rad) Run #2")
    assert made["signal"].values == pytest.approx(THREE[1][1], abs=1e-6)
    made = take(FORMS["capstone"][0], signal_column="Angle (rad) Run #2", stop_s=5)
    assert made.sizes["time"] == 301


def test_a_run_that_is_not_there_is_told_with_those_that_are(take):
    with pytest.raises(InputError, match=r"column run\): there is no run 'Run #7'.*Run #1, Run #2, Run #3"):
        take(FORMS["capstone"][0], run="Run #7")
    with pytest.raises(InputError, match="one recording, and no runs"):
        take(text("t_s,theta_rad", *THREE[0]), run="Run #7")


@pytest.mark.parametrize(
    "header",
    [
        "Time (s) Run #1,Angle (rad) Run #1,Angular Velocity (rad/s) Run #1",
        "Latest: Time (s),Latest: Angle (rad),Latest: Velocity (rad/s)",
        "t_s,theta_rad,theta2",
        "t,angle,channel 2",
        "t (s),angle (rad),t (ms)",
    ],
)
def test_columns_of_one_run_are_one_recording(take, header):
    times, angle = THREE[0]
    made = take(text(header, times, angle, np.arange(times.size) / 1.5))
    assert made["signal"].values == pytest.approx(angle, abs=1e-6)


def numbered(anew, numbers=(4, 5, 7), name="packet"):
    """A file of the three runs below each other, with their numbers; the clock counts anew, or goes on half a minute later."""
    lines, begins = [f"{name},time_ms,angle_rad"], 0.0
    for run, number in enumerate(numbers):
        times, angle = swing(run)
        lines += [f"{number},{1e3 * (begins + t):.3f},{x:.6f}" for t, x in zip(times, angle, strict=True)]
        begins += 0.0 if anew else times[-1] + 30
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize("anew", [True, False])
@pytest.mark.parametrize("name", ["packet", "Versuch"])
def test_a_column_that_numbers_the_runs_parts_them(take, tmp_path, anew, name):
    with pytest.raises(SeveralRuns, match=f"`{name}` numbers 3 runs in it") as told:
        take(numbered(anew, name=name))
    assert told.value.names == ("part 1", "part 2", "part 3")
    for run in range(3):
        part = take(numbered(anew, name=name), run=f"part {run + 1}")
        np.testing.assert_allclose(part["signal"].values, swing(run)[1])
        assert f"this is part {run + 1}" in part.attrs["remarks"]
    (parts,) = [own.take(row, tmp_path / "swing.csv") for row in own.rows([tmp_path / "swing.csv"], tmp_path, False, {})]  # fmt: skip
    assert len(parts) == 3 and not any(isinstance(one, own.Refused) for one in parts)


def test_a_column_that_changes_while_the_clock_goes_on_numbers_no_runs(take):
    whole = "\n".join(f"{k // 200},{t:.6f},{x:.6f}" for k, (t, x) in enumerate(zip(*swing(0), strict=True)))
    assert take("state,time_s,angle_rad\n" + whole + "\n").sizes["time"] == SIZES[0]


def test_a_part_that_hardly_moves_is_no_pendulum_at_rest_beside_another(tmp_path):
    (times, wide), (later, narrow) = swing(0), swing(1)
    lines = [f"{t:.4f},{x:.6f}" for t, x in [*zip(times, wide, strict=True), *zip(later, narrow / 25, strict=True)]]  # fmt: skip
    (tmp_path / "a.csv").write_text("time_s,angle_rad\n" + "\n".join(lines) + "\n")
    (row,) = own.rows([tmp_path / "a.csv"], tmp_path, False, {})
    assert not any(isinstance(one, own.Refused) for one in own.take(row, tmp_path / "a.csv"))
