# Which effect is missing: rounds of fit, disagreement, naming and confirmation, made by one search.
# needs: results/angles/, results/experiment/fits/ (whether a swing is free)
# makes: results/discovery/{campaign}/: rounds.json, round-{n}/model.yaml, first/, last/, difference.json, verdict.json and figures/

MODELS = models_of_rounds(config["discovery"]["rounds"])
# the recordings of each campaign as discovery takes them: static ones tell the noise
MEMBERS = {campaign: PLAN.swings(campaign) + PLAN.statics(campaign) for campaign in PLAN.searched}


rule discover_search:
    input:
        angles=lambda wildcards: expand(
            "results/angles/{recording}.nc", recording=MEMBERS[wildcards.campaign]
        ),
        fits=lambda wildcards: expand(
            "results/experiment/fits/{recording}.nc", recording=PLAN.swings(wildcards.campaign)
        ),
    output:
        rounds=expand("results/discovery/{{campaign}}/{file}", file=SEARCH_FILES),
        models=expand("results/discovery/{{campaign}}/{file}", file=MODELS),
        follows="results/discovery/{campaign}/difference.json",
    log:
        "results/logs/discover/{campaign}/search.log",
    params:
        roles=lambda wildcards: [PLAN.rows[name]["role"] for name in MEMBERS[wildcards.campaign]],
        base=config["discovery"]["base"],
        rounds=config["discovery"]["rounds"],
        budget_s=config["discovery"]["budget_s"],
        changed=lambda wildcards: PLAN.changed(wildcards.campaign),
        model=config["model"],
        effects=config["effects"],
        code=code("discover_search"),
    message:
        "Looking for what the model of {wildcards.campaign} lacks"
    script:
        "../scripts/discover_search.py"


rule discover_verdict:
    input:
        rounds="results/discovery/{campaign}/rounds.json",
        follows="results/discovery/{campaign}/difference.json",
    output:
        "results/discovery/{campaign}/verdict.json",
    log:
        "results/logs/discover/{campaign}/verdict.log",
    params:
        effects=config["effects"],
        code=code("discover_verdict"),
    message:
        "The verdict on {wildcards.campaign}"
    script:
        "../scripts/discover_verdict.py"


rule discover_figures:
    input:
        verdict="results/discovery/{campaign}/verdict.json",
        rounds="results/discovery/{campaign}/rounds.json",
    output:
        expand("results/discovery/{{campaign}}/figures/{name}.{ending}", name=SEEN, ending=["svg", "png"]),
    log:
        "results/logs/discover/{campaign}/figures.log",
    params:
        lang=LANG,
        code=code("discover_figures"),
    message:
        "Drawing what was found in {wildcards.campaign}"
    script:
        "../scripts/discover_figures.py"


rule discover_difference:
    input:
        "results/discovery/{campaign}/difference.json",
    output:
        expand("results/discovery/{{campaign}}/figures/difference.{ending}", ending=["svg", "png"]),
    log:
        "results/logs/discover/{campaign}/difference.log",
    params:
        lang=LANG,
        code=code("discover_difference"),
    message:
        "Drawing what follows the change in {wildcards.campaign}"
    script:
        "../scripts/discover_difference.py"


rule discover:
    input:
        lambda wildcards: made("discovery"),
        "results/discovery/manifest.json",
    localrule: True
