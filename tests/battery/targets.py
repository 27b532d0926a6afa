"""Machines and C libraries: one hash from all compilers, instruction sets and levels: X40."""

from __future__ import annotations

import hashlib
import os
import shlex
import shutil
import sys
import tempfile
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

import kanegen as kg
from kanegen.c import Source
from kanegen.extras import is_installed
from kanegen.library.native import commands
from tests.battery import bits, scenes
from tests.battery.experiments import Row, Size, experiment
from tests.battery.state_classes import CLASSES, State, states

ZIG = f"{sys.executable} -m ziglang cc"


@dataclass(frozen=True)
class Target:
    """A compiler for one kind of machine, and the emulator that runs its programs.

    Attributes:
        name: Compiler and machine, for the report.
        command: Command of the compiler.
        emulator: Program that runs what the compiler makes, such as "qemu-aarch64"; "" where none is needed.
        levels: Sets of flags to try.
    """

    name: str
    command: str
    emulator: str = ""
    levels: tuple[str, ...] = ("-O0", "-O1", "-O2", "-O3", "-Os")

    @property
    def is_there(self) -> bool:
        """Whether this machine compiles for the target and runs the result."""
        found = not self.emulator or shutil.which(self.emulator) is not None
        return found and _says_hello(self.command)


WIDTHS = ("-O2 -DKANEGEN_LANES=1", "-O2 -DKANEGEN_LANES=8")
NATIVE = ("-O0", "-O1", "-O2", "-O3", "-Os", "-O3 -march=native -fno-tree-slp-vectorize", *WIDTHS)

TARGETS = (
    Target("gcc, x86-64", "gcc", levels=NATIVE),
    Target("clang, x86-64", "clang", levels=NATIVE),
    Target("tcc, x86-64", "tcc", levels=("",)),
    Target("zig, x86-64", ZIG, levels=NATIVE),
    Target("gcc, i386 with SSE2", "gcc -m32 -msse2 -mfpmath=sse"),
    Target("clang, i386 with SSE2", "clang -m32 -msse2"),
    Target("zig, x86-64 with musl", f"{ZIG} -target x86_64-linux-musl", levels=("-O0", "-O3", *WIDTHS)),
    Target("zig, i386 with SSE2 and musl", f"{ZIG} -target x86-linux-musl", levels=("-O0", "-O3", *WIDTHS)),
    *(
        Target(f"zig, {name} with musl", f"{ZIG} -target {name}-linux-{system}", f"qemu-{emulator}", levels)
        for levels in [("-O0", "-O2", "-O3", *WIDTHS)]
        for name, system, emulator in (
            ("aarch64", "musl", "aarch64"),
            ("riscv64", "musl", "riscv64"),
            ("arm", "musleabihf", "arm"),
            ("powerpc64le", "musl", "ppc64le"),
            ("s390x", "musl", "s390x"),
        )
    ),
)
"""The targets that are tried where they can be: s390x stores the most significant byte first."""

VARIANTS = {
    "double": kg.Variant(),
    "float": kg.Variant(precision="float"),
    "multiversioned": kg.Variant(machine="multiversioned"),
    "multiversioned float": kg.Variant(precision="float", machine="multiversioned"),
    "double stored as float": kg.Variant(storage="float"),
    "polynomials of degree 7": kg.Variant(sincos="polynomial-7"),
    "factorisation refined twice": kg.Variant(solver="factorisation", refinement=2),
    "double-double": kg.Variant(precision="double-double"),
}
"""The variants that are printed as C of their own."""


@experiment("X40", "One hash on all machines")
def machines(size: Size) -> Iterator[Row]:
    """No bit depends on the machine either, in states of eight classes: ordinary ones, zeros of both signs,
    subnormal and huge numbers, angles of many turns, next to gimbal lock, infinite and NaN inputs.

    Programs for other machines run in an emulator. All NaN count as one number, since their signs and
    payloads depend on compiler and machine. 32-bit x86 has to use SSE2. States are computed one by one and
    as a batch.
    """
    targets = [target for target in TARGETS if target.is_there]
    amount = size.pick(3, 40, 200)
    for name, variant in VARIANTS.items():
        every = name in size.pick((), ("double", "float"), tuple(VARIANTS))
        programs = [(t, level) for t in targets for level in (t.levels if every else t.levels[-1:])]
        found = _hashes(programs, variant, amount)
        over = f"{len(programs)} programs; {amount} states of each of {len(classes(variant))} classes"
        yield Row(name, float(len(found)), 1.0, "1 hash", f"{over}{_minority(found)}")
    missing = [target.name for target in TARGETS if target not in targets]
    tried = "; ".join(f"{target.name} ({', '.join(target.levels)})" for target in targets)
    over = f"tried: {tried}; not tried: {', '.join(missing) or 'none'}"
    yield Row("targets that this machine lacks", len(missing), len(TARGETS) - 3, "three are tried", over)


Hashes = dict[str, list[str]]
"""Names of the programs that computed the same bits, by the hash of these bits."""


def _hashes(programs: Sequence[tuple[Target, str]], variant: kg.Variant, amount: int) -> Hashes:
    """Compile and run all programs of a variant, as many at a time as there are processors."""
    found: Hashes = {}
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        results = pool.map(lambda program: result(*program, variant, amount), programs)
        for (target, level), value in zip(programs, results, strict=True):
            found.setdefault(value, []).append(f"{target.name} {level}")
    return found


def _minority(found: Hashes) -> str:
    """Return the programs whose hash fewer others have, as text."""
    fewer = sorted(found.values(), key=len)[:-1]
    return f"; otherwise: {'; '.join(', '.join(names) for names in fewer)}" if fewer else ""


def result(target: Target, level: str, variant: kg.Variant, amount: int) -> str:
    """Return the hash of all numbers that a program for the target computes at one level."""
    found = bits.printed(_source(variant), _states(variant, amount), target.command, level, target.emulator)
    return hashlib.sha256(found.encode()).hexdigest()


@cache
def _says_hello(command: str) -> bool:
    """Return whether the compiler makes a program; what it would need for that may not be installed."""
    words = shlex.split(command)
    if shutil.which(words[0]) is None or ("ziglang" in words and not is_installed("ziglang")):
        return False
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "hello.c").write_text('#include <stdio.h>\nint main(void) { return puts("") < 0; }\n')
        return commands.run([*words, "hello.c", "-lm"], Path(folder)).returncode == 0


@cache
def _source(variant: kg.Variant) -> Source:
    return kg.generate(system(), bits.OUTPUTS, tier=variant)


@cache
def system() -> kg.System:
    """Return a tree of five bodies: a free one with three angles, a quaternion, hinges and slides.

    Drives have every function of expressions.
    """
    free = np.eye(6, dtype=bool)[[0, 0, 0, 1, 2]]
    free[0] = free[1, :3] = free[2, 4] = True
    coordinates = ["angles", "quaternion", "angles", "angles", "angles"]
    tree = scenes.tree(np.random.default_rng(40), [0, 1, 1, 3, 4], free, coordinates=coordinates)
    drives = [
        kg.Drive(name, effort.replace("X", f'x["{x}"]').replace("Y", f'y["{y}"]'))
        for effort, name, x, y in zip(
            EFFORTS,
            tree.speed_names,
            reversed(tree.coordinate_names),
            reversed(tree.speed_names),
            strict=False,
        )
    ]
    return tree.with_force_elements(*drives)


EFFORTS = (
    "3*tanh(X)*exp(-abs(Y)/8) - tanh(4*Y)",
    "log(2 + X**2) + log(1e-300 + abs(Y))",
    "atan2(Y, X) - atan2(-0.3, Y)",
    "max(0, X, -Y) + min(X, 2*Y)*sign(Y)",
    "sqrt(abs(X)) if 0 < Y < 2 or not X <= pi else tan(X)/3",
    "exp(X/4)*sign(Y) + atan2(1, exp(-X*X))",
)
"""Efforts with every function of expressions, of a coordinate X and a speed Y."""


def classes(variant: kg.Variant) -> list[str]:
    """Return the classes of states in which bits are promised; of double-doubles, from 1e-290 to 1e290."""
    beyond = ("subnormal", "huge") if variant.precision == "double-double" else ()
    return [name for name in CLASSES if name not in beyond]


@cache
def _states(variant: kg.Variant, amount: int) -> State:
    return states(system(), bits.storage(_source(variant)), amount, 40, classes(variant))
