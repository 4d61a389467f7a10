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
    read = dataset.series_of(result)
    unit = "°" if read.name == "angle" else "°/s"
    degrees = np.degrees(read.values)
    uncertainty = np.degrees(float(np.sqrt((dataset.series_of(result, "standard_uncertainty") ** 2).mean())))
    return (
        f"{result.attrs['recording']}: {degrees.min():.2f}{unit} to {degrees.max():.2f}{unit}, "
        f"standard uncertainty {uncertainty:.2g}{unit} ({result.attrs['mode']})"
    )


if __name__ == "__main__":
    with console.job(snakemake.log[0]) as say:
        files = snakemake.input
        say(angle(files.recording, files.calibration, snakemake.params.mode, snakemake.output[0]))
