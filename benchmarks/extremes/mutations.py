"""Whether the battery would notice: X38 spoils the generated C and asks the row of X2 to object."""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

import kanegen as kg
from benchmarks.extremes import scenes
from benchmarks.extremes.measuring import FLAGS, FORWARD, Floats, efforts, promise
from benchmarks.extremes.rows import Row, Size, count, subject
from kanegen.c import Source
from kanegen.check.states import States, random_states
from kanegen.check.truth import Truth, errors, truth
from kanegen.library import load
from kanegen.precision import DOUBLE

NUMBER = re.compile(r"(?<![\w.])\d+\.\d+(?:e[-+]?\d+)?")
SIGN = re.compile(r"(?<=[\w)\]]) ?\n? *([+-]) (?=[\w(])")
TERM = re.compile(r"(?<=[\w)\]])\s+[+-] [\w.]+(?:e[-+]\d+)?(?:\*[\w.]+)*(?=\s[+-]|;)")
KINDS = ("sign flipped", "coefficient off by 1e-9", "term dropped")


@dataclass(frozen=True)
class Judge:
    """States with their exact accelerations, and what a program may miss them by."""

    states: States
    tau: Floats
    exact: tuple[Truth, ...]

    @classmethod
    def of(cls, system: kg.System) -> Judge:
        """Eight random states."""
        states = random_states(system, 8, 38)
        tau = efforts(system, states, np.random.default_rng(38))
        rows = zip(states.x, states.y, tau, strict=True)
        return cls(states, tau, tuple(truth(system, *row) for row in rows))

    def objects(self, source: Source) -> bool:
        """Whether a program misses the exact accelerations of a state by more than X2 allows."""
        library = load(source, flags=FLAGS)
        with warnings.catch_warnings(action="ignore", category=kg.KanegenWarning):
            found = library.forward_dynamics(self.states.x, self.states.y, self.tau)
        return any(
            errors(value, one["forward_dynamics"], one.units.of("forward_dynamics"), DOUBLE.roundoff).normwise
            > promise(one, DOUBLE)
            for value, one in zip(found, self.exact, strict=True)
        )


@subject("X38", "Mutants of the generated C")
def mutants(size: Size) -> Iterator[Row]:
    """A sign, the tenth digit of a coefficient, a term: each change must be seen by X2."""
    system = scenes.mixed(3)
    source, judge = kg.generate(system, FORWARD), Judge.of(system)
    yield count("the code as it is", [judge.objects(source)], "8 states", "no objection")
    for kind in KINDS:
        changed = list(_mutants(source, kind))
        step = max(1, len(changed) // size.pick(6, 100))
        survived = [not judge.objects(mutant) for mutant in changed[::step]]
        over = f"{len(survived)} of {len(changed)} places, 8 states each"
        yield count(kind, survived, over, "no survivor")


def _mutants(source: Source, kind: str) -> Iterator[Source]:
    """Every change of a kind in the function for many states."""
    file = f"{source.model.name}_batch.c"
    text = source.files[file]
    start = text.index("forward_dynamics_lanes(")
    body = text[start : text.index("\n}\n", start)]
    for changed in _changes(body, kind):
        yield replace(source, files={**source.files, file: text.replace(body, changed)})


def _changes(body: str, kind: str) -> Iterator[str]:
    pattern = {"sign flipped": SIGN, "term dropped": TERM}.get(kind, NUMBER)
    for match in pattern.finditer(body):
        found = match.group()
        if kind == "sign flipped":
            other = found.replace("+", "~").replace("-", "+").replace("~", "-")
        elif kind == "term dropped":
            other = re.sub("[+-] ", r"\g<0>0.0*", found)  # not cut out, so that the types still fit
        elif float(found) == 0.0:
            continue  # what a pivot is compared with
        else:
            other = repr(float(found) * (1 + 1e-9))
        yield body[: match.start()] + other + body[match.end() :]
