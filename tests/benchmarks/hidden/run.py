"""Holds the search for hidden effects against what one would otherwise use, on the same campaigns: ``make benchmark-discovery``.

Reads results/hidden_effects as ``snakemake hidden_effects`` leaves it, runs each method on every campaign and writes
discovery.csv (a row for each method and campaign) and discovery_summary.csv (a row for each method). A campaign that a
method cannot digest counts as failed, and the rest goes on. ``--answers FILE`` adds a method that was run elsewhere: a CSV with a
row for each campaign (docs/benchmark.md).
"""

import argparse
import time
from pathlib import Path

import pandas as pd
import weak_form
from campaigns import campaigns, row

from swingdown import console
from swingdown.errors import InputError

OURS = "this package"
KINDS = ("single", "pair", "null", "own", "calibrated", "removed", "foreign")
SAID = ("named", "consistent", "unknown", "failed")
PAUSE = 15  # s between two lines of progress


def methods():
    """(methods by name, reasons why others are left out): each method takes swings and the effects that are not in the catalogue."""
    found, missing = {"weak form, one term at a time": weak_form.named}, []
    try:
        import bayes
        import sindy

        found |= {
            "pysindy STLSQ, strong form": sindy.strong,
            "pysindy STLSQ, weak form": sindy.weak,
            "sparse Bayesian learning, weak form": bayes.named,
        }
    except ImportError as error:
        missing.append(
            f"pysindy ({error}; make benchmark-discovery installs it from requirements-discovery.lock)"
        )
    return found, missing


def measure(found, trials):
    """The rows of ``found`` methods on all campaigns, told as they come."""
    rows, begun, told = [], time.monotonic(), time.monotonic()
    for number, one in enumerate(trials, 1):
        for method, names in found.items():
            started = time.process_time()
            try:
                named, said = names(one.swings(), one.lacks), None
            except (
                Exception
            ) as error:  # of whatever kind: a method that falls over has not answered, and that is counted
                named, said = [], "failed"
                print(f"  {one.name}: {method} failed: {type(error).__name__}: {error}", flush=True)
            rows.append(row(method, one, named, time.process_time() - started, said))
        if time.monotonic() - told > PAUSE or number == len(trials):
            told = time.monotonic()
            print(f"  {number:4d} of {len(trials)} campaigns, {told - begun:.0f} s", flush=True)
    return rows


def ours(path, trials):
    """The package's own rows from its scores.csv, of those campaigns that are scored there; none where it is missing."""
    if not Path(path).is_file():
        print(f"NOT SHOWN: {OURS}, for {path} is not there (snakemake hidden_effects makes it)")
        return []
    scores = pd.read_csv(path, keep_default_na=False).set_index("campaign")
    rows = []
    for one in trials:
        if one.name not in scores.index or scores.loc[one.name, "hidden"] != "+".join(one.truth["hidden"]):
            continue
        score = scores.loc[one.name]
        named = (
            []
            if score["status"] in ("consistent", "unknown")
            else [(name,) for name in score["named"].split("+") if name]
        )
        flags = {name: str(score[name]) == "True" for name in ("exact", "inside", "wrong")}
        rows.append(row(OURS, one, named, float(score["seconds"]), score["status"]) | flags)
    if len(rows) < len(trials):
        print(
            f"{OURS}: {len(rows)} of {len(trials)} campaigns are scored in {path}; its figures are of those alone"
        )
    return rows


def answers(path, trials):
    """The rows of a method that was run elsewhere, from a CSV of its answers; InputError where that is none.

    Columns ``campaign``, ``said`` (named, consistent, unknown or failed), ``named`` (effects with + between them, and / between those
    that one term may stand for) and, if known, ``cpu_s``. A campaign without an answer counts as failed.
    """
    path = Path(path)
    if not path.is_file():
        raise InputError(path, "the answers are not there", mend="say where they are: --answers FILE")
    table = pd.read_csv(path, dtype=str, keep_default_na=False)
    if lacks := [name for name in ("campaign", "said", "named") if name not in table]:
        raise InputError(path, f"no column {lacks[0]}", "the columns campaign, said and named")
    if len(strange := sorted(set(table["said"]) - set(SAID))):
        raise InputError(f"{path}, column said", f"{strange[0]!r}", f"one of {', '.join(SAID)}")
    if unknown := sorted(set(table["campaign"]) - {one.name for one in trials}):
        raise InputError(f"{path}, column campaign", f"no campaign is called {unknown[0]}")
    told, rows = table.drop_duplicates("campaign").set_index("campaign"), []
    for one in trials:
        if one.name not in told.index:
            rows.append(row(path.stem, one, [], float("nan"), "failed"))
            continue
        answer = told.loc[one.name]
        names = [tuple(name.split("/")) for name in answer["named"].split("+") if name]
        seconds = float(answer["cpu_s"]) if answer.get("cpu_s") else float("nan")
        rows.append(row(path.stem, one, names, seconds, answer["said"]))
    return rows


def summarise(table):
    """The table of figures, a row for each method: counts as "k of n", the median CPU time of a campaign in s."""
    found = []
    for method, part in table.groupby("method", sort=False):
        kind = {name: part[part["kind"] == name] for name in KINDS}
        outside = pd.concat([kind["removed"], kind["foreign"]])
        found.append(
            {"method": method}
            | {
                f"exact, {ratio:g} times the noise": _count(one["exact"])
                for ratio, one in kind["single"].groupby("ratio")
            }
            | {
                "exact, single": _count(kind["single"]["exact"]),
                "the same or inside a tie of at most four": _count(kind["single"]["inside"]),
                "wrong name, single": _count(kind["single"]["wrong"]),
                "false alarm, null": _count(kind["null"]["alarm"]),
                "false alarm, own frequencies": _count(kind["own"]["alarm"]),
                "false alarm, volts with a calibration": _count(kind["calibrated"]["alarm"]),
                "unknown, removed or foreign": _count(outside["said"] == "unknown"),
                "wrong name, removed or foreign": _count(outside["wrong"]),
                "both of a pair": _count(kind["pair"]["exact"]),
                "both, or each inside a tie": _count(kind["pair"]["inside"]),
                "wrong name, pair": _count(kind["pair"]["wrong"]),
                "failed": _count(part["said"] == "failed"),
                "median CPU s a campaign": f"{part['cpu_s'].median():.3g}",
            }
        )
    return pd.DataFrame(found)


def _count(flags):
    return f"{int(flags.sum())} of {len(flags)}"


def main():
    reader = argparse.ArgumentParser(description=__doc__)
    reader.add_argument(
        "--hidden",
        type=Path,
        default=Path("results/hidden_effects"),
        help="what snakemake hidden_effects made",
    )
    reader.add_argument("--results", type=Path, default=Path("results/benchmarks"))
    reader.add_argument("--answers", type=Path, action="append", default=[], help="a method's answers, a CSV")
    reader.add_argument("--most", type=int, help="of each kind, for a quicker look; by default all")
    given = reader.parse_args()
    trials = campaigns(given.hidden)
    if given.most:
        kinds = [one.truth["kind"] for one in trials]
        trials = [one for k, one in enumerate(trials) if kinds[:k].count(kinds[k]) < given.most]
    found, missing = methods()
    for reason in missing:
        print(f"NOT MEASURED: {reason}")
    print(f"{len(trials)} campaigns of {given.hidden}, {len(found)} methods:")
    elsewhere = [line for path in given.answers for line in answers(path, trials)]
    table = pd.DataFrame(ours(given.hidden / "scores.csv", trials) + elsewhere + measure(found, trials))
    figures = summarise(table)
    given.results.mkdir(parents=True, exist_ok=True)
    table.to_csv(given.results / "discovery.csv", index=False, float_format="%.4g")
    figures.to_csv(given.results / "discovery_summary.csv", index=False)
    print("\n" + figures.set_index("method").T.to_string() + "\n")
    print(f"written: {given.results / 'discovery.csv'}, {given.results / 'discovery_summary.csv'}")


if __name__ == "__main__":
    with console.job():
        main()
