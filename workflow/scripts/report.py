"""The report: every table and figure of the run, its settings and what it rests on, in one HTML file."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

from pathlib import Path

from swingdown import console, dataset
from swingdown.plots.answer import shown_in
from swingdown.report import contents, page, sweeps
from swingdown.sealed import read_json


def report(
    tables, figures, captions, recordings, verdicts, seen, told, settings, sweep_captions, fits, output
):
    fitted = [dataset.read(path) for path in fits]
    material = contents.Material(
        tables=contents.read_tables(tables),
        figures={
            Path(path).stem: (path, Path(caption).read_text(encoding="utf-8"))
            for path, caption in zip(figures, captions, strict=True)
        },
        recordings=[dataset.read(path).attrs for path in recordings],
        settings=settings,
        inputs=told,
        verdicts=[read_json(path) for path in verdicts],
        seen=list(seen),
        sweeps=sweeps.made(settings["sweeps"], sweep_captions),
        swings={one.attrs["campaign"]: shown_in(one) for one in fitted},
    )
    sections = contents.sections(material)
    page.write(output, sections, **contents.head(material))
    size = Path(output).stat().st_size / 1e6
    return "\n".join([*contents.plain_findings(material), f"all of it: {output} ({size:.1f} MB)"])


if __name__ == "__main__":
    with console.job(snakemake.log[0]) as say:
        files = snakemake.input
        say(
            report(
                files.tables, files.figures, files.captions, files.recordings, files.verdicts, files.seen, files.told,
                snakemake.params.settings, files.sweep_captions, files.fits, snakemake.output[0],
            )
        )  # fmt: skip
