"""One set of bits, whoever compiles: X32."""

from __future__ import annotations

import hashlib
import os
import platform
import shutil
import subprocess
import sys
from collections.abc import Iterable, Iterator

import numpy as np

import kanegen as kg
from kanegen.extras import is_installed
from kanegen.program.precision import Precision, precision_named
from kanegen.reference.states import random_states
from tests.battery import scenes
from tests.battery.measuring import PRECISIONS, bits, efforts, rounded
from tests.battery.rows import Row, Size, subject
from tests.support.paths import MODELS, ROOT

STRICT = "-ffp-contract=off"
LEVELS = ("-O0", "-O1", "-O2", "-O3", "-Os", "-O3 -march=native")
OUTPUTS = ("mass_matrix", "forcing", "forward_dynamics")
BATCH = 3001
"""States for threads and places: enough for several, and no multiple of any width."""


def compilers() -> list[str]:
    """Those of the machine, and the package ziglang, which links a libm of its own at -O0."""
    found = [name for name in ("gcc", "clang") if shutil.which(name)]
    zig = f"{sys.executable} -m ziglang cc"
    return [*found, zig] if is_installed("ziglang") else found


@subject("X32", "Reproducibility")
def reproducibility(size: Size) -> Iterator[Row]:
    """No bit depends on compiler, level, C library, place, threads, or on one state or many at a time."""
    levels = size.pick(LEVELS[::3], LEVELS)
    amount = size.pick(30, 10_000)
    names = ", ".join(name.split()[-2] if "ziglang" in name else name for name in compilers())
    over = f"{names}; {', '.join(levels)}, all with {STRICT}; {amount} states one by one and as a batch"
    for precision in PRECISIONS:
        for name, system in size.pick({"mixed joints": _mixed()}, _trees()).items():
            inputs = _inputs(system, precision, amount)
            found: set[str] = set()
            for compiler in compilers():
                for level in levels:
                    library = _library(system, precision, compiler, level)
                    found |= {_alone(library, inputs), _together(library, inputs)}
            yield _one_hash(f"{name}, {precision.name}", found, over)
        positions = {_shifted(precision, shift) for shift in range(1, size.pick(4, 17))}
        yield _one_hash(f"place in the batch, {precision.name}", positions, f"{size.pick(3, 16)} shifts")
        threads = {_threaded(precision, number) for number in size.pick([3], [1, 2, 3, 8])}
        alone = _together(_library(_mixed(), precision), _inputs(_mixed(), precision))
        over_threads = f"{size.pick('3', '1, 2, 3, 8')} threads, and without"
        yield _one_hash(f"threads, {precision.name}", threads | {alone}, over_threads)


def _trees() -> dict[str, kg.System]:
    return {
        "mixed joints": _mixed(),
        "arm of 7 hinges": scenes.tree(np.random.default_rng(32), range(7)),
        "planar chain of 8": scenes.planar([1.0] * 8),
        "eight_body": kg.load(MODELS / "eight_body.toml"),
    }


def _mixed() -> kg.System:
    return scenes.mixed(3)


def _one_hash(case: str, hashes: set[str], over: str) -> Row:
    return Row(case, float(len(hashes)), 1.0, "1 hash", over)


def _library(
    system: kg.System, precision: Precision, compiler: str = "", level: str = "-O2", threads: bool = False
) -> kg.Library:
    flags = f"{level} {STRICT}"
    command = compiler or compilers()[0]
    return kg.build(system, OUTPUTS, command, flags, threads=threads, precision=precision.name)


def _inputs(system: kg.System, precision: Precision, count: int = BATCH) -> tuple[np.ndarray, ...]:
    states = random_states(system, count, 32).rounded(precision)
    return states.x, states.y, rounded(efforts(system, states, np.random.default_rng(32)), precision)


def _hash(values: Iterable[np.ndarray]) -> str:
    return hashlib.sha256(b"".join(map(bits, values))).hexdigest()


def _outputs(library: kg.Library, x: np.ndarray, y: np.ndarray, tau: np.ndarray) -> tuple[np.ndarray, ...]:
    return library.mass_matrix(x), library.forcing(x, y), library.forward_dynamics(x, y, tau)


def _alone(library: kg.Library, inputs: tuple[np.ndarray, ...]) -> str:
    states = [_outputs(library, *state) for state in zip(*inputs, strict=True)]
    return _hash(np.array(values) for values in zip(*states, strict=True))


def _together(library: kg.Library, inputs: tuple[np.ndarray, ...]) -> str:
    return _hash(_outputs(library, *inputs))


def _shifted(precision: Precision, shift: int) -> str:
    """The hash of the same states when the batch begins elsewhere."""
    library = _library(_mixed(), precision)
    inputs = [np.roll(array, shift, axis=0)[: BATCH - shift % 2] for array in _inputs(_mixed(), precision)]
    return _hash(values[shift : shift + BATCH // 2] for values in _outputs(library, *inputs))


def _threaded(precision: Precision, threads: int) -> str:
    """In a process of its own, because one that has used threads must not fork."""
    code = f"from {__name__} import print_threaded; print_threaded({precision.name!r})"
    environment = {**os.environ, "OMP_NUM_THREADS": str(threads)}
    command = [sys.executable, "-W", "ignore", "-c", code]
    root = ROOT
    done = subprocess.run(command, cwd=root, env=environment, check=True, capture_output=True, text=True)
    return done.stdout.strip()


def print_threaded(precision: str) -> None:
    """Print the hash of the batch computed by as many threads as OMP_NUM_THREADS says."""
    library = _library(_mixed(), precision_named(precision), threads=True)
    print(_together(library, _inputs(_mixed(), precision_named(precision))))


def machine() -> str:
    """What the figures were found on."""
    return f"{platform.system()} {platform.machine()}, {' '.join(platform.libc_ver())}"
