"""One round of discovery: fit, look where the model fails, rank what could mend it; or pass the last round on."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

import shutil
from pathlib import Path

from swingdown import console
from swingdown.discovery import files
from swingdown.discovery.rounds import first_fit, fit_from, look
from swingdown.pendulum.catalogue import catalogue
from swingdown.pendulum.model import Model


def discover_round(campaign, angles, roles, base, previous, number, rounds, output):
    """The round's folder written, and what it found in a sentence."""
    swings, emulated = files.read_campaign(campaign, angles, roles)
    found = ()
    if previous is None:
        fit = first_fit(swings, base)
    else:
        start = files.read_rounds([previous])[0]["next"]
        if start is None:  # nothing to add: the round hands its model on
            shutil.copytree(previous, output, dirs_exist_ok=True)
            return f"{campaign}: round {number} has nothing to do"
        fit, found = fit_from(swings, files.begin(start, base, swings.slack)), tuple(start["found"])
    state = look(number, swings, fit, found, last=number == rounds)
    files.write_round(state, swings, output, emulated)
    said = state.chosen.move if state.chosen else state.reason
    return f"{campaign}: {state.fit.model.label} leaves {state.fit.rms / state.noise.deviation:.3g} times the noise; {said}"


if __name__ == "__main__":
    with console.job(snakemake.log[0]) as say:
        params, wildcards = snakemake.params, snakemake.wildcards
        base = Model(tuple(params.base), **params.model, catalogue=catalogue(params.effects))
        previous = snakemake.input.get("previous")
        say(
            discover_round(
                wildcards.campaign, list(snakemake.input.angles), params.roles, base,
                Path(previous).parent if previous else None, int(wildcards.n), params.rounds,
                Path(snakemake.output.model).parent,
            )
        )  # fmt: skip
