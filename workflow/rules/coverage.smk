# How often stated 95 % intervals hold the truth: many simulated calibrations and swings.
# needs: config/apparatus.yaml of this project
# makes: results/coverage/coverage.csv, on request only

COVERAGE = config["coverage"]


rule coverage_case:
    input:
        apparatus=f"{workflow.basedir}/config/apparatus.yaml",
        code=code("coverage_case"),
    output:
        "results/coverage/cases/{case}.csv",
    log:
        "results/logs/coverage/{case}.log",
    params:
        measurements=lambda wildcards: COVERAGE.get(wildcards.case, COVERAGE["swings"]),
        seed=COVERAGE["seed"],
    message:
        "Coverage of stated intervals: {wildcards.case}, {params.measurements} measurements"
    script:
        "../scripts/coverage_case.py"


rule coverage_table:
    input:
        cases=expand(
            "results/coverage/cases/{case}.csv",
            case=["calibrations", "white", "ar5", "ar9", "steps", "together"],
        ),
        code=code("coverage"),
    output:
        "results/coverage/coverage.csv",
    log:
        "results/logs/coverage.log",
    message:
        "Coverage of stated intervals"
    script:
        "../scripts/coverage.py"


rule coverage:
    input:
        rules.coverage_table.output,
        "results/coverage/manifest.json",
    localrule: True
