"""All fits of the experiment in one dataset, and the tables from them: norms, paired comparison, parameters."""

import pandas as pd

from swingdown import console, dataset
from swingdown.norms import combine_recordings
from swingdown.tables import comparison, parameters, table3, write_table


def collect(fits, published, outputs):
    norms = combine_recordings([dataset.read(path) for path in fits])
    dataset.write(norms, outputs.norms)
    pairs = comparison(norms)
    write_table(table3(norms, pd.read_csv(published)), outputs.table3)
    write_table(pairs, outputs.comparison)
    write_table(parameters(norms), outputs.parameters)
    return "\n".join(
        f"{row.campaign}: {row.verdict}" for row in pairs.itertuples() if "indistinguishable" in row.verdict
    )


if __name__ == "__main__":
    with console.job(snakemake.log[0]) as say:
        say(collect(snakemake.input.fits, snakemake.input.published, snakemake.output))
