"""Published cases computed by the project's own code, beside their certified values."""

from pathlib import Path

from swingdown import console
from swingdown.sealed import write_csv
from swingdown_trials.certified.table import quantities, table, told

with console.job(snakemake.log[0]) as say:
    found = table(quantities(Path(snakemake.params.folder)))
    write_csv(found, snakemake.output[0])
    say(told(found))
