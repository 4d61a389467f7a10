"""Files in the form of the program that recorded them: Tracker, CASSY Lab, Logger Pro; phyphox's account of the telephone."""

import io

import numpy as np
import openpyxl
import pytest
from exports import zipped

from swingdown.errors import InputError
from swingdown.measurement.files import elements
from swingdown.measurement.files.programs import CLOSED, saved_by_program
from swingdown.measurement.recording import ingest
from swingdown.measurement.sheet import COLUMNS
from swingdown.planning.own import Refused, Taken, files, rows, take

LENGTH, OMEGA = 0.8, 3.5  # m, rad/s
PER_METRE, ORIGIN, TILT = 500.0, (640.0, 100.0), 0.2  # what a project's axes are: px/m, px, rad


def angle(times):
    return 0.5 * np.exp(-0.02 * times) * np.cos(OMEGA * times)


def saved(kind, **properties):
    """An object as Tracker writes it."""
    return f'<object class="{kind}">{"".join(_property(*one) for one in properties.items())}</object>'


def _property(name, value):
    kinds = {str: "string", float: "double", int: "int"}
    if isinstance(value, dict):  # an array of objects by their places
        inside = "".join(f'<property name="[{k}]" type="object">{one}</property>' for k, one in value.items())
        return f'<property name="{name}" type="array">{inside}</property>'
    if isinstance(value, list):
        inside = "".join(f'<property name="item" type="object">{one}</property>' for one in value)
        return f'<property name="{name}" type="collection">{inside}</property>'
    if isinstance(value, np.ndarray):
        text = ",".join(map(str, value))
        return f'<property name="{name}" type="array"><property name="array" type="string">{{{text}}}</property></property>'
    kind = "object" if str(value).startswith("<object") else kinds[type(value)]
    return f'<property name="{name}" type="{kind}">{value}</property>'


def project(masses, scale=PER_METRE, clip=None, delta_t=20.0, start_times=None):
    """A Tracker project with these point masses, ``{name: {frame: (x, y) px}}``; axes as above."""
    frame = "org.opensourcephysics.cabrillo.tracker.PointMass$FrameData"
    video = {} if start_times is None else {"video": saved("media.XuggleVideo", start_times=start_times)}
    tracks = [
        saved(
            "org.opensourcephysics.cabrillo.tracker.PointMass",
            name=name,
            framedata={k: saved(frame, x=float(x), y=float(y)) for k, (x, y) in marks.items()},
        )
        for name, marks in masses.items()
    ]
    axes = saved("FrameData", xorigin=ORIGIN[0], yorigin=ORIGIN[1], angle=float(np.degrees(TILT)), xscale=scale, yscale=scale)  # fmt: skip
    panel = saved(
        "org.opensourcephysics.cabrillo.tracker.TrackerPanel",
        semantic_version="6.1.0",
        videoclip=saved(
            "VideoClip", **video, **(clip or {"startframe": 0, "stepsize": 1, "stepcount": 2000})
        ),
        clipcontrol=saved("StepperClipControl", delta_t=delta_t),
        coords=saved("org.opensourcephysics.media.core.ImageCoordSystem", framedata={0: axes}),
        length_unit="m",
        tracks=[saved("org.opensourcephysics.cabrillo.tracker.CoordAxes", name="axes"), *tracks],
    )
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{panel}'.encode()


def marks(frames, times):
    """Where a bob is in a picture that leans as the axes do: it hangs from their origin, against their y."""
    x = ORIGIN[0] + PER_METRE * LENGTH * np.sin(angle(times) + TILT)
    y = ORIGIN[1] + PER_METRE * LENGTH * np.cos(angle(times) + TILT)
    return dict(zip(map(int, frames), zip(x, y, strict=True), strict=True))


FRAMES = np.arange(1500)


def read(content, name="swing.trk"):
    found = saved_by_program(io.BytesIO(content), name)
    return {key: columns.frame for key, columns in found.items()}


def test_a_point_mass_is_told_along_the_axes_in_metres_at_the_times_of_its_frames():
    times = FRAMES * 0.02
    frame = read(project({"bob": marks(FRAMES, times)}))[""]
    assert list(frame.columns) == ["t (s)", "x (m)", "y (m)"]
    np.testing.assert_allclose(frame["t (s)"], times, atol=1e-9)
    np.testing.assert_allclose(np.hypot(frame["x (m)"], frame["y (m)"]), LENGTH, rtol=1e-9)
    np.testing.assert_allclose(np.arctan2(frame["x (m)"], -frame["y (m)"]), angle(times), atol=1e-9)


def test_the_axes_angle_is_counted_as_tracker_counts_it():
    """Axes turned counter-clockwise by a quarter: what is to the right in the picture is below them."""
    one = project({"bob": {0: (740.0, 100.0), 1: (640.0, 200.0)}}).decode()
    quarter = one.replace(str(float(np.degrees(TILT))), "90.0").encode()
    np.testing.assert_allclose(read(quarter)[""].iloc[:, 1:], [[0, -0.2], [-0.2, 0]], atol=1e-12)


def test_frames_without_a_mark_are_left_out_and_marks_beside_the_steps_too():
    times = FRAMES * 0.02
    all_ = marks(FRAMES, times)
    kept = {k: one for k, one in all_.items() if k not in (100, 101, 102, 500)}
    frame = read(project({"bob": kept}, clip={"startframe": 10, "stepsize": 2, "stepcount": 700}))[""]
    expected = [k for k in range(10, 10 + 1400, 2) if k in kept]
    np.testing.assert_allclose(frame["t (s)"], [(k - 10) * 0.02 for k in expected], atol=1e-9)


def test_frames_have_the_times_that_the_video_gives_them():
    """A telephone's camera takes frames unevenly; the interval that is set stretches them all."""
    video = np.cumsum(np.random.default_rng(1).uniform(25, 42, 400)).round(3)
    masses = {"bob": marks(np.arange(400), video / 1000)}
    clip = {"startframe": 3, "stepsize": 1, "stepcount": 397}
    mean = float((video[-1] - video[3]) / 396)
    frame = read(project(masses, delta_t=mean, clip=clip, start_times=video))[""]
    np.testing.assert_allclose(frame["t (s)"], (video[3:] - video[3]) / 1000, atol=1e-6)
    slow = read(project(masses, delta_t=mean / 4, clip=clip, start_times=video))[""]
    np.testing.assert_allclose(slow["t (s)"], frame["t (s)"] / 4, atol=1e-6)


def test_without_a_scale_positions_are_in_pixels():
    frame = read(project({"bob": marks(FRAMES, FRAMES * 0.02)}, scale=1.0))[""]
    assert list(frame.columns) == ["t (s)", "x (px)", "y (px)"]


def test_each_point_mass_is_a_recording(tmp_path):
    times = FRAMES * 0.02
    path = tmp_path / "two.trk"
    path.write_bytes(
        project({"left": marks(FRAMES, times), "right": marks(FRAMES, 1.1 * times), "never": {}})
    )
    found = take(rows([path], tmp_path)[0], path)
    assert [one.recording.attrs["label"] for one in found if isinstance(one, Taken)] == ["two, left", "two, right"]  # fmt: skip
    assert found[0].recording.attrs["source"] == "Tracker 6.1.0"
    assert "point mass `left`" in found[0].recording.attrs["taken"]


def test_a_tracker_project_gives_the_swing(tmp_path):
    path = tmp_path / "a.trk"
    path.write_bytes(project({"bob": marks(FRAMES, FRAMES * 0.02)}))
    found = ingest({**COLUMNS, "recording": "a", "campaign": "a", "file": str(path)})
    swing = found["signal"].values - found["signal"].values.mean()
    np.testing.assert_allclose(swing, angle(FRAMES * 0.02) - angle(FRAMES * 0.02).mean(), atol=1e-6)


def test_a_zipped_project_is_the_same_as_the_project():
    plain = project({"bob": marks(FRAMES, FRAMES * 0.02)})
    packed = zipped({"swing.trk": plain, "videos/a.mp4": b"x", "html/a_info.html": b"<p>"})
    np.testing.assert_array_equal(read(packed, "swing.trz")[""], read(plain)[""])


@pytest.mark.parametrize(
    ("content", "name", "words"),
    [
        (project({"bob": {}}), "a.trk", "no point mass.*Mend: track the bob"),
        (project({"bob": marks(FRAMES, FRAMES * 0.02)})[:5000], "a.trk", "no XML, or not whole.*save it again in Tracker"),
        (b"\x00\x01", "a.trk", "no XML, or not whole"),
        (zipped({"readme.txt": b"x"}), "a.trz", "no file that ends in .trk"),
        (project({"bob": {1: (1, 2)}}).replace(b"delta_t", b"delta_q"), "a.trk", "no time between frames"),
        (b'<!DOCTYPE a [<!ENTITY b "b"><!ENTITY c "&b;&b;">]><a>&c;</a>', "a.labx", "document type"),
        (b"<cassylab/>", "a.labx", "no channel of times"),
        (b"<Document><DataSet/></Document>", "a.cmbl", "no data set with two columns"),
        (b'<?xml version="1.0" encoding="no-such"?><a/>', "a.cmbl", "cannot be read"),
    ],
)  # fmt: skip
def test_what_is_no_such_file_is_refused_with_its_mend(content, name, words):
    with pytest.raises(InputError, match=words) as caught:
        saved_by_program(io.BytesIO(content), name)
    assert caught.value.mend


def test_a_file_that_would_fill_the_memory_is_refused(monkeypatch):
    monkeypatch.setattr(elements, "LARGEST", 1000)
    for content in (b"<a>" + b" " * 2000 + b"</a>", zipped({"data.xml": b"<a>" + b" " * 2000 + b"</a>"})):
        with pytest.raises(InputError, match="more than 0 MB.*CSV"):
            saved_by_program(io.BytesIO(content), "a.labx")


TIMES = np.round(np.arange(1000) * 0.0201, 6)
DEGREES = np.round(np.degrees(angle(TIMES)), 4)


def logger_pro(*sets):
    def column(name, short, unit, values):
        cells = "\n".join("" if one != one else str(one) for one in values)
        return (
            f"<DataColumn><DataObjectName>{name}</DataObjectName><DataObjectShortName>{short}</DataObjectShortName>"
            f"<ColumnUnits>{unit}</ColumnUnits><ColumnCells>\n{cells}\n</ColumnCells></DataColumn>"
        )

    inside = "".join(
        f"<DataSet><DataSetName>{name}</DataSetName>{column('Time', 't', 's', t)}{column('Angle', 'A', unit, a)}</DataSet>"
        for name, unit, t, a in sets
    )
    functions = "<DataSet><DataSetName>CurveFitFunctions</DataSetName><FunctionModel/></DataSet>"
    return f"<?xml version='1.0'?><Document><FileCoherence>1</FileCoherence>{inside}{functions}</Document>".encode()  # fmt: skip


def test_data_sets_of_logger_pro(tmp_path):
    holed = np.where(np.arange(1000) == 7, np.nan, angle(TIMES))
    found = read(logger_pro(("Latest", "rad", TIMES, holed), ("Run 1", "deg", TIMES, DEGREES)), "a.cmbl")
    assert list(found) == ["Latest", "Run 1"]
    np.testing.assert_array_equal(found["Latest"]["Angle"], holed)
    path = tmp_path / "a.cmbl"
    path.write_bytes(logger_pro(("Latest", "deg", TIMES, DEGREES)))
    one = ingest({**COLUMNS, "recording": "a", "campaign": "a", "file": str(path)})
    np.testing.assert_array_equal(one["signal"].values, DEGREES)


@pytest.mark.parametrize("ending", sorted(CLOSED))
def test_what_only_its_program_reads_is_told_with_the_way_to_a_table(tmp_path, ending):
    path = tmp_path / f"swing{ending}"
    path.write_bytes(b"\x00" * 100)
    assert files([tmp_path])[0] == [path]
    (found,) = take(rows([path], tmp_path)[0], path)
    assert isinstance(found, Refused)
    program, way = CLOSED[ending]
    assert program in found.problem
    assert way in found.mend


CSV = "Time (s),Angle (°)\n" + "".join(f"{t},{a}\n" for t, a in zip(TIMES, DEGREES, strict=True))
DEVICE = [["property", "value"], ["deviceModel", "Nexus 5"], ["deviceBrand", "google"]]
EVENTS = [
    ["event", "experiment time", "system time", "system time text"],
    ["START", 0, 1721470101.7, "2024-07-20 12:08:21.715 UTC+02:00"],
    ["PAUSE", 9.25, 1721470148.0, "2024-07-20 12:09:08.071 UTC+02:00"],
]
AGAIN = [*EVENTS, ["START", 9.25, 1721470160.0, "…"], ["PAUSE", 20.1, 1721470180.0, "…"]]


def phyphox(events, workbook, separator=","):
    if not workbook:
        text = {
            f"meta/{name}.csv": "".join(
                separator.join(f'"{one}"' if isinstance(one, str) else str(one) for one in row) + "\n"
                for row in table
            )
            for name, table in (("device", DEVICE), ("time", events))
        }
        return zipped({"Raw_Data.csv": CSV} | text)
    book = openpyxl.Workbook()
    book.active.title = "Raw Data"
    for row in [["Time (s)", "Angle (°)"], *zip(TIMES, DEGREES, strict=True)]:
        book.active.append(list(row))
    for name, table in (("Metadata Device", DEVICE), ("Metadata Time", events)):
        sheet = book.create_sheet(name)
        for row in table:
            sheet.append(row)
    stream = io.BytesIO()
    book.save(stream)
    return stream.getvalue()


@pytest.mark.parametrize(("name", "separator"), [("a.zip", ","), ("a.zip", ";"), ("a.xlsx", "")])
def test_phyphox_tells_the_telephone_and_when_it_began(tmp_path, name, separator):
    path = tmp_path / name
    row = {**COLUMNS, "recording": "a", "campaign": "a", "file": str(path)}
    path.write_bytes(phyphox(EVENTS, name.endswith("xlsx"), separator))
    found = ingest(row)
    assert found.attrs["device"] == "google Nexus 5"
    assert found.attrs["begun"] == "2024-07-20 12:08:21.715 UTC+02:00"
    assert "paused" not in found.attrs.get("remarks", "")
    path.write_bytes(phyphox(AGAIN, name.endswith("xlsx"), separator))
    assert "phyphox was paused at 9.25 s" in ingest(row).attrs["remarks"]
