"""A config that cannot be meant is refused, naming the key, what was expected, and the mend."""

import pytest
import yaml

from swingdown.errors import InputError
from swingdown.pendulum.model import BASES
from swingdown.planning.settings import complete


def test_the_shipped_config_is_the_defaults_with_the_bench(root):
    shipped = yaml.safe_load((root / "config/config.yaml").read_text())
    files = {"recordings": shipped.pop("recordings"), "apparatus": shipped.pop("apparatus")}
    defaults = complete({})
    assert shipped["experiment"].pop("campaigns") == ["bench"]
    assert defaults["experiment"].pop("campaigns") == []
    assert shipped.pop("discovery") == defaults.pop("discovery") | {
        "campaigns": ["bench", "bench_b"],
        "base": ["quadratic_drag", "load_coulomb"],
    }
    assert defaults.pop("effects") == {} and defaults.pop("hidden_effects")["seed"] == 2026
    assert defaults.pop("sweeps") == {}
    assert defaults.pop("coverage") == {"seed": 2026, "calibrations": 5000, "swings": 5000, "together": 2000}
    assert shipped == defaults
    assert complete(files) == complete({}) | files


@pytest.mark.parametrize("restoring", ["sine", "linear"])
def test_a_search_starts_from_the_same_base_by_the_settings_and_by_a_call(restoring):
    model = {"model": {"restoring": restoring}}
    assert complete(model)["discovery"]["base"] == list(BASES[restoring])
    assert complete(model | {"discovery": {"base": ["viscous"]}})["discovery"]["base"] == ["viscous"]
    assert complete({}) == complete({"model": {"restoring": "sine"}})


def test_what_is_given_is_kept_and_the_given_config_is_not_changed():
    given = {"simulation": {"snr": 10}, "model": None}
    settings = complete(given)
    assert settings["simulation"]["snr"] == 10
    assert settings["simulation"]["realizations"] == 10
    assert settings["model"] == {"restoring": "sine", "form": "consistent"}
    assert given == {"simulation": {"snr": 10}, "model": None}


@pytest.mark.parametrize(
    ("config", "key", "told"),
    [
        ({"sead": 1}, "sead", "seed"),
        ({"simulation": {"realisations": 3}}, "simulation.realisations", "realizations"),
        ({"snr": 3}, "snr", "simulation.snr"),
        ({"simulation": {"seed": 3}}, "simulation.seed", "it belongs at seed"),
        ({"seed": "1e3"}, "seed", "1000"),
        ({"seed": -1}, "seed", "≥ 0"),
        ({"seed": 1.5}, "seed", "a whole number"),
        ({"seed": True}, "seed", "a whole number"),
        ({"simulation": {"snr": 0}}, "simulation.snr", "> 0"),
        ({"simulation": {"snr": float("nan")}}, "simulation.snr", "nan is not a finite number"),
        ({"simulation": {"duration_s": ".inf"}}, "simulation.duration_s", "is not a number"),
        ({"simulation": {"duration_s": float("inf")}}, "simulation.duration_s", "not a finite number"),
        ({"simulation": {"realizations": 1}}, "simulation.realizations", "≥ 2"),
        ({"simulation": {"noise": "propotional"}}, "simulation.noise", "'proportional'"),
        ({"simulation": {"simulated": ["viscus"]}}, "simulation.simulated[1]", "'viscous'"),
        ({"simulation": "fast"}, "simulation", "a group of keys"),
        ({"experiment": {"fitted": []}}, "experiment.fitted", "at least 1"),
        ({"experiment": {"fitted": ["viscous+quadratic_drg"]}}, "experiment.fitted[1]", "'quadratic_drag'"),
        (
            {"experiment": {"fitted": ["load_coulomb+viscous"]}},
            "experiment.fitted[1]",
            "'viscous+load_coulomb'",
        ),
        ({"experiment": {"fitted": ["viscous+viscous"]}}, "experiment.fitted[1]", "twice"),
        ({"discovery": {"base": ["viscosity"]}}, "discovery.base[1]", "'viscous'"),
        ({"discovery": {"rounds": -1}}, "discovery.rounds", "≥ 0"),
        ({"recordings": ""}, "recordings", "text"),
    ],
)
def test_a_bad_key_or_value_is_named_with_the_mend(config, key, told):
    with pytest.raises(InputError) as refused:
        complete(config, where="mine.yaml")
    assert refused.value.where == f"mine.yaml, key {key}"
    assert told in str(refused.value)
    assert refused.value.expected
    assert refused.value.mend


def test_a_config_that_is_no_mapping_is_refused():
    with pytest.raises(InputError, match="keys and values"):
        complete(["recordings"])


def test_what_the_command_line_says_of_a_capture_is_read_as_yaml():
    """Snakemake makes text of every value within a group."""
    settings = complete(
        {"capture": {"duration_s": "null", "trigger": {"threshold": "0.05"}, "notes": "7"}, "live": "true"}
    )
    assert settings["live"] is True
    capture = settings["capture"]
    assert capture["duration_s"] is None and capture["notes"] == "7" and capture["rate_hz"] == 100
    assert capture["trigger"] == {"threshold": 0.05, "pre_s": 0.5, "wait_s": 120}
    with pytest.raises(InputError, match=r"capture\.duration_s: 'soon' does not fit.*a number or null > 0"):
        complete({"capture": {"duration_s": "soon"}})


@pytest.mark.parametrize(
    ("setting", "told"),
    [
        ({"calibration": {"draws": 10**12}}, "2000000"),
        ({"simulation": {"natural_frequency": 1e308}}, "10000"),
        ({"simulation": {"realizations": 10**9}}, "1000000"),
        ({"simulation": {"duration_s": 1e5, "sampling_rate_hz": 1000}}, "take 8 GB"),
    ],
)
def test_settings_that_cannot_be_computed_say_what_they_would_take(setting, told):
    with pytest.raises(InputError, match=told):
        complete(setting)
