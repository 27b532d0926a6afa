"""Compilers: numbers in the C, promises that are kept, and equal bits: X30 to X32."""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

import kanegen as kg
from kanegen.extras import is_installed
from kanegen.library.native.compilers import find
from kanegen.library.native.selftest import properties, sound_flags
from kanegen.program import semantics
from kanegen.program.precision import DOUBLE, Precision, precision_named
from kanegen.reference.states import random_states
from tests.battery import scenes
from tests.battery.experiments import Row, Size, count, experiment
from tests.battery.measurement import FORWARD, PRECISIONS, Floats, bits, built, efforts, rounded
from tests.support.paths import MODELS, ROOT

LARGEST_EXPONENT = 960
"""Magnitude of exponents of two up to which a mass and its weight are accepted; see `reference.range`."""


@experiment("X30", "Numbers in the C")
def literals(size: Size) -> Iterator[Row]:
    """The mass of a body that slides on the ground is an entry of [A], which must be the same number.

    In single precision a double must be rounded once; masses next to the midpoint of two floats would reveal
    a second rounding, that of the decimals.
    """
    for precision in PRECISIONS:
        masses = _masses(precision, size.pick(32, 512))
        system = scenes.planar(
            masses.tolist(),
            connection=[0] * len(masses),
            free=scenes.flags(len(masses), "s1"),
            inertia=np.zeros((len(masses), 3, 3)),
        )
        found = np.diag(built(system, precision, ("mass_matrix",)).mass_matrix(np.zeros(len(masses))))
        over = f"{len(masses)} masses from {masses.min():.0e} to {masses.max():.0e} kg"
        yield count(precision.name, found != masses.astype(precision.dtype), over, "same bits")


def _masses(precision: Precision, amount: int) -> Floats:
    """Return random numbers of every size, the ends of the range, and doubles next to midpoints of floats."""
    rng = np.random.default_rng(30)
    info = np.finfo(precision.dtype)
    least, largest = max(info.minexp + 1, -LARGEST_EXPONENT), min(info.maxexp - 1, LARGEST_EXPONENT)
    exponents = rng.uniform(least, largest, amount)
    ends = [
        float(info.max) if precision is not DOUBLE else 2.0**largest,
        float(info.tiny) if precision is not DOUBLE else 2.0**least,
        1 / 3,
        0.1,
    ]
    middle = 1.0 + rng.integers(0, 2**20, amount) * 2.0**-23 + 2.0**-24
    beside = [middle, np.nextafter(middle, 2.0), np.nextafter(middle, 0.0)] if precision is not DOUBLE else []
    masses: Floats = np.concatenate([2.0**exponents, ends, *beside])
    return masses


@experiment("X31", "Properties of compilers that the code relies on")
def selftest(size: Size) -> Iterator[Row]:
    """A small program checks the properties that a variant relies on: all of them hold, or nothing is
    built."""
    levels = size.pick([2], semantics.OPTIMISATIONS)
    machines = size.pick(["portable"], ["portable", "native"])
    source = kg.generate(scenes.straight(2), FORWARD)
    for command in compilers():
        compiler, broken, tried = find(command), [], 0
        for name in semantics.SEMANTICS:
            for machine in machines:
                for level in levels:
                    variant = kg.Variant(semantics=name, machine=machine, optimisation=level)
                    kept = properties(compiler, sound_flags(compiler, replace(source, variant=variant)))
                    broken += sorted(set(semantics.guaranteed_properties((name,))) - kept)
                    tried += 1
        short = command.split()[-2] if "ziglang" in command else command
        amount = f"{tried} sets of flags, {len(semantics.PROPERTIES)} properties"
        over = "; ".join([amount, *sorted(set(broken))])
        yield count(f"properties violated, {short}", broken, over, "none")
        yield _narrowing(command, short)


def _narrowing(command: str, short: str) -> Row:
    """Check that doubles stored as floats are rounded with the flags in use; gcc 12 alone forgets it."""
    compiler = find(command)
    source = kg.generate(scenes.straight(2), FORWARD, tier=kg.Variant(storage="float"))
    flags = sound_flags(compiler, source)
    lost = semantics.NARROWING not in properties(compiler, source.variant.flags)
    over = f"{' '.join(flags)}; without a remedy it is {'lost' if lost else 'kept'}"
    still = semantics.NARROWING not in properties(compiler, flags)
    return count(f"rounding to float, {short}", [still], over, "kept")


STRICT = "-ffp-contract=off"
NATIVE = "-O3 -march=native -fno-tree-slp-vectorize"
"""Flags for this processor with which gcc 12.1 and 12.2, too, keep products and sums apart."""

LEVELS = ("-O0", "-O1", "-O2", "-O3", "-Os", NATIVE)
OUTPUTS = ("mass_matrix", "forcing", "forward_dynamics")
BATCH = 3001
"""Number of states for threads and places in a batch: no multiple of any SIMD width."""


def compilers() -> list[str]:
    """Return the compilers of the machine and the package ziglang, which links its own libm at -O0."""
    found = [name for name in ("gcc", "clang") if shutil.which(name)]
    zig = f"{sys.executable} -m ziglang cc"
    return [*found, zig] if is_installed("ziglang") else found


@experiment("X32", "Reproducibility")
def reproducibility(size: Size) -> Iterator[Row]:
    """No bit depends on the compiler, its level, the C library, threads, the batch or the place in it."""
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
    """Return the hash of the same states at other places in a batch."""
    library = _library(_mixed(), precision)
    inputs = [np.roll(array, shift, axis=0)[: BATCH - shift % 2] for array in _inputs(_mixed(), precision)]
    return _hash(values[shift : shift + BATCH // 2] for values in _outputs(library, *inputs))


def _threaded(precision: Precision, threads: int) -> str:
    """Return the hash computed in a new process, since a process that has used threads must not fork."""
    code = f"from {__name__} import print_threaded; print_threaded({precision.name!r})"
    environment = {**os.environ, "OMP_NUM_THREADS": str(threads)}
    command = [sys.executable, "-W", "ignore", "-c", code]
    root = ROOT
    done = subprocess.run(command, cwd=root, env=environment, check=True, capture_output=True, text=True)
    return done.stdout.strip()


def print_threaded(precision: str) -> None:
    """Print the hash of the batch computed by OMP_NUM_THREADS threads."""
    library = _library(_mixed(), precision_named(precision), threads=True)
    print(_together(library, _inputs(_mixed(), precision_named(precision))))
