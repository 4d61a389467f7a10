"""Whatever a sheet and a file hold: an InputError with a mend, or the right numbers."""

import numpy as np
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from swingdown.errors import InputError
from swingdown.measurement.recording import ingest
from swingdown.measurement.sheet import COLUMNS, read_sheet

TIME = np.arange(300) / 25
SWING = np.round(0.5 * np.exp(-0.02 * TIME) * np.cos(5 * TIME), 5)
FUZZ = settings(deadline=None, max_examples=120, suppress_health_check=[HealthCheck.function_scoped_fixture])

cell = st.one_of(
    st.sampled_from(["", "a.csv", "rad", "deg", "V", "ms", "1", "-1", "nan", "inf", "1e999", "1e308", "0x10", "=1+1", "allow", "static"]),
    st.text(max_size=12),
)  # fmt: skip


@FUZZ
@given(
    columns=st.lists(st.sampled_from([*COLUMNS, "wind"]), max_size=6),
    rows=st.lists(st.lists(cell, max_size=7), max_size=4),
    separator=st.sampled_from([",", ";", "\t"]),
)
def test_any_sheet(tmp_path, monkeypatch, columns, rows, separator):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.csv").write_text("t_s,theta_rad\n")
    lines = [["recording", "file", *columns], *[["a", "a.csv", *row] for row in rows]]
    text = "\n".join(separator.join(line) for line in lines)
    (tmp_path / "sheet.csv").write_bytes(text.encode("utf-8", errors="surrogatepass"))
    try:
        table = read_sheet("sheet.csv")
    except InputError as error:
        assert error.problem and error.mend
        return
    assert table.index.is_unique
    for _, row in table.iterrows():
        assert row["signal_unit"] in ("", "rad", "deg", "V", "counts") and row["time_unit"] in (
            "",
            "s",
            "ms",
            "us",
        )
        assert not np.isinf([row["start_s"], row["stop_s"], row["counts_per_revolution"]]).any()


@FUZZ
@given(raw=st.binary(max_size=400))
def test_any_bytes_as_a_sheet(tmp_path, monkeypatch, raw):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "sheet.csv").write_bytes(raw)
    try:
        read_sheet("sheet.csv")
    except InputError as error:
        assert error.problem and error.mend


def read(tmp_path, raw, name="a.csv"):
    (tmp_path / name).write_bytes(raw)
    (tmp_path / "sheet.csv").write_text(f"recording,file\na,{name}\n")
    return ingest(read_sheet("sheet.csv").loc["a"], "sheet.csv")


@FUZZ
@example(raw=b"0", ending="csv")
@given(raw=st.binary(max_size=600), ending=st.sampled_from(["csv", "txt", "xlsx", "zip"]))
def test_any_bytes_as_a_recording(tmp_path, monkeypatch, raw, ending):
    monkeypatch.chdir(tmp_path)
    try:
        read(tmp_path, raw, f"a.{ending}")
    except InputError as error:
        assert error.problem and error.mend


LINES = [f"{t:.2f};{x:.5f}".replace(".", ",") for t, x in zip(TIME, SWING, strict=True)]


@FUZZ
@given(
    changes=st.lists(
        st.tuples(
            st.integers(0, len(LINES)),
            st.sampled_from(["drop", "twice", "swap", "text", "point", "cells", "empty", "digit", "cut"]),
            st.text("0123456789,.;-+eE naif\"'#\t", max_size=5),
        ),
        max_size=2,
    ),
    end=st.sampled_from(["\n", "\r\n", "\r"]),
)
def test_a_recording_that_was_edited(tmp_path, monkeypatch, changes, end):
    """What is read of a spoilt file is what stands in it: every sample is a line of it, and of a line that is passed over it is told."""
    monkeypatch.chdir(tmp_path)
    lines = ["Zeit (s);Winkel (rad)", *LINES]
    for at, what, text in changes:
        at = min(at, len(lines) - 1)
        if what == "drop":
            del lines[at]
        elif what == "twice":
            lines.insert(at, lines[at])
        elif what == "swap":
            lines[at], lines[at - 1] = lines[at - 1], lines[at]
        elif what == "cut":
            lines = [*lines[:at], lines[at][: len(lines[at]) // 2]]
        else:
            lines[at] = {
                "text": text, "point": lines[at].replace(",", ".", 1), "cells": lines[at] + ";" + text, "empty": "",
                "digit": lines[at].replace("1", "7", 1),
            }[what]  # fmt: skip
        if not lines:
            return
    try:
        found = read(tmp_path, end.join([*lines, ""]).encode())
    except InputError as error:
        assert error.problem and error.mend
        return
    stand = set()
    for line in lines:
        try:
            stand.add(tuple(float(one.replace(",", ".")) for one in line.split(";")[:2]))
        except ValueError:
            continue
    samples = set(zip(found["time"].values.tolist(), found["signal"].values.tolist(), strict=True))
    assert samples <= stand
    if len(samples) < len(stand) - 1:  # a last line that was cut is left out
        assert "missing samples" in found.attrs["remarks"] or "left out" in found.attrs["remarks"]
