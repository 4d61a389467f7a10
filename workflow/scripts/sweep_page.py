"""The sweeps' section of the report as a page of its own."""

from swingdown import console
from swingdown.report import page, sweeps


def sweep_page(names, captions, output):
    found = sweeps.made(names, captions)
    section = sweeps.section(found)
    page.write(
        output,
        [section],
        title="How often is it the right model?",
        subtitle=f"Sweeps: {', '.join(found)}",
        notices=[],
        footer="Made by swingdown. The datasets behind every map lie in results/sweeps.",
    )
    return "\n".join(
        [
            *section.items[0].lines,
            f"all of it: {output}; the study's report shows it too when it is made again",
        ]
    )


if __name__ == "__main__":
    with console.job(snakemake.log[0]) as say:
        say(sweep_page(snakemake.params.names, snakemake.input.captions, snakemake.output[0]))
