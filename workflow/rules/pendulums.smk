# The pendulums of the study side by side: period, quality, decay, the model of damping and the verdict of each.
# needs: results/experiment/, results/discovery/*/verdict.json
# makes: results/tables/left_out.csv and pendulums.csv, and where there are several recordings results/figures/pendulums.svg and .png;
#        where the sheet states lengths or what was varied results/tables/g_budget.csv, series.csv, laws.csv, results/figures/series and groups


rule left_out:
    input:
        swings=expand(
            "results/experiment/fits/{recording}.nc",
            recording=PLAN.moving,
        ),
        statics=expand("results/angles/{recording}.nc", recording=PLAN.still),
        verdicts=MADE.verdicts,
        before=str(find(config["left_out"])) if config.get("left_out") else [],
    output:
        report("results/tables/left_out.csv", category="Tables", labels={"table": "left out"}),
    log:
        "results/logs/left_out.log",
    params:
        code=code("left_out"),
    message:
        "Listing the recordings that were left out"
    script:
        "../scripts/left_out.py"


rule pendulums:
    input:
        norms="results/experiment/norms.nc",
        joint=MADE.joint,
        verdicts=MADE.verdicts,
        left_out=rules.left_out.output[0],
    output:
        report("results/tables/pendulums.csv", category="Tables", labels={"table": "pendulums"}),
    log:
        "results/logs/pendulums.log",
    params:
        effects=config["effects"],
        stated=MADE.stated,
        restoring=config["model"]["restoring"],
        code=code("pendulums"),
    message:
        "Period, quality and decay of each pendulum"
    script:
        "../scripts/pendulums.py"


rule pendulums_figure:
    input:
        table=rules.pendulums.output[0],
    output:
        svg="results/figures/pendulums.svg",
        png="results/figures/pendulums.png",
    log:
        "results/logs/figures/pendulums.log",
    params:
        lang=LANG,
        code=code("pendulums_figure"),
    message:
        "Drawing the pendulums side by side"
    script:
        "../scripts/pendulums_figure.py"


rule series:
    input:
        table=rules.pendulums.output[0],
    output:
        budget=report("results/tables/g_budget.csv", category="Tables", labels={"table": "g"}),
        series=report("results/tables/series.csv", category="Tables", labels={"table": "series"}),
        laws=report("results/tables/laws.csv", category="Tables", labels={"table": "laws"}),
    log:
        "results/logs/series.log",
    params:
        stated=MADE.stated,
        restoring=config["model"]["restoring"],
        code=code("series"),
    message:
        "g of the pendulums, and how their quantities go with what was varied"
    script:
        "../scripts/series.py"


rule series_figure:
    input:
        table=rules.pendulums.output[0],
    output:
        svg="results/figures/{kind}.svg",
        png="results/figures/{kind}.png",
    log:
        "results/logs/figures/{kind}.log",
    wildcard_constraints:
        kind="series|groups",
    params:
        stated=MADE.stated,
        lang=LANG,
        code=code("series_figure"),
    message:
        "Drawing the {wildcards.kind}"
    script:
        "../scripts/series_figure.py"
