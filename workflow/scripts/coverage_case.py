"""How often stated intervals hold the truth, in one case of many simulated measurements."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

from swingdown import console
from swingdown.measurement.apparatus import read_apparatus
from swingdown.sealed import write_csv
from swingdown_trials.coverage import CASES, calibrations, swings


def coverage_case(apparatus, case, count, seed, output):
    known = read_apparatus(apparatus)
    if case == "calibrations":
        found = calibrations(known, count, seed)
    else:
        found = swings(known, CASES[case], count, seed)
    write_csv(found, output)
    least = found.loc[found["share"].idxmin()]
    return f"{found['case'].iloc[0]}: {count} measurements; least covered is {least['quantity']}, {least['share']:.1%}"


if __name__ == "__main__":
    with console.job(snakemake.log[0]) as say:
        params = snakemake.params
        say(
            coverage_case(
                snakemake.input.apparatus,
                snakemake.wildcards.case,
                params.measurements,
                params.seed,
                snakemake.output[0],
            )
        )
