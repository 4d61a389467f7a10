"""The line from voltage to angle in three modes of uncertainty, and the uncertainty budget."""

from swingdown import console, dataset
from swingdown.apparatus import read_apparatus
from swingdown.calibration import budget, calibrate
from swingdown.tables import write_table


def run(apparatus, static, draws, seed, mode, calibration_output, budget_output):
    sheet = read_apparatus(apparatus)
    calibration = calibrate(sheet, [dataset.read(path) for path in static], draws=draws, seed=seed)
    dataset.write(calibration, calibration_output)
    write_table(budget(calibration), budget_output)
    return "calibrated"


if __name__ == "__main__":
    with console.job(snakemake.log[0]) as say:
        params, files, made = snakemake.params, snakemake.input, snakemake.output
        say(
            run(
                files.apparatus,
                files.static,
                params.draws,
                params.seed,
                params.mode,
                made.calibration,
                made.budget,
            )
        )
