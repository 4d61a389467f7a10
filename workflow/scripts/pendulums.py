"""Period, quality, decay and friction of each recording and pendulum, with the verdict on it, in one table."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

from swingdown import console, dataset
from swingdown.measurement.refused import used
from swingdown.pendulum.catalogue import catalogue
from swingdown.sealed import read_csv, read_json, write_csv
from swingdown.studies.gravity import with_gravity
from swingdown.studies.left_out import NO_VERDICT
from swingdown.studies.pendulums import pendulums


def collect(norms, joint, verdicts, left_out, known, stated, restoring, output):
    """The table written, and a line on each of its rows."""
    table = pendulums(
        dataset.read(norms),
        used(joint)[0],
        [found for path in verdicts if (found := read_json(path))["status"] != NO_VERDICT],
        read_csv(left_out),
        known,
    )
    table, _ = with_gravity(table, stated, restoring)
    write_csv(table, output)
    return "\n".join(
        f"{row.recording} ({row.campaign}): period {row.period_s_text} s, Q {row.quality_text}"
        if row.model == row.model
        else f"{row.recording}: {row.remark}"
        for row in table.itertuples()
    )


if __name__ == "__main__":
    with console.job(snakemake.log[0]) as say:
        files = snakemake.input
        say(
            collect(
                files.norms, list(files.joint), list(files.verdicts), files.left_out,
                catalogue(snakemake.params.effects), snakemake.params.stated, snakemake.params.restoring, snakemake.output[0],
            )
        )  # fmt: skip
