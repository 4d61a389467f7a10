# Which effect is missing: rounds of fit, disagreement, naming and confirmation, each a folder that the next starts from.
# needs: results/angles/
# makes: results/discovery/{campaign}/: round-{n}/, verdict.json and figures/

ROUNDS = config["discovery"]["rounds"]
SEEN = [
    "answer",
    "residuals",
    "map",
    "half_swings",
    "ranking",
    "gap",
]  # the figures: functions of swingdown.plots.discovery
VERDICTS += expand("results/discovery/{campaign}/verdict.json", campaign=PLAN.searched)
SEEN_FIGURES = expand("results/discovery/{campaign}/figures/{name}.svg", campaign=PLAN.searched, name=SEEN)

# the recordings of each campaign as discovery takes them: static ones tell the noise
MEMBERS = {campaign: PLAN.swings(campaign) + PLAN.statics(campaign) for campaign in PLAN.searched}


rule discover_round:
    input:
        angles=lambda wildcards: expand(
            "results/angles/{recording}.nc", recording=MEMBERS[wildcards.campaign]
        ),
        previous=lambda wildcards: (
            f"results/discovery/{wildcards.campaign}/round-{int(wildcards.n) - 1}/round.json"
            if int(wildcards.n)
            else []
        ),
        code=code("discover_round"),
    output:
        state="results/discovery/{campaign}/round-{n}/round.json",
        model="results/discovery/{campaign}/round-{n}/model.yaml",
        fit="results/discovery/{campaign}/round-{n}/fit.nc",
        groups="results/discovery/{campaign}/round-{n}/groups.csv",
        ranking="results/discovery/{campaign}/round-{n}/ranking.csv",
        map="results/discovery/{campaign}/round-{n}/map.csv",
        unnamed="results/discovery/{campaign}/round-{n}/unnamed.csv",
        half_swings="results/discovery/{campaign}/round-{n}/half_swings.csv",
    log:
        "results/logs/discover/{campaign}/round-{n}.log",
    wildcard_constraints:
        n=r"\d+",
    params:
        roles=lambda wildcards: [PLAN.rows[name]["role"] for name in MEMBERS[wildcards.campaign]],
        base=config["discovery"]["base"],
        rounds=ROUNDS,
        model=config["model"],
        effects=config["effects"],
    message:
        "Looking for what the model of {wildcards.campaign} lacks, round {wildcards.n}"
    script:
        "../scripts/discover_round.py"


rule discover_verdict:
    input:
        rounds=expand("results/discovery/{{campaign}}/round-{n}/round.json", n=range(ROUNDS + 1)),
        code=code("discover_verdict"),
    output:
        "results/discovery/{campaign}/verdict.json",
    log:
        "results/logs/discover/{campaign}/verdict.log",
    params:
        effects=config["effects"],
    message:
        "The verdict on {wildcards.campaign}"
    script:
        "../scripts/discover_verdict.py"


rule discover_figures:
    input:
        verdict="results/discovery/{campaign}/verdict.json",
        rounds=expand("results/discovery/{{campaign}}/round-{n}/round.json", n=range(ROUNDS + 1)),
        code=code("discover_figures"),
    output:
        expand("results/discovery/{{campaign}}/figures/{name}.{ending}", name=SEEN, ending=["svg", "png"]),
    log:
        "results/logs/discover/{campaign}/figures.log",
    message:
        "Drawing what was found in {wildcards.campaign}"
    script:
        "../scripts/discover_figures.py"


rule discover:
    input:
        VERDICTS,
        SEEN_FIGURES,
        "results/discovery/manifest.json",
    localrule: True
