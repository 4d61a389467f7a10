# The pendulums of the study side by side: period, quality, decay, the model of damping and the verdict of each.
# needs: results/experiment/, results/discovery/*/verdict.json
# makes: results/tables/pendulums.csv, and where there are several recordings results/figures/pendulums.svg and .png

TABLES += ["results/tables/pendulums.csv"]
SIDE_BY_SIDE = ["results/figures/pendulums.svg"] if OWN and len(PLAN.swings()) > 1 else []
FIGURES += [path.replace(".svg", ending) for path in SIDE_BY_SIDE for ending in (".svg", ".png")]


rule pendulums:
    input:
        norms="results/experiment/norms.nc",
        joint=JOINT,
        verdicts=VERDICTS,
        left_out=str(find(config["left_out"])) if config.get("left_out") else [],
    output:
        report("results/tables/pendulums.csv", category="Tables", labels={"table": "pendulums"}),
    log:
        "results/logs/pendulums.log",
    params:
        effects=config["effects"],
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
        code=code("pendulums_figure"),
    message:
        "Drawing the pendulums side by side"
    script:
        "../scripts/pendulums_figure.py"
