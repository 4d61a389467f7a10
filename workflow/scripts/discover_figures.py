"""The figures of one campaign's search: residuals, missing torque, half-swings, ranking, and the gap by round."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

from pathlib import Path

import numpy as np

from swingdown import console, dataset
from swingdown.curves import laws
from swingdown.curves.chosen import of_verdict
from swingdown.curves.dataset import curves as dataset_of_curves
from swingdown.discovery.verdict import noise_rms
from swingdown.errors import InputError
from swingdown.measurement.refused import used
from swingdown.pendulum.catalogue import catalogue
from swingdown.plots import discovery, save, style
from swingdown.plots.answer import shown_in, swings_with_fit
from swingdown.plots.curves import backbone, envelopes
from swingdown.plots.remainder import remainder
from swingdown.sealed import read_csv, read_json
from swingdown.studies.left_out import NO_VERDICT
from swingdown.studies.words import short


def against_amplitude(found, angles, restoring, known):
    """The pictures of a campaign's curves and of the laws of damping, by name; each says why where there is none."""
    given, _ = used(angles)
    curves = compared = None
    try:
        curves = dataset_of_curves(given, *(of_verdict(found, restoring, known) or (None, None)), restoring)
        yield "curves", lambda: backbone(curves)
    except InputError as problem:
        why = problem.problem
        yield "curves", lambda: style.absent(f"no curves: {why}")
    try:
        compared = [laws.laws(one, None, restoring, known) for one in given]
        largest = max(compared, key=lambda one: float(np.ptp(one.series)))
        drawn = laws.envelopes(largest, laws.exponential_words(compared, curves))
        yield "laws", lambda: envelopes(drawn)
    except InputError as problem:
        reason = problem.problem
        yield "laws", lambda: style.absent(f"no laws of damping: {reason}")


def figures(verdict, folders, outputs, angles, restoring, known):
    """Each of the outputs written, the first and the last of the campaign's rounds side by side."""
    found = read_json(verdict)
    if found["status"] == NO_VERDICT:
        for output in outputs:
            save(discovery.no_verdict(found["campaign"]), output)
        return
    used = [Path(folder) for folder in folders][: len(found["gap"]["fit"])]
    first, last = used[0], used[-1]
    moved = found["moves"][0] if found["moves"] else ""
    fitted = dataset.read(last / "fit.nc")
    drawn = {
        "answer": lambda: swings_with_fit(shown_in(fitted), noise_rms(found), fitted, short({}, found)),
        "remainder": lambda: remainder(
            read_csv(last / "remainder.csv"), read_csv(last / "course.csv"), read_json(last / "round.json")
        ),
        "residuals": lambda: discovery.residuals(
            dataset.read(first / "fit.nc"), dataset.read(last / "fit.nc")
        ),
        "map": lambda: discovery.missing_torque(
            read_csv(first / "map.csv"),
            read_csv(last / "map.csv"),
            [read_json(folder / "round.json") for folder in used],
        ),
        "half_swings": lambda: discovery.half_swings(
            read_csv(first / "half_swings.csv"), read_csv(last / "half_swings.csv")
        ),
        "ranking": lambda: discovery.ranking(read_csv(first / "ranking.csv"), moved),
        "gap": lambda: discovery.gap(found),
    }
    if {"curves", "laws"} & {Path(output).stem for output in outputs}:
        drawn |= dict(against_amplitude(found, angles, restoring, known))
    made = {}
    for output in map(Path, outputs):
        made[output.stem] = made.get(output.stem) or drawn[output.stem]()
        save(made[output.stem], output, style.emulated_note(fitted))


if __name__ == "__main__":
    with console.job(snakemake.log[0]):
        files = snakemake.input
        params = snakemake.params
        figures(
            files.verdict, [Path(path).parent for path in files.rounds], snakemake.output,
            list(files.angles), params.model.get("restoring", "sine"), catalogue(params.effects),
        )  # fmt: skip
