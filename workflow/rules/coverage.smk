# How often stated 95 % intervals hold the truth: many simulated calibrations and swings.
# needs: config/apparatus.yaml of this project
# makes: results/coverage/coverage.csv, on request only

COVERAGE = config["coverage"]


rule coverage_case:
    input:
        apparatus=f"{workflow.basedir}/config/apparatus.yaml",
    output:
        "results/coverage/cases/{case}.csv",
    log:
        "results/logs/coverage/{case}.log",
    params:
        measurements=lambda wildcards: COVERAGE.get(wildcards.case, COVERAGE["swings"]),
        seed=COVERAGE["seed"],
        code=code("coverage_case"),
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
    output:
        "results/coverage/coverage.csv",
    log:
        "results/logs/coverage.log",
    params:
        code=code("coverage"),
    message:
        "Coverage of stated intervals"
    script:
        "../scripts/coverage.py"


rule coverage:
    input:
        lambda wildcards: made("coverage"),
        "results/coverage/manifest.json",
    localrule: True
