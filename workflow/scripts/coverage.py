"""The coverage of all cases as one table."""

import pandas as pd

from swingdown import console
from swingdown.sealed import read_csv, write_csv

with console.job(snakemake.log[0]) as say:
    whole = pd.concat([read_csv(path) for path in snakemake.input.cases], ignore_index=True)
    write_csv(whole, snakemake.output[0])
    least = whole.loc[whole["share"].idxmin()]
    say(
        f"{len(whole)} quantities; least covered: {least['quantity']} ({least['case']}), {least['share']:.1%} of {least['n']}"
    )
