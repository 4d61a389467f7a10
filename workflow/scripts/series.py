"""g with its budget, and how periods, qualities and decay rates go with what was varied."""

from swingdown import console
from swingdown.sealed import read_csv, write_csv
from swingdown.series import as_laws, as_table, of_sheet
from swingdown.studies.gravity import budgets, of_two_pivots, with_gravity

with console.job(snakemake.log[0]) as say:
    table, params, files = read_csv(snakemake.input.table), snakemake.params, snakemake.output
    found = with_gravity(table, params.stated, params.restoring)[1] | of_two_pivots(table, params.stated)
    made = of_sheet(table, params.stated)
    write_csv(budgets(found), files.budget)
    write_csv(as_table(made), files.series)
    write_csv(as_laws(made), files.laws)
    say("\n".join(one.sentence for one in made))
