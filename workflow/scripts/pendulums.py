"""Period, quality, decay and friction of each recording and pendulum, with the verdict on it, in one table."""

from swingdown import console, dataset
from swingdown.measurement.refused import used
from swingdown.pendulum.catalogue import catalogue
from swingdown.sealed import read_csv, read_json, write_csv
from swingdown.status import Status
from swingdown.studies.gravity import with_gravity
from swingdown.studies.pendulums import pendulums

with console.job(snakemake.log[0]) as say:
    files, params = snakemake.input, snakemake.params
    verdicts = [found for path in files.verdicts if (found := read_json(path))["status"] != Status.NO_VERDICT]
    norms, known = dataset.read(files.norms), catalogue(params.effects)
    table = pendulums(norms, used(list(files.joint))[0], verdicts, read_csv(files.left_out), known)
    table, _ = with_gravity(table, params.stated, params.restoring)
    write_csv(table, snakemake.output[0])
    for row in table.itertuples():
        if row.model == row.model:
            say(f"{row.recording} ({row.campaign}): period {row.period_s_text} s, Q {row.quality_text}")
        else:
            say(f"{row.recording}: {row.remark}")
