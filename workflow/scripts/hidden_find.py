"""Verdicts on campaigns of which only the sample sheet and its files are seen."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

import json
from pathlib import Path

from swingdown import console
from swingdown.paths import write_text
from swingdown.pendulum.catalogue import catalogue
from swingdown.pendulum.model import Model
from swingdown.trials.find import find
from swingdown.trials.trial import BASE


def verdicts(sheet, excluded, base, rounds, output):
    """The verdicts written, and how many there are."""
    found = find(sheet, base, rounds, json.loads(Path(excluded).read_text()))
    write_text(output, json.dumps(found, indent=1) + "\n")
    return f"{len(found)} verdicts in {sum(one['seconds'] for one in found.values()):.0f} s"


if __name__ == "__main__":
    with console.job(snakemake.log[0]) as say:
        inputs, params = snakemake.input, snakemake.params
        base = Model(BASE, catalogue=catalogue(params.effects))
        say(verdicts(inputs.sheet, inputs.excluded, base, params.rounds, snakemake.output[0]))
