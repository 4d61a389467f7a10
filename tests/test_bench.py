"""The emulated bench: it says what it is, is what its checksums say, and can be made again byte for byte."""

import ast
import hashlib
import importlib.util

import numpy as np
import pytest
import yaml

from swingdown.measurement.recording import ingest
from swingdown.measurement.sheet import read_sheet


@pytest.fixture(scope="module")
def bench(root):
    return root / "resources/bench"


@pytest.fixture(scope="module")
def emulate(bench):
    spec = importlib.util.spec_from_file_location("emulate", bench / "emulate.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_emulation_writes_the_same_bytes_again(bench, emulate, tmp_path):
    names = ["swing_03", "tower_2"]
    emulate.main(tmp_path, names)
    assert sorted(path.stem for path in tmp_path.iterdir()) == names
    for name in names:
        assert (tmp_path / f"{name}.csv").read_bytes() == (bench / f"{name}.csv").read_bytes()


def test_the_truth_beside_the_records_is_that_of_the_script(bench, emulate):
    truths = {name: truth for name, *_, truth in emulate.records()}
    assert (bench / "truth.yaml").read_text(encoding="utf-8") == emulate.truth_text(truths)


def test_checksums_hold_in_every_place_they_are_written(root, bench):
    sums = dict(reversed(line.split()) for line in (bench / "SHA256SUMS").read_text().splitlines())
    assert sorted(sums) == sorted(path.name for path in bench.glob("*.csv"))
    for name, digest in sums.items():
        assert hashlib.sha256((bench / name).read_bytes()).hexdigest() == digest
    table = read_sheet(root / "config/recordings.csv")
    apparatus = yaml.safe_load((root / "config/apparatus.yaml").read_text())
    told = {row.file.split("/")[-1]: row.sha256 for row in table.itertuples()}
    told |= {point["file"].split("/")[-1]: point["sha256"] for point in apparatus["points"]}
    assert told == sums


def test_the_emulation_shares_no_code_with_what_is_tried_on_it(bench):
    tree = ast.parse((bench / "emulate.py").read_text())
    names = {alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names}
    names |= {node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    assert not [name for name in names if name.startswith("swingdown")]


def test_every_record_says_it_is_emulated_and_can_be_used(root):
    table = read_sheet(root / "config/recordings.csv")
    swings = table[table.role != "static"]
    assert len(swings) >= 10 and list(table.role).count("static") == 1
    for _, row in table.iterrows():
        recording = ingest(row)
        assert recording.attrs["emulated"] == "yes" and "no real apparatus" in recording.attrs["source"]
        assert recording.sizes["time"] == (3000 if row.campaign == "bench" else 2000)
        assert np.diff(recording["time"]) == pytest.approx(0.01)


def test_every_swing_still_moves_at_the_end_and_starts_at_its_highest(root):
    table = read_sheet(root / "config/recordings.csv")
    for name, row in table[table.role != "static"].iterrows():
        volts = ingest(row)["signal"].values - 5.0065
        assert np.abs(volts).max() < np.abs(volts[0]) + 0.01, name  # the noise is 2 mV
        assert np.abs(volts[-100:]).max() > (0.4 if row.campaign == "bench" else 0.1), (
            name
        )  # 3 degrees, or 0.7


def test_the_emulated_motion_loses_what_its_forces_take(emulate):
    """Energy at two turning points differs by the work of drag and friction between them, by plain quadrature."""
    times = np.linspace(0, 0.5, 200_001)
    angle = emulate.motion(times, 0.5)
    velocity = np.gradient(angle, times, edge_order=2)
    moving = slice(0, int(np.argmin(angle)) + 1)
    wn, q, g = emulate.NATURAL_FREQUENCY, emulate.QUADRATIC_COEFFICIENT, emulate.LOAD_FRICTION
    power = (
        wn * q * velocity * np.abs(velocity) + g * (velocity**2 + wn**2 * np.cos(angle)) * np.sign(velocity)
    ) * velocity
    lost = np.trapezoid(power[moving], times[moving])
    fallen = wn**2 * (np.cos(angle[moving][-1]) - np.cos(0.5))
    assert lost == pytest.approx(fallen, rel=1e-5)
    assert fallen > 0.01


def test_the_emulated_bob_sticks_where_friction_holds_it(emulate):
    times = np.linspace(0, 10, 1001)
    angle = emulate.motion(times, 0.9 * emulate.LOAD_FRICTION)
    assert angle == pytest.approx(0.9 * emulate.LOAD_FRICTION)
    late = emulate.motion(np.linspace(0, 200, 2001), 0.1)
    assert np.ptp(late[-500:]) == 0 and abs(late[-1]) <= emulate.LOAD_FRICTION
