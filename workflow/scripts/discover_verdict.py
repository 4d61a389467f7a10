"""The verdict on a campaign, from the rounds of its search."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

from swingdown import console
from swingdown.discovery.verdict import no_verdict, verdict
from swingdown.pendulum.catalogue import catalogue
from swingdown.sealed import read_json, write_json


def discover_verdict(rounds, follows, known, output):
    """The verdict written, and its sentence."""
    rounds = read_json(rounds)
    if "no_verdict" in rounds[0]:
        found = no_verdict(rounds[0])
    else:
        found = verdict(rounds, known.of(rounds[0].get("reading", "angle")), read_json(follows))
        doubt = rounds[0].get("doubt")
        if doubt and found["status"] == "unknown":  # then it is as little a pendulum's as damping alone says
            out = [{"recording": name, "problem": doubt["problem"]} for name in found["recordings"]]
            members = {"recordings": [], "left_out": [*found["left_out"], *out]}
            found = no_verdict({"campaign": found["campaign"], "no_verdict": doubt} | members)
    write_json(output, found)
    return f"{found['campaign']}: {found['status']}. {found['sentence']}"


if __name__ == "__main__":
    with console.job(snakemake.log[0]) as say:
        given = snakemake.input
        say(
            discover_verdict(
                given.rounds, given.follows, catalogue(snakemake.params.effects), snakemake.output[0]
            )
        )
