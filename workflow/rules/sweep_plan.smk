# How the work of the sweeps is dealt out in chunks; see swingdown/sweep/chunks.py.
# needs: the config (key sweeps), the books that earlier runs wrote, and what lies in the folders of chunks
# makes: results/sweeps/{sweep}/plan.jsonl, when a run starts

import atexit
import sys
from pathlib import Path

from swingdown.sweep import chunks as dealt
from swingdown.sweep import code as codes

CHUNK = "[0-9a-f]{16}(-[0-9a-f]{8})?"
STORED = workflow.storage_settings.default_storage_provider is not None  # no file system that all nodes share
AGAIN = bool(config.pop("recompute", False))
PLANS = {}


def book(name):
    return f"results/sweeps/{name}/plan.jsonl"


def chunk_file(name, stem):
    """Where a chunk's results are."""
    return f"results/sweeps/{name}/chunks/{stem}.nc"


def result(name, stem):
    """What a job makes in Snakemake's eyes: a record of the chunk; the chunk itself where it has to be carried to a storage."""
    return f"results/sweeps/{name}/{'chunks' if STORED else 'jobs'}/{stem}.{'nc' if STORED else 'json'}"


def open_chunks(kind):
    """A pattern of the sweeps that compute this. In the run itself it leaves out chunks that are whole and recorded.

    A job asks in its own process, later: there the pattern is open, and the job finds for itself that its chunk is whole.
    """
    names = [name for name, sweep in SWEEPS.items() if sweep.computes == kind]
    if not names:
        return "(?!)"
    done = []
    if workflow.is_main_process and not STORED:
        for name in names:
            kept = {path.name for path in Path(f"results/sweeps/{name}/jobs").glob("*.json")}
            there = dealt.made(f"results/sweeps/{name}/chunks")
            stems = [dealt.stem(chunk, version) for chunk, all in there.items() for version in all]
            done += [f"{name}/jobs/{stem}" for stem in stems if f"{stem}.json" in kept]
    pattern = "|".join(names)
    return f"(?!(?:{'|'.join(done)})[.]json$)(?:{pattern})" if done else pattern


def planned(name):
    """The plan of a sweep, made once, and the records of chunks as the chunks are: one lacks where a run was killed before it wrote
    it, and one outlives a chunk that was deleted.
    """
    if name not in PLANS:
        with console.job():
            if STORED and SWEEPS[name].format == "zarr":
                raise InputError(f"config, key sweeps.{name}.format", "a Zarr store is a folder, and the storage plugin carries files alone",
                                 "`netcdf`, where a storage plugin carries the chunks", "write `format: netcdf`")  # fmt: skip
            PLANS[name] = dealt.deal(SWEEPS[name], book(name), codes.version(SWEEPS[name].computes), AGAIN)
        if workflow.is_main_process and not STORED:
            if workflow.dryrun:
                tell(name, PLANS[name])
            else:
                missing = set(PLANS[name].missing)
                for chunk, stem in PLANS[name].files.items():
                    if chunk in missing:
                        Path(result(name, stem)).unlink(missing_ok=True)
                    elif not os.path.exists(result(name, stem)):
                        from swingdown.sweep.job import (
                            record,
                        )  # takes a while to import, and is rarely needed

                        record(chunk_file(name, stem), result(name, stem))
    return PLANS[name]


def tell(name, plan):
    """What a sweep will take, below a dry run's list of jobs, where it is seen."""
    from swingdown.sweep.cost import estimate

    told = "\n".join(estimate(SWEEPS[name], plan, list(plan.missing)))
    atexit.register(lambda: print(told, file=sys.stderr))


def results_of(wildcards):
    """What the jobs of a sweep's chunks make."""
    return [result(wildcards.sweep, stem) for stem in planned(wildcards.sweep).files.values()]


def chunk_files(name, made):
    """The files of the chunks whose jobs made these."""
    return list(made) if STORED else [chunk_file(name, Path(path).stem) for path in made]


def book_for_jobs(wildcards):
    """The book as an input, where jobs have no other way to see it."""
    return ancient(f"results/sweeps/{wildcards.sweep}/book.jsonl") if STORED else []


def new_in_book(name):
    """Stands for the chunks that this run computes: with others the book is carried to the storage again."""
    return sorted(planned(name).missing) if workflow.is_main_process else []


def swept():
    """The sweeps' tables that lie there, with their age: a newer one makes the report new."""
    tables = [f"results/sweeps/{name}/summary.csv" for name in SWEEPS]
    return {table: os.stat(table).st_mtime_ns for table in tables if os.path.exists(table)}


def write_books():
    for name, plan in PLANS.items():
        dealt.add_to_book(book(name), plan.new)
