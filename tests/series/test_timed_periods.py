"""Tables of periods that were timed by hand: what is varied in them, trials, units and counts."""

import json

import numpy as np
import pandas as pd
import pytest
from scipy.special import ellipk
from scipy.stats import f

from swingdown.__main__ import main
from swingdown.errors import InputError
from swingdown.series import series_of, timed

LENGTHS = np.array([0.2, 0.3, 0.45, 0.6, 0.8, 1.0])
PERIODS = 2 * np.pi * np.sqrt(LENGTHS / 9.81)


def written(folder, head, rows, name="timed.csv"):
    path = folder / name
    path.write_text("\n".join([head, *rows]) + "\n", encoding="utf-8")
    return path


def series(found):
    return series_of(found.table, found.values, found.groups)


def test_heads_in_other_languages_and_their_errors(tmp_path):
    rows = [f"{100 * length:.1f},{10 * period:.2f},0.3,0.4" for length, period in zip(LENGTHS, PERIODS, strict=True)]  # fmt: skip
    for head in (
        "lengte (cm),tijd 10 slingeringen (s),fout in lengte (cm),fout in tijd (s)",
        "длина (cm),10 колебаний (s),err длина (cm),err_t (s)",
    ):
        found = timed(written(tmp_path, head, rows))
        assert np.allclose(found.table["period_s"], PERIODS, atol=2e-3)


def test_trials_side_by_side_give_g_with_what_their_scatter_leaves(tmp_path):
    rng = np.random.default_rng(1)
    rows = [
        ",".join(f"{one:.2f}" for one in (100 * length, *(10 * period + rng.normal(0, 0.1, 4))))
        for length, period in zip(LENGTHS, PERIODS, strict=True)
    ]
    found = timed(written(tmp_path, "L (cm),10T_1 (s),10T_2 (s),10T_3 (s),10T_4 (s)", rows))
    # a hundredth of 0.1 s: of ten swings, by the mean of four trials
    assert (
        np.allclose(found.table["period_s_u"], 0.005, rtol=0.4) and found.table["period_s_u"].nunique() == 1
    )
    (one,) = series(found)
    assert abs(one.gravity.g - 9.81) < 3 * one.gravity.u_g and 0.01 < one.gravity.u_g < 0.15


def test_trials_below_each_other_are_those_side_by_side(tmp_path):
    beside = written(tmp_path, "length (m);time for 5 swings 1 (s);time for 5 swings 2 (s)", [f"{length};{5 * period:.2f};{5 * period + 0.1:.2f}".replace(".", ",") for length, period in zip(LENGTHS, PERIODS, strict=True)])  # fmt: skip
    below = written(tmp_path, "length (m),trial,time for 5 swings (s)", [f"{length},{k},{5 * period + 0.1 * k:.2f}" for k in (0, 1) for length, period in zip(LENGTHS, PERIODS, strict=True)], "b.csv")  # fmt: skip
    tables = [timed(path).table for path in (beside, below)]
    for name in ("period_s", "period_s_u"):
        assert np.allclose(tables[0][name], tables[1][name], rtol=1e-12)


def test_tables_of_the_same_heads_side_by_side_are_one_below_the_other(tmp_path):
    each = [f"{k},{100 * length:.1f},{10 * period:.2f}" for k, (length, period) in enumerate(zip(LENGTHS, PERIODS, strict=True))]  # fmt: skip
    head = "Sample,length (cm),10T (s)"
    beside = written(tmp_path, f"{head},,{head}", [f"{one},,{other}" for one, other in zip(each[:3], each[3:], strict=True)])  # fmt: skip
    unequal = written(tmp_path, f"{head},,,{head}", [f"{each[k]},,,{each[k + 4]}" if k < 2 else each[k] + "," * 6 for k in range(4)], "u.csv")  # fmt: skip
    below = timed(written(tmp_path, head, each, "b.csv")).table
    for path in (beside, unequal):
        found = timed(path)
        assert any("2 tables with the same heads stand side by side" in one for one in found.told)
        assert sorted(found.table["period_s"]) == pytest.approx(sorted(below["period_s"]))
        assert len(series(found)) == 1 and abs(series(found)[0].gravity.g - 9.81) < 0.1


def test_a_cell_of_a_table_that_stands_beside_is_found(tmp_path):
    path = written(
        tmp_path, "length (cm),10T (s),,length (cm),10T (s)", ["20,9.0,,30,11.0", "40,12.7,,50,no"]
    )
    with pytest.raises(InputError, match="'no' is no time") as told:
        timed(path)
    assert "line 3b" in told.value.where


def test_columns_of_one_name_within_a_table_are_refused(tmp_path):
    with pytest.raises(InputError, match="two columns have one name") as told:
        timed(written(tmp_path, "length (cm),10T (s),10T (s)", ["20,9.0,9.1", "30,11.0,11.1"]))
    assert told.value.where.endswith("line 1")


def test_tables_one_below_the_other_under_heads_of_their_own_are_asked_about(tmp_path):
    path = written(tmp_path, "# 10T (s)", ["18.63", "18.72", "18.62", "# 50T (s), position (cm)", "95.75,70", "97.26,72"])  # fmt: skip
    with pytest.raises(
        InputError, match="2 tables of times, one below the other .*which one is meant"
    ) as told:
        timed(path)
    assert told.value.where.endswith("line 1")
    written(tmp_path, "# 10T (s)", ["18.63", "# looked away here", "18.62"])
    assert len(timed(path).table)


def test_lengths_without_a_unit_take_the_one_by_which_weight_pulls(tmp_path):
    rows = [f"{100 * length:g},{period:.3f}" for length, period in zip(LENGTHS, PERIODS, strict=True)]
    found = timed(written(tmp_path, "length,period", rows))
    assert any("TAKEN AS cm" in line for line in found.told)
    assert series(found)[0].gravity.g == pytest.approx(9.81, abs=0.05)
    stated = timed(written(tmp_path, "length (m),period", rows))
    assert series(stated)[0].gravity.g == pytest.approx(981, abs=5)  # what is stated is never overruled


def test_the_times_of_ten_swings_are_not_taken_for_one(tmp_path):
    rows = [f"{length:g},{10 * period:.2f}" for length, period in zip(LENGTHS, PERIODS, strict=True)]
    with pytest.raises(InputError, match="the times of 10 swings"):
        timed(written(tmp_path, "length (m),T (s)", rows))


def test_times_of_trials_ask_for_the_number_of_swings(tmp_path):
    rows = [f"{length:g},{10 * period:.2f}" for length, period in zip(LENGTHS, PERIODS, strict=True)]
    with pytest.raises(InputError, match="how many swings each time covers"):
        timed(written(tmp_path, "length (m),trial 1 (s)", rows))


def test_the_angle_of_release_is_taken_off(tmp_path):
    # the period at 60° is 1.0732 times that of small swings
    rows = [f"{length},60,{1.07318 * period:.4f}" for length, period in zip(LENGTHS, PERIODS, strict=True)]
    found = timed(written(tmp_path, "length (m),angle (deg),period (s)", rows))
    assert np.allclose(found.table["period_s"], PERIODS, rtol=1e-4)


@pytest.mark.parametrize(
    "head", ["t,length,angle", "T (s),L,theta", "time (s),mass,x", "Time (s),Period (s)", "t,i,theta"]
)
def test_a_recording_is_no_table_of_periods(tmp_path, head):
    times = np.arange(40) * 0.05
    rows = [f"{t:.2f},0.5,{np.cos(5 * t):.4f}" for t in times]
    assert timed(written(tmp_path, head, rows)) is None


def test_a_sentence_with_commas_is_no_head(tmp_path):
    path = written(
        tmp_path,
        "# I in A, +/- 0.1    T in s, +/- 0.01, 10 Schwingungen",
        ["0.3 28.12", "0.6 20.67", "0.9 17.11"],
    )
    assert timed(path) is None


def test_trials_of_one_pendulum_at_the_command_give_g(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    times = [20.04, 20.11, 20.02, 20.09, 20.05]
    written(tmp_path, "trial,time for 10 oscillations (s)", [f"{k},{one}" for k, one in enumerate(times)])
    assert main(["timed.csv", "--length", "1.000±0.002", "--json"]) == 0
    told = capsys.readouterr()
    found = json.loads(told.out)
    (period,) = found["periods_by_hand"]
    assert period["period_s"] == pytest.approx(2.0062)
    assert period["period_s_u"] == pytest.approx(np.std(times, ddof=1) / np.sqrt(5) / 10, rel=0.01)
    (g,) = found["g"].values()
    assert abs(g["value"] - 4 * np.pi**2 / 2.0062**2) < 1e-3 and g["standard_uncertainty"] > 0.0196
    assert "T = 2.0062" in told.err
    assert (tmp_path / "timed-swingdown" / "periods.csv").exists()


def test_a_cell_that_is_no_time_is_told_with_its_line(tmp_path):
    rows = ["0.2,9.0", "0.4,12.7", "0.6,abt. 15"]
    with pytest.raises(InputError, match="abt. 15") as told:
        timed(written(tmp_path, "length (m),time for 10 swings (s)", rows))
    assert "line 4" in str(told.value)


def test_other_columns_of_numbers_make_no_mean(tmp_path):
    rows = [f"{k},{120 - k}" for k in range(30, 90, 10)]
    found = timed(written(tmp_path, "D (cm),time for 20 swings (s)", rows))
    assert found.period() is None and found.others == ["D (cm)"]
    varied = timed(written(tmp_path, "D (cm),time for 20 swings (s)", rows), by="d")
    assert varied.values[varied.table["recording"][0]]["d"].value == pytest.approx(0.3)


def test_two_columns_of_lengths_are_asked_about(tmp_path):
    rows = [f"{k},{k + 2},{k / 20}" for k in (30, 40, 50)]
    with pytest.raises(InputError, match="each is the length"):
        timed(written(tmp_path, "string length (cm),length to the middle (cm),T (s)", rows))


def test_a_workbook_is_read_as_text_is(tmp_path):
    pd.DataFrame({"length (m)": LENGTHS, "T (s)": PERIODS.round(3)}).to_excel(tmp_path / "timed.xlsx", index=False)  # fmt: skip
    assert np.allclose(timed(tmp_path / "timed.xlsx").table["period_s"], PERIODS, atol=6e-4)


def test_in_a_folder_of_recordings_it_is_told_apart(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "class").mkdir()
    times = np.arange(0, 12, 0.02)
    rows = [f"{t:.2f},{20 * np.exp(-t / 30) * np.cos(4.8 * t):.3f}" for t in times]
    written(tmp_path / "class", "time (s),angle (deg)", rows, "swing.csv")
    written(tmp_path / "class", "length (m),T (s)", ["0.2,0.90", "0.4,1.27", "0.6,1.55"], "watch.csv")
    assert main(["class", "--quick"]) == 0
    told = capsys.readouterr().out
    assert "watch.csv: NOT USED: it is a table of times that were taken by hand" in told
    assert "swingdown watch.csv" in told and "T = " in told


def test_times_side_by_side_between_spaces_are_asked_about(tmp_path):
    file = written(tmp_path, "# 5T ball 5T disc", ["9.53 9.28", "9.41 9.36", "9.44 9.31"], "two.txt")
    with pytest.raises(InputError, match="line 2.*several times.*which one"):
        timed(file)


def test_a_head_in_the_last_of_many_comments_is_one(tmp_path):
    notes = [f"# arm {k} = 13.{k} cm" for k in range(12)]
    file = written(tmp_path, "\n".join([*notes, "# 5T[s]"]), ["1.93", "1.95", "1.90", "1.82"])
    assert timed(file).period().value == pytest.approx(0.38)
    unsaid = written(tmp_path, "\n".join(notes), ["1.93", "1.95", "1.90", "1.82"], "unsaid.csv")
    assert timed(unsaid) is None


@pytest.mark.parametrize(
    ("head", "row"), [("l theta tau", "{0:.2f} 5 {1:.2f}"), ("Event#, Time(ms)", "{1:.0f},{2}")]
)
def test_what_may_be_times_by_hand_asks_how_many_swings_each_covers(tmp_path, monkeypatch, capsys, head, row):
    monkeypatch.chdir(tmp_path)
    rows = [row.format(length, 10 * period, k) for k, (length, period) in enumerate(zip(LENGTHS, PERIODS, strict=True))]  # fmt: skip
    written(tmp_path, head, 3 * rows)
    with pytest.raises(SystemExit):
        main(["timed.csv", "--quick"])
    assert "how many swings each covers" in capsys.readouterr().err


def test_a_workbook_of_a_few_lines_is_asked_too_however_many_bytes_it_has(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    table = pd.DataFrame({"#": range(1, 7), "a, cm": 100 * LENGTHS, "T, s": (10 * PERIODS).round(2)[::-1]})
    notes = pd.DataFrame({"note": [f"note {k} {hash(k * 7.3)}" for k in range(1500)]})
    with pd.ExcelWriter("timed.xlsx") as book:
        table.to_excel(book, sheet_name="times", index=False)
        notes.to_excel(book, sheet_name="notes", index=False)
    assert (tmp_path / "timed.xlsx").stat().st_size > 12_000
    with pytest.raises(SystemExit):
        main(["timed.xlsx", "--quick"])
    assert "how many swings each covers" in capsys.readouterr().err


def test_a_short_recording_is_not_asked_how_many_swings_its_times_cover(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    times = np.arange(250) / 20
    grown = 0.1 * np.exp(0.1 * times) * np.cos(6 * times)
    rows = [f"{t:.2f},{x:.4f}" for t, x in zip(times, grown, strict=True)]
    written(tmp_path, "t (s),angle (rad)", rows)
    with pytest.raises(SystemExit):
        main(["timed.csv", "--quick"])
    told = capsys.readouterr().err
    assert "its swings grow" in told and "how many swings each covers" not in told


@pytest.mark.parametrize(
    "head", ["number of oscillations,time (s)", "Кол-во периодов,Время", "Anzahl Schwingungen,t (s)"]
)
def test_a_column_may_count_the_swings_of_each_line(tmp_path, head):
    found = timed(written(tmp_path, head, ["10,14.02", "20,28.10", "5,7.03", "10,14.03"]))
    assert np.allclose(found.table["period_s"], 1.404, atol=2e-3) and "as many swings as" in found.told[0]


@pytest.mark.parametrize("cell", ["0", "2.5", "", "many"])
def test_a_count_that_is_no_whole_number_is_refused(tmp_path, cell):
    with pytest.raises(InputError, match="is no number of swings"):
        timed(written(tmp_path, "number of swings,time (s)", ["10,14.02", f"{cell},28.10"]))


def test_of_half_swings_and_of_n_alone_nobody_knows_what_they_count(tmp_path):
    for head in ("number of half swings,time (s)", "n,time (s)", "number of the trial,time (s)"):
        assert timed(written(tmp_path, head, ["10,14.02", "20,28.10"])) is None


def test_times_that_rise_with_their_counts_may_be_those_of_one_swing(tmp_path):
    """Of a watch that runs on each line would be the trial of all before it."""
    assert (
        timed(
            written(
                tmp_path,
                "number of swings,time_A (s),time_B (s)",
                ["1,8.6,8.5", "2,17.2,", "3,25.9,25.7", "4,34.5,34.2"],
            )
        )
        is None
    )


def test_a_trial_that_is_not_there_leaves_the_others(tmp_path):
    found = timed(
        written(tmp_path, "length (m),10T_1 (s),10T_2 (s)", ["0.5,14.1,14.3", "0.6,15.5,", "0.7,16.7,16.9"])
    )
    assert np.allclose(found.table["period_s"], [1.42, 1.55, 1.68]) and found.table["period_s_u"].gt(0).all()


def test_columns_of_two_pendulums_are_no_trials(tmp_path):
    """Their mean would be nobody's period; trials by two hands, which start and stop a little differently, are trials."""
    with pytest.raises(InputError, match="differ by 84 % in line after line.*whose are they"):
        timed(written(tmp_path, "5T (cylinder) / s,5T (ball) / s", ["3.81,9.29", "3.76,9.20", "3.77,9.43"]))
    found = timed(written(tmp_path, "10T_A (s),10T_B (s)", ["15.1,15.3", "15.0,15.2", "15.2,15.3"]))
    assert np.allclose(found.table["period_s"], 1.518, atol=1e-3)


def test_names_between_commas_may_stand_above_numbers_between_spaces(tmp_path):
    found = timed(written(tmp_path, "# length / cm, 10T / s", ["20 9.0", "30 11.0", "40 12.7"]))
    assert np.allclose(found.table["period_s"], [0.9, 1.1, 1.27])


def test_lines_of_several_pendulums_are_no_trials(tmp_path):
    with pytest.raises(InputError, match="scatter by 2[0-9] %, 5.* s: are they of several"):
        timed(written(tmp_path, "10T (s)", ["14.0", "20.1", "25.3"]))
    with pytest.raises(InputError, match="differ by .* whose are they"):  # of one line no scatter is known
        timed(written(tmp_path, "10T (20 cm) / s,10T (30 cm) / s", ["9.0,11.0"]))
    assert timed(written(tmp_path, "length (cm),10T (s)", ["20,9.0", "30,11.0", "40,12.7"])) is not None
    one_by_one = timed(
        written(tmp_path, "length (cm),T (s)", ["20,0.8", "20,1.0", "30,1.2", "30,1.0"])
    )  # a swing at a time
    assert len(one_by_one.table) == 2


def test_a_mean_is_as_sure_as_the_scatter_of_all_trials_and_the_last_digit_leave_it(tmp_path):
    """Pooled over lines (JCGM 100, 4.2), each about its own mean; half a unit of the last digit beside it (4.3.7)."""
    trials = {"20": [9.02, 8.91, 9.05], "50": [14.11, 14.25, 14.2], "90": [19.1, 18.9]}
    rows = [",".join([length, *(f"{one:.2f}" for one in times), ""][:4]) for length, times in trials.items()]
    found = timed(written(tmp_path, "length (cm),10T 1 (s),10T 2 (s),10T 3 (s)", rows))
    squares = sum(np.var(one) * len(one) for one in trials.values()) / (8 - 3)
    u = [np.sqrt((squares + 0.01**2 / 12) / len(one)) / 10 for one in trials.values()]
    assert found.table["period_s"].tolist() == pytest.approx([np.mean(one) / 10 for one in trials.values()])
    assert found.table["period_s_u"].tolist() == pytest.approx(u)
    assert "`10T 1 (s)`, `10T 2 (s)`, `10T 3 (s)` as times of 10 swings; trials side by side" in found.told[0]
    assert found.table["label"].tolist() == ["line 2", "line 3", "line 4"] and found.period() is None
    assert not any("there are no trials" in one for one in found.told)


def test_without_trials_the_last_digit_alone_is_told_and_said(tmp_path):
    found = timed(written(tmp_path, "length (cm),10T (s)", ["20,9.0", "50,14.2"]))
    assert found.table["period_s_u"].tolist() == pytest.approx([0.1 / np.sqrt(12) / 10] * 2)
    assert any("there are no trials" in one for one in found.told)


def test_trials_of_one_pendulum_have_one_period(tmp_path):
    found = timed(written(tmp_path, "10T (s)", ["20.1", "19.9", "20.3"]))
    period = found.period()
    assert period.value == pytest.approx(2.01) and found.table["label"].tolist() == ["lines 2, 3, 4"]
    u = np.sqrt((np.var([20.1, 19.9, 20.3], ddof=1) + 0.1**2 / 12) / 3) / 10
    assert period.uncertainty == pytest.approx(u)


@pytest.mark.parametrize(("apart", "lines", "refused"), [(0.2, 6, True), (0.02, 6, False), (0.2, 1, True), (0.02, 1, False)])  # fmt: skip
def test_columns_are_trials_unless_each_is_longer_in_line_after_line(tmp_path, apart, lines, refused):
    """By more than a twentieth, and by more than chance, as an analysis of variance has it; of one line chance is not known."""
    rows = [f"{100 * length:.0f},{period:.3f},{period * (1 + apart) + 0.01 * (k % 2):.3f}" for k, (length, period) in enumerate(zip(LENGTHS, PERIODS, strict=True))]  # fmt: skip
    path = written(tmp_path, "length (cm),T 1 (s),T 2 (s)", rows[:lines])
    if refused:
        with pytest.raises(InputError, match="differ by 1[89] % in line after line"):
            timed(path)
    else:
        assert len(timed(path).table) == lines


def test_columns_that_differ_by_chance_are_trials_however_far(tmp_path):
    """A tenth apart in the mean, by one line that went wrong: a test of variance does not see that as rare."""
    times = np.array([[2.0, 2.02, 2.01], [2.01, 2.0, 2.03], [2.0, 2.9, 2.02], [2.02, 2.0, 1.99]])
    rows = [f"{20 + k},{','.join(f'{one:.2f}' for one in line)}" for k, line in enumerate(times)]
    means = times.mean(axis=0)
    left = times - times.mean(axis=1, keepdims=True) - means + times.mean()
    ratio = (4 * np.sum((means - times.mean()) ** 2) / 2) / (np.sum(left**2) / 6)
    assert np.ptp(means) / times.mean() > 0.05 and f.sf(ratio, 2, 6) > 0.01
    assert len(timed(written(tmp_path, "mass (g),T 1 (s),T 2 (s),T 3 (s)", rows)).table) == 4


@pytest.mark.parametrize(
    ("head", "factor"),
    [
        ("angle (deg)", 1.0),
        ("angle (rad)", np.pi / 180),
        ("angle", 1.0),
        ("Angle of release (°)", 1.0),
        ("initial amplitude (deg)", 1.0),
        ("Anfangswinkel (°)", 1.0),
        ("theta_0 (deg)", 1.0),
    ],
)
def test_wide_swings_are_taken_down_to_small_ones_by_their_angle(tmp_path, head, factor):
    """By the elliptic integral; numbers beyond half a turn are degrees."""
    degrees = np.array([5.0, 40.0, 90.0, -60.0])
    longer = 2 / np.pi * ellipk(np.sin(np.radians(degrees) / 2) ** 2)
    rows = [f"{10 + k},{one * factor:.6f},{2 * more:.5f}" for k, (one, more) in enumerate(zip(degrees, longer, strict=True))]  # fmt: skip
    found = timed(written(tmp_path, f"mass (g),{head},T (s)", rows))
    assert found.table["period_s"].tolist() == pytest.approx([2.0] * 4, abs=1e-5)
    assert any("small swings, by the angle of release" in one for one in found.told)
    with pytest.raises(InputError, match="not every line holds an angle"):
        timed(written(tmp_path, f"mass (g),{head},T (s)", [*rows, f"20,{200 * factor},2.0"]))


@pytest.mark.parametrize(("unit", "factor"), [("cm", 0.01), ("mm", 0.001), ("in", 0.0254)])
def test_lengths_take_the_unit_that_gives_g_with_their_uncertainties(tmp_path, unit, factor):
    rows = [
        f"{length / factor:.4f},0.5,{period:.3f}" for length, period in zip(LENGTHS, PERIODS, strict=True)
    ]
    found = timed(written(tmp_path, "length,error of length,period", rows))
    assert any(
        f"TAKEN AS {unit}, as in m they would give g = {9.81 / factor:.3g}" in one for one in found.told
    )
    values = [own["length"] for own in found.values.values()]
    assert [one.value for one in values] == pytest.approx(LENGTHS, rel=1e-3)
    assert [one.uncertainty for one in values] == pytest.approx([0.5 * factor] * 6)
