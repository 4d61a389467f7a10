"""The figures of one campaign's search: residuals, missing torque, half-swings, ranking, and the gap by round."""

from pathlib import Path

from swingdown import console, dataset
from swingdown.discovery.tell.verdict import noise_rms
from swingdown.language import language
from swingdown.plots import discovery, save, style
from swingdown.plots.answer import shown_in, swings_with_fit
from swingdown.plots.remainder import remainder
from swingdown.plots.style import in_language
from swingdown.sealed import read_csv, read_json
from swingdown.status import Status
from swingdown.studies.words import short


def figures(verdict, rounds, outputs, spoken):
    """Each of the outputs written, the first and the last of the campaign's rounds side by side."""
    found = read_json(verdict)
    if found["status"] == Status.NO_VERDICT:
        for output in outputs:
            save(in_language(discovery.no_verdict(found["campaign"]), spoken), output)
        return
    first, last = (Path(rounds).with_name(place) for place in ("first", "last"))
    rounds = read_json(rounds)
    unit = found.get("unit", "rad").removesuffix("/s")  # of what swings, also where its rate is read
    moved = found["moves"][0] if found["moves"] else ""
    fitted = dataset.read(last / "fit.nc")
    drawn = {
        "answer": lambda: swings_with_fit(shown_in(fitted), noise_rms(found), fitted, short({}, found)),
        "remainder": lambda: remainder(
            read_csv(last / "remainder.csv"), read_csv(last / "course.csv"), rounds[-1], unit
        ),
        "residuals": lambda: discovery.residuals(
            dataset.read(first / "fit.nc"), dataset.read(last / "fit.nc")
        ),
        "map": lambda: discovery.missing_torque(
            read_csv(first / "map.csv"), read_csv(last / "map.csv"), rounds, unit
        ),
        "half_swings": lambda: discovery.half_swings(
            read_csv(first / "half_swings.csv"), read_csv(last / "half_swings.csv"), unit
        ),
        "ranking": lambda: discovery.ranking(read_csv(first / "ranking.csv"), moved),
        "gap": lambda: discovery.gap(found),
    }
    made = {}
    for output in map(Path, outputs):
        made[output.stem] = made.get(output.stem) or in_language(drawn[output.stem](), spoken)
        save(made[output.stem], output, spoken.text(style.emulated_note(fitted)))


with console.job(snakemake.log[0]):
    files = snakemake.input
    figures(files.verdict, files.rounds, snakemake.output, language(snakemake.params.lang))
