# Sweeps: tables of cells, each computed many times, in chunks that any machine may take.
# needs: the config alone (key sweeps)
# makes: results/sweeps/{sweep}/: plan.jsonl, chunks/, jobs/, sweep.nc, summary.csv, figures/; and results/sweeps.html

from dataclasses import asdict

from swingdown.report.page import FILES

MAPS = {"identification": ["by_norm", "by_bic", "by_ten"], "detection": ["detection"]}
MAPPED = [
    f"results/sweeps/{name}/figures/{map}" for name, sweep in SWEEPS.items() for map in MAPS[sweep.computes]
]
SWEEP_CAPTIONS = [
    f"{workflow.basedir}/workflow/report/sweep_{name}.rst" for maps in MAPS.values() for name in maps
]


# What a job of a sweep is known by to Snakemake. A chunk that is whole has no job at all, so that nothing which Snakemake
# knows of jobs (a script's age, a parameter, a mark that it was not finished) can make it compute one again.
rule sweep_identification:
    input:
        book_for_jobs,
    output:
        update(result("{sweep}", "{chunk}")),
    log:
        "results/logs/sweep/{sweep}/{chunk}.log",
    wildcard_constraints:
        sweep=open_chunks("identification"),
        chunk=CHUNK,
    params:
        book=lambda wildcards: book(wildcards.sweep),
        results=lambda wildcards: "" if STORED else chunk_file(wildcards.sweep, wildcards.chunk),
    message:
        "Sweep {wildcards.sweep}: computing chunk {wildcards.chunk}"
    script:
        "../scripts/sweep_chunk.py"


use rule sweep_identification as sweep_detection with:
    wildcard_constraints:
        sweep=open_chunks("detection"),
        chunk=CHUNK,


if STORED:

    rule sweep_book:
        output:
            update("results/sweeps/{sweep}/book.jsonl"),
        log:
            "results/logs/sweep/{sweep}/book.log",
        localrule: True
        params:
            book=lambda wildcards: book(wildcards.sweep),
            new=lambda wildcards: new_in_book(wildcards.sweep),
        message:
            "Sweep {wildcards.sweep}: the book of chunks for all nodes"
        script:
            "../scripts/sweep_book.py"


rule sweep_combine:
    input:
        made=results_of,
    output:
        data="results/sweeps/{sweep}/sweep.nc",
        table="results/sweeps/{sweep}/summary.csv",
    log:
        "results/logs/sweep/{sweep}/combine.log",
    params:
        sweep=lambda wildcards: asdict(SWEEPS[wildcards.sweep]),  # another table is combined again
        chunks=lambda wildcards, input: chunk_files(wildcards.sweep, input.made),
        code=code("sweep_combine"),
    message:
        "Sweep {wildcards.sweep}: one dataset and a table of all chunks"
    script:
        "../scripts/sweep_combine.py"


rule sweep_maps:
    input:
        data="results/sweeps/{sweep}/sweep.nc",
    output:
        svg="results/sweeps/{sweep}/figures/{map}.svg",
        png="results/sweeps/{sweep}/figures/{map}.png",
    log:
        "results/logs/sweep/{sweep}/{map}.log",
    params:
        code=code("sweep_maps"),
    message:
        "Sweep {wildcards.sweep}: drawing {wildcards.map}"
    script:
        "../scripts/sweep_maps.py"


rule sweep_page:
    input:
        tables=expand("results/sweeps/{sweep}/summary.csv", sweep=SWEEPS),
        maps=[f"{path}.svg" for path in MAPPED],
        captions=here(SWEEP_CAPTIONS),
        form=here(list(map(str, FILES))),
    output:
        "results/sweeps.html",
    log:
        "results/logs/sweep/page.log",
    params:
        names=list(SWEEPS),
        code=code("sweep_page"),
    message:
        "Writing the page of the sweeps"
    script:
        "../scripts/sweep_page.py"


rule sweep:
    input:
        lambda wildcards: made("sweeps"),
        "results/sweeps/manifest.json",
    localrule: True
