"""How a measured drive acts: one effect for each kind, and for each part of its sensor that is open."""

from swingdown.pendulum.catalogue.inputs import FREE, INPUTS, KINDS


def test_each_kind_of_drive_has_the_parts_of_its_sensor_open_that_are_asked_for():
    """None, each alone, and all: a gain multiplies what drives it, and a delay is a parameter of its own."""
    open_ones = [
        tuple(part for part in FREE if any(one.name.endswith(f"_{part}") for one in effect.parameters))
        for effect in INPUTS
    ]
    assert open_ones == [(), *((one,) for one in FREE), tuple(FREE)] * len(KINDS)
    assert len({effect.name for effect in INPUTS}) == len(INPUTS)
    for effect, parts in zip(INPUTS, open_ones, strict=True):
        assert ("g_u" in effect.term) == ("gain" in parts) and "u" in effect.term
