"""Tables of the telephone app Sensor Logger: what their columns hold stands in the file's name alone.

Units: github.com/tszheichoi/awesome-sensor-logger, UNITS.md.
"""

import re

from .table import Table

_CLOCK = "seconds_elapsed"
_AXES, _ATTITUDE = ("x", "y", "z"), ("pitch", "roll", "yaw")
_HELD = {
    "gyroscope": (_AXES, "rad/s"), "accelerometer": (_AXES, "m/s^2"), "totalacceleration": (_AXES, "m/s^2"),
    "gravity": (_AXES, "m/s^2"), "orientation": (_ATTITUDE, "rad"),
}  # fmt: skip
_SENSOR = re.compile(rf"(?i)({'|'.join(_HELD)})")


def with_units(table: Table, file: str) -> Table:
    """The table with the units of its axes where it is the app's, as it is where it is not; ``file`` is its name, which names the sensor."""
    if _CLOCK not in table.names or table.units or not (sensor := _SENSOR.search(file)):
        return table
    names, unit = _HELD[sensor[1].lower()]
    return table._replace(units=dict.fromkeys(names, unit)) if {*names} <= {*table.names} else table
