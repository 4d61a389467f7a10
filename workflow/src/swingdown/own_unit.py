"""The unit of swings that are no angle: that of the reading of a wheel or a mass on a spring, whose scale nobody knows.

A spring's pull is as many times the reading as it is times the angle, so that models and searches need no scale. Inside, the largest
swing stands for a tenth of a radian (``measurement.apparent_scale``); what is told is in the reading's own unit.
"""

import re
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np

from .arrays import Floats

UNNAMED = "units"  # of a reading whose unit nobody states
OF_AN_ANGLE = ("detent", "finite_amplitude", "flexible_pivot", "eccentricity")
"""The effects that go with the sine of the angle, or with poles a turn: where nothing is an angle there are none."""
# the power of the angle in a parameter, where its unit does not say it
_POWERS = {
    "quadratic_coefficient": -1, "wind_coefficient": -1, "added_mass": -1, "quadratic_stiffness": -1, "cubic_stiffness": -2,
    "magnet_depth": 2,
}  # fmt: skip
_TURNS = re.compile(r"(frequency|phase)$")  # of what turns: its rad is none of the reading
_SHOWN = {"rad": (180 / np.pi, "°"), "rad/s": (180 / np.pi, "°/s")}
_SMALL = {"rad": (1e3, "mrad"), "rad/s": (1e3, "mrad/s")}


class Own(NamedTuple):
    """A reading's own unit: its ``name``, and how much of it stands for 1 rad (``step``)."""

    name: str
    step: float

    def told(self, name: str, unit: str) -> tuple[float, str]:
        """What a parameter is multiplied by to be in this unit, and its unit then."""
        if _TURNS.search(name):
            return 1.0, unit
        if name == "power_law_coefficient":  # the speed to the power is counted in steps a second
            return self.step, f"{self.name}/s^2 at {self.step:.3g} {self.name}/s"
        power = 1 if unit.startswith("rad") else -1 if unit.endswith("/rad") else 0
        if power:
            return self.step**power, unit.replace("rad", self.name)
        power = _POWERS.get(name, 0)
        beside = f"{self.name}^{abs(power)}" if abs(power) > 1 else self.name
        if power > 0:
            unit = f"{beside}{unit.removeprefix('1')}"
        elif power < 0:
            unit = f"{'1' if unit == '1' else unit}/{beside}"
        return self.step**power, unit

    def entries(self, found: Mapping[str, Mapping[str, Any]]) -> dict[str, dict[str, Any]]:
        """Values by parameter, as verdict.json has them (``value``, an error or two, ``unit``), in this unit."""
        told = {}
        for name, one in found.items():
            times, unit = self.told(name, one["unit"])
            sizes = {key: cell for key, cell in one.items() if key != "unit" and cell is not None}
            told[name] = {**one, **{key: times * cell for key, cell in sizes.items()}, "unit": unit}
        return told

    def covariance(self, names: list[str], units: list[str], cells: list[list[Any]]) -> list[list[Any]]:
        """A covariance of parameters in this unit; None for what is not known."""
        by = [self.told(name, unit)[0] for name, unit in zip(names, units, strict=True)]
        return [
            [cell if cell is None else a * b * cell for b, cell in zip(by, row, strict=True)]
            for a, row in zip(by, cells, strict=True)
        ]


def has_size(name: str, unit: str) -> bool:
    """True for a parameter whose value depends on how large the unit of the angle is."""
    return Own("", 2.0).told(name, unit)[0] != 1.0


def own_of(about: Mapping[str, Any]) -> Own | None:
    """The own unit of a dataset of angles by its attributes; None of angles, and of readings that no spring pulls back."""
    return Own(str(about["own_unit"]), float(about["own_step"])) if "own_unit" in about else None


def shown(values: Any, unit: str) -> tuple[Floats, str]:
    """Values in ``unit`` as figures show them, with what they are then in: of rad degrees."""
    times, symbol = _SHOWN.get(unit, (1.0, unit))
    return times * np.asarray(values, float), symbol


def small(value: float, unit: str, written: Callable[[float], str] = "{:.3g}".format) -> str:
    """A small size in ``unit``, its number ``written`` so: of rad in mrad."""
    times, symbol = _SMALL.get(unit, (1.0, unit))
    return f"{written(times * value)} {symbol}"


def speed(unit: str) -> str:
    """How the speed of what is read in ``unit`` is labelled."""
    return "angular speed (rad/s)" if unit in _SHOWN else f"speed ({unit}/s)"


def axis(unit: str) -> str:
    """What is read in a unit, as an axis is labelled: ``angle (°)``, ``angular rate (°/s)``, ``reading (V)``."""
    what = {"rad": "angle", "rad/s": "angular rate"}.get(unit, "reading")
    return f"{what} ({shown(0.0, unit)[1]})"
