"""Versions of functions for several instruction sets, of which a program runs the widest that it can.

Compilers call this function multiversioning. The functions stand in a file of their own, which the file that
users compile includes once for each instruction set; what it defines has other names in each version.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from kanegen.c.layout import BREAK, wrap


@dataclass(frozen=True)
class InstructionSet:
    """An instruction set of x86-64 for which there is a version of every function.

    Attributes:
        name: Name of the instruction set.
        bits: Bits of its vectors.
        features: Names of its parts, as gcc and clang write them; () for what every such processor has.
        saved: Bits of the register XCR0 for the registers that the operating system must save.
        fuses: Whether it has fused multiply-adds, which the code does not use.
    """

    name: str
    bits: int
    features: tuple[str, ...] = ()
    saved: str = ""
    fuses: bool = False

    @property
    def flags(self) -> list[str]:
        """Names in <cpuid.h> of the bits of its features."""
        return [f"bit_{feature.upper()}" for feature in self.features]


VERSIONS = (
    InstructionSet("SSE2", 128),
    InstructionSet("AVX2", 256, ("avx2",), "0x6"),
    InstructionSet("AVX-512", 512, ("avx512f", "avx512dq", "avx512bw", "avx512vl"), "0xe6", fuses=True),
)
"""The instruction sets of multiversioned code, each with all that the one before it has."""

_ARGUMENT = re.compile(r"(\w+)(?:\[[^\]]*\])?(?=[,)])")
"""The name of an argument, with its lengths, before the next one or the end of a prototype."""

_INCLUDE = re.compile(r'^#include "(.+)"$', re.MULTILINE)

_DEFINED = re.compile(
    r"^(?!typedef)(?:(?:SIMD_)?PART )?[a-z][\w ]*?[ *](\w+)\("  # a function
    r"|^typedef [\w ]+?(\w+)(?: __attribute__.*)?;"  # another name of a type
    r"|^\} (\w+);",  # a structure or union
    re.MULTILINE,
)

_OF_WIDTH = re.compile(r"^ *#define (\w+_(?:H|LANES)|SIMD_PART|SIMD_(?:EVEN|ODD)_\d+)\b", re.MULTILINE)


def included(text: str, headers: Mapping[str, str]) -> list[str]:
    """Return the texts of those `headers`, by name, that a text includes, also by way of one another."""
    names = [name for name in _INCLUDE.findall(text) if name in headers]
    found = [one for name in names for one in (headers[name], *included(headers[name], headers))]
    return list(dict.fromkeys(found))


def defined_names(texts: Iterable[str]) -> list[str]:
    """Return the functions and types that some texts of C define or declare at their top level, each once."""
    found = (next(filter(None, match)) for text in texts for match in _DEFINED.findall(text))
    return list(dict.fromkeys(found))


def macros_of_width(texts: Iterable[str]) -> list[str]:
    """Return the macros of some headers that must go before these are included for another width."""
    return list(dict.fromkeys(name for text in texts for name in _OF_WIDTH.findall(text)))


@dataclass(frozen=True)
class Dispatched:
    """A function that runs one of its versions.

    Attributes:
        name: Name with the prefix of the model.
        prototype: Lines of its prototype.
        call: Lines of the statement that calls the version.
    """

    name: str
    prototype: list[str]
    call: list[str]

    @classmethod
    def of(cls, name: str, prototype: list[str]) -> Dispatched:
        """Return the function of a prototype."""
        arguments = _ARGUMENT.findall(" ".join(prototype))
        call = wrap(f"return KANEGEN_CHOSEN({name})({f',{BREAK}'.join(arguments)});")
        return cls(name, prototype, call)
