"""One recording of the sample sheet as a dataset: signal as recorded, time in s, provenance."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

import pandas as pd

from swingdown import console, dataset
from swingdown.measurement.recording import ingest


def record(row, sheet, output):
    recording = ingest(pd.Series(row, name=row["recording"]), sheet)
    dataset.write(recording, output)
    signal, time = recording["signal"], recording["time"].values
    return (
        f"{row['recording']}: {signal.size} samples over {time[-1] - time[0]:.4g} s, "
        f"{float(signal.min()):.4g} to {float(signal.max()):.4g} {signal.units}"
        + ("; PARTIAL, as the sheet allows" if recording.attrs["partial"] == "yes" else "")
        + "".join(f"\n{recording.attrs[key]}" for key in ("taken", "remarks") if key in recording.attrs)
    )


if __name__ == "__main__":
    with console.job(snakemake.log[0]) as say:
        say(record(snakemake.params.row, snakemake.params.sheet, snakemake.output[0]))
