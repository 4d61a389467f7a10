"""Verdicts on campaigns of which only the sample sheet and its files are seen."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

from swingdown import console
from swingdown.pendulum.catalogue import catalogue
from swingdown.pendulum.model import Model
from swingdown.sealed import read_bytes, read_json, write_json
from swingdown_trials.find import find
from swingdown_trials.trial import BASE


def verdicts(sheet, excluded, base, rounds, output):
    """The verdicts written, and how many there are."""
    read_bytes(sheet)  # it is as it was written; the swings' own sums stand in it
    found = find(sheet, base, rounds, read_json(excluded))
    write_json(output, found)
    return f"{len(found)} verdicts in {sum(one['seconds'] for one in found.values()):.0f} s"


if __name__ == "__main__":
    with console.job(snakemake.log[0]) as say:
        inputs, params = snakemake.input, snakemake.params
        base = Model(BASE, catalogue=catalogue(params.effects))
        say(verdicts(inputs.sheet, inputs.excluded, base, params.rounds, snakemake.output[0]))
