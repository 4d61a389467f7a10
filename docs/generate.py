"""The site's pages that are made from the code: catalogue, settings, commands, API. ``python docs/generate.py FOLDER``."""

import json
import os
import pkgutil
import sys
from collections.abc import Iterator, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import rule_graph
import sympy
from signature import signature
from sympy.printing.mathml import MathMLPresentationPrinter

import swingdown
from swingdown import __main__ as command
from swingdown.engine.trajectory import simulate
from swingdown.fitting.least_squares import fit_trajectory
from swingdown.paths import PROJECT, written_whole
from swingdown.pendulum import catalogue as entries
from swingdown.pendulum.catalogue import SHIPPED
from swingdown.pendulum.effect import TERM_UNITS, VARIABLES, Effect
from swingdown.pendulum.formula import parse
from swingdown.pendulum.model import Model
from swingdown.plots import style
from swingdown.schema import rules

BASE = ("viscous", "load_coulomb")
SWING = {"natural_frequency": 7.25, "viscous_ratio": 0.006, "load_friction": 0.002}
RELEASE = np.radians(40)
TIMES = np.arange(1501) / 100  # s
KINDS = {
    "dissipation": "What takes energy away", "restoring": "What pulls back", "drive": "What drives", "sensor": "How it is read",
    "clock": "When it is read",
}  # fmt: skip
ACTS = {
    "torque": "added to the angular acceleration, rad/s²", "sensor": "the reading, rad",
    "play": "width of the dead band between angle and reading, rad", "clock": "the true time of a sample stamped t, s",
}  # fmt: skip
ROOMS = {
    "swingdown": "From arrays to an answer", "swingdown.pendulum": "Effects and models", "swingdown.engine": "Trajectories",
    "swingdown.fitting": "Fits", "swingdown.measurement": "From a file to an angle", "swingdown.calibration": "From volts to an angle",
    "swingdown.studies": "Studies, and the quantities of a pendulum", "swingdown.discovery": "The search for what is missing",
    "swingdown.sweep": "Sweeps",
}  # fmt: skip
_LETTERS = {"theta": "θ", "thetadot": "θ̇", "thetaddot": "θ̈", "duration": "T"}


class _Printer(MathMLPresentationPrinter):
    def _print_Symbol(self, sym: Any, style: str = "plain") -> Any:
        return super()._print_Symbol(sympy.Symbol(_LETTERS.get(sym.name, sym.name)), style)


def write(folder: Path) -> None:
    """Writes all generated pages, each whole or not at all."""
    folder.mkdir(parents=True, exist_ok=True)
    pages = {"catalogue": catalogue(folder), "settings": settings(), "commands": commands(), "api": api()}
    pages["rules"] = rule_graph.reference(PROJECT / "workflow/rules")
    with written_whole(folder / "rules.svg") as partial:
        partial.write_text(rule_graph.svg(rule_graph.asked(PROJECT)), encoding="utf-8")
    for room, title in ROOMS.items():
        pages[f"api_{room.rpartition('.')[2]}"] = _room(room, title)
    for name, lines in pages.items():
        with written_whole(folder / f"{name}.md") as partial:
            partial.write_text("\n".join(lines) + "\n", encoding="utf-8")


def equation(text: str, effect: Effect, left: str) -> str:
    """The MathML of ``left`` = the formula ``text`` of an effect, as one line of HTML."""
    names = (
        *VARIABLES,
        *(p.symbol for p in effect.parameters),
        *(s.symbol for s in effect.states),
        "thetaddot",
    )
    printer = _Printer({"mul_symbol": " "})
    right = printer.doprint(parse(text, names, where=effect.name))
    return f'<div><math display="block"><mrow><mi>{left}</mi><mo>=</mo>{right}</mrow></math></div>'


def catalogue(folder: Path) -> Iterator[str]:
    """The catalogue of effects as lines of Markdown; their sketches are written into ``folder``."""
    yield "# The catalogue of effects\n"
    yield (
        f"{len(SHIPPED)} effects that the search may name, and that models may have. The pendulum swings by "
        "θ̈ = −ω<sub>n</sub>² sin θ + Σ torques, divided by 1 + Σ inertias; θ is 0 hanging straight down. Equations, sketches and tables are "
        "made from the entries themselves. *Sketch*: a swing of 15 s from 40° with the effect at its typical size, and what the "
        "best fit of viscous and load Coulomb damping leaves of it, over time and over the angle; the number is its RMS.\n"
    )
    for module, title in KINDS.items():
        yield f"## {title}\n"
        for effect in getattr(import_module(f"{entries.__name__}.{module}"), module.upper()):
            yield from _entry(effect, folder)


def _entry(effect: Effect, folder: Path) -> Iterator[str]:
    yield f"### {effect.name}\n"
    yield f"{effect.explanation}\n"
    if effect.term != "0":
        yield (
            equation(
                effect.term,
                effect,
                {"clock": "t′", "sensor": "reading", "play": "play"}.get(effect.acts_on, "torque"),
            )
            + "\n"
        )
    if effect.inertia:
        yield equation(effect.inertia, effect, "inertia") + "\n"
    for state in effect.states:
        yield equation(state.rate, effect, f"d{state.symbol}/dt") + "\n"
    yield f"In files: `{effect.term}`, {ACTS[effect.acts_on]}.\n"
    assert effect.acts_on in TERM_UNITS
    if effect.parameters:
        yield "| parameter | symbol | unit | bounds | typical | what |"
        yield "|---|---|---|---|---|---|"
        for p in effect.parameters:
            unit = p.unit.replace("^2", "²")
            what = p.text.replace("|", "\\|")
            yield f"| `{p.name}` | `{p.symbol}` | {unit} | {_bounds(p.lower, p.upper)} | {p.typical:g} | {what} |"
        yield ""
    if effect.name not in BASE:
        yield f"![What a fit of viscous and load Coulomb damping leaves of {effect.name}]({sketch(effect, folder)})\n"
    for other, measurement in effect.told_apart.items():
        yield f"- Told from `{other}`: {measurement}"
    yield f"\nSource: {effect.reference}.\n"


def sketch(effect: Effect, folder: Path) -> str:
    """The name of the SVG that is written: what a fit of the base leaves of a swing with the effect."""
    values = SWING | {p.name: p.typical for p in effect.parameters if p.name not in SWING}
    names = tuple(dict.fromkeys((*BASE, effect.name)))
    model = Model(names, values, restoring="linear" if effect.beside == "linear" else "sine")
    angle = simulate(model, TIMES, RELEASE)
    fit = fit_trajectory("+".join(BASE), TIMES, angle)
    name = f"{effect.name}.svg"
    style.save(signature(TIMES, angle, angle - fit.angle), folder / name)
    return name


def settings() -> Iterator[str]:
    """Every key of config, sample sheet and apparatus sheet, as the schemas have them, in lines of Markdown."""
    yield "# Every key\n"
    yield (
        "Made from the schemas that settings and sheets are held against. What the keys mean, with examples: "
        "[config/README.md](../../config/README.md).\n"
    )
    for file, title in (
        ("config", "The config"),
        ("recordings", "The sample sheet"),
        ("apparatus", "The apparatus sheet"),
    ):
        yield f"## {title}\n"
        yield "| key | takes | default | what |\n|---|---|---|---|"
        for key, rule in _keys(rules(f"{file}.schema.yaml")):
            yield f"| `{key}` | {_takes(rule)} | {_default(rule)} | {_cell(rule.get('description', ''))} |"
        yield ""


def _keys(rule: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Each key below a rule with its own rule, the groups opened; ``NAME`` stands for one of the user's own."""
    required = rule.get("required", [])
    for key, inner in rule.get("properties", {}).items():
        path = f"{above}{key}"
        opened = list(_keys(inner, f"{path}."))
        if isinstance(inner.get("additionalProperties"), dict):
            opened += _keys(inner["additionalProperties"], f"{path}.NAME.")
        if isinstance(inner.get("items"), dict):
            opened += _keys(inner["items"], f"{path}[].")
        if not opened or "description" in inner:
            yield path, {**inner, "must": key in required}
        yield from opened


def _takes(rule: Mapping[str, Any]) -> str:
    if "enum" in rule:
        return ", ".join(f"`{one}`" for one in rule["enum"])
    kinds = rule.get("type", "string")
    words = {"string": "text", "integer": "whole number", "number": "number", "array": "list", "object": "group", "boolean": "true, false"}  # fmt: skip
    text = " or ".join(words.get(kind, kind) for kind in ([kinds] if isinstance(kinds, str) else kinds))
    signs = {"minimum": "≥", "exclusiveMinimum": ">", "maximum": "≤", "exclusiveMaximum": "<"}
    return " ".join([text, *(f"{sign} {rule[bound]:g}" for bound, sign in signs.items() if bound in rule)])


def _default(rule: Mapping[str, Any]) -> str:
    value = rule.get("default")
    if rule.get("must"):
        return "must be given"
    return "" if value in (None, "", {}) or value != value else f"`{json.dumps(value, ensure_ascii=False)}`"


def commands() -> Iterator[str]:
    """What can be typed, as the programs themselves tell it, in lines of Markdown."""
    os.environ["COLUMNS"] = "100"
    head = [line[2:] for line in (PROJECT / "Makefile").read_text(encoding="utf-8").splitlines()]
    yield "# Commands\n"
    yield f"## swingdown\n\n```text\n{command._parser().format_help().strip()}\n```\n"
    yield "## make\n\n```text"
    yield from head[: next(k for k, line in enumerate(head) if not line)]
    yield "```\n"
    yield (
        "## snakemake\n\n`.venv/bin/snakemake -c2 TARGET`, TARGET one of `all` (the default), `discover`, `sweep`, `capture`, `report`, "
        "`hidden_effects`, `coverage`, `certified`, or the path of a file under `results/`. `--configfile mine.yaml --directory somewhere` makes it "
        "a study of your own. What each rule makes: [the paper again](../paper.md#where-each-of-them-is-made)."
    )


def api() -> Iterator[str]:
    """The API's table of contents, in lines of Markdown."""
    yield "# The package\n"
    yield (
        "Plain functions on arrays and datasets; nothing here knows of the workflow that calls it. The rooms are in the order in which "
        "a swing goes through them ([the map](../../CONTRIBUTING.md#the-map)).\n"
    )
    yield "```{toctree}\n:maxdepth: 1\n"
    yield from (f"api_{room.rpartition('.')[2]}" for room in ROOMS)
    yield "```"


def _room(room: str, title: str) -> Iterator[str]:
    yield f"# {title}: {room}\n"
    names = [room]
    if room != swingdown.__name__:
        names += sorted(one.name for one in pkgutil.walk_packages(import_module(room).__path__, f"{room}."))
    for name in names:
        if name != room:
            yield f"## {name.removeprefix(f'{room}.')}\n"
        yield f"```{{eval-rst}}\n.. automodule:: {name}\n   :members:\n```\n"


def _bounds(lower: float, upper: float) -> str:
    parts = [
        *([f"≥ {lower:g}"] if np.isfinite(lower) else []),
        *([f"≤ {upper:g}"] if np.isfinite(upper) else []),
    ]
    return ", ".join(parts)


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("\n", " ")


if __name__ == "__main__":
    write(Path(sys.argv[1]))
