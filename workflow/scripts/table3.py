"""All fits of the experiment in one dataset, and the tables from them: norms, paired comparison, parameters."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

import pandas as pd

from swingdown import console, dataset
from swingdown.measurement.refused import none_left, taking_part, used
from swingdown.sealed import read_json, write_csv
from swingdown.studies.comparison import comparison
from swingdown.studies.left_out import explained
from swingdown.studies.norms import combine_recordings
from swingdown.studies.paper_tables import table3
from swingdown.studies.parameters import parameter_budget, parameters


def collect(fits, joint, verdicts, published, outputs):
    kept, lost = taking_part(fits, explained([read_json(path) for path in verdicts]))
    if not kept:
        raise none_left(lost)
    single = [dataset.read(path) for path in kept]
    campaigns = {str(one["campaign"].item()) for one in single}
    norms = combine_recordings(single)
    dataset.write(norms, outputs.norms)
    pairs = comparison(norms)
    write_csv(table3(norms, pd.read_csv(published)), outputs.table3)
    write_csv(pairs, outputs.comparison)
    together = [one for one in used(joint)[0] if one.attrs["campaign"] in campaigns]
    write_csv(parameters(norms, together), outputs.parameters)
    alone = [
        one
        for one in single
        if str(one["campaign"].item()) not in {each.attrs["campaign"] for each in together}
    ]
    write_csv(parameter_budget([*together, *alone]), outputs.budget)
    alike = [
        f"{row.campaign}: {row.verdict}" for row in pairs.itertuples() if "indistinguishable" in row.verdict
    ]
    return "\n".join(
        [f"models compared: {norms.sizes['fitted']}, over swings: {norms.sizes['recording']}", *alike]
    )


if __name__ == "__main__":
    with console.job(snakemake.log[0]) as say:
        files = snakemake.input
        say(collect(files.fits, files.joint, files.verdicts, files.published, snakemake.output))
