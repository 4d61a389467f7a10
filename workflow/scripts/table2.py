"""All norms of the simulation study in one dataset, and the paper's Table 2 from them."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

import pandas as pd

from swingdown import console, dataset
from swingdown.sealed import write_csv
from swingdown.studies.norms import combine_simulated
from swingdown.studies.paper_tables import table2


def collect(parts, published, norms_output, table_output):
    norms = combine_simulated(dataset.read(part) for part in parts)
    dataset.write(norms, norms_output)
    table = table2(norms, pd.read_csv(published))
    write_csv(table, table_output)
    compared = table.dropna(subset=["published_mean", "published_std"])
    inside = (compared["mean"] - compared["published_mean"]).abs() <= compared["published_std"]
    return f"Table 2: {inside.sum()} of {len(compared)} means within one standard deviation of the paper's"


if __name__ == "__main__":
    with console.job(snakemake.log[0]) as say:
        files, made = snakemake.input, snakemake.output
        say(collect(files.norms, files.published, made.norms, made.table))
