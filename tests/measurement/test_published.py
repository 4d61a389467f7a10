"""The shipped study of somebody's pendulum is read from its address, byte for byte what was published."""

import functools
import http.server
import re
import threading

import numpy as np
import pytest
import yaml

from swingdown.errors import InputError
from swingdown.measurement.recording import ingest
from swingdown.measurement.sheet import read_sheet

PUBLISHED = r"https://raw\.githubusercontent\.com/[\w-]+/[\w-]+/[0-9a-f]{40}/[\w/]+/"


@pytest.fixture
def served(root, shared_data, tmp_path):
    """The folder of a server on this machine with the files as they were published, and the shipped sheet with its address."""
    rows = read_sheet(root / "config/published.csv", check_files=False)
    for name, row in rows.iterrows():
        angle = np.degrees(
            np.loadtxt(shared_data / f"real/jensen_rotary/{name}.csv", delimiter=",", skiprows=1)[:, 1]
        )
        titles = f"trigger_start_deg, sample_rate, duration_sec\n{name.removeprefix('rel')}, 1000, 5 \n"
        text = titles + "".join(f"{x:.2f}\n" for x in angle)
        (tmp_path / row["file"].rpartition("/")[2]).write_text(text)

    class Quiet(http.server.SimpleHTTPRequestHandler):
        def log_message(self, *_):
            pass

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Quiet, directory=tmp_path))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    text = (root / "config/published.csv").read_text()
    assert len(re.findall(PUBLISHED, text)) == len(rows) == 3
    (tmp_path / "sheet.csv").write_text(re.sub(PUBLISHED, f"http://127.0.0.1:{server.server_port}/", text))
    yield tmp_path
    server.shutdown()


def test_the_shipped_study_reads_what_was_published(root, served, shared_data):
    settings = yaml.safe_load((root / "config/published.yaml").read_text())
    assert settings["recordings"] == "config/published.csv"
    for name, row in read_sheet(served / "sheet.csv").iterrows():
        assert len(row["sha256"]) == 64
        found = ingest(row, "sheet.csv")
        time, angle = np.loadtxt(shared_data / f"real/jensen_rotary/{name}.csv", delimiter=",", skiprows=1).T
        np.testing.assert_allclose(np.radians(found["signal"].values), angle, atol=1e-8)
        np.testing.assert_allclose(found["time"].values, time, atol=1e-9)
        assert "was released at about" in found.attrs["remarks"]


def test_other_bytes_at_that_address_are_refused(served):
    row = read_sheet(served / "sheet.csv").loc["rel45"]
    path = served / row["file"].rpartition("/")[2]
    path.write_text(path.read_text().replace("-45.27", "-45.28", 1))
    with pytest.raises(InputError, match="the checksum does not match"):
        ingest(row, "sheet.csv")
    path.unlink()
    with pytest.raises(InputError, match="cannot be read"):
        ingest(row, "sheet.csv")


def numbers(tmp_path, text, rate="50"):
    (tmp_path / "a.txt").write_text(text)
    (tmp_path / "s.csv").write_text(f"recording,file,rate_hz,signal_unit\na,{tmp_path}/a.txt,{rate},deg\n")
    return ingest(read_sheet(tmp_path / "s.csv").loc["a"], "s.csv")


SWING = [f"{20 * np.cos(5 * k / 50):.3f}" for k in range(500)]


def test_one_number_a_line_takes_its_times_from_the_sheet(tmp_path):
    found = numbers(tmp_path, "\n".join(["angle", *SWING, "", ""]).replace(".", ","))
    np.testing.assert_allclose(found["signal"].values, [float(x) for x in SWING])
    np.testing.assert_allclose(found["time"].values, np.arange(500) / 50)


def test_what_is_no_number_between_the_numbers_is_told(tmp_path):
    for lines in (["angle", *SWING, "nan"], [*SWING[:9], "", *SWING[9:]]):
        np.testing.assert_allclose(numbers(tmp_path, "\n".join(lines))["signal"].values, [*map(float, SWING)])
    with pytest.raises(InputError, match="column rate_hz"):
        numbers(tmp_path, "\n".join(f"{k},{x}" for k, x in enumerate(SWING)))


def test_a_lone_column_without_a_rate_is_told_of_it(tmp_path):
    with pytest.raises(InputError, match="rate_hz"):
        numbers(tmp_path, "\n".join(SWING), rate="")
