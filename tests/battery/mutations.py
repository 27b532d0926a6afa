"""The sensitivity of the battery: mutants of the generated C must miss the limit of X2: X38."""

from __future__ import annotations

import itertools
import re
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

import kanegen as kg
from kanegen.c import Source
from kanegen.library import load
from kanegen.measure.truth import Truth, errors, truth
from kanegen.program.precision import DOUBLE
from kanegen.reference.states import States, random_states
from tests.battery import scenes
from tests.battery.experiments import Row, Size, count, experiment
from tests.battery.measurement import FLAGS, FORWARD, Floats, efforts, promise

NUMBER = re.compile(r"(?<![\w.])\d+\.\d+(?:e[-+]?\d+)?")
SIGN = re.compile(r"(?<=[\w)\]]) ?\n? *([+-]) (?=[\w(])(?!\d+\])")
TERM = re.compile(r"(?<=[\w)\]])\s+[+-] [\w.]+(?:e[-+]\d+)?(?:\*[\w.]+)*(?=\s[+-]|;)")
VALUE = re.compile(r"(?<= = )(?!x\[|y\[)[^;{]+(?=;)")
DIFFERENCE = re.compile(r"(?<= = )([\w.*]+) - ([\w.*]+)(?=;)")
RECIPROCAL = re.compile(r"(?<= = )1\.0/(\w+)(?=;)")
MOTION = re.compile(r"(?<=const simd )((?:ww|W|w|v|alpha)_\w+) = ([^;]+)(?=;)")
LOAD = re.compile(r"(?<= = )((?:force|torque|tau)\[[^;]+)(?=;)")
RESULT = re.compile(r"(?<=acceleration\[)\d+(?=\] = )")

Changes = Callable[[str], Iterator[str]]
"""Function that yields every text with one change of a certain kind."""


@dataclass(frozen=True)
class Oracle:
    """States with efforts and exact accelerations, with which programs are compared."""

    states: States
    tau: Floats
    exact: tuple[Truth, ...]

    @classmethod
    def of(cls, system: kg.System) -> Oracle:
        """Compute exact accelerations in eight random states."""
        states = random_states(system, 8, 38)
        tau = efforts(system, states, np.random.default_rng(38))
        rows = zip(states.x, states.y, tau, states.force, states.torque, strict=True)
        return cls(states, tau, tuple(truth(system, *row) for row in rows))

    def rejects(self, source: Source) -> bool:
        """Return whether a program misses the exact accelerations of a state by more than the limit of X2."""
        library, states = load(source, flags=FLAGS), self.states
        with warnings.catch_warnings(action="ignore", category=kg.KanegenWarning):
            found = library.forward_dynamics(states.x, states.y, self.tau, states.force, states.torque)
        return any(
            not errors(
                value, one["forward_dynamics"], one.units.of("forward_dynamics"), DOUBLE.roundoff
            ).normwise
            <= promise(one, DOUBLE)
            for value, one in zip(found, self.exact, strict=True)
        )


@experiment("X38", "Mutants of the generated C")
def mutants(size: Size) -> Iterator[Row]:
    """The limit of X2 must reject every change of a sign, a term, a load or the tenth digit of a number."""
    system = scenes.mixed(3, loads=True)
    source, oracle = kg.generate(system, FORWARD), Oracle.of(system)
    yield count("the code as it is", [oracle.rejects(source)], "8 states", "no objection")
    for kind, changes in KINDS.items():
        changed = list(_mutants(source, changes))
        step = max(1, -(-len(changed) // size.pick(3, 25, nightly=1000)))
        survived = [not oracle.rejects(mutant) for mutant in changed[::step]]
        over = f"{len(survived)} of {len(changed)} places, 8 states each"
        yield count(kind, survived or [True], over, "no survivor")


def _mutants(source: Source, changes: Changes) -> Iterator[Source]:
    """Yield a source for every change of a kind in the function for many states."""
    file = f"{source.model.name}_batch.c"
    text = source.files[file]
    start = text.index("forward_dynamics_simd(")
    body = text[start : text.index("\n}\n", start)]
    for changed in changes(body):
        yield replace(source, files={**source.files, file: text.replace(body, changed)})


def _replacing(pattern: re.Pattern[str], new: Callable[[re.Match[str]], str]) -> Changes:
    """Return the function that replaces each match of a pattern, one at a time."""

    def changes(body: str) -> Iterator[str]:
        for match in pattern.finditer(body):
            other = new(match)
            if other != match.group():
                yield body[: match.start()] + other + body[match.end() :]

    return changes


def _flipped(match: re.Match[str]) -> str:
    return match.group().replace("+", "~").replace("-", "+").replace("~", "-")


def _dropped(match: re.Match[str]) -> str:
    """Multiply a term by zero, so that the types still fit."""
    return re.sub("[+-] ", r"\g<0>0.0*", match.group())


def _exchanged(body: str) -> Iterator[str]:
    """Yield texts in which a number is replaced by the next different number."""
    found = list(NUMBER.finditer(body))
    for match, after in itertools.pairwise(found):
        if match.group() != after.group() and 0.0 not in (float(match.group()), float(after.group())):
            yield body[: match.start()] + after.group() + body[match.end() :]


def _results_exchanged(body: str) -> Iterator[str]:
    """Yield texts in which two accelerations are stored in each other's place."""
    found = list(RESULT.finditer(body))
    for one, two in itertools.pairwise(found):
        between = body[one.end() : two.start()]
        yield body[: one.start()] + two.group() + between + one.group() + body[two.end() :]


KINDS: dict[str, Changes] = {
    "sign flipped": _replacing(SIGN, _flipped),
    "coefficient off by 1e-9": _replacing(NUMBER, lambda match: repr(float(match.group()) * (1 + 1e-9))),
    "coefficient exchanged": _exchanged,
    "value off by 1e-9": _replacing(VALUE, lambda match: f"1.000000001*({match.group()})"),
    "term dropped": _replacing(TERM, _dropped),
    "operands of a difference swapped": _replacing(DIFFERENCE, lambda match: f"{match[2]} - {match[1]}"),
    "reciprocal forgotten": _replacing(RECIPROCAL, lambda match: match[1]),
    "Coriolis and centrifugal values zero": _replacing(
        MOTION, lambda match: f"{match[1]} = 0.0*({match[2]})"
    ),
    "load dropped": _replacing(LOAD, lambda match: f"0.0*{match[1]}"),
    "results exchanged": _results_exchanged,
}
"""The kinds of changes by name."""
