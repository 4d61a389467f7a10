"""One figure of the paper, as SVG and PNG, from the datasets and tables its function takes."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

from swingdown import console, dataset
from swingdown.measurement.apparatus import read_apparatus
from swingdown.plots import FIGURES, save
from swingdown.sealed import read_csv


def figure(name, data, outputs):
    drawn = FIGURES[name](**{key: opened(path) for key, path in data.items()})
    for path in outputs:
        save(drawn, path)


def opened(path):
    """The dataset, table or sheet in a file."""
    if path.endswith(".csv"):
        return read_csv(path)
    return dataset.read(path) if path.endswith(".nc") else read_apparatus(path)


if __name__ == "__main__":
    with console.job(snakemake.log[0]):
        figure(snakemake.rule, snakemake.params.data, snakemake.output)
