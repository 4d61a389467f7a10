"""What the cells of the sample sheet are called where nobody has written a sheet yet: options of the command, arguments of a call."""

from ..errors import Audience

# The arguments of ``read`` that are called otherwise than the cell; options of the command are called as these are.
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
_ARGUMENT = {cell: name for name, cell in ARGUMENTS.items()}
# The cells that an option of the command stands for.
_OPTIONS = (
    "sheet", "time_column", "time_unit", "rate_hz", "signal_column", "signal_unit", "signal_kind", "input_column", "input_kind", "input_unit",
    "input_free", "input_between", "start_s", "stop_s", "counts_per_revolution", "scale", "zero_tolerance_rad", "length", "bob_diameter",
    "bob_density",
)  # fmt: skip
CELLS = {cell: f"--{_ARGUMENT.get(cell, cell).replace('_', '-')}" for cell in _OPTIONS}
CELLS["pivot_distance"] = "--kater"
_OF_A_CALL = {cell: f"{name}=" for cell, name in _ARGUMENT.items()} | {"restoring": "restoring="}
_ALIKE = ("time_unit", "time_column", "counts_per_revolution", "scale", "length", "run", "sheet")

TO_THE_COMMAND = Audience(CELLS | {"restoring": "--restoring"})
TO_READ = Audience(_OF_A_CALL | {name: f"{name}=" for name in _ALIKE}, pair="{}{}", quoted=True)
TO_FIT = Audience(
    {name: _OF_A_CALL[name] for name in ("signal_unit", "signal_kind", "restoring")}
    | {"scale": "unit='deg', the readings multiplied by them"},
    pair="{}{}",
    quoted=True,
)
