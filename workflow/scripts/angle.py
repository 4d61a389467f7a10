"""One swing in radians, with its uncertainty."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

import numpy as np

from swingdown import console, dataset
from swingdown.measurement.angle import to_angle
from swingdown.measurement.recording import read_recording


def angle(recording, calibration, mode, output):
    calibration = dataset.read(calibration) if calibration else None
    result = to_angle(read_recording(recording), calibration, mode=mode)
    dataset.write(result, output)
    degrees = np.degrees(result["angle"].values)
    uncertainty = np.degrees(float(np.sqrt((result["angle_standard_uncertainty"] ** 2).mean())))
    return (
        f"{result.attrs['recording']}: {degrees.min():.2f}° to {degrees.max():.2f}°, "
        f"standard uncertainty {uncertainty:.2g}° ({result.attrs['mode']})"
    )


if __name__ == "__main__":
    with console.job(snakemake.log[0]) as say:
        files = snakemake.input
        say(angle(files.recording, files.calibration, snakemake.params.mode, snakemake.output[0]))
