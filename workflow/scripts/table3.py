"""All fits of the experiment in one dataset, and the tables from them: norms, paired comparison, parameters."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

import pandas as pd

from swingdown import console, dataset
from swingdown.studies.norms import combine_recordings
from swingdown.studies.paper_tables import comparison, table3, write_table
from swingdown.studies.parameters import parameter_budget, parameters


def collect(fits, joint, published, outputs):
    single = [dataset.read(path) for path in fits]
    norms = combine_recordings(single)
    dataset.write(norms, outputs.norms)
    pairs = comparison(norms)
    write_table(table3(norms, pd.read_csv(published)), outputs.table3)
    write_table(pairs, outputs.comparison)
    together = [dataset.read(path) for path in joint]
    write_table(parameters(norms, together), outputs.parameters)
    alone = [
        one
        for one in single
        if str(one["campaign"].item()) not in {each.attrs["campaign"] for each in together}
    ]
    write_table(parameter_budget([*together, *alone]), outputs.budget)
    alike = [
        f"{row.campaign}: {row.verdict}" for row in pairs.itertuples() if "indistinguishable" in row.verdict
    ]
    return "\n".join(
        [f"{norms.sizes['fitted']} models compared over {norms.sizes['recording']} swings", *alike]
    )


if __name__ == "__main__":
    with console.job(snakemake.log[0]) as say:
        files = snakemake.input
        say(collect(files.fits, files.joint, files.published, snakemake.output))
