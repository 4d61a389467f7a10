"""All fits of the experiment in one dataset, and the tables from them: norms, paired comparison, parameters."""

import pandas as pd

from swingdown import console, dataset
from swingdown.measurement.refused import none_left, taking_part, used
from swingdown.sealed import read_json, write_csv
from swingdown.studies.comparison import comparison
from swingdown.studies.left_out import explained
from swingdown.studies.norms import combine_recordings
from swingdown.studies.paper_tables import table3
from swingdown.studies.parameters import parameter_budget, parameters

with console.job(snakemake.log[0]) as say:
    files, made = snakemake.input, snakemake.output
    kept, lost = taking_part(files.fits, explained(map(read_json, files.verdicts)))
    if not kept:
        raise none_left(lost)
    single = [dataset.read(path) for path in kept]
    norms = combine_recordings(single)
    dataset.write(norms, made.norms)
    write_csv(table3(norms, pd.read_csv(files.published)), made.table3)
    pairs = comparison(norms)
    write_csv(pairs, made.comparison)
    campaigns = {str(one["campaign"].item()) for one in single}
    together = [one for one in used(files.joint)[0] if one.attrs["campaign"] in campaigns]
    write_csv(parameters(norms, together), made.parameters)
    joined = {one.attrs["campaign"] for one in together}
    alone = [one for one in single if str(one["campaign"].item()) not in joined]
    write_csv(parameter_budget([*together, *alone]), made.budget)
    say(f"models compared: {norms.sizes['fitted']}, over swings: {norms.sizes['recording']}")
    for row in pairs.itertuples():
        if "indistinguishable" in row.verdict:
            say(f"{row.campaign}: {row.verdict}")
