"""What a compiler may do to floating-point arithmetic, by names of which each stands for its flags.

Strict means that every operation of the program is rounded as IEEE 754 says, in its order: the same bits
from every compiler at every level of optimisation. Everything looser has to be named.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from kanegen.choices import several
from kanegen.errors import OptionError

STRICT = "strict"
"""Nothing but what IEEE 754 says."""

CONTRACTED = "contracted"
"""A product may go into a sum unrounded, by one fused instruction."""

FLUSH = "flush-to-zero"
"""Subnormal numbers count as zero."""

_SUBNORMALS = "subnormal numbers"
_ZEROS = "signs of zeros"
_SUMS = "order of sums"


@dataclass(frozen=True)
class Licence:
    """Something that a compiler may do.

    Attributes:
        flags: Of gcc and clang.
        gives_up: Properties of `selftest.c` that need not hold with them.
    """

    flags: tuple[str, ...] = ()
    gives_up: frozenset[str] = frozenset()


SEMANTICS = {
    STRICT: Licence(),
    CONTRACTED: Licence(("-ffp-contract=fast",), frozenset({"products rounded by themselves"})),
    "reciprocal": Licence(("-freciprocal-math",), frozenset({"rounding of quotients"})),
    "no-signed-zeros": Licence(("-fno-signed-zeros",), frozenset({_ZEROS})),
    "no-traps": Licence(("-fno-trapping-math",)),
    "no-errno": Licence(("-fno-math-errno",)),
    "associative": Licence(
        ("-fassociative-math", "-fno-signed-zeros", "-fno-trapping-math"), frozenset({_SUMS, _ZEROS})
    ),
    "finite": Licence(("-ffinite-math-only",), frozenset({"not a number"})),
    FLUSH: Licence(gives_up=frozenset({_SUBNORMALS})),
}
"""By name; gcc reorders sums only where neither signed zeros nor traps count. Flushing takes no flag, which
would change the whole process: every function sets the mode of its thread and puts it back."""

PROPERTIES = (
    "not a number",
    _SUBNORMALS,
    _ZEROS,
    "products rounded by themselves",
    _SUMS,
    "rounding of quotients",
    "rounding of roots",
    "no excess precision",
)
"""What strict semantics promise, in the words of `selftest.c`."""

NARROWING = "rounding to float"
"""What is promised beside them where doubles become floats."""

RELAXED = (CONTRACTED, "reciprocal", "no-signed-zeros", "no-traps", "no-errno")
"""What leaves NaN, infinity and the order of sums as they are."""

MACHINES: dict[str, tuple[str, ...]] = {"portable": (), "native": ("-march=native",)}
"""What the code may run on: every machine of the kind, or those with the instructions of this one."""

OPTIMISATIONS = (0, 1, 2, 3)
"""Levels of optimisation; with strict semantics no bit depends on them."""

_WHOLESALE = {"-ffast-math": (), "-funsafe-math-optimizations": (), "-Ofast": ("-O3",)}
"""Flags at which gcc links code that switches subnormal numbers off for the whole process, and what is left
of them when linking."""


def names(semantics: Iterable[str] | str) -> tuple[str, ...]:
    """Names of `SEMANTICS` checked, each once, in their order; none is strict.

    Raises:
        OptionError: If there is no such name, or strict stands beside others.
    """
    found = several("semantics", "semantics", semantics, SEMANTICS) or (STRICT,)
    if STRICT in found and len(found) > 1:
        raise OptionError(f"semantics: strict excludes {', '.join(found[1:])}. Name one or the other.")
    return found


def flags(semantics: tuple[str, ...], machine: str, optimisation: int) -> tuple[str, ...]:
    """Flags of gcc and clang for checked names."""
    named = [flag for name in semantics for flag in SEMANTICS[name].flags]
    contract = () if CONTRACTED in semantics else ("-ffp-contract=off",)
    return tuple(dict.fromkeys((f"-O{optimisation}", *MACHINES[machine], *contract, *named)))


def promised(semantics: tuple[str, ...]) -> tuple[str, ...]:
    """The `PROPERTIES` that checked names leave."""
    given_up = frozenset[str]().union(*(SEMANTICS[name].gives_up for name in semantics))
    return tuple(found for found in PROPERTIES if found not in given_up)


def linking(given: Iterable[str]) -> tuple[str, ...]:
    """Flags for the linker: without those that would change the process that loads the library."""
    return tuple(left for flag in given for left in _WHOLESALE.get(flag, (flag,)))
