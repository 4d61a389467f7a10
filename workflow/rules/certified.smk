# Published cases with known answers, through the code that fits swings and propagates uncertainty.
# needs: resources/certified/
# makes: results/trust/certified.csv, on request only

from pathlib import Path

CERTIFIED = f"{workflow.basedir}/resources/certified"


rule certified_cases:
    input:
        known=lambda wildcards: here(sorted(map(str, Path(CERTIFIED).rglob("*.*")))),
    output:
        "results/trust/certified.csv",
    log:
        "results/logs/trust/certified.log",
    params:
        folder=CERTIFIED,
        code=code("certified"),
    message:
        "Computing the published cases"
    script:
        "../scripts/certified.py"


rule certified:
    input:
        rules.certified_cases.output,
        "results/trust/manifest.json",
    localrule: True
