"""Verdicts on campaigns of which only the sample sheet and its files are seen."""

from swingdown import console
from swingdown.pendulum.catalogue import catalogue
from swingdown.pendulum.model import Model
from swingdown.sealed import read_bytes, read_json, write_json
from swingdown_trials.find import find
from swingdown_trials.trial import BASE

with console.job(snakemake.log[0]) as say:
    files, params = snakemake.input, snakemake.params
    read_bytes(files.sheet)  # it is as it was written; the swings' own sums stand in it
    base = Model(BASE, catalogue=catalogue(params.effects))
    found = find(files.sheet, base, params.rounds, read_json(files.excluded))
    write_json(snakemake.output[0], found)
    say(f"{len(found)} verdicts in {sum(one['seconds'] for one in found.values()):.0f} s")
