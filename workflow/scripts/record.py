"""One recording of the sample sheet as a dataset: signal as recorded, time in s, provenance; or why it cannot be used."""

import pandas as pd

from swingdown import console, dataset
from swingdown.errors import InputError
from swingdown.measurement.recording import ingest
from swingdown.measurement.refused import may_pass, refuse


def record(row, sheet, restoring, calibrated, output):
    try:
        recording = ingest(pd.Series(row, name=row["recording"]), sheet, restoring, calibrated)
    except InputError as problem:
        if may_pass(problem, row):
            raise
        return refuse(problem, row, output)
    dataset.write(recording, output)
    signal, time = recording["signal"], recording["time"].values
    return (
        f"{row['recording']}: {signal.size} samples over {time[-1] - time[0]:.4g} s, "
        f"{float(signal.min()):.4g} to {float(signal.max()):.4g} {signal.units}"
        + ("; PARTIAL, as the sheet allows" if recording.attrs["partial"] == "yes" else "")
        + "".join(f"\n{recording.attrs[key]}" for key in ("taken", "remarks") if key in recording.attrs)
    )


with console.job(snakemake.log[0]) as say:
    say(
        record(
            snakemake.params.row,
            snakemake.params.sheet,
            snakemake.params.restoring,
            snakemake.params.calibrated,
            snakemake.output[0],
        )
    )
