"""All norms of the simulation study in one dataset, and the paper's Table 2 from them."""

import pandas as pd

from swingdown import console, dataset
from swingdown.sealed import write_csv
from swingdown.studies.norms import combine_simulated
from swingdown.studies.paper_tables import table2

with console.job(snakemake.log[0]) as say:
    files, made = snakemake.input, snakemake.output
    norms = combine_simulated(map(dataset.read, files.norms))
    dataset.write(norms, made.norms)
    table = table2(norms, pd.read_csv(files.published))
    write_csv(table, made.table)
    compared = table.dropna(subset=["published_mean", "published_std"])
    inside = (compared["mean"] - compared["published_mean"]).abs() <= compared["published_std"]
    say(f"Table 2: {inside.sum()} of {len(compared)} means within one standard deviation of the paper's")
