"""The stack that compiled C takes: frames of functions as compilers report them, summed along calls."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path

_DEFINITION = re.compile(r"^[a-z][^\n;{}#=]*?\b(?P<name>\w+)\([^;{}]*\)\s*\{(?P<body>.*?)^\}", re.M | re.S)
_INCLUDE = re.compile(r'^#include "(?P<file>[^"]+)"', re.M)


def frames(folder: Path, file: str, command: Sequence[str]) -> dict[str, int]:
    """Compile a file with -fstack-usage and return the bytes of the frame of each function in the object."""
    line = [*command, "-std=c99", "-ffp-contract=off", "-fstack-usage", "-c", file, "-o", "stack_usage.o"]
    done = subprocess.run(line, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    found: dict[str, int] = {}
    (report,) = {*folder.glob("stack_usage*.su"), *folder.glob(f"{Path(file).stem}.su")}
    for entry in report.read_text().splitlines():
        place, size, kind = entry.split("\t")
        assert kind in ("static", "dynamic,bounded"), entry
        name = place.rpartition(":")[2].partition(".")[0]  # gcc calls a copy `name.isra.0`
        found[name] = max(found.get(name, 0), int(size))
    report.unlink()
    return found


def calls(folder: Path, file: str) -> dict[str, frozenset[str]]:
    """Return the functions that each function calls, in a file and in the headers beside it."""
    texts = [(folder / file).read_text()]
    for text in texts:
        names = [one["file"] for one in _INCLUDE.finditer(text)]
        texts += [new for name in names if (new := (folder / name).read_text()) not in texts]
    bodies = {one["name"]: one["body"] for text in texts for one in _DEFINITION.finditer(text)}
    return {
        name: frozenset(word for word in re.findall(r"\b(\w+)\(", body) if word in bodies and word != name)
        for name, body in bodies.items()
    }


def deepest(graph: Mapping[str, frozenset[str]], sizes: Mapping[str, int]) -> dict[str, int]:
    """Return the bytes of stack of each function with all that it calls; inlined functions have no frame."""

    @cache
    def below(name: str) -> int:
        return sizes.get(name, 0) + max((below(one) for one in graph[name]), default=0)

    return {name: below(name) for name in graph}
