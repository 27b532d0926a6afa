"""Floating-point semantics that a compiler may be allowed, by name, with the compiler flags of each.

Strict semantics mean that every operation of the program is rounded as IEEE 754 says, in the order of the
program: the same bits from every compiler at every level of optimisation. Only the sign and the payload of a
NaN, which IEEE 754 leaves open, may differ. Every relaxation has a name.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from kanegen.choices import several
from kanegen.errors import OptionError

STRICT = "strict"
"""Semantics of IEEE 754, without any relaxation."""

CONTRACTED = "contracted"
"""A product may be added without being rounded first, by one fused multiply-add."""

FLUSH = "flush-to-zero"
"""Subnormal numbers count as zero."""

FINITE = "finite"
"""The compiler may assume that no number is infinite or NaN."""

OWN_ROUNDING = "products rounded by themselves"
"""The property that a product is rounded before it is added."""

_SUBNORMALS = "subnormal numbers"
_ZEROS = "signs of zeros"
_SUMS = "order of sums"


@dataclass(frozen=True)
class Relaxation:
    """A deviation from IEEE 754 that a compiler is allowed.

    Attributes:
        flags: Flags of gcc and clang.
        lost_properties: The `PROPERTIES` that need not hold with them.
    """

    flags: tuple[str, ...] = ()
    lost_properties: frozenset[str] = frozenset()


SEMANTICS = {
    STRICT: Relaxation(),
    CONTRACTED: Relaxation(("-ffp-contract=fast",), frozenset({OWN_ROUNDING})),
    "reciprocal": Relaxation(("-freciprocal-math",), frozenset({"rounding of quotients"})),
    "no-signed-zeros": Relaxation(("-fno-signed-zeros",), frozenset({_ZEROS})),
    "no-traps": Relaxation(("-fno-trapping-math",)),
    "no-errno": Relaxation(("-fno-math-errno",)),
    "associative": Relaxation(
        ("-fassociative-math", "-fno-signed-zeros", "-fno-trapping-math"), frozenset({_SUMS, _ZEROS})
    ),
    FINITE: Relaxation(("-ffinite-math-only",), frozenset({"not a number"})),
    FLUSH: Relaxation(lost_properties=frozenset({_SUBNORMALS})),
}
"""All semantics by name.

"associative" has three flags because gcc reorders sums only where neither signed zeros nor traps count.
Flushing subnormal numbers has none, because its flag would change the whole process: every generated function
sets the mode of its thread and restores it.
"""

PROPERTIES = (
    "not a number",
    _SUBNORMALS,
    _ZEROS,
    OWN_ROUNDING,
    _SUMS,
    "rounding of quotients",
    "rounding of roots",
    "no excess precision",
)
"""Properties of floating-point arithmetic that hold with strict semantics; the self-test in C tests them."""

NARROWING = "rounding to float"
"""The further property that holds where doubles are converted to floats."""

RELAXED = (CONTRACTED, "reciprocal", "no-signed-zeros", "no-traps", "no-errno")
"""The relaxations that leave NaN, infinity and the order of sums as they are."""

MULTIVERSIONED = "multiversioned"
"""Code for all of the architecture that uses what a processor has beyond it, in versions of its functions."""

MACHINES: dict[str, tuple[str, ...]] = {"portable": (), MULTIVERSIONED: (), "native": ("-march=native",)}
"""Flags for the machines on which the code may run: all of the architecture, or those like this one."""

UNFUSED = "-fno-tree-slp-vectorize"
"""The flag with which gcc 12.1 and 12.2 keep products and sums apart in native code, too.

There, with -ffp-contract=off, they still fuse products with a difference and a sum that stand side by side.
"""

OPTIMISATIONS = (0, 1, 2, 3)
"""Levels of optimisation of a compiler; with strict semantics no bit of a result depends on them."""

_FLAGS_WHEN_LINKING = {"-ffast-math": (), "-funsafe-math-optimizations": (), "-Ofast": ("-O3",)}
"""Replacements of the flags at which gcc links code that flushes subnormal numbers in the whole process."""


def checked_semantics(semantics: Iterable[str] | str) -> tuple[str, ...]:
    """Return names of `SEMANTICS`, each once, in the order of that table; no name means strict.

    Raises:
        OptionError: If there is no such name, or strict stands beside others.
    """
    found = several("semantics", "semantics", semantics, SEMANTICS) or (STRICT,)
    if STRICT in found and len(found) > 1:
        raise OptionError(f"semantics: strict excludes {', '.join(found[1:])}. Name one or the other.")
    return found


def compiler_flags(
    semantics: tuple[str, ...], machine: str, optimisation: int, is_tested: bool = False
) -> tuple[str, ...]:
    """Return the flags of gcc and clang for checked names of semantics, a machine and a level.

    Args:
        semantics: Names of `SEMANTICS`.
        machine: Name of one of `MACHINES`.
        optimisation: One of `OPTIMISATIONS`.
        is_tested: Whether the compiler is known, and tested for fusing products and sums unasked; if not,
            `UNFUSED` keeps every version of it from that.
    """
    named = [flag for name in semantics for flag in SEMANTICS[name].flags]
    contract = () if CONTRACTED in semantics else ("-ffp-contract=off",)
    unfused = (UNFUSED,) if contract and MACHINES[machine] and not is_tested else ()
    return tuple(dict.fromkeys((f"-O{optimisation}", *MACHINES[machine], *contract, *unfused, *named)))


def guaranteed_properties(semantics: tuple[str, ...]) -> tuple[str, ...]:
    """Return the `PROPERTIES` that hold with checked names of semantics."""
    lost = frozenset[str]().union(*(SEMANTICS[name].lost_properties for name in semantics))
    return tuple(found for found in PROPERTIES if found not in lost)


def linker_flags(flags: Iterable[str]) -> tuple[str, ...]:
    """Return `flags` without those that would change the process that loads the linked library."""
    return tuple(left for flag in flags for left in _FLAGS_WHEN_LINKING.get(flag, (flag,)))
