"""One set of bits, whoever compiles: X32."""

from __future__ import annotations

import hashlib
import importlib.util
import os
import platform
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

import kanegen as kg
from benchmarks.extremes import scenes
from benchmarks.extremes.measuring import FORWARD, PRECISIONS, bits, efforts, rounded
from benchmarks.extremes.rows import Row, Size, subject
from kanegen.check.states import random_states
from kanegen.precision import Precision, named

STRICT = "-ffp-contract=off"
LEVELS = ("-O0", "-O1", "-O2", "-O3", "-Os", "-O3 -march=native")
BATCH = 3001
"""States: enough for several threads, and no multiple of any width."""


def compilers() -> list[str]:
    """Those of the machine; the package ziglang counts as one."""
    found = [name for name in ("gcc", "clang") if shutil.which(name)]
    zig = f"{sys.executable} -m ziglang cc"
    return [*found, zig] if importlib.util.find_spec("ziglang") else found


@subject("X32", "Reproducibility")
def reproducibility(size: Size) -> Iterator[Row]:
    """A batch has its own sine and cosine, so it has its own hash; a state alone has libm's."""
    builds = [(compiler, level) for compiler in compilers() for level in size.pick(LEVELS[::3], LEVELS)]
    for precision in PRECISIONS:
        single: set[str] = set()
        own_sine: set[str] = set()
        batch: set[str] = set()
        for compiler, level in builds:
            library = _library(precision, compiler, level)
            hashes = own_sine if _has_own_sine(compiler, level) else single
            hashes.add(_alone(library, precision, size.pick(20, 1000)))
            batch.add(_together(library, precision))
        names = ", ".join(name.split()[-2] if "ziglang" in name else name for name in compilers())
        over = f"{names}; {', '.join(size.pick(LEVELS[::3], LEVELS))}, all with {STRICT}"
        yield _one_hash(f"state by state, {precision.name}", single, over)
        if own_sine:
            yield _one_hash(
                f"state by state, ziglang -O0 too, {precision.name}", single | own_sine, over, ZIG
            )
        yield _one_hash(f"batch of {BATCH}, {precision.name}", batch, over)
        positions = {_shifted(precision, shift) for shift in range(1, size.pick(4, 17))}
        yield _one_hash(f"place in the batch, {precision.name}", positions, f"{size.pick(3, 16)} shifts")
        threads = {_threaded(precision, number) for number in size.pick([3], [1, 2, 3, 8])}
        over = f"{size.pick('3', '1, 2, 3, 8')} threads, and without"
        yield _one_hash(f"threads, {precision.name}", threads | batch, over)


ZIG = "without optimisation ziglang links its own sine and cosine instead of the machine's"


def _has_own_sine(compiler: str, level: str) -> bool:
    return "ziglang" in compiler and level == "-O0"


def _one_hash(case: str, hashes: set[str], over: str, cause: str = "") -> Row:
    return Row(case, float(len(hashes)), 1.0, "1 hash", over, cause if len(hashes) > 1 else "")


def _system() -> kg.System:
    return scenes.mixed(3)


def _library(precision: Precision, compiler: str, level: str, threads: bool = False) -> kg.Library:
    flags = f"{level} {STRICT}"
    return kg.build(_system(), FORWARD, compiler, flags, threads=threads, precision=precision.name)


def _inputs(precision: Precision) -> tuple[np.ndarray, ...]:
    states = random_states(_system(), BATCH, 32).rounded(precision)
    return states.x, states.y, rounded(efforts(_system(), states, np.random.default_rng(32)), precision)


def _hash(values: np.ndarray) -> str:
    return hashlib.sha256(bits(values)).hexdigest()


def _alone(library: kg.Library, precision: Precision, amount: int) -> str:
    states = zip(*(array[:amount] for array in _inputs(precision)), strict=True)
    return _hash(np.array([library.forward_dynamics(*state) for state in states]))


def _together(library: kg.Library, precision: Precision) -> str:
    return _hash(library.forward_dynamics(*_inputs(precision)))


def _shifted(precision: Precision, shift: int) -> str:
    """The hash of the same states when the batch begins elsewhere."""
    library = _library(precision, compilers()[0], "-O2")
    inputs = [np.roll(array, shift, axis=0)[: BATCH - shift % 2] for array in _inputs(precision)]
    found = library.forward_dynamics(*inputs)
    return _hash(found[shift : shift + BATCH // 2])


def _threaded(precision: Precision, threads: int) -> str:
    """In a process of its own, because one that has used threads must not fork."""
    code = f"from {__name__} import print_threaded; print_threaded({precision.name!r})"
    environment = {**os.environ, "OMP_NUM_THREADS": str(threads)}
    command = [sys.executable, "-W", "ignore", "-c", code]
    root = Path(__file__).parents[2]
    done = subprocess.run(command, cwd=root, env=environment, check=True, capture_output=True, text=True)
    return done.stdout.strip()


def print_threaded(precision: str) -> None:
    """Print the hash of the batch computed by as many threads as OMP_NUM_THREADS says."""
    print(_together(_library(named(precision), compilers()[0], "-O2", threads=True), named(precision)))


def machine() -> str:
    """What the hashes hold for: libm differs between systems."""
    return f"{platform.system()} {platform.machine()}, {' '.join(platform.libc_ver())}"
