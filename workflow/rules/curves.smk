# What one's own recordings show against the amplitude, and what each law of damping leaves of them.
# needs: results/angles/, results/experiment/, results/tables/pendulums.csv, results/discovery/*/verdict.json
# makes: results/curves/{campaign}/curves.csv and laws.csv, and a picture of each beside them

from pathlib import Path


rule curves:
    input:
        table=rules.pendulums.output[0],
        angles=lambda wildcards: expand(
            "results/angles/{recording}.nc", recording=PLAN.swings(wildcards.campaign)
        ),
        fits=lambda wildcards: expand(
            "results/experiment/fits/{recording}.nc", recording=PLAN.swings(wildcards.campaign)
        ),
        joint=lambda wildcards: [path for path in MADE.joint if Path(path).stem == wildcards.campaign],
        verdict=lambda wildcards: [
            path for path in MADE.verdicts if Path(path).parent.name == wildcards.campaign
        ],
    output:
        curves=expand("results/curves/{{campaign}}/curves.{ending}", ending=["csv", "svg", "png"]),
        laws=expand("results/curves/{{campaign}}/laws.{ending}", ending=["csv", "svg", "png"]),
    log:
        "results/logs/curves/{campaign}.log",
    params:
        model=config["model"],
        effects=config["effects"],
        lang=LANG,
        code=code("curves"),
    message:
        "What {wildcards.campaign} shows against the amplitude"
    script:
        "../scripts/curves.py"
