"""The apparatus sheet: what it may not hold is refused by name before anything is computed."""

import copy
import re

import numpy as np
import pytest
import yaml

from swingdown.errors import InputError
from swingdown.measurement.apparatus import encoder_limit, read_apparatus

SHEET = {
    "campaigns": ["bench"],
    "lengths": {
        "arm": {"value": 0.2, "limit": 4e-5},
        "shaft_diameter": {"value": 0.01, "limit": 2e-6},
        "over_shaft": {"value": 0.23, "limit": 4e-5},
        "bob_diameter": {"value": 0.02, "limit": 2e-6},
    },
    "points": [{"height": h, "limit": 4e-5, "file": "tower.csv"} for h in (0.03, 0.05, 0.09)],
    "encoder": {"limits": [{"up_to": 5.0, "limit": 0.015}, {"up_to": 10.0, "limit": 0.025}]},
}


@pytest.fixture
def read(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "tower.csv").write_text("time_s,voltage_V\n")

    def read(change=lambda sheet: None):
        sheet = copy.deepcopy(SHEET)
        change(sheet)
        (tmp_path / "apparatus.yaml").write_text(yaml.safe_dump(sheet))
        return read_apparatus("apparatus.yaml")

    return read


def put(*keys_and_value):
    *keys, last, value = keys_and_value

    def change(sheet):
        for key in keys:
            sheet = sheet[key]
        sheet[last] = value

    return change


def test_defaults(read):
    apparatus = read()
    assert apparatus["lengths"]["arm"]["distribution"] == "uniform"
    assert apparatus["encoder"]["kind"] == "systematic"
    assert apparatus["emulated"] is False and apparatus["rest"]["limit"] > 0


def test_the_encoders_limit_depends_on_the_voltage(read):
    assert encoder_limit(read(), [0.0, 5.0, 5.01, -7.0]) == pytest.approx([0.015, 0.015, 0.025, 0.025])
    with pytest.raises(InputError, match="12 V is beyond the encoder's range"):
        encoder_limit(read(), 12.0)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (put("points", 2, "height", 0.3), ["points[3].height", "the tower is above the arm"]),
        (put("points", 2, "height", 0.2151), ["points[3].height", "the tower is above the arm"]),
        (put("points", 0, "height", 0.001), ["points[1].height", "does not reach"]),
        (put("points", SHEET["points"][:2]), ["key points", "2 calibration point", "at least 3"]),
        (put("points", 0, "limit", 0.0), ["points[1].limit", "> 0"]),
        (put("lengths", "arm", "limit", -4e-5), ["lengths.arm.limit", "> 0"]),
        (put("encoder", "limits", 0, "limit", 0), ["encoder.limits[1].limit", "> 0"]),
        (put("rest", {"limit": 0}), ["rest.limit", "> 0"]),
        (put("lengths", "arm", "value", 0), ["lengths.arm.value", "> 0"]),
        (put("lengths", "arm", {"value": 0.2}), ["lengths.arm", "'limit' is missing"]),
        (put("lengths", "arm", "limt", 1e-5), ["lengths.arm.limt", "unknown key", "'limit'"]),
        (put("campaign", "bench"), ["campaign", "unknown key", "'campaigns'"]),
        (put("lengths", "arm", "distribution", "flat"), ["lengths.arm.distribution", "'flat'"]),
        (put("points", 1, "file", "gone.csv"), ["points[2].file", "no file gone.csv"]),
        (put("encoder", "limits", SHEET["encoder"]["limits"][::-1]), ["encoder.limits", "rise"]),
        (put("encoder", "limits", []), ["encoder.limits"]),
        (put("encoder", "limits", 0, "limit", 9.0), ["encoder.limits", "9 V, larger than the readings"]),
        (
            put("encoder", "limits", 1, "limit", 5e-324),
            ["encoder.limits", "less than the last digit of 10 V"],
        ),
        (put("lengths", "arm", "limit", 3.0), ["lengths.arm", "3 m, larger than the readings"]),
        (put("points", 1, "limit", 0.5), ["points[2]", "0.5 m, larger than the readings"]),
        (put("campaigns", []), ["campaigns"]),
    ],
)
def test_what_an_apparatus_sheet_may_not_hold(read, change, told):
    with pytest.raises(InputError) as caught:
        read(change)
    for part in ("apparatus.yaml", *told, "Expected:", "Mend:"):
        assert part in str(caught.value), str(caught.value)


def test_something_that_is_no_sheet(tmp_path):
    with pytest.raises(InputError, match=r"gone\.yaml: there is no such"):
        read_apparatus(tmp_path / "gone.yaml")
    (tmp_path / "a.yaml").write_text("a: [1")
    with pytest.raises(InputError, match=r"a\.yaml.*cannot be read as YAML"):
        read_apparatus(tmp_path / "a.yaml")
    (tmp_path / "a.yaml").write_text("- 1")
    with pytest.raises(InputError, match=r"a\.yaml"):
        read_apparatus(tmp_path / "a.yaml")


def test_the_shipped_sheet_is_that_of_the_emulated_bench(root):
    apparatus = read_apparatus(root / "config/apparatus.yaml")
    truth = yaml.safe_load((root / "resources/bench/truth.yaml").read_text())
    assert apparatus["emulated"] and apparatus["campaigns"] == ["bench", "bench_b"]
    for name, entry in apparatus["lengths"].items():
        assert abs(entry["value"] - truth["lengths_m"][name]) <= entry["limit"]
    for k, point in enumerate(apparatus["points"], 1):
        assert abs(point["height"] - truth["records"][f"tower_{k}"]["height_m"]) <= point["limit"]
    encoder = truth["encoder"]
    volts = np.linspace(0, 10, 50)
    angle = (volts - encoder["zero_V"]) * encoder["slope_rad_per_V"]
    nominal = encoder["nominal_zero_V"] + angle / encoder["nominal_slope_rad_per_V"]
    assert np.all(np.abs(volts - nominal) <= encoder_limit(apparatus, volts))


def test_the_heights_that_a_refusal_names_are_the_ends_of_those_that_can_be(read):
    with pytest.raises(InputError) as caught:
        read(put("points", 0, "height", 5.0))
    low, high = map(float, re.findall(r"[-\d.]+(?= and| m)", caught.value.expected))
    for height in (low + 1e-5, high - 1e-5):
        read(put("points", 0, "height", height))
    for height in (low - 1e-4, high + 1e-4):
        with pytest.raises(InputError, match="the tower is above|does not reach"):
            read(put("points", 0, "height", height))
