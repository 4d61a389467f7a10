"""What a study makes, by its plan and settings alone: the files that its rules write, its report shows and its manifest lists."""

from collections.abc import Iterable, Mapping
from itertools import product
from typing import Any, NamedTuple

from .plan import Plan

_ROUND = (
    "model.yaml", "fit.nc", "groups.csv", "ranking.csv", "map.csv", "half_swings.csv", "remainder.csv", "course.csv",
)  # fmt: skip
# What a search writes below the folder of its campaign.
SEARCH_FILES = ("rounds.json", *(f"{place}/{file}" for place in ("first", "last") for file in _ROUND))
SEEN = ("answer", "remainder", "residuals", "map", "half_swings", "ranking", "gap")  # functions of plots
_PICTURES = ("svg", "png")
# What a sample sheet states beside its files: lengths, and what was varied between recordings.
CELLS = ("length", "bob_diameter", "bob_density", "pivot_distance", "mass", "area", "current", "group")
_SERIES = ("length", "mass", "area", "current")
_FEWEST = 3  # values that a law is fitted to


class Made(NamedTuple):
    """Paths below the folder of the run, in the order in which a report shows them.

    ``tables`` and ``figures`` (the paper's apart), ``verdicts`` and ``seen``, their figures, are shown. ``study`` and ``searched`` are what
    these rest on, of the whole study and of the target ``discover``. ``joint``: fits to all swings of a pendulum; ``curves``: by amplitude.
    ``stated``: what the sheet says of lengths and of what was varied, by recording.
    """

    tables: list[str]
    figures: list[str]
    verdicts: list[str]
    seen: list[str]
    study: list[str]
    searched: list[str]
    joint: list[str]
    curves: list[str]
    stated: dict[str, dict[str, str]]


def made(plan: Plan, settings: Mapping[str, Any], own: bool) -> Made:
    """What a study of the recordings of a plan makes, by its complete settings (``settings.complete``).

    If it is somebody's ``own``, pendulums are shown side by side, with what each shows against the amplitude.
    """
    tables, figures, study = [], [], []
    simulated = settings["simulation"]["simulated"]
    if simulated:
        tables += ["table2"]
        study += ["simulation/realizations.nc", "simulation/norms.nc"]
        study += [f"simulation/norms_{name}.nc" for name in simulated]
    if not plan.campaigns:
        return Made(_in("tables", tables, ".csv"), [], [], [], _in("", study), [], [], [], {})
    cells = {
        name: {key: plan.rows[name][key] for key in CELLS if plan.rows[name][key]} for name in plan.moving
    }
    stated = {name: one for name, one in cells.items() if one}
    tables += ["uncertainty_budget"] if plan.in_volts else []
    tables += ["table3", "comparison", "parameters", "parameter_budget", "left_out", "pendulums"]
    if own:
        tables += ["g_budget", "series", "laws"] if stated else []
        figures += ["pendulums"] if len(plan.swings()) > 1 else []
        figures += varied_in(stated)
    # A pendulum of one swing has nothing to fit together: that is the swing's own fit.
    joint = [f"experiment/joint/{name}.nc" for name in plan.campaigns if len(plan.swings(name)) > 1]
    each = product(plan.campaigns if own else (), ("curves", "laws"), ("csv", *_PICTURES))
    curves = [f"curves/{name}/{kind}.{ending}" for name, kind, ending in each]
    found = _searched(plan, settings["discovery"]["rounds"])
    return Made(
        _in("tables", tables, ".csv"), _pictures("figures", figures),
        [f"results/discovery/{name}/verdict.json" for name in plan.searched],
        [path for path in found if path.endswith(".svg")],
        _in("", [*study, *joint, "experiment/norms.nc", *curves]),
        [path for path in found if not path.endswith(".svg")], _in("", joint), _in("", curves), stated,
    )  # fmt: skip


def models_of_rounds(rounds: int) -> list[str]:
    """The files below a campaign's folder that hold the model of each round, the base's first."""
    return [f"round-{number}/model.yaml" for number in range(rounds + 1)]


def _searched(plan: Plan, rounds: int) -> list[str]:
    """What the searches make but for their verdicts, and what they read. A swing that is only searched is fitted too: is it free?"""
    found = _in("recordings", plan.measured, ".nc") + _in("angles", plan.measured, ".nc")
    found += ["results/calibration/calibration.nc"] if plan.in_volts else []
    found += _in("experiment/fits", plan.moving, ".nc")
    for name in plan.searched:
        folder = f"discovery/{name}"
        found += _in(folder, (*SEARCH_FILES, *models_of_rounds(rounds), "difference.json"))
        found += _pictures(f"{folder}/figures", (*SEEN, *(["difference"] if plan.changed(name) else [])))
    return found


def _in(folder: str, names: Iterable[str], ending: str = "") -> list[str]:
    return ["/".join(filter(None, ("results", folder, f"{name}{ending}"))) for name in names]


def _pictures(folder: str, names: Iterable[str]) -> list[str]:
    return [path for name in names for path in _in(folder, [f"{name}.{ending}" for ending in _PICTURES])]


def varied_in(stated: Mapping[str, Mapping[str, str]]) -> tuple[str, ...]:
    """The figures that these cells by recording ask for: ``series``, where a column has three values, and ``groups``, where there are two."""

    def different(column: str) -> int:
        return len({cells[column] for cells in stated.values() if column in cells})

    series = ("series",) if any(different(one) >= _FEWEST for one in _SERIES) else ()
    return (*series, "groups") if different("group") > 1 else series
