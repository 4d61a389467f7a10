"""The search for what a campaign's model lacks, and what follows a change between its recordings."""

from pathlib import Path

from swingdown import console, dataset
from swingdown.discovery.budget import Budget
from swingdown.discovery.change import difference
from swingdown.discovery.search import discover
from swingdown.discovery.tell import files
from swingdown.discovery.tell.conclusion import concluded
from swingdown.errors import InputError
from swingdown.measurement.refused import doubt_in, left_out, none_left, row_on, taking_part
from swingdown.measurement.sharing import sharing
from swingdown.pendulum.catalogue import catalogue
from swingdown.pendulum.model import Model
from swingdown.sealed import write_json


def discover_search(campaign, angles, fits, roles, base, rounds, budget_s, changed, output):
    """The rounds written, what follows the change between the recordings, and what was found in a sentence.

    ``angles`` and ``roles`` are of all members, first the swings, whose ``fits`` say whether they are free, then the static ones. Where
    none is free, what moves them may have a name, and is looked for.
    """
    free, lost = taking_part(fits, [campaign])
    rows = {path: left_out(path) for path in angles[len(fits) :]}
    lost += [row for row in rows.values() if row]
    told = [*fits, *rows]
    able = [k for k, path in enumerate(told) if path in free or (path in rows and not rows[path])]
    usable = [dataset.read(angles[k]) for k in able]
    shared, alone = sharing(usable)
    lost += [row_on(usable[k].attrs, why) for k, why in alone.items()]
    kept = [able[k] for k in shared]
    members = {
        "recordings": [Path(angles[k]).stem for k in kept],
        "left_out": [
            {key: row[key] for key in ("recording", "file", "problem", "expected", "mend")} for row in lost
        ],
        "doubt": doubt_in(told[kept[0]]) if kept else {},
    }
    try:
        if not any(k < len(fits) for k in kept):
            raise none_left(lost)
        swings, emulated = files.read_campaign(campaign, [angles[k] for k in kept], [roles[k] for k in kept])
    except InputError as problem:
        if problem.where in angles:  # a damaged file
            raise
        files.write_no_verdict(campaign, problem, members, [*output.rounds, *output.models])
        write_json(output.follows, None)
        return f"{campaign}: NOT SEARCHED: {problem}"
    base = base.under(swings.fit[0].drive)
    quantity, values = changed or ("", {})
    budget = Budget(budget_s)
    follows = difference(swings, values, base, budget_s=budget_s and budget_s / 2)
    write_json(output.follows, follows and follows.to_dict(quantity))
    base = follows.beside(base) if follows else base
    states = concluded(discover(swings, base, rounds, budget_s=budget.left), swings)
    files.write_rounds(states, swings, Path(output.follows).parent, emulated, members)
    files.write_models(states, output.models)
    last = states[-1]
    gap = last.fit.rms / last.noise.deviation
    return f"{campaign}: {last.fit.model.label} leaves {gap:.3g} times the noise; {last.reason}"


with console.job(snakemake.log[0]) as say:
    params, given = snakemake.params, snakemake.input
    base = Model(tuple(params.base), **params.model, catalogue=catalogue(params.effects))
    say(
        discover_search(
            snakemake.wildcards.campaign, list(given.angles), list(given.fits), params.roles, base, params.rounds,
            params.budget_s, params.changed, snakemake.output,
        )
    )  # fmt: skip
