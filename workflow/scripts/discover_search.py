"""The search for what a campaign's model lacks, written as a folder a round; rounds that it did not need repeat the last."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

from pathlib import Path

from swingdown import console
from swingdown.discovery import files
from swingdown.discovery.conclusion import concluded
from swingdown.discovery.search import discover
from swingdown.pendulum.catalogue import catalogue
from swingdown.pendulum.model import Model


def discover_search(campaign, angles, roles, base, rounds, budget_s, folders):
    """The rounds' folders written, and what was found in a sentence."""
    swings, emulated = files.read_campaign(campaign, angles, roles)
    states = concluded(discover(swings, base, rounds, budget_s=budget_s), swings)
    files.write_rounds(states, swings, folders, emulated)
    last = states[-1]
    gap = last.fit.rms / last.noise.deviation
    return f"{campaign}: {last.fit.model.label} leaves {gap:.3g} times the noise; {last.reason}"


if __name__ == "__main__":
    with console.job(snakemake.log[0]) as say:
        params, wildcards = snakemake.params, snakemake.wildcards
        base = Model(tuple(params.base), **params.model, catalogue=catalogue(params.effects))
        folders = sorted({Path(path).parent for path in snakemake.output}, key=lambda one: int(one.name[6:]))
        say(
            discover_search(
                wildcards.campaign, list(snakemake.input.angles), params.roles, base, params.rounds, params.budget_s, folders
            )
        )  # fmt: skip
