# How far verdicts can be trusted: campaigns in which the truth is hidden, and the score of the verdicts on them.
# needs: the settings, and config/apparatus.yaml of this project for what is in volts
# makes: results/hidden_effects/scores.csv, summary.csv, confusion.csv, reliability.csv, guard.yaml and their figure; on request only

HIDDEN = config["hidden_effects"]


rule hidden_make:
    input:
        apparatus=here(f"{workflow.basedir}/config/apparatus.yaml"),
    output:
        sheet="results/hidden_effects/campaigns/{chunk}/sheet.csv",
        excluded="results/hidden_effects/campaigns/{chunk}/excluded.json",
        truth="results/hidden_effects/truth/{chunk}.json",
    log:
        "results/logs/hidden_effects/make-{chunk}.log",
    params:
        trials=lambda wildcards: [list(one) for one in trials()[wildcards.chunk]],
        seed=HIDDEN["seed"],
        effects=config["effects"],
        code=code("hidden_make"),
    message:
        "Hiding effects in campaigns {wildcards.chunk}"
    script:
        "../scripts/hidden_make.py"


rule hidden_find:
    input:
        sheet=rules.hidden_make.output.sheet,
        excluded=rules.hidden_make.output.excluded,
    output:
        "results/hidden_effects/verdicts/{chunk}.json",
    log:
        "results/logs/hidden_effects/find-{chunk}.log",
    params:
        rounds=HIDDEN["rounds"],
        effects=config["effects"],
        code=code("hidden_find"),
    message:
        "Looking for what is hidden in campaigns {wildcards.chunk}"
    script:
        "../scripts/hidden_find.py"


rule hidden_score:
    input:
        truths=lambda wildcards: expand("results/hidden_effects/truth/{chunk}.json", chunk=trials()),
        verdicts=lambda wildcards: expand("results/hidden_effects/verdicts/{chunk}.json", chunk=trials()),
    output:
        scores="results/hidden_effects/scores.csv",
        summary="results/hidden_effects/summary.csv",
        confusion="results/hidden_effects/confusion.csv",
        reliability="results/hidden_effects/reliability.csv",
        guard="results/hidden_effects/guard.yaml",
    log:
        "results/logs/hidden_effects/score.log",
    params:
        effects=config["effects"],
        code=code("hidden_score"),
    message:
        "Holding the verdicts against the truth"
    script:
        "../scripts/hidden_score.py"


rule hidden_figures:
    input:
        scores=rules.hidden_score.output.scores,
        confusion=rules.hidden_score.output.confusion,
    output:
        expand(
            "results/hidden_effects/figures/{name}.{ending}",
            name=["confusion", "detection"],
            ending=["svg", "png"],
        ),
    log:
        "results/logs/hidden_effects/figures.log",
    params:
        code=code("hidden_figures"),
    message:
        "Drawing the scores"
    script:
        "../scripts/hidden_figures.py"


rule hidden_effects:
    input:
        lambda wildcards: made("hidden_effects"),
        "results/hidden_effects/manifest.json",
    localrule: True
