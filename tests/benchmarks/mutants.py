"""How many faults put into random modules their closest tests notice: python tests/benchmarks/mutants.py SEED [MODULES] [EACH] [list]

A mutant is a copy of the package in which one comparison, sign, number or condition of a module is another. The closest tests are the
files of its room that are named after the module; else those of its room that import it; else those of other rooms that do, and those
of its room that are closest to the modules that do. A mutant that leaves them green survives: either a test lacks an assertion,
or the change changes nothing that a user would notice. What survives is tried by the frozen files, answers and verdicts as well, which are the
package's as a whole. It exits with the share that survives above a tenth. ``list`` shows them untried.
"""

import ast
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from swingdown.planning.sources import imported

ROOT = Path(__file__).resolve().parents[2]
SOURCE = ROOT / "workflow/src"
LEFT_OUT = ("__init__", "__main__")
WHOLE = [
    ROOT / "tests" / path
    for path in (
        "measurement/test_frozen_door.py",
        "answer/test_frozen_answers.py",
        "discovery/test_frozen.py",
    )
]
_GREEN = (0, 5)  # codes of pytest: all passed, or none were to run
LONGEST = 900  # s that the tests of a mutant may take; one that never ends is noticed
OTHER = {
    ast.Lt: "<=", ast.LtE: "<", ast.Gt: ">=", ast.GtE: ">", ast.Eq: "!=", ast.NotEq: "==", ast.Is: "is not", ast.IsNot: "is",
    ast.In: "not in", ast.NotIn: "in", ast.Add: "-", ast.Sub: "+", ast.Mult: "/", ast.Div: "*", ast.And: "or", ast.Or: "and",
}  # fmt: skip


def modules():
    """The modules of the package but the search's rooms, which have trials of their own."""
    found = sorted((SOURCE / "swingdown").rglob("*.py"))
    return [path for path in found if path.stem not in LEFT_OUT and "discovery" not in path.parts]


def closest(module, passed=()):
    """The files of tests that are closest to a module, none to those ``passed`` on the way to it."""
    parts = module.relative_to(SOURCE).with_suffix("").parts
    room = ROOT / "tests" / (parts[1] if len(parts) > 2 else "")
    parts = parts[:-1] if parts[-1] == "__init__" else parts  # a package is imported by its own name
    names = {f"test_{parts[-1]}.py", f"test_{parts[1]}_{parts[-1]}.py"} if len(parts) > 1 else set()
    if named := [path for path in sorted(room.glob("test_*.py")) if path.name in names]:
        return named
    above, name = re.escape(".".join(parts[:-1])), re.escape(parts[-1])
    imports = re.compile(rf"{above}\.{name}\b(?!\.)|from {above} import (\([^)]*|.*)\b{name}\b")
    found = [path for path in sorted((ROOT / "tests").rglob("test_*.py")) if imports.search(path.read_text())]
    if own := [path for path in found if path.parent == room]:
        return own
    package = sorted((SOURCE / "swingdown").rglob("*.py"))
    users = (user for user in package if user not in passed and module in imported(user))
    through = sorted({test for user in users for test in closest(user, (*passed, module))})
    return sorted({*found, *(path for path in through if path.parent == room)}) or through or [room]


def changes(text):
    """Every (start, end, replacement) by which one comparison, sign, number or condition of a source becomes another."""
    starts = [0]
    for line in text.encode().splitlines(keepends=True):
        starts.append(starts[-1] + len(line))

    def begin(node):
        return starts[node.lineno - 1] + node.col_offset

    def end(node):
        return starts[node.end_lineno - 1] + node.end_col_offset

    def between(left, operator, right):
        symbol = {ast.And: "and", ast.Or: "or"}.get(type(operator)) or _SYMBOLS[type(operator)]
        gap = text.encode()[end(left) : begin(right)].decode()
        found = re.search(re.escape(symbol).replace(r"\ ", r"\s+"), gap)
        if found:
            yield end(left) + found.start(), end(left) + found.end(), OTHER[type(operator)]

    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Compare) and len(node.ops) == 1 and type(node.ops[0]) in OTHER:
            yield from between(node.left, node.ops[0], node.comparators[0])
        elif isinstance(node, ast.BinOp) and type(node.op) in OTHER:
            yield from between(node.left, node.op, node.right)
        elif isinstance(node, ast.BoolOp):
            yield from between(node.values[0], node.op, node.values[1])
        elif isinstance(node, ast.Constant) and type(node.value) in (int, float):
            yield (
                begin(node),
                end(node),
                repr(node.value + 1 if isinstance(node.value, int) else 2 * node.value + 1e-3),
            )
        elif isinstance(node, ast.If | ast.IfExp):
            yield begin(node.test), end(node.test), f"not ({ast.unparse(node.test)})"


_SYMBOLS = {
    ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!=", ast.Is: "is", ast.IsNot: "is not",
    ast.In: "in", ast.NotIn: "not in", ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/",
}  # fmt: skip


def copied(folder):
    """The package in a copy of the project, whose other files are links: some tests ask for them."""
    sources = folder / "workflow" / "src"
    shutil.copytree(SOURCE, sources, ignore=shutil.ignore_patterns("__pycache__", "*.egg-info"))
    for one in (*ROOT.iterdir(), *SOURCE.parent.iterdir()):
        there = folder / one.relative_to(ROOT)
        if one.name[0] != "." and not there.exists():
            there.symlink_to(one)
    return sources


def noticed(folder, tests):
    """Whether tests fail with the package in a folder."""
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-n0", "-p", "no:cacheprovider", *tests]
    environment = os.environ | {"PYTHONPATH": str(folder), "SWINGDOWN_CACHE": str(folder.parent / "cache")}
    try:
        done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, timeout=LONGEST)
    except subprocess.TimeoutExpired:
        return True
    return done.returncode not in _GREEN


def drawn(seed, count, each):
    """Modules by chance, the source of each, and of its mutants those drawn."""
    draw = random.Random(int(seed))
    for module in draw.sample(modules(), int(count)):
        whole = module.read_bytes()
        known = sorted(set(changes(whole.decode())))
        yield module, whole, sorted(draw.sample(known, min(int(each), len(known))))


def told(module, whole, mutant):
    """Where a mutant is, and what it changes into what."""
    start, end, other = mutant
    line, was = whole[:start].count(b"\n") + 1, " ".join(whole[start:end].decode().split())
    return f"{module.relative_to(ROOT)}:{line}: {was} -> {other}"


def main(seed, count=12, each=3, how=""):
    survived, frozen, total = 0, 0, 0
    with tempfile.TemporaryDirectory() as place:
        copy = copied(Path(place))
        for module, whole, mutants in drawn(seed, count, each):
            tests, target = closest(module), copy / module.relative_to(SOURCE)
            if how == "list":
                print(*(str(test.relative_to(ROOT)) for test in tests))
                print(*(told(module, whole, mutant) for mutant in mutants), sep="\n")
                continue
            if noticed(copy, tests):
                print(
                    f"not counted: {module.relative_to(ROOT)}, whose tests fail without a mutant", flush=True
                )
                continue
            for start, end, other in mutants:
                target.write_bytes(whole[:start] + other.encode() + whole[end:])
                seen = noticed(copy, tests)
                later = not seen and noticed(copy, WHOLE)
                target.write_bytes(whole)
                survived, frozen, total = survived + (not seen), frozen + later, total + 1
                word = "noticed " if seen else "frozen  " if later else "SURVIVES"
                print(word, told(module, whole, (start, end, other)), flush=True)
    print(f"{survived} of {total} survive their closest tests, {survived - frozen} what is frozen as well")
    return survived > total / 10


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
