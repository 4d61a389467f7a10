"""The engine on other machines: other compilers, none, a cache that is broken, shared or not to be written."""

import hashlib
import os
import shutil
import stat
import subprocess
import sys

import numpy as np
import pytest

from swingdown.engine import build, cache, interface, prebuilt
from swingdown.engine.trajectory import simulate
from swingdown.errors import EngineError
from swingdown.pendulum.catalogue import SHIPPED
from swingdown.pendulum.model import Model

# few effects, so that the generator is done at once
EFFECTS = SHIPPED["viscous"], SHIPPED["constant_coulomb"]
GRAVITIES = tuple(SHIPPED.gravity.values())
TIMES = np.linspace(0.0, 3.0, 200)
VALUES = {"natural_frequency": 7.0, "viscous_ratio": 0.01, "constant_friction": 0.2}


def angles(path):
    """The angles (rad) that the engine in a shared library computes for a pendulum with both effects."""
    library = interface.ffi().dlopen(str(path))
    model = interface.model(interface.Layout([(0, 1, 0), (2, 1, 0), (3, 2, 0)], n_parameters=3), 3.0)
    read = np.empty(TIMES.size)
    status, _ = interface.swing_trajectory(
        library,
        model,
        interface.InitialValueProblem(np.array(list(VALUES.values())), (0.5, 0.1), TIMES),
        read,
    )
    assert status == library.DONE
    return read


def fitted(path, angle):
    """How a fit in the lanes of the engine in a shared library ends, and what it finds of a pendulum with both effects."""
    library, motions = interface.ffi().dlopen(str(path)), [(0, 1, 0), (2, 1, 0), (3, 2, 0)]
    model = interface.model(interface.Layout(motions, n_parameters=3), 3.0)
    bounds = interface.Bounds(np.full(5, -np.inf), np.full(5, np.inf))
    start = np.array([*VALUES.values(), 0.5, 0.1])
    common = interface.Batch(model, TIMES, start, np.arange(5, dtype=np.int32), bounds)
    converged, evaluations, alone = np.zeros((3, 1), dtype=np.int32)
    found = interface.BatchResult(np.empty((1, 5)), np.empty(1), converged, evaluations, alone)
    interface.fit_batch(
        library, common, angle[None], start[None].copy(), interface.Options(200, 1e-10), found
    )
    assert not alone[0]
    return converged[0], [*found.rss, *found.values[0]]


@pytest.fixture(scope="module")
def usual():
    """The same angles by the engine of this machine."""
    return simulate(Model("viscous+constant_coulomb", VALUES), TIMES, 0.5, 0.1)


@pytest.fixture
def library(tmp_path, monkeypatch):
    """A function that builds or finds the engine, in a cache of the test's own."""
    interface.ffi()  # from the usual cache
    monkeypatch.setenv("SWINGDOWN_CACHE", str(tmp_path / "cache"))
    return lambda: build.library(EFFECTS, GRAVITIES)


@pytest.fixture
def compiler(tmp_path, monkeypatch):
    """A function that makes a compiler of a few lines of shell the one to use; returns the file that its calls go to.

    It hands over to the real one, without optimisation, for that is done in a second.
    """
    real = next(filter(None, map(shutil.which, ("gcc", "cc", "clang"))))

    def make(*lines, real=real):
        program, calls = tmp_path / "compiler", tmp_path / "calls"
        program.write_text(
            "\n".join(["#!/bin/sh", f'echo "$*" >> {calls}', *lines, f'exec {real} "$@" -O0', ""])
        )
        program.chmod(0o755)
        monkeypatch.setenv("CC", str(program))
        calls.write_text("")
        return calls

    return make


def test_a_compiler_that_knows_no_native_processor(library, compiler, usual):
    calls = compiler('case "$*" in *-march=native*) echo "unknown value native" >&2; exit 1;; esac')
    assert np.array_equal(angles(library()), usual)
    assert ["-march=native" in call for call in calls.read_text().splitlines()] == [True, False]


def test_clang_gives_the_same_bits(library, compiler, usual):
    clang = shutil.which("clang")
    if clang is None:
        pytest.skip("NOT TESTED: no clang on this machine (tools/install-test-tools)")
    compiler(real=clang)
    assert np.array_equal(angles(library()), usual)


@pytest.mark.parametrize("name", ["gcc", "clang"])
def test_the_whole_engine_compiles_without_a_warning(name, tmp_path):
    """The C that is written by hand, and what is generated from the catalogue."""
    if shutil.which(name) is None:
        pytest.skip(f"no {name} on this machine (tools/install-test-tools)")
    header = build.header(SHIPPED.known, tuple(SHIPPED.gravity.values()))
    for file, text in (build.sources() | {"catalogue.h": header}).items():
        (tmp_path / file).write_text(text)
    strict = [name, "-std=c99", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", "engine.c"]
    done = subprocess.run(strict, cwd=tmp_path, text=True, capture_output=True)
    assert done.returncode == 0, done.stderr


def test_a_later_start_asks_no_compiler(library, compiler):
    calls = compiler()
    first, told = library(), calls.read_text()
    assert library() == first and calls.read_text() == told


def test_another_version_of_the_compiler_builds_anew(library, compiler):
    compiler()
    first = library()
    compiler("# a later version")
    assert library() != first


def test_another_processor_builds_anew(library, compiler, monkeypatch):
    compiler()
    first = library()
    monkeypatch.setattr("swingdown.engine.compiler.processor", lambda: "another")
    assert library() != first


@pytest.mark.parametrize("damage", ["truncated", "corrupt", "empty", "checksum lost"])
def test_a_damaged_library_is_built_anew(library, compiler, usual, damage):
    compiler()
    path = library()
    whole = path.read_bytes()
    if damage == "truncated":
        path.write_bytes(whole[: len(whole) // 2])
    elif damage == "corrupt":
        path.write_bytes(whole[:5000] + bytes(1000) + whole[6000:])
    elif damage == "empty":
        path.write_bytes(b"")
    else:
        path.with_name(path.name + ".sha256").unlink()
    assert library() == path and path.read_bytes() == whole
    assert np.array_equal(angles(path), usual)


def test_a_damaged_header_is_written_anew(library, compiler):
    compiler()
    path = library()
    header = next(path.parent.glob("catalogue-*.h"))
    whole = header.read_text()
    header.write_text(whole[:1000])
    assert library() == path and header.read_text() == whole


START = """
import sys
sys.path.insert(0, sys.argv[1])
from test_build import EFFECTS, GRAVITIES, angles, build
print(angles(build.library(EFFECTS, GRAVITIES)).tobytes().hex())
"""


def test_processes_that_build_at_once(library, compiler, usual, tmp_path, request):
    compiler("sleep 0.5")
    for path in (library(), *(tmp_path / "cache").glob("interface-*")):
        path.unlink()  # the header stays: generating it takes longest, and goes the same way
    command = [sys.executable, "-c", START, str(request.path.parent)]
    started = [subprocess.Popen(command, stdout=subprocess.PIPE, text=True) for _ in range(2)]
    told = [process.communicate()[0].strip() for process in started]
    assert told == [usual.tobytes().hex()] * 2
    left = sorted(path.name.partition("-")[0] for path in (tmp_path / "cache").iterdir())
    assert left == ["catalogue", "catalogue", "engine", "engine", "interface", "interface"]
    assert cache.is_whole(library())


COLD = """
import numpy as np
from swingdown.engine.trajectory import simulate
from swingdown.pendulum.model import Model
values = {"natural_frequency": 7.0, "viscous_ratio": 0.01, "constant_friction": 0.2}
print(simulate(Model("viscous+constant_coulomb", values), np.linspace(0.0, 3.0, 200), 0.5, 0.1).tobytes().hex())
"""


@pytest.mark.slow("the whole engine is compiled")
def test_processes_that_need_the_whole_engine_at_once_on_a_new_machine(tmp_path, monkeypatch, usual):
    """Nothing is there: header, library and interface of the whole catalogue are made by each that comes, and one stays."""
    monkeypatch.setenv("SWINGDOWN_CACHE", str(tmp_path / "cache"))
    command = [sys.executable, "-c", COLD]
    started = [
        subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) for _ in range(3)
    ]
    told = [process.communicate() for process in started]
    assert [out.strip() for out, _ in told] == [usual.tobytes().hex()] * 3, told
    left = sorted(path.name.partition("-")[0] for path in (tmp_path / "cache").iterdir())
    assert left == ["catalogue", "catalogue", "engine", "engine", "interface", "interface"]


def test_a_cache_that_cannot_be_written(compiler, tmp_path, monkeypatch):
    compiler()
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("SWINGDOWN_CACHE", str(tmp_path / "file" / "cache"))
    with pytest.raises(EngineError, match="cannot be kept there.*Mend: set SWINGDOWN_CACHE"):
        build.library(EFFECTS, GRAVITIES)


def test_a_cache_that_has_all_need_not_be_written(library, compiler, monkeypatch):
    compiler()
    path = library()
    monkeypatch.setattr("tempfile.TemporaryDirectory", None)
    assert library() == path


@pytest.fixture
def given_away(monkeypatch):
    """A function that makes a path another user's."""

    def give(path):
        if os.geteuid() == 0:
            os.chown(path, 65534, -1)
        else:
            monkeypatch.setattr(os, "geteuid", lambda: os.getuid() + 1)

    return give


def opened_to_others(path):
    path.chmod(path.stat().st_mode | 0o020)


@pytest.mark.parametrize("folder", [True, False])
@pytest.mark.parametrize("others", [True, False])
def test_a_cache_that_another_user_could_have_written_is_not_run(
    library, compiler, given_away, tmp_path, folder, others
):
    """Whatever the checksum beside the engine says, for that is written as easily."""
    compiler()
    path = library()
    whose = tmp_path / "cache" if folder else path
    (given_away if others else opened_to_others)(whose)
    problem = "it belongs to another user" if others else "others may write"
    with pytest.raises(EngineError, match=f"{whose}: {problem}.*Mend: .*SWINGDOWN_CACHE"):
        library()


@pytest.mark.parametrize("others", [True, False])
def test_code_that_another_user_put_into_the_cache_is_not_executed(given_away, tmp_path, others, monkeypatch):
    """The interface is Python, and was run with the rights of whoever started swingdown."""
    monkeypatch.setenv("SWINGDOWN_CACHE", str(tmp_path / "cache"))
    interface.ffi.__wrapped__()
    (path,) = (tmp_path / "cache").glob("interface-*.py")
    path.write_text(f"open({str(tmp_path / 'harm')!r}, 'w')\n" + path.read_text())
    path.with_name(path.name + ".sha256").write_text(hashlib.sha256(path.read_bytes()).hexdigest())
    (given_away if others else opened_to_others)(tmp_path / "cache")
    with pytest.raises(EngineError):
        interface.ffi.__wrapped__()
    assert not (tmp_path / "harm").exists()


def test_without_a_compiler_too_another_users_engine_is_not_run(
    library, compiler, given_away, monkeypatch, tmp_path
):
    compiler()
    given_away(library())
    monkeypatch.delenv("CC")
    monkeypatch.setenv("PATH", str(tmp_path / "empty"))
    with pytest.raises(EngineError, match="it belongs to another user"):
        library()


def test_a_new_cache_is_its_users_alone_whatever_the_umask(library, compiler, tmp_path):
    compiler()
    before = os.umask(0)
    try:
        path = library()
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "cache").stat().st_mode) == 0o700
    assert not path.stat().st_mode & 0o022 and library() == path


def test_no_compiler(library, monkeypatch, tmp_path):
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(EngineError, match="there is no C compiler.*Mend: install gcc or clang"):
        library()


def test_what_a_compiler_has_built_needs_none_any_more(library, compiler, monkeypatch, tmp_path):
    compiler()
    path = library()
    monkeypatch.delenv("CC")
    monkeypatch.setenv("PATH", str(tmp_path / "empty"))
    assert library() == path
    path.write_bytes(b"damaged")
    with pytest.raises(EngineError, match="there is no C compiler"):
        library()


@pytest.mark.parametrize("name", ["no-such-compiler -m64", "/no/such/compiler"])
def test_cc_names_a_program_that_is_not_there(library, monkeypatch, name):
    monkeypatch.setenv("CC", name)
    with pytest.raises(EngineError, match=f"CC={name}: there is no program '{name.split()[0]}'.*Mend: "):
        library()


def test_cc_with_options(library, compiler, monkeypatch, tmp_path):
    calls = compiler()
    monkeypatch.setenv("CC", f"{tmp_path / 'compiler'} -DUNUSED='a b'")
    library()
    assert "-DUNUSED=a b -O3" in calls.read_text()


def test_a_compiler_that_fails_is_quoted(library, compiler, tmp_path):
    compiler('echo "out of registers" >&2; exit 1')
    with pytest.raises(EngineError, match=r"compiler -O3 (.|\n)*out of registers(.|\n)*Mend: "):
        library()
    assert not list((tmp_path / "cache").glob("engine-*")) and not list((tmp_path / "cache").glob("making-*"))


def test_a_compiler_that_does_not_start(library, monkeypatch, tmp_path):
    program = tmp_path / "compiler"
    program.write_text("#!/no/such/shell\n")
    program.chmod(0o755)
    monkeypatch.setenv("CC", str(program))
    with pytest.raises(EngineError, match="does not start"):
        library()


FLAGS = {
    "x86-64": "fpu sse sse2",
    "x86-64-v3": "sse2 avx2 bmi1 bmi2 f16c fma abm movbe avx512f",
    "x86-64-v4": "sse2 avx2 bmi1 bmi2 f16c fma abm movbe avx512f avx512bw avx512cd avx512dq avx512vl",
}


@pytest.fixture(scope="module")
def carried(tmp_path_factory):
    """The folder of what a wheel carries, of a few effects and compiled without optimisation."""
    if not prebuilt.levels():
        pytest.skip("engines are carried for Linux on x86-64 alone")
    folder, told = tmp_path_factory.mktemp("carried"), pytest.MonkeyPatch()
    program = folder / "compiler"
    real = next(filter(None, map(shutil.which, ("gcc", "cc", "clang"))))
    program.write_text(f'#!/bin/sh\nexec {real} "$@" -O0\n')
    program.chmod(0o755)
    told.setenv("CC", str(program))
    build.carry(folder / "files", EFFECTS, GRAVITIES)
    told.undo()
    return folder / "files"


@pytest.fixture
def wheel(library, carried, tmp_path, monkeypatch):
    """A function like ``library`` where a wheel carries the engine and there is no compiler; its folder, to do harm in."""
    folder = tmp_path / "carried"
    shutil.copytree(carried, folder)
    monkeypatch.setattr(prebuilt, "FOLDER", folder)
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setenv("PATH", str(tmp_path))
    return library


def test_what_a_wheel_carries_needs_no_compiler_and_no_cache(wheel, usual, tmp_path):
    path = wheel()
    assert path.parent == tmp_path / "carried" and path.stem.endswith(prebuilt.levels()[0])
    assert np.array_equal(angles(path), usual)
    assert not (tmp_path / "cache").exists()


def test_every_level_of_processors_gives_the_same_bits(wheel, usual, tmp_path):
    found = {level: next((tmp_path / "carried").glob(f"*-{level}.so")) for level in prebuilt.levels()}
    noisy = usual + 3e-4 * np.random.default_rng(2).standard_normal(usual.size)
    converged, values = fitted(found["x86-64"], noisy)
    assert converged == 1 and values[1:4] == pytest.approx([*VALUES.values()], rel=0.1)
    for level, path in found.items():
        assert np.array_equal(angles(path), usual), level
        assert fitted(path, noisy) == (converged, values), level


@pytest.mark.parametrize("level", FLAGS)
def test_a_processor_gets_the_best_that_it_runs(wheel, monkeypatch, level):
    monkeypatch.setattr("swingdown.engine.compiler.processor", lambda: f"x86_64 flags : {FLAGS[level]}")
    assert wheel().stem.endswith(f"-{level}")


def test_a_damaged_one_is_passed_over(wheel, usual):
    wheel().write_bytes(b"damaged")
    assert np.array_equal(angles(wheel()), usual)
    for _ in prebuilt.levels()[1:]:
        wheel().write_bytes(b"damaged")
    with pytest.raises(EngineError, match="there is no C compiler"):
        wheel()


def test_an_own_effect_takes_a_compiler_all_the_same(wheel):
    with pytest.raises(EngineError, match="there is no C compiler.*Mend: install gcc or clang"):
        build.library((*EFFECTS, SHIPPED["quadratic_drag"]), GRAVITIES)


def test_a_compiler_that_is_asked_for_is_used(carried, library, compiler, monkeypatch):
    monkeypatch.setattr(prebuilt, "FOLDER", carried)
    calls = compiler()
    assert library().parent != carried and "engine.c" in calls.read_text()


@pytest.mark.parametrize("machine", [("Linux", "aarch64"), ("Darwin", "x86_64"), ("Darwin", "arm64")])
def test_elsewhere_a_wheel_carries_one_engine_without_an_x86_level(monkeypatch, machine):
    monkeypatch.setattr(prebuilt.platform, "system", lambda: machine[0])
    monkeypatch.setattr(prebuilt.platform, "machine", lambda: machine[1])
    (only,) = prebuilt.levels()
    assert only == "-".join(machine).lower() and prebuilt.built() == {only: ("",)}
