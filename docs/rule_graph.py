"""The workflow's rules as a picture and as pages: asked of Snakemake and read from workflow/rules, never written by hand."""

import re
import subprocess
import sys
from collections.abc import Iterator, Mapping
from itertools import pairwise
from pathlib import Path

WIDE, HIGH, BESIDE, BELOW = 118, 26, 132, 50  # px: a box, and from one to the next
_RULE = re.compile(r"^ *(?:rule|checkpoint) (\w+):\n(.*?)(?=^ *(?:rule|checkpoint) |\Z)", re.M | re.S)
_MESSAGE = re.compile(r"message:\s+f?\"([^\"]*)\"")
_SCRIPT = re.compile(r"script:\s+\"\.\./(scripts/\w+\.py)\"")
Edges = set[tuple[str, str]]


def asked(project: Path) -> Edges:
    """The pairs of rules of the paper's study in which the second needs what the first makes; its figures are one rule."""
    command = [sys.executable, "-m", "snakemake", "all", "--rulegraph", "--forceall"]
    dot = subprocess.run(command, cwd=project, capture_output=True, text=True, check=True).stdout
    names = {
        key: re.sub(r"^fig\d\d$", "fig01 … fig15", name)
        for key, name in re.findall(r'(\d+)\[label = "(\w+)', dot)
    }
    edges = {(names[one], names[other]) for one, other in re.findall(r"(\d+) -> (\d+)", dot)}
    edges = {(one, other) for one, other in edges if one != other}
    return {(one, other) for one, other in edges if not _leads(edges - {(one, other)}, one, other)}


def _leads(edges: Edges, one: str, other: str) -> bool:
    """Whether a way leads from one rule to the other."""
    return any(b == other or _leads(edges, b, other) for a, b in edges if a == one)


def _lines(edges: Edges) -> dict[str, int]:
    """The line of each rule: as far down as what it needs asks for."""
    found: dict[str, int] = {}

    def line(name: str) -> int:
        if name not in found:
            found[name] = max((line(a) + 1 for a, b in edges if b == name), default=0)
        return found[name]

    for edge in edges:
        for name in edge:
            line(name)
    return found


def _ways(edges: Edges, lines: Mapping[str, int]) -> list[list[str]]:
    """Each edge as the names that it passes, with one for every line in between, where nothing else may lie."""
    return [
        [one, *(f"{one}>{other}:{k}" for k in range(lines[one] + 1, lines[other])), other]
        for one, other in sorted(edges)
    ]


def _places(lines: Mapping[str, int], steps: Edges) -> dict[str, float]:
    """The place of each name in its line: near to those that it is joined to, and apart from its neighbours."""
    found = dict.fromkeys(lines, 0.0)
    for _ in range(24):
        for line in sorted(set(lines.values())):
            near = {
                name: [found[b if a == name else a] for a, b in steps if name in (a, b)]
                for name in lines
                if lines[name] == line
            }
            wanted = {name: sum(places) / len(places) for name, places in near.items()}
            middle = sum(wanted.values()) / len(wanted)
            for k, name in enumerate(sorted(near, key=lambda name: (wanted[name], name))):
                found[name] = middle + k - (len(near) - 1) / 2
    least = min(found.values())
    return {name: place - least for name, place in found.items()}


def svg(edges: Edges) -> str:
    """The graph as a picture, from above downwards."""
    rules = _lines(edges)
    ways = _ways(edges, rules)
    lines = rules | {name: rules[way[0]] + k for way in ways for k, name in enumerate(way)}
    places = _places(lines, {step for way in ways for step in pairwise(way)})
    across = {name: 4 + WIDE / 2 + place * BESIDE for name, place in places.items()}
    down = {name: 4 + line * BELOW for name, line in lines.items()}
    size = max(across.values()) + WIDE / 2 + 4, max(down.values()) + HIGH + 4
    drawn = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{size[0]:.0f}" height="{size[1]:.0f}" font-family="sans-serif" font-size="12">',
        "<style>path{fill:none;stroke:#888;stroke-width:1.2}rect{fill:#e8eef4;stroke:#22577a}text{fill:#1c2430;text-anchor:middle}</style>",
    ]
    for way in ways:
        path = f"M{across[way[0]]:.1f} {down[way[0]] + HIGH}"
        for one, other in pairwise(way):
            begin, end = down[one] + HIGH, down[other]
            middle = (begin + end) / 2
            path += f" C{across[one]:.1f} {middle} {across[other]:.1f} {middle} {across[other]:.1f} {end}"
            path += "" if other == way[-1] else f" v{HIGH}"
        drawn.append(f'<path d="{path}"/>')
    for name in rules:
        x, y = across[name], down[name]
        drawn.append(f'<rect x="{x - WIDE / 2:.1f}" y="{y}" width="{WIDE}" height="{HIGH}" rx="5"/>')
        drawn.append(f'<text x="{x:.1f}" y="{y + HIGH / 2 + 4}">{name}</text>')
    return "\n".join([*drawn, "</svg>", ""])


def reference(folder: Path) -> Iterator[str]:
    """Every file of rules, in lines of Markdown: what it needs, what it makes, and its rules."""
    yield "# The rules\n"
    yield "Each file of `workflow/rules` opens with what it needs and makes; a rule calls one script, and a script one function.\n"
    for path in sorted(folder.glob("*.smk")):
        text = path.read_text(encoding="utf-8")
        opening = re.match(r"(?:# [^\n]*\n)+", text)
        if not opening or not (rules := _RULE.findall(text)):
            continue
        yield f"## {path.stem}\n"
        words = " ".join(line.lstrip("# ") for line in opening[0].splitlines())
        parts = re.split(r" (?=(?:needs|makes): )", words)
        yield "\n".join([parts[0] + "\n", *(f"- {part}" for part in parts[1:]), ""])
        yield "| rule | what it says | script |\n|---|---|---|"
        for name, body in rules:
            said, script = (pattern.search(body) for pattern in (_MESSAGE, _SCRIPT))
            yield f"| `{name}` | {said[1] if said else ''} | {f'`{script[1]}`' if script else ''} |"
        yield ""
