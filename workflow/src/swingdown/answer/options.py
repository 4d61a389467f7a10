"""What the cells of the sample sheet are called where nobody has written a sheet yet: options of the command, arguments of a call."""

from ..errors import Audience

# The options of the command that stand for a cell.
CELLS = {
    "sheet": "--sheet",
    "time_column": "--time-column",
    "time_unit": "--time-unit",
    "rate_hz": "--rate",
    "signal_column": "--column",
    "signal_unit": "--unit",
    "signal_kind": "--kind",
    "input_column": "--input",
    "input_kind": "--input-kind",
    "input_unit": "--input-unit",
    "input_free": "--input-free",
    "input_between": "--input-between",
    "start_s": "--start",
    "stop_s": "--stop",
    "counts_per_revolution": "--counts-per-revolution",
    "scale": "--scale",
    "zero_tolerance_rad": "--zero-tolerance",
    "length": "--length",
    "bob_diameter": "--bob-diameter",
    "bob_density": "--bob-density",
    "pivot_distance": "--kater",
}
# The arguments of ``read`` that are called otherwise than the cell.
ARGUMENTS = {
    "unit": "signal_unit",
    "column": "signal_column",
    "rate": "rate_hz",
    "kind": "signal_kind",
    "start": "start_s",
    "stop": "stop_s",
    "input": "input_column",
    "zero_tolerance": "zero_tolerance_rad",
}
_OF_A_CALL = {cell: f"{name}=" for name, cell in ARGUMENTS.items()} | {"restoring": "restoring="}
_ALIKE = ("time_unit", "time_column", "counts_per_revolution", "scale", "length", "run", "sheet")

TO_THE_COMMAND = Audience(CELLS | {"restoring": "--restoring"})
TO_READ = Audience(_OF_A_CALL | {name: f"{name}=" for name in _ALIKE}, pair="{}{}", quoted=True)
TO_FIT = Audience(
    {name: _OF_A_CALL[name] for name in ("signal_unit", "signal_kind", "restoring")}
    | {"scale": "unit='deg', the readings multiplied by them"},
    pair="{}{}",
    quoted=True,
)
