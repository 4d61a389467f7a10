"""What a draw is known by stays: with another key what was computed before would be computed anew."""

import pytest

from swingdown.sweep.draws import cell_key, noise_key, stream, value_of

SETTINGS = {
    "seed": 150,
    "simulation.snr": 50,
    "simulation.fitted": ["viscous"],
    "simulation.start": "rest",
    "detection.noise": "additive",
}
KEY = "8650ce86c08aa6e62ebbffd7028c7e2d"


def test_keys_are_what_they_were():
    known = {"seed": 150, "simulation.snr": 50, "simulation.fitted": ["viscous"]}
    for settings in (known, known | {"detection.noise": "additive"}, dict(reversed(known.items()))):
        assert cell_key("identification", settings) == "0a1ef1286d702f819f557604a3f1404e"
        assert noise_key(settings) == KEY
    assert cell_key("detection", known) != cell_key("identification", known)
    assert cell_key("identification", known | {"detection.noise": "proportional"}) != cell_key(
        "identification", known
    )


@pytest.mark.parametrize(
    ("key", "value", "same"),
    [("seed", 1, True), ("simulation.fitted", [], True), ("simulation.start", "free", True), ("discovery.base", [], True),
     ("discovery.rounds", 2, True), ("simulation.snr", 20, False), ("detection.snr", 5.0, False), ("detection.snr", None, True)],
)  # fmt: skip
def test_the_noise_of_a_swing_does_not_depend_on_what_is_fitted_to_it(key, value, same):
    assert (noise_key(SETTINGS | {key: value}) == noise_key(SETTINGS)) is same
    assert (cell_key("identification", SETTINGS | {key: value}) == cell_key("identification", SETTINGS)) is (
        value is None
    )


def test_a_draw_is_of_the_seed_the_swing_and_its_number_alone():
    first = stream(SETTINGS, KEY, 3).standard_normal(2)
    assert first == pytest.approx([1.26797858, -0.77038274], abs=1e-8)
    assert list(stream(SETTINGS, KEY, 3).standard_normal(2)) == list(first)
    others = (
        stream(SETTINGS, KEY, 4),
        stream(SETTINGS | {"seed": 151}, KEY, 3),
        stream(SETTINGS, KEY[::-1], 3),
    )
    assert all(one.standard_normal() != first[0] for one in others)


def test_a_parameter_is_where_the_settings_have_it():
    settings = {
        "simulation.viscous_ratio": 0.1,
        "parameters.viscous_ratio": 0.2,
        "parameters.magnet_depth": 0.3,
    }
    assert value_of(settings, "viscous_ratio") == 0.1 and value_of(settings, "magnet_depth") == 0.3
