# What a target left, each file with its checksum; `swingdown verify results` holds the folder against it.
# needs: everything that the target makes
# makes: results/manifest.json for the whole study, and one in the folder of each part that is a target of its own

# Parts of results/ by the folder of their manifest. A part is asked for by itself and knows nothing of the others.
PARTS = {
    "discovery": [
        "recordings",
        "angles",
        "calibration",
        "experiment/fits",
        "tables/uncertainty_budget.csv",
        "tables/left_out.csv",
        "discovery",
    ],
    "sweeps": ["sweeps", "sweeps.html"],
    "hidden_effects": ["hidden_effects"],
    "trust": ["trust"],
    "coverage": ["coverage"],
}
# All that is made, and not its last files alone: what is deleted, as the mend of a damaged file says, is made anew.
MADE_OF = {
    "discovery": (
        [*MADE.searched, *MADE.verdicts, *MADE.seen, "results/tables/left_out.csv"] if MADE.verdicts else []
    ),
    "sweeps": ["results/sweeps.html"]
    + expand("results/sweeps/{sweep}/{file}", sweep=SWEEPS, file=["sweep.nc", "summary.csv"])
    + [f"{path}.png" for path in MAPPED],
    "hidden_effects": [*rules.hidden_score.output, *rules.hidden_figures.output],
    "trust": rules.certified_cases.output,
    "coverage": [*rules.coverage_table.input.cases, *rules.coverage_table.output],
}


rule manifest:
    input:
        made=[*MADE.tables, *FIGURES, *MADE.study, *MADE_OF["discovery"], "results/report.html"],
    output:
        "results/manifest.json",
    log:
        "results/logs/manifest.log",
    localrule: True
    params:
        parts=["."],
        without=[*PARTS["sweeps"], *PARTS["hidden_effects"], *PARTS["trust"], *PARTS["coverage"]],
        code=code("manifest"),
    message:
        "Listing what was made"
    script:
        "../scripts/manifest.py"


rule part_manifest:
    input:
        made=lambda wildcards: made(wildcards.part),
    output:
        "results/{part}/manifest.json",
    log:
        "results/logs/{part}/manifest.log",
    wildcard_constraints:
        part="|".join(PARTS),
    localrule: True
    params:
        parts=lambda wildcards: PARTS[wildcards.part],
        without=[],
        code=code("manifest"),
    message:
        "Listing what was made of {wildcards.part}"
    script:
        "../scripts/manifest.py"
