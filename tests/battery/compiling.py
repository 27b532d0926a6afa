"""What compilers make of arithmetic, asked before any code is built: X31."""

from __future__ import annotations

from collections.abc import Iterator

import kanegen as kg
from kanegen.library.native.compilers import find
from kanegen.library.native.selftest import properties, sound_flags
from kanegen.program import semantics
from tests.battery import scenes
from tests.battery.measuring import FORWARD
from tests.battery.reproducibility import compilers
from tests.battery.rows import Row, Size, count, subject


@subject("X31", "Compilers that keep what is promised")
def selftest(size: Size) -> Iterator[Row]:
    """A small program tries what a variant relies on: every promise is kept, or nothing is built."""
    levels = size.pick([2], semantics.OPTIMISATIONS)
    machines = size.pick(["portable"], list(semantics.MACHINES))
    for command in compilers():
        compiler, broken, tried = find(command), [], 0
        for name in semantics.SEMANTICS:
            for machine in machines:
                for level in levels:
                    kept = properties(compiler, semantics.compiler_flags((name,), machine, level))
                    broken += sorted(set(semantics.guaranteed_properties((name,))) - kept)
                    tried += 1
        short = command.split()[-2] if "ziglang" in command else command
        amount = f"{tried} sets of flags, {len(semantics.PROPERTIES)} properties"
        over = "; ".join([amount, *sorted(set(broken))])
        yield count(f"promises broken, {short}", broken, over, "none")
        yield _narrowing(command, short)


def _narrowing(command: str, short: str) -> Row:
    """Doubles that become floats, which gcc 12 forgets to round: with the flags used they are rounded."""
    compiler = find(command)
    source = kg.generate(scenes.straight(2), FORWARD, tier=kg.Variant(storage="float"))
    flags = sound_flags(compiler, source)
    lost = semantics.NARROWING not in properties(compiler, source.variant.flags)
    over = f"{' '.join(flags)}; without a remedy it is {'lost' if lost else 'kept'}"
    still = semantics.NARROWING not in properties(compiler, flags)
    return count(f"rounding to float, {short}", [still], over, "kept")
