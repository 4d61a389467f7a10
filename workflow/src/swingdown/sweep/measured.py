"""A pendulum that was measured, as the one that a sweep simulates: what its campaign's discovery found."""

from pathlib import Path

from ..errors import InputError
from ..pendulum.catalogue import ANGLE, catalogue
from ..pendulum.model_file import read_model
from ..sealed import read_json

_CONFIG = ("natural_frequency", "viscous_ratio", "quadratic_coefficient", "load_friction")


def of_pendulum(entry, place, own=None):
    """The settings (by key) that a sweep's key ``pendulum`` stands for; none where it has none.

    It names a model file, or the folder of a campaign in ``results/discovery``: the model of its last round, and the noise that
    was measured. InputError where neither is there.
    """
    if not entry.get("pendulum"):
        return {}
    path = Path(entry["pendulum"])
    file = path / "last/model.yaml" if path.is_dir() else path
    if not file.is_file():
        raise InputError(place, f"{path} is no model file, nor the folder of a campaign that was searched", "a file such as last/model.yaml",
                         "run `snakemake discover` first, or correct the path")  # fmt: skip
    model = read_model(file, catalogue(own))
    if model.reading != ANGLE:
        raise InputError(place, f"{file} is the model of a recording of an angular rate", "a model of angles, which is what sweeps simulate",
                         "name a campaign of angles, or leave `pendulum` out and state the values")  # fmt: skip
    found = {"model.restoring": model.restoring, "model.form": model.form}
    for name, value in model.values.items():
        found[f"{'simulation' if name in _CONFIG else 'parameters'}.{name}"] = float(value)
    if entry["computes"] == "identification":
        return found | {"simulation.simulated": [model.label]}
    found["discovery.base"] = list(model.names)
    verdict = path / "verdict.json"
    if verdict.is_file():
        found["detection.noise_rad"] = float(read_json(verdict)["noise_rms_rad"])
    return found
