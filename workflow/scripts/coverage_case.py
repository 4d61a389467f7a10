"""How often stated intervals hold the truth, in one case of many simulated measurements."""

from swingdown import console
from swingdown.measurement.apparatus import read_apparatus
from swingdown.sealed import write_csv
from swingdown_trials.coverage import CASES, calibrations, swings

with console.job(snakemake.log[0]) as say:
    params, case = snakemake.params, snakemake.wildcards.case
    known = read_apparatus(snakemake.input.apparatus)
    if case == "calibrations":
        found = calibrations(known, params.measurements, params.seed)
    else:
        found = swings(known, CASES[case], params.measurements, params.seed)
    write_csv(found, snakemake.output[0])
    least = found.loc[found["share"].idxmin()]
    say(
        f"{found['case'].iloc[0]}: {params.measurements} measurements; least covered is {least['quantity']}, {least['share']:.1%}"
    )
