"""Code for all processors, in versions, and for this one: times, bits, and what a call from Python adds.

python -m benchmarks.machines [MODEL ...]
python -m benchmarks.machines --count [MODEL ...]

Without --count it prints times. All programs take turns in every round. A row has the median time of a call
and how many times as fast as portable code the program is, the median of the rounds with its 95 % confidence
interval. With the usual models this takes about two minutes, most of it compilation, which a second run does
not need.

With --count it prints how many instructions the functions of each version consist of, and how many of these
access the stack: exact figures for the C compiler at hand, whatever else runs. Code for one state has no
loops but those of sines and cosines in vectors, so most instructions are executed once.
"""

from __future__ import annotations

import argparse
import re
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import kanegen as kg
from benchmarks import models
from benchmarks.embedding.alone import in_c
from benchmarks.embedding.row import turn_of
from kanegen.c import Source
from kanegen.c.versions import VERSIONS
from kanegen.library import load
from kanegen.library.native import commands, compilers, selftest
from kanegen.library.native.build import code, write
from kanegen.measure.machine import Machine
from kanegen.measure.timing import Times, speedup
from kanegen.options import Variant

OUTPUT = "forward_dynamics"
STATES = 1024
ROUNDS = 15
WIDTHS = (2, 4, 8)
"""Numbers of states in a vector of native code."""


@dataclass(frozen=True)
class Program:
    """Code for some processors, and how it is compiled.

    Attributes:
        name: Name for the table.
        variant: The choices for the code.
        define: Option of the compiler beside the flags of the variant, "" for none.
        in_batches: Whether it is timed in batches alone.
    """

    name: str
    variant: Variant
    define: str = ""
    in_batches: bool = False


def programs() -> list[Program]:
    """Return all programs, portable code first."""
    native, versions = Variant(), Variant(machine="multiversioned")
    limited = [
        Program(f"version for {one.name}", versions, f"-DKANEGEN_WIDEST={one.bits}") for one in VERSIONS
    ]
    return [
        Program("portable, -O2", Variant(machine="portable")),
        Program("portable, -O3", Variant(machine="portable", optimisation=3)),
        *limited,
        Program("multiversioned, -O2", versions),
        Program("native, -O2 (the default of kg.build)", native),
        Program("native, -O3", Variant(optimisation=3)),
        *(
            Program(f"native, -O2, {width} lanes", native, f"-DKANEGEN_LANES={width}", True)
            for width in WIDTHS
        ),
    ]


def main() -> None:
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.machines", description=__doc__.splitlines()[0]
    )
    parser.add_argument("models", nargs="*", default=["ur5", "panda"], metavar="MODEL")
    parser.add_argument("--count", action="store_true", help="count instructions instead")
    options = parser.parse_args()
    for name in options.models:
        (_count if options.count else _measure)(name, models.system(name))
    print("\n".join(Machine.here().lines()))


def _count(name: str, system: kg.System) -> None:
    """Print the instructions and the accesses of the stack of one state and of a vector of states."""
    source = kg.generate(system, ("mass_matrix", "forcing", OUTPUT), tier=Variant(machine="multiversioned"))
    flags = _flags(Program("", source.variant), source)
    with tempfile.TemporaryDirectory() as folder:
        write(code(source), Path(folder))
        for file in (f"{name}.c", f"{name}_batch.c"):
            command = [*compilers.find().command, "-std=c99", *flags, "-c", file, "-o", "object.o"]
            commands.make(command, "object.o", Path(folder))
            listing = commands.output(["objdump", "-d", "--no-show-raw-insn", "object.o"], Path(folder))
            for function, counts in _counts(listing, name).items():
                shown = (f"{one.name} {counts[one.bits][0]} ({counts[one.bits][1]})" for one in VERSIONS)
                print(f"{function}: instructions (of them with the stack) {', '.join(shown)}", flush=True)


def _counts(listing: str, model: str) -> dict[str, dict[int, tuple[int, int]]]:
    """Return instructions and accesses of the stack of every function with its parts, by bits of vectors."""
    found: dict[str, dict[int, tuple[int, int]]] = {}
    for name, bits, body in re.findall(r"<(\w+?)_(128|256|512)>:\n((?:\s+[0-9a-f]+:.*\n)+)", listing):
        if name.startswith(model):
            function = re.sub(r"(_simd)?(_\d+)?$", "", name)
            before = found.setdefault(function, {}).get(int(bits), (0, 0))
            stack = len(re.findall(r"\(%r[sb]p", body))
            found[function][int(bits)] = before[0] + body.count("\n"), before[1] + stack
    return {function: counts for function, counts in found.items() if len(counts) == len(VERSIONS)}


def _measure(name: str, system: kg.System) -> None:
    """Print the times of one state and of a batch, and what a bound call adds."""
    every = programs()
    sources = {one: kg.generate(system, (OUTPUT,), tier=one.variant) for one in every}
    flags = {one: _flags(one, sources[one]) for one in every}
    x, y, tau = np.random.default_rng(0).uniform(-1, 1, (3, STATES, len(system.freedoms)))
    many = {"x": x, "y": y, "tau": tau}
    single = {array: values[0] for array, values in many.items()}
    libraries = {one: load(sources[one], flags=flags[one]) for one in every}
    found = {one: library.forward_dynamics(x, y, tau).tobytes() for one, library in libraries.items()}
    bound = libraries[every[0]].bind(OUTPUT)
    for array, values in single.items():
        setattr(bound, array, values)
    for title, inputs, states in (("one state", single, None), (f"batch of {STATES}", many, STATES)):
        turns = {
            one: in_c(sources[one], OUTPUT, inputs, states, flags[one])
            for one in every
            if states or not one.in_batches
        }
        times = _in_turns([*turns.values(), *([] if states else [lambda: turn_of(bound)])])
        print(f"{name}, {OUTPUT}, {title}", flush=True)
        for one, taken in zip(turns, times, strict=False):
            same = "same bits" if found[one] == found[every[0]] else "OTHER BITS"
            print(_row(one.name, times[0], taken, states or 1, same), flush=True)
        if not states:
            beyond = Times(tuple(a - b for a, b in zip(times[-1].rounds, times[0].rounds, strict=True)))
            print(f"    a bound call of Python takes {beyond.median:.0f} ns beyond the portable C")


def _flags(program: Program, source: Source) -> tuple[str, ...]:
    """Return the flags with which kanegen compiles a source here, and those of the program."""
    return (*selftest.sound_flags(compilers.find(), source), *program.define.split())


def _in_turns(turns: list[Callable[[], float]]) -> list[Times]:
    """Return the times of calls that take turns; the first round does not count."""
    rounds = [[turn() for turn in turns] for _ in range(ROUNDS + 1)][1:]
    return [Times(tuple(times)) for times in zip(*rounds, strict=True)]


def _row(name: str, portable: Times, times: Times, states: int, same: str) -> str:
    """Return a line of the table."""
    ratio = speedup(portable, times)
    return (
        f"    {name:38} {times.median / states:8.1f} ns a state  {ratio.median:5.2f} times as fast "
        f"({ratio.low:.2f} to {ratio.high:.2f}), {same}"
    )


if __name__ == "__main__":
    main()
