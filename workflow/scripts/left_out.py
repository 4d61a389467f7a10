"""The recordings that could not be used, or whose campaign could not be searched, and why: one table of the whole study."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

from pathlib import Path

from swingdown import console
from swingdown.measurement.refused import left_out as row_of
from swingdown.measurement.refused import none_left, taking_part
from swingdown.sealed import read_csv, read_json, write_csv
from swingdown.studies.left_out import explained, left_out


def collect(swings, statics, verdicts, before, output):
    """The table written, and how many recordings are in it; InputError where nothing is left of the study."""
    found = [read_json(path) for path in verdicts]
    kept, lost = taking_part(swings, explained(found))
    if not kept:
        raise none_left(lost)
    lost += [row for path in statics if (row := row_of(path))]
    members = {Path(path).stem for path in (*swings, *statics)}
    table = left_out(lost, found, read_csv(before) if before else None, members)
    write_csv(table, output)
    return f"{len(table)} recordings were left out" if len(table) else "every recording could be used"


if __name__ == "__main__":
    with console.job(snakemake.log[0]) as say:
        files = snakemake.input
        say(collect(files.swings, files.statics, files.verdicts, files.before, snakemake.output[0]))
