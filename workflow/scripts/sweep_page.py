"""The sweeps' section of the report as a page of its own."""

from pathlib import Path

from swingdown import console
from swingdown.report import page, sweeps

with console.job(snakemake.log[0]) as say:
    files, output = snakemake.input, snakemake.output[0]
    results = Path(files.tables[0]).parents[1] if files.tables else "results/sweeps"
    found = sweeps.made(snakemake.params.names, files.captions, results)
    section = sweeps.section(found)
    head = page.Head(
        "How often is it the right model?",
        f"Sweeps: {', '.join(found)}",
        [],
        "Made by swingdown. The datasets behind every map lie in results/sweeps.",
    )
    page.write(output, [section], head)
    more = f"all of it: {output}; the study's report shows it too when it is made again"
    say("\n".join([*section.items[0].lines, more]))
