"""One figure of the paper, as SVG and PNG, from the datasets and tables its function takes."""

from swingdown import console, dataset
from swingdown.measurement.apparatus import read_apparatus
from swingdown.measurement.refused import left_out, none_left
from swingdown.plots import FIGURES, save
from swingdown.sealed import read_csv


def figure(name, data, outputs):
    drawn = FIGURES[name](**{key: opened(path) for key, path in of_one_swing(data).items()})
    for path in outputs:
        save(drawn, path)


def of_one_swing(data):
    """The same paths, where they are lists over all swings those of the first swing that can be used."""
    lists = {key: paths for key, paths in data.items() if not isinstance(paths, str)}
    rows = [[row for path in paths if (row := left_out(path))] for paths in zip(*lists.values(), strict=True)]
    if rows and all(rows):
        raise none_left([lost[0] for lost in rows])
    return data | {key: paths[rows.index([])] for key, paths in lists.items()}


def opened(path):
    """The dataset, table or sheet in a file."""
    if path.endswith(".csv"):
        return read_csv(path)
    return dataset.read(path) if path.endswith(".nc") else read_apparatus(path)


with console.job(snakemake.log[0]):
    figure(snakemake.rule, snakemake.params.data, snakemake.output)
