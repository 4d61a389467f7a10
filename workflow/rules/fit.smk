# The experiment study: the models fitted to each swing, to the swings of a campaign together, and compared.
# needs: results/angles/
# makes: results/experiment/, results/tables/table3.csv, comparison.csv, parameters.csv, parameter_budget.csv


rule fit_swing:
    input:
        angle="results/angles/{recording}.nc",
    output:
        "results/experiment/fits/{recording}.nc",
    log:
        "results/logs/fit_swing/{recording}.log",
    params:
        fitted=config["experiment"]["fitted"],
        start=config["experiment"]["start"],
        model=config["model"],
        effects=config["effects"],
        code=code("fit_swing"),
    message:
        "Fitting the models to {wildcards.recording}"
    script:
        "../scripts/fit_swing.py"


rule fit_campaign:
    input:
        angles=lambda wildcards: expand(
            "results/angles/{recording}.nc", recording=PLAN.swings(wildcards.campaign)
        ),
        fits=lambda wildcards: expand(
            "results/experiment/fits/{recording}.nc", recording=PLAN.swings(wildcards.campaign)
        ),
    output:
        "results/experiment/joint/{campaign}.nc",
    log:
        "results/logs/fit_campaign/{campaign}.log",
    params:
        fitted=config["experiment"]["fitted"],
        start=config["experiment"]["start"],
        model=config["model"],
        effects=config["effects"],
        code=code("fit_campaign"),
    message:
        "Fitting the models to all swings of {wildcards.campaign} together"
    script:
        "../scripts/fit_campaign.py"


rule table3:
    input:
        fits=expand("results/experiment/fits/{recording}.nc", recording=PLAN.swings()),
        joint=MADE.joint,
        verdicts=lambda wildcards: MADE.verdicts,  # what damping alone does not follow counts where they explain it
        published=find("resources/paper/table3.csv"),
    output:
        norms="results/experiment/norms.nc",
        table3=report("results/tables/table3.csv", category="Tables", labels={"table": "3"}),
        comparison=report(
            "results/tables/comparison.csv", category="Tables", labels={"table": "paired comparison"}
        ),
        parameters=report("results/tables/parameters.csv", category="Tables", labels={"table": "parameters"}),
        budget=report(
            "results/tables/parameter_budget.csv",
            category="Tables",
            labels={"table": "budget of the parameters"},
        ),
    log:
        "results/logs/table3.log",
    params:
        code=code("table3"),
    message:
        "Collecting and comparing the fits of the experiment (Table 3)"
    script:
        "../scripts/table3.py"
