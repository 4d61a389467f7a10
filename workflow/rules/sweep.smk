# Sweeps: tables of cells, each computed many times, in chunks that any machine may take.
# needs: the config alone (key sweeps)
# makes: results/sweeps/{sweep}/: plan.jsonl, chunks/, sweep.nc, summary.csv, figures/; and results/sweeps.html

from dataclasses import asdict

MAPS = {"identification": ["by_norm", "by_bic", "by_ten"], "detection": ["detection"]}
SWEEP_CAPTIONS = [
    f"{workflow.basedir}/workflow/report/sweep_{name}.rst" for maps in MAPS.values() for name in maps
]


rule sweep_identification:
    input:
        code=code("sweep_identification"),
    output:
        "results/sweeps/{sweep}/chunks/{chunk}.nc",
    log:
        "results/logs/sweep/{sweep}/{chunk}.log",
    benchmark:
        "results/sweeps/{sweep}/benchmarks/{chunk}.tsv"
    wildcard_constraints:
        sweep=named("identification"),
        chunk="[0-9a-f]{16}",
    params:
        book=lambda wildcards: book(wildcards.sweep),
    message:
        "Sweep {wildcards.sweep}: computing chunk {wildcards.chunk}"
    script:
        "../scripts/sweep_identification.py"


rule sweep_detection:
    input:
        code=code("sweep_detection"),
    output:
        "results/sweeps/{sweep}/chunks/{chunk}.nc",
    log:
        "results/logs/sweep/{sweep}/{chunk}.log",
    benchmark:
        "results/sweeps/{sweep}/benchmarks/{chunk}.tsv"
    wildcard_constraints:
        sweep=named("detection"),
        chunk="[0-9a-f]{16}",
    params:
        book=lambda wildcards: book(wildcards.sweep),
    message:
        "Sweep {wildcards.sweep}: computing chunk {wildcards.chunk}"
    script:
        "../scripts/sweep_detection.py"


rule sweep_combine:
    input:
        chunks=chunks_of,
        code=code("sweep_combine"),
    output:
        data="results/sweeps/{sweep}/sweep.nc",
        table="results/sweeps/{sweep}/summary.csv",
    log:
        "results/logs/sweep/{sweep}/combine.log",
    params:
        sweep=lambda wildcards: asdict(SWEEPS[wildcards.sweep]),  # another table is combined again
    message:
        "Sweep {wildcards.sweep}: one dataset and a table of all chunks"
    script:
        "../scripts/sweep_combine.py"


rule sweep_maps:
    input:
        data="results/sweeps/{sweep}/sweep.nc",
        code=code("sweep_maps"),
    output:
        svg="results/sweeps/{sweep}/figures/{map}.svg",
        png="results/sweeps/{sweep}/figures/{map}.png",
    log:
        "results/logs/sweep/{sweep}/{map}.log",
    message:
        "Sweep {wildcards.sweep}: drawing {wildcards.map}"
    script:
        "../scripts/sweep_maps.py"


rule sweep_page:
    input:
        tables=expand("results/sweeps/{sweep}/summary.csv", sweep=SWEEPS),
        maps=[
            f"results/sweeps/{name}/figures/{map}.svg"
            for name, sweep in SWEEPS.items()
            for map in MAPS[sweep.computes]
        ],
        captions=SWEEP_CAPTIONS,
        template=f"{workflow.basedir}/workflow/src/swingdown/report/report.html.j2",
        code=code("sweep_page"),
    output:
        "results/sweeps.html",
    log:
        "results/logs/sweep/page.log",
    params:
        names=list(SWEEPS),
    message:
        "Writing the page of the sweeps"
    script:
        "../scripts/sweep_page.py"


rule sweep:
    input:
        "results/sweeps.html",
        "results/sweeps/manifest.json",
    localrule: True
