"""The sweeps' section of the report as a page of its own."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

from pathlib import Path

from swingdown import console
from swingdown.report import page, sweeps


def sweep_page(names, captions, results, output):
    found = sweeps.made(names, captions, results)
    section = sweeps.section(found)
    head = page.Head(
        "How often is it the right model?",
        f"Sweeps: {', '.join(found)}",
        [],
        "Made by swingdown. The datasets behind every map lie in results/sweeps.",
    )
    page.write(output, [section], head)
    return "\n".join(
        [
            *section.items[0].lines,
            f"all of it: {output}; the study's report shows it too when it is made again",
        ]
    )


if __name__ == "__main__":
    with console.job(snakemake.log[0]) as say:
        results = Path(snakemake.input.tables[0]).parents[1] if snakemake.input.tables else "results/sweeps"
        say(sweep_page(snakemake.params.names, snakemake.input.captions, results, snakemake.output[0]))
