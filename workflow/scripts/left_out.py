"""The recordings that could not be used, or whose campaign could not be searched, and why: one table of the whole study."""

from pathlib import Path

from swingdown import console
from swingdown.measurement.refused import left_out as row_of
from swingdown.measurement.refused import none_left, taking_part
from swingdown.sealed import read_csv, read_json, write_csv
from swingdown.studies.left_out import explained, left_out

with console.job(snakemake.log[0]) as say:
    files = snakemake.input
    found = [read_json(path) for path in files.verdicts]
    kept, lost = taking_part(files.swings, explained(found))
    if not kept:
        raise none_left(lost)
    lost += [row for path in files.statics if (row := row_of(path))]
    members = {Path(path).stem for path in (*files.swings, *files.statics)}
    table = left_out(lost, found, read_csv(files.before) if files.before else None, members)
    write_csv(table, snakemake.output[0])
    lost = "1 recording was left out" if len(table) == 1 else f"{len(table)} recordings were left out"
    say(lost if len(table) else "every recording could be used")
