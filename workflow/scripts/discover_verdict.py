"""The verdict on a campaign, from the rounds of its search."""

from swingdown import console
from swingdown.discovery.tell.verdict import no_verdict, verdict
from swingdown.pendulum.catalogue import catalogue
from swingdown.sealed import read_json, write_json
from swingdown.status import Status

with console.job(snakemake.log[0]) as say:
    files, known = snakemake.input, catalogue(snakemake.params.effects)
    rounds = read_json(files.rounds)
    if "no_verdict" in rounds[0]:
        found = no_verdict(rounds[0])
    else:
        found = verdict(rounds, known.of(rounds[0].get("reading", "angle")), read_json(files.follows))
        doubt = rounds[0].get("doubt")
        # what is unknown beside it is as little a pendulum's as damping alone says
        if doubt and found["status"] == Status.UNKNOWN:
            out = [{"recording": name, "problem": doubt["problem"]} for name in found["recordings"]]
            members = {"recordings": [], "left_out": [*found["left_out"], *out]}
            found = no_verdict({"campaign": found["campaign"], "no_verdict": doubt} | members)
    write_json(snakemake.output[0], found)
    say(f"{found['campaign']}: {found['status']}. {found['sentence']}")
