# How the work of the sweeps is dealt out in chunks; see swingdown/sweep/chunks.py.
# needs: the config (key sweeps), and the books that earlier runs wrote
# makes: results/sweeps/{sweep}/plan.jsonl, when a run starts

import atexit
import sys

from swingdown.sweep import chunks as dealt

NEW = {}  # chunks that are not in their sweep's book yet; written when the run starts, and never by a dry run


def book(name):
    return f"results/sweeps/{name}/plan.jsonl"


def named(kind):
    """A pattern of the sweeps that compute this."""
    return "|".join(name for name, sweep in SWEEPS.items() if sweep.computes == kind) or "(?!)"


def chunks_of(wildcards):
    """The files of a sweep's chunks; what is new is dealt out, and told in a dry run."""
    name = wildcards.sweep
    with console.job():
        plan = dealt.plan(SWEEPS[name], book(name))
    files = {chunk: f"results/sweeps/{name}/chunks/{chunk}.nc" for chunk in plan.chunks}
    if workflow.dryrun and name not in NEW:
        from swingdown.sweep.cost import estimate

        missing = [chunk for chunk, file in files.items() if not os.path.exists(file)]
        told = "\n".join(estimate(SWEEPS[name], plan, missing))
        atexit.register(lambda: print(told, file=sys.stderr))  # below the list of jobs, where it is seen
    NEW[name] = plan.new
    return list(files.values())


def swept():
    """The sweeps' tables that lie there, with their age: a newer one makes the report new."""
    tables = [f"results/sweeps/{name}/summary.csv" for name in SWEEPS]
    return {table: os.stat(table).st_mtime_ns for table in tables if os.path.exists(table)}


def write_books():
    for name, new in NEW.items():
        dealt.add_to_book(book(name), new)


AT_START.append(write_books)
