"""The study on one page: settings and sheets are checked, then each stage adds its rules and its results."""

from snakemake.utils import min_version

from swingdown import console
from swingdown.paths import find, is_url
from swingdown.plan import plan
from swingdown.settings import complete
from swingdown.sources import sources

min_version("9.0")

# Without --configfile the study is the paper's. With it only that file counts, so that a study of one's own
# does not inherit the bench from this folder.
if not workflow.overwrite_configfiles:

    configfile: find("config/config.yaml")


with console.job():
    config.update(complete(config, where=", ".join(map(str, workflow.configfiles)) or "config"))
    PLAN = plan(config)

TABLES, FIGURES = [], []  # each stage adds what it makes; the report shows all of it


wildcard_constraints:
    recording="|".join(map(re.escape, PLAN.rows)) or "(?!)",
    campaign="|".join(map(re.escape, PLAN.campaigns)) or "(?!)",
    simulated="|".join(config["simulation"]["simulated"]) or "(?!)",


include: "workflow/rules/common.smk"


if config["simulation"]["simulated"]:

    include: "workflow/rules/simulate.smk"


if PLAN.campaigns:

    include: "workflow/rules/measure.smk"
    include: "workflow/rules/fit.smk"


include: "workflow/rules/figures.smk"
include: "workflow/rules/report.smk"


rule all:
    default_target: True
    localrule: True
    input:
        TABLES,
        FIGURES,
        "results/report.html",
