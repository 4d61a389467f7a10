"""The study on one page: settings and sheets are checked, then each stage adds its rules and its results."""

import logging
import os
import sys

from snakemake.utils import min_version

from swingdown import console, prefork
from swingdown.capture import takes
from swingdown.paths import find, is_url, remove_leftovers
from swingdown.sealed import remove_orphans
from swingdown.studies import left_out
from swingdown.planning.made import SEARCH_FILES, SEEN, made as made_by, models_of_rounds
from swingdown.planning.plan import plan
from swingdown.planning.settings import complete
from swingdown.planning.sources import fingerprint
from swingdown.sweep.table import sweeps

min_version("9.0")

# A full disk is told once, by what needs the room, and not by every line that Snakemake's own log cannot keep.
logging.raiseExceptions = False

# Settings that name recordings are a study of one's own and inherit nothing of the bench from this folder; any others
# change single settings of the paper's study. `recordings: null` is a study without any.
if "recordings" not in config:

    configfile: find("config/config.yaml")


if "sweeps" not in config:

    configfile: find("config/sweeps.yaml")


with console.job():
    where = ", ".join(map(str, workflow.configfiles)) or "config"
    AT_THE_BENCH = any(config.get(key) for key in takes.KEYS)
    if AT_THE_BENCH:
        config.setdefault("capture", {})
    settings = complete(config, where)
    config.clear()
    config.update(settings)
    # A recording that is asked for by name is captured, and nothing of the study is looked at: it may not be there yet.
    PLAN = plan({} if AT_THE_BENCH else config)
    SWEEPS = sweeps(config, where)

# A study of recordings that leaves the paper's simulations out is somebody's own: its results show no trace of the paper.
OWN = bool(PLAN.campaigns) and not config["simulation"]["simulated"]
LANG = config["lang"] if OWN else "en"
MADE = made_by(PLAN, config, OWN)


onstart:
    with console.job():
        remove_leftovers("results")
        remove_orphans("results")
        if not AT_THE_BENCH:
            write_books()
    # How jobs are executed is known only now. A capture has Ctrl-C and a window to itself.
    if workflow.local_exec and workflow.is_main_process and not AT_THE_BENCH:
        prefork.start()
        # Snakemake's limit to 100 jobs a second looks at all jobs anew once a second for each job that has ended; on one
        # machine there is nothing to limit.
        if hasattr(
            workflow.scheduler, "job_rate_limiter"
        ):  # a version without one has nothing to be rid of
            workflow.scheduler.job_rate_limiter = None


onsuccess:
    # The last words of a run: what its results do not rest on.
    if PLAN.rows and workflow.is_main_process:
        print(left_out.last_words("results/tables/left_out.csv"), end="", file=sys.stderr)


wildcard_constraints:
    recording="|".join(map(re.escape, PLAN.rows)) or "(?!)",
    campaign="|".join(map(re.escape, {*PLAN.campaigns, *PLAN.searched})) or "(?!)",
    chunk=r"\d+",
    simulated="|".join(config["simulation"]["simulated"]) or "(?!)",
    sweep="|".join(SWEEPS) or "(?!)",


include: "workflow/rules/common.smk"


if AT_THE_BENCH:

    include: "workflow/rules/capture.smk"

    rule all:
        default_target: True  # in an included file it would count for nothing
        input:
            only_capture,
        localrule: True

else:
    config.pop("capture", None)  # it tells how recordings are made, and no result rests on that

    if config["simulation"]["simulated"]:

        include: "workflow/rules/simulate.smk"

    if PLAN.campaigns:

        include: "workflow/rules/measure.smk"
        include: "workflow/rules/fit.smk"
        include: "workflow/rules/discover.smk"
        include: "workflow/rules/pendulums.smk"
        include: "workflow/rules/curves.smk"
    include: "workflow/rules/hidden_effects.smk"
    include: "workflow/rules/certified.smk"
    include: "workflow/rules/coverage.smk"
    include: "workflow/rules/figures.smk"
    include: "workflow/rules/sweep_plan.smk"
    include: "workflow/rules/sweep.smk"
    include: "workflow/rules/report.smk"
    include: "workflow/rules/manifest.smk"

    rule all:
        default_target: True
        input:
            rules.manifest.input,
            "results/manifest.json",
        localrule: True
