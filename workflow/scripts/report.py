"""The report: every table and figure of the run, its settings and what it rests on, in one HTML file."""

from pathlib import Path

from swingdown import console, dataset
from swingdown.plots.answer import shown_in
from swingdown.report import contents, page, sweeps
from swingdown.sealed import read_csv, read_json
from swingdown.status import Status
from swingdown.studies.left_out import OF_ALL


def report(
    tables,
    figures,
    captions,
    recordings,
    verdicts,
    seen,
    told,
    settings,
    sweep_captions,
    fits,
    curves,
    output,
):
    made = contents.read_tables(tables)
    found = [one for path in verdicts if (one := read_json(path))["status"] != Status.NO_VERDICT]
    searched = {one["campaign"] for one in found}
    fitted = [dataset.read(path) for path in fits if Path(path).parents[1].name in searched]
    material = contents.Material(
        tables=made,
        figures={
            Path(path).stem: (path, Path(caption).read_text(encoding="utf-8"))
            for path, caption in zip(figures, captions, strict=True)
        },
        recordings=[dataset.read(path).attrs for path in used(recordings, made)],
        settings=settings,
        inputs=told,
        verdicts=found,
        seen=[*(path for path in seen if Path(path).parents[1].name in searched), *telling(curves)],
        sweeps=sweeps.made(settings["sweeps"], sweep_captions),
        swings={one.attrs["campaign"]: shown_in(one) for one in fitted},
    )
    sections = contents.sections(material)
    page.write(output, sections, contents.head(material))
    size = Path(output).stat().st_size / 1e6
    return "\n".join([*contents.plain_findings(material), f"all of it: {output} ({size:.1f} MB)"])


def telling(curves):
    """The pictures of curves whose tables beside them are not empty."""
    pictures = [path for path in curves if path.endswith(".svg")]
    return [path for path in pictures if len(read_csv(Path(path).with_suffix(".csv")))]


def used(recordings, tables):
    """The paths of those recordings that results rest on."""
    table = tables.get("left_out")
    lost = set() if table is None else set(table.loc[table["left_out_of"] == OF_ALL, "recording"].astype(str))
    return [path for path in recordings if Path(path).stem not in lost]


with console.job(snakemake.log[0]) as say:
    files = snakemake.input
    say(
        report(
            files.tables, files.figures, files.captions, files.recordings, files.verdicts, files.seen, files.told,
            snakemake.params.settings, files.sweep_captions, files.fits, files.curves, snakemake.output[0],
        )
    )  # fmt: skip
