"""One swing in radians, with its uncertainty; of one that no model follows, its longest free stretch."""

import numpy as np

from swingdown import console, dataset
from swingdown.errors import InputError
from swingdown.measurement.angle import to_angle
from swingdown.measurement.points.points_recording import are_points
from swingdown.measurement.recording import read_recording
from swingdown.measurement.refused import problem_in, refuse
from swingdown.measurement.second_reading import TOLD
from swingdown.studies.doubt import free_stretch


def angle(recording, calibration, mode, restoring, output):
    if (problem := problem_in(recording)) is not None:
        return refuse(problem, dataset.attributes(recording), output, known=True)
    calibration, read = dataset.read(calibration) if calibration else None, read_recording(recording)
    try:
        result = free_stretch(to_angle(read, calibration, mode=mode), restoring)
    except InputError as problem:
        return refuse(problem, read.attrs, output)
    dataset.write(result, output)
    series = dataset.series_of(result)
    unit = "°" if series.name == "angle" else "°/s"
    degrees = np.degrees(series.values)
    span = f"{result.attrs['recording']}: {degrees.min():.2f}{unit} to {degrees.max():.2f}{unit}"
    if are_points(result):
        return f"{span} at {series.size} turning points; how they scatter the fit tells"
    uncertainty = np.degrees(float(np.sqrt((dataset.series_of(result, "standard_uncertainty") ** 2).mean())))
    again = f"; {result.attrs[TOLD]}" if TOLD in result.attrs else ""
    return f"{span}, standard uncertainty {uncertainty:.2g}{unit} ({result.attrs['mode']}){again}"


with console.job(snakemake.log[0]) as say:
    files, params = snakemake.input, snakemake.params
    say(angle(files.recording, files.calibration, params.mode, params.restoring, snakemake.output[0]))
