"""What is read of files in many forms is what it was: columns, units, clock, samples, remarks, and the words of a refusal.

``frozen_door.json`` holds them; after a change that is meant, ``FROZEN_WRITE=1 make quick TESTS=tests/measurement/test_frozen_door.py`` writes
them anew, and the diff shows what it did.
"""

import csv
import gzip
import io
import json
import zipfile
from pathlib import Path

import numpy as np
import openpyxl
import pytest
import scipy.io
from frozen import by_a_decimal, held

import swingdown
from swingdown.dataset import series_of
from swingdown.errors import InputError

FROZEN = Path(__file__).with_name("frozen_door.json")
RATE, SECONDS, LENGTH = 50, 12, 0.6
T = np.arange(RATE * SECONDS + 1) / RATE
DRAWS = np.random.default_rng(12)
NOISE = 1.5e-3 * DRAWS.standard_normal(T.size)
OMEGA = 4.2


def angle(amplitude=0.5, loss=0.02, times=T):
    """Of a pendulum that swings by itself (rad), to the order of its period over the amplitude."""
    size = amplitude * np.exp(-loss * times)
    phase = OMEGA * np.concatenate([[0], np.cumsum(np.diff(times) * (1 - size[1:] ** 2 / 16))])
    return size * np.cos(phase) + NOISE[: times.size]


A = angle()
DEG = np.degrees(A)
X, Y = LENGTH * np.sin(A), -LENGTH * np.cos(A)
RATE_OF = np.gradient(A, T)


def text(head, *columns, sep=",", mark=".", digits=4, ends="\n", above=()):
    """A table as text, with lines above it."""
    lines = [*above, *([sep.join(head)] if head else [])]
    lines += [
        sep.join(f"{one:.{digits}f}".replace(".", mark) for one in row) for row in zip(*columns, strict=True)
    ]
    return (ends.join(lines) + ends).encode()


def stamped(times, start="2024-05-03 10:11:12"):
    base = np.datetime64(start.replace(" ", "T"), "us")
    return [str(base + np.timedelta64(round(1e6 * one), "us")).replace("T", " ") for one in times]


def rows(head, *columns, sep=","):
    """A table whose cells are written as they are."""
    out = io.StringIO()
    csv.writer(out, delimiter=sep, lineterminator="\n").writerows([head, *zip(*columns, strict=True)])
    return out.getvalue().encode()


def workbook(head, *columns, more=()):
    book = openpyxl.Workbook()
    sheet = book.active
    sheet.title = "swing"
    for row in [head, *zip(*(map(float, one) for one in columns), strict=True)]:
        sheet.append(list(row))
    for name in more:
        book.create_sheet(name).append(["notes"])
    held_in = io.BytesIO()
    book.save(held_in)
    return held_in.getvalue()


def archive(**files):
    held_in = io.BytesIO()
    with zipfile.ZipFile(held_in, "w") as made:
        for name, content in files.items():
            made.writestr(zipfile.ZipInfo(name.replace("__", "/") + ".csv"), content)
    return held_in.getvalue()


def saved(how, **arrays):
    held_in = io.BytesIO()
    how(held_in, **arrays)
    return held_in.getvalue()


def matlab(**arrays):
    held_in = io.BytesIO()
    scipy.io.savemat(held_in, arrays)
    return held_in.getvalue()


def but(which):
    """All samples but these."""
    return np.delete(np.arange(T.size), which)


def spoilt(at, by, values=DEG):
    found = values.copy()
    found[at] += by
    return found


HOLE, LOST = but(np.arange(200, 215)), but([70, 71, 260])
JITTER = np.sort(T + 2e-3 * DRAWS.standard_exponential(T.size))
WRAPPED = np.mod(DEG + 5, 360)
COUNTS = np.round(A / (2 * np.pi) * 4096 + 512)
CM, MM, PX = 100 * X, 1e3 * X, 400 * X + 320
HELD = np.r_[np.full(60, DEG[0]) + np.degrees(NOISE[:60]), DEG]
HELD_T = np.arange(HELD.size) / RATE
STILL = np.degrees(NOISE)
NS = 1.7e18 + 1e9 * T
PHONE = text(("time", "seconds_elapsed", "z", "y", "x"), NS, T, 0.01 * RATE_OF, RATE_OF, 0.02 * RATE_OF)
CLIPPED = np.clip(DEG, -20, 20)
TWICE = np.repeat(np.arange(T.size), np.where(np.arange(T.size) % 97 == 5, 2, 1))
DEGREES = ("Time (s)", "Angle (deg)")

# By name: the file's name, what it holds, and what is said beside it.
FILES = {
    "a table with units": ("a.csv", text(DEGREES, T, DEG), {}),
    "radians": ("a.csv", text(("t [s]", "theta [rad]"), T, A), {}),
    "no head, unit said": ("a.csv", text((), T, DEG), {"unit": "deg"}),
    "no head, nothing said": ("a.csv", text((), T, DEG), {}),
    "no unit in the head": ("a.csv", text(("time", "angle"), T, DEG), {}),
    "semicolons and commas": ("a.csv", text(("Zeit (s)", "Winkel (°)"), T, DEG, sep=";", mark=","), {}),
    "tabs": ("a.txt", text(DEGREES, T, DEG, sep="\t"), {}),
    "spaces": ("a.dat", text((), T, A, sep="   "), {"unit": "rad"}),
    "strokes": ("a.csv", text(DEGREES, T, DEG, sep="|"), {}),
    "strokes and commas": ("a.csv", text(("t (s)", "Winkel (°)"), T, DEG, sep="|", mark=","), {}),
    "a table in Markdown": ("a.md", b"| t (s) | angle (deg) |\n|---|---|\n" + "".join(f"| {a:.3f} | {b:.3f} |\n" for a, b in zip(T, DEG, strict=True)).encode(), {}),
    "an array as numpy prints it": ("a.txt", np.array2string(np.column_stack([T, A]), threshold=10_000).encode(), {}),
    "lines above": ("a.csv", text(DEGREES, T, DEG, above=("# pendulum 3", "# released at 30 deg", "")), {}),
    "units in a row below": ("a.csv", text(("Time", "Angle"), T, DEG).replace(b"Time,Angle\n", b"Time,Angle\ns,deg\n"), {}),
    "Latin-1": ("a.csv", "Temps (s);Angle (°)\n".encode("latin-1") + text((), T, DEG, sep=";", mark=","), {}),
    "UTF-16": ("a.csv", text(DEGREES, T, DEG).decode().encode("utf-16"), {}),
    "carriage returns": ("a.csv", text(DEGREES, T, DEG, ends="\r\n"), {}),
    "milliseconds": ("a.csv", text(("millis", "angle_deg"), 1e3 * T, DEG), {}),
    "microseconds said": ("a.csv", text(("t", "deg"), 1e6 * T, DEG, digits=1), {"time_unit": "us", "unit": "deg"}),
    "ticks": ("a.csv", text(("ticks", "angle_deg"), 16e6 * T, DEG, digits=1), {}),
    "ticks, unit said": ("a.csv", text(("ticks", "angle_deg"), 1e3 * T, DEG, digits=1), {"time_unit": "ms"}),
    "steps of time alone": ("a.csv", text(("dt (ms)", "angle (deg)"), np.full(T.size, 20.0), DEG), {}),
    "steps beside times": ("a.csv", text(("dt (ms)", "t (s)", "angle (deg)"), 20 + np.arange(T.size) % 3 - 1.0, T, DEG), {}),
    "minutes and mrad": ("a.csv", text(("t (min)", "angle (mrad)"), T / 60, 1e3 * A, digits=6), {}),
    "stamps": ("a.csv", rows(("timestamp", "angle (deg)"), stamped(T), DEG.round(4)), {}),
    "time of the day": ("a.csv", rows(("clock", "angle (deg)"), [one[11:] for one in stamped(T)], DEG.round(4)), {}),
    "seconds since 1970": ("a.csv", text(("time", "angle (deg)"), 1.7e9 + T, DEG), {}),
    "a column alone, rate said": ("a.txt", text((), DEG), {"rate": 50, "unit": "deg"}),
    "a column alone": ("a.txt", text(("angle (deg)",), DEG), {}),
    "frames": ("a.csv", text(("frame", "angle (deg)"), np.arange(T.size), DEG, digits=3), {"rate": 50}),
    "three columns, one asked for": ("a.csv", text(("t (s)", "left (deg)", "right (deg)"), T, DEG, 0.5 * DEG), {"column": "right (deg)"}),
    "three columns, none asked for": ("a.csv", text(("t (s)", "left (deg)", "right (deg)"), T, DEG, 0.5 * DEG), {}),
    "a column of errors beside it": ("a.csv", text(("t (s)", "angle (deg)", "angle_err (deg)", "setpoint (deg)"), T, DEG, 0.1 + 0.001 * T, 5 + T), {}),
    "a minus of its own": ("a.csv", text(DEGREES, T, DEG).decode().replace("-", "\u2212").encode(), {}),
    "a dash for a minus": ("a.csv", text(DEGREES, T, DEG).decode().replace("-", "\u2013").encode(), {}),
    "a column that is not there": ("a.csv", text(DEGREES, T, DEG), {"column": "Winkel"}),
    "a film's positions": ("a.csv", text(("t", "x", "y"), T, X, Y), {}),
    "positions in pixels": ("a.csv", text(("t (s)", "x (px)", "y (px)"), T, PX, 240 - 400 * Y), {}),
    "a position and a length": ("a.csv", text(("t (s)", "x (cm)"), T, CM), {"length": "0.600(1)"}),
    "a position alone": ("a.csv", text(("t (s)", "x (mm)"), T, MM), {}),
    "a position of a wheel": ("a.csv", text(("t (s)", "x (m)"), T, X), {"restoring": "linear"}),
    "a film's hundredths": ("a.txt", b"#Kinovea Trajectory data export\n#T X Y\n" + "".join(f"0:00:{int(a):02d}:{round(100 * a) % 100:02d} {b:.2f} {c:.2f} \n" for a, b, c in zip(T, PX, 240 - 400 * Y, strict=True)).encode(), {}),
    "a film's frames": ("a.txt", b"T X Y\n" + "".join(f"0:00:{k // 50:02d}:{k % 50:02d} {b:.2f} {c:.2f} \n" for k, (b, c) in enumerate(zip(PX, 240 - 400 * Y, strict=True))).encode(), {}),
    "counts": ("a.csv", text(("t (s)", "counts"), T, COUNTS), {"counts_per_revolution": "4096"}),
    "counts per turn in words": ("a.csv", text(("t (s)", "counts"), T, COUNTS), {"counts_per_revolution": "many"}),
    "counts without their number": ("a.csv", text(("t (s)", "counts"), T, COUNTS), {}),
    "volts": ("a.csv", text(("t (s)", "U (V)"), T, 2.5 + 0.8 * A), {}),
    "volts of a wheel": ("a.csv", text(("t (s)", "U (V)"), T, 2.5 + 0.8 * A), {"restoring": "linear"}),
    "degrees, scale said": ("a.csv", text(("t (s)", "angle (deg)"), T, 28 * A), {"scale": "0.5"}),
    "readings, scale said": ("a.csv", text(("t (s)", "reading"), T, 512 + 300 * A), {"scale": "0.176"}),
    "volts, scale said": ("a.csv", text(("t (s)", "U (V)"), T, 2.5 + 0.8 * A), {"scale": "71.6 deg/V"}),
    "volts, scale said in rad": ("a.csv", text(("t (s)", "U (V)"), T, 2.5 + 0.8 * A), {"scale": "1.25 rad per V"}),
    "volts, scale of a rate": ("a.csv", text(("t (s)", "U (V)"), T, 2.5 + 0.8 * A), {"scale": "0.061 deg/s"}),
    "volts, scale of millivolts": ("a.csv", text(("t (s)", "U (V)"), T, 2.5 + 0.8 * A), {"scale": "0.07 deg/mV"}),
    "volts, scale said in words": ("a.csv", text(("t (s)", "U (V)"), T, 2.5 + 0.8 * A), {"scale": "about 70 degrees"}),
    "a gyroscope": ("a.csv", text(("Time (s)", "Gyroscope x (rad/s)", "Gyroscope y (rad/s)", "Gyroscope z (rad/s)"), T, 0.01 * RATE_OF, RATE_OF, 0.02 * RATE_OF), {}),
    "a board's gyroscope": ("a.csv", text(("time", "ax", "ay", "az", "gx", "gy", "gz"), T, *np.outer([0.1, 0, 9.81], np.cos(A)), *np.outer([0.01, 1, 0.02], np.degrees(RATE_OF))), {}),
    "parts of gravity": ("a.csv", text(("time", "gx", "gy", "gz"), T, 0 * T, 9.81 * np.sin(A), 9.81 * np.cos(A)), {}),
    "Sensor Logger": ("Gyroscope.csv", PHONE, {}),
    "Sensor Logger, packed": ("a.zip", archive(Gyroscope=PHONE, Accelerometer=PHONE), {"sheet": "Gyroscope.csv"}),
    "Sensor Logger's other sensor": ("Accelerometer.csv", PHONE, {}),
    "Sensor Logger's attitude": ("Orientation.csv", text(("time", "seconds_elapsed", "yaw", "qx", "roll", "pitch"), NS, T, NOISE, NOISE, A, NOISE), {}),
    "two clocks": ("a.csv", text(("%time", "field.seq", "field.header.stamp", "field.angular_velocity.x"), NS, np.arange(T.size), NS, RATE_OF), {}),
    "a wrapped angle": ("a.csv", text(DEGREES, T, WRAPPED), {}),
    "a hole": ("a.csv", text(DEGREES, T[HOLE], DEG[HOLE]), {}),
    "lost samples": ("a.csv", text(DEGREES, T[LOST], DEG[LOST]), {}),
    "late stamps": ("a.csv", text(DEGREES, JITTER, DEG), {}),
    "rounded stamps": ("a.csv", text(DEGREES, T.round(1), DEG), {}),
    "samples twice": ("a.csv", text(DEGREES, T[TWICE], DEG[TWICE]), {}),
    "rows out of order": ("a.csv", text(DEGREES, np.roll(T, 100), np.roll(DEG, 100)), {}),
    "a spike": ("a.csv", text(DEGREES, T, spoilt([123], 25.0)), {}),
    "a jump": ("a.csv", text(DEGREES, T, spoilt(np.arange(300, T.size), 4.0)), {}),
    "a cell that is no number": ("a.csv", text(DEGREES, T, DEG).replace(b"\n1.0000,", b"\n1.0000,n/a"), {}),
    "cells that are empty": ("a.csv", rows(DEGREES, T.round(3), ["" if k in (90, 91) else f"{one:.3f}" for k, one in enumerate(DEG)]), {}),
    "held and let go": ("a.csv", text(DEGREES, HELD_T, HELD), {}),
    "a window": ("a.csv", text(DEGREES, T, DEG), {"start": 2.0, "stop": 8.0}),
    "a window that is empty": ("a.csv", text(DEGREES, T, DEG), {"start": 50.0}),
    "at rest": ("a.csv", text(DEGREES, T, STILL), {}),
    "at its rail": ("a.csv", text(DEGREES, T, CLIPPED), {}),
    "too short": ("a.csv", text(DEGREES, T[:20], DEG[:20]), {}),
    "constant": ("a.csv", text(DEGREES, T, np.full(T.size, 3.0)), {}),
    "empty": ("a.csv", b"", {}),
    "words": ("a.csv", b"Dear all,\nhere is the pendulum.\n", {}),
    "two runs": ("a.csv", text(("Run 1: Time (s)", "Run 1: Angle (deg)", "Run 2: Time (s)", "Run 2: Angle (deg)"), T, DEG, T, 0.6 * DEG), {}),
    "one of two runs": ("a.csv", text(("Run 1: Time (s)", "Run 1: Angle (deg)", "Run 2: Time (s)", "Run 2: Angle (deg)"), T, DEG, T, 0.6 * DEG), {"run": "Run 2"}),
    "across the page": ("a.csv", b"\n".join(head + b"," + b",".join(f"{one:.3f}".encode() for one in row) for head, row in ((b"t (s)", T), (b"angle (deg)", DEG))) + b"\n", {}),
    "one row": ("a.txt", " ".join(f"{one:.4f}" for one in A).encode(), {}),
    "one row, rate said": ("a.txt", " ".join(f"{one:.4f}" for one in A).encode(), {"rate": 50}),
    "a list as a program prints it": ("a.txt", str([(round(float(a), 3), round(float(b), 5)) for a, b in zip(T, A, strict=True)]).encode(), {}),
    "a list of Mathematica's": ("a.m.txt", ("{" + ",\n ".join(f"{{{a:.2f}, {b:.5f}}}" for a, b in zip(T, A, strict=True)) + "}\n").encode(), {}),
    "a table of R's": ("a.txt", b'"t" "theta"\n' + "".join(f'"{k}" {a:.2f} {b:.5f}\n' for k, (a, b) in enumerate(zip(T, A, strict=True), 1)).encode(), {}),
    "minutes of arc": ("a.csv", b"t (s),angle\n" + "".join(f"{a:.2f},{'-' * bool(b < 0)}{int(abs(b))}\u00b0{abs(b) % 1 * 60:.1f}'\n" for a, b in zip(T, DEG, strict=True)).encode(), {}),
    "worded lines": ("a.txt", "".join(f"t={a:.3f} s angle: {b:.3f} deg\n" for a, b in zip(T, DEG, strict=True)).encode(), {}),
    "units in the cells": ("a.csv", b"t,angle\n" + "".join(f"{a:.3f} s,{b:.3f} deg\n" for a, b in zip(T, DEG, strict=True)).encode(), {}),
    "degrees in the cells": ("a.csv", b"t (s),angle\n" + "".join(f"{a:.3f},{b:.3f}\u00b0\n" for a, b in zip(T, DEG, strict=True)).encode(), {}),
    "lines of JSON": ("a.txt", "".join(json.dumps({"t": round(a, 3), "angle_deg": round(b, 3)}) + "\n" for a, b in zip(T, DEG, strict=True)).encode(), {}),
    "columns of JSON": ("a.json", json.dumps({"time_s": T.round(3).tolist(), "angle_deg": DEG.round(3).tolist()}).encode(), {}),
    "numbered sensors": ("a.csv", rows(("pin", "t (ms)", "angle (deg)"), np.tile([1, 2], T.size), np.repeat((1e3 * T).round(), 2), np.column_stack([DEG, 0.2 * DEG]).ravel().round(3)), {}),
    "named sensors": ("a.csv", rows(("sensor", "t (ms)", "angle (deg)"), np.tile(["left", "right"], T.size), np.repeat((1e3 * T).round(), 2), np.column_stack([DEG, 0.2 * DEG]).ravel().round(3)), {}),
    "one of the named sensors": ("a.csv", rows(("sensor", "t (ms)", "angle (deg)"), np.tile(["left", "right"], T.size), np.repeat((1e3 * T).round(), 2), np.column_stack([DEG, 0.2 * DEG]).ravel().round(3)), {"run": "sensor right"}),
    "a sensor that swings beside one that does not": ("a.csv", rows(("what", "t (ms)", "value"), np.tile(["imu", "temp"], T.size), np.repeat((1e3 * T).round(), 2), np.column_stack([DEG, 21 + 0 * T]).ravel().round(3)), {}),
    "sensors without a name": ("a.csv", rows(("t (ms)", "angle (deg)"), np.repeat((1e3 * T).round(), 2), np.column_stack([DEG, 0.2 * DEG]).ravel().round(3)), {}),
    "turning points of two sides": ("a.csv", rows(("t (s)", "side", "reading (cm)"), (np.pi / OMEGA * np.arange(40)).round(3), np.tile(["l", "r"], 20), (30 + 20 * 0.97 ** np.arange(40) * np.tile([1, -1], 20)).round(2)), {"kind": "half_swings"}),
    "a workbook": ("a.xlsx", workbook(DEGREES, T, DEG, more=("notes",)), {}),
    "an archive": ("a.zip", archive(swing=text(DEGREES, T, DEG)), {}),
    "an archive of two": ("a.zip", archive(one=text(DEGREES, T, DEG), two=text(DEGREES, T, 0.5 * DEG)), {}),
    "packed by gzip": ("a.csv.gz", gzip.compress(text(DEGREES, T, DEG), mtime=0), {}),
    "packed by gzip, cut": ("a.csv.gz", gzip.compress(text(DEGREES, T, DEG), mtime=0)[:2000], {}),
    "npz": ("a.npz", saved(np.savez, time_s=T, angle_rad=A), {}),
    "MATLAB": ("a.mat", matlab(t=T, theta=A), {"unit": "rad"}),
    "a form that is not read": ("a.pdf", b"%PDF-1.4\n", {}),
    "an unknown argument": ("a.csv", text(DEGREES, T, DEG), {"colum": "angle"}),
}  # fmt: skip


def told(path, options):
    """What is read of a file, line by line, and of each swing some numbers; or why it is not."""
    try:
        found = swingdown.read(path, **options)
    except InputError as problem:
        return {
            key: str(getattr(problem, key)).replace(str(path.parent), "…")
            for key in ("where", "problem", "expected", "mend")
        }
    swings = []
    for one in found.swings:
        series, times = series_of(one), one["time"].values
        numbers = (
            times[0],
            times[-1],
            float(np.median(np.diff(times))),
            series.values[0],
            series.values[-1],
            np.nanmin(series.values),
            np.nanmax(series.values),
        )
        known = [f"{float(one[name].max()):.3g}" for name in sorted(one.data_vars) if "uncertainty" in name]
        swings.append([one.attrs["recording"], series.name, series.attrs["units"], str(times.size), *(f"{x:.4f}" for x in numbers), *known])  # fmt: skip
    return {"taken": list(found.taken), "remarks": list(found.remarks), "swings": swings}


@pytest.mark.parametrize("name", FILES)
def test_what_is_read_is_what_it_was(name, tmp_path):
    file, content, options = FILES[name]
    (tmp_path / file).write_bytes(content)
    held(FROZEN, FILES, name, told(tmp_path / file, options), by_a_decimal)
