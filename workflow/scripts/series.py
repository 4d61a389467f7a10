"""g with its budget, and how periods, qualities and decay rates go with what was varied."""

import swingdown.prefork  # noqa: F401  # first of all: it may take the job over

from swingdown import console
from swingdown.sealed import read_csv, write_csv
from swingdown.series import as_laws, as_table, of_sheet
from swingdown.studies.gravity import budgets, of_two_pivots, with_gravity


def collect(table, stated, restoring, budget, series, laws):
    """The tables written, and a sentence on each law."""
    table = read_csv(table)
    found = with_gravity(table, stated, restoring)[1] | of_two_pivots(table, stated)
    made = of_sheet(table, stated)
    write_csv(budgets(found), budget)
    write_csv(as_table(made), series)
    write_csv(as_laws(made), laws)
    return "\n".join(one.sentence for one in made)


if __name__ == "__main__":
    with console.job(snakemake.log[0]) as say:
        asked, made = snakemake.params, snakemake.output
        say(
            collect(snakemake.input.table, asked.stated, asked.restoring, made.budget, made.series, made.laws)
        )
