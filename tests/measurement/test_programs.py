"""Files in the form of the program that recorded them: Tracker, CASSY Lab, Logger Pro; phyphox's account of the telephone."""

import io

import numpy as np
import openpyxl
import pytest
from exports import zipped

import swingdown
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


def channel(quantity, symbol, unit, values):
    cells = "".join(f"<value>{one}</value>" if one == one else "<value />" for one in values)
    return (
        f'<channel datetime="2016-11-03T13:52:12+01:00"><quantity>{quantity}</quantity><symbol>{symbol}</symbol>'
        f'<unit>{unit}</unit><values count="{len(values)}">{cells}</values></channel>'
    )


def cassy(runs):
    """A measurement of CASSY Lab 2: each channel with its runs, a rate that ends earlier, and a spectrum."""
    groups = [
        ("Index", "n", "", [np.arange(1, len(t) + 1) for t, _ in runs]),
        ("Zeit", "t", "s", [t for t, _ in runs]),
        ("Frequenz", "f", "Hz", [np.arange(64.0) for _ in runs]),
        ("Winkel", "&amp;a_A1", "°", [a for _, a in runs]),
        ("omega", "v", "1/s", [np.r_[np.nan, np.diff(a)[:-1]] for _, a in runs]),
        ("Spektrum", "F", "°", [np.arange(64.0) for _ in runs]),
    ]
    inside = "".join(
        f'<channels count="{len(of_runs)}">{"".join(channel(quantity, symbol, unit, one) for one in of_runs)}</channels>'
        for quantity, symbol, unit, of_runs in groups
    )
    return f'\ufeff<?xml version="1.0" encoding="utf-8"?><cassylab><allchannels>{inside}</allchannels></cassylab>'.encode()  # fmt: skip


def cassy_1(columns):
    """A file of CASSY Lab 1: quantities in four lines each, what was computed last, the rows, a spectrum, and how it is drawn."""
    shown = "0 80 10 0 3 0 0 1 0 0 0 0 0 0 1 1"
    own = (("Index", "n", ""), ("Zeit", "t", "s"), ("Frequenz", "f", "Hz"))
    first = [f"{name}\n{symbol}\n{unit}\n{shown}\n" for name, symbol, unit in own]
    more = [f"0 1 0 1\n1 0 0 0 1 0 4 0 0 0 0 0 0 0 0 2500 0\n{name}\n{symbol}\n{unit}\n-1 1 0.5 0 3 0 0 0 0 1 1 0 0 -0.014 1 1\n" for name, symbol, unit in (("Spannung", "U_A1", "V"), ("Spannung", "U_B1", "V"), ("neue Größe", "f_1", "V"))]  # fmt: skip
    rows = "".join("\t".join(map(str, row)) + "\t\n" for row in columns)
    spectrum = "2 30\n" + "".join(f"{k / 10}\t{1 / (1 + k)}\t\n" for k in range(30))
    text = f"CL4\n180 0.1\n{''.join(first)}3 1\n{''.join(more)}4 {len(columns)}\n{rows}{spectrum}1 0 0\n-1\n2\nStandard\n"
    return text.replace("\n", "\r\n").encode("latin-1")


TIMES = np.round(np.arange(1000) * 0.0201, 6)
DEGREES = np.round(np.degrees(angle(TIMES)), 4)


@pytest.mark.parametrize("packed", [False, True])
def test_a_measurement_of_cassy_lab(tmp_path, packed):
    content = cassy([(TIMES, DEGREES)])
    path = tmp_path / "wheel.labx"
    path.write_bytes(zipped({"data.xml": content}) if packed else content)
    found = ingest({**COLUMNS, "recording": "a", "campaign": "a", "file": str(path)})
    np.testing.assert_array_equal(found["signal"].values, DEGREES)
    np.testing.assert_array_equal(found["time"].values, TIMES)
    assert found["signal"].attrs["units"] == "deg"
    assert found.attrs["begun"] == "2016-11-03T13:52:12+01:00"


def test_a_table_of_cassy_lab_1(tmp_path):
    noise = np.round(12 + 0.01 * np.random.default_rng(1).standard_normal(TIMES.size), 3)
    rows = [[k, *row] for k, row in enumerate(zip(TIMES, np.round(DEGREES / 40, 4), noise, strict=True), 1)]
    rows[999][2] = "NAN"
    path = tmp_path / "wheel.lab"
    path.write_bytes(cassy_1(rows))
    (found,) = swingdown.read(path, restoring="linear").swings
    np.testing.assert_array_equal(found["time"].values, TIMES[:999])
    assert found.attrs["own_unit"] == "V"
    assert [*read(cassy_1(rows), "a.lab")[""]] == ["Zeit", "Spannung U_A1", "Spannung U_B1"]
    path.write_text("t,angle\n" + "".join(f"{t},{x}\n" for t, x in zip(TIMES, DEGREES, strict=True)))
    assert swingdown.read(path).swings[0].sizes["time"] == 1000  # another program's
    with pytest.raises(InputError, match="no quantity beside the time"):
        read(cassy_1([[1, 0.0], [2, 0.1]]), "a.lab")


def test_each_run_of_cassy_lab_is_a_recording():
    found = read(cassy([(TIMES, DEGREES), (TIMES[:600], 2 * DEGREES[:600])]), "a.labx")
    assert list(found) == ["run 1", "run 2"]
    assert list(found["run 1"].columns) == ["Zeit", "Winkel", "omega"]
    np.testing.assert_array_equal(found["run 2"]["Winkel"], 2 * DEGREES[:600])
    assert found["run 1"]["omega"].isna().sum() == 2  # before the first, and after its end


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
