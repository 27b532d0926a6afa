"""Robustness: sanitizers on the C, and model files of all kinds: X33 and X34."""

from __future__ import annotations

import math
import tempfile
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import kanegen as kg
from kanegen.library.native.commands import CommandError
from kanegen.measure.truth import errors, truth
from kanegen.model.saving import toml_text
from kanegen.program.precision import DOUBLE, Precision
from kanegen.reference.states import random_states
from tests.battery import scenes
from tests.battery.c_programs import efforts_for, printed
from tests.battery.experiments import Row, Size, count, experiment
from tests.battery.measurement import FLAGS, FORWARD, PRECISIONS, efforts, promise

WARNING_FLAGS = ("-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-O1", "-g", "-ffp-contract=off")
SANITIZERS = "address,undefined,float-divide-by-zero,float-cast-overflow"
SANITIZER_FLAGS = (*WARNING_FLAGS, f"-fsanitize={SANITIZERS}", "-fno-sanitize-recover=all")


@experiment("X33", "Sanitizers on the C of every scene")
def sanitizers(size: Size) -> Iterator[Row]:
    """Sanitizers and warnings find no byte outside an array and no undefined operation, in any batch size."""
    trees = _sanitized_scenes(size)
    for precision in PRECISIONS:
        found = {name: _objection(system, precision) for name, system in trees.items()}
        objections = [f"{name}: {text}" for name, text in found.items() if text]
        over = f"{', '.join(trees)}; {SANITIZERS.replace(',', ', ')}; {' '.join(WARNING_FLAGS[:5])}"
        yield count(precision.name, objections, "; ".join([over, *objections]), "no objection")


def _sanitized_scenes(size: Size) -> dict[str, kg.System]:
    """Return the trees of the other experiments with few bodies each."""
    rng = np.random.default_rng(33)
    free = np.eye(6, dtype=bool)[rng.integers(0, 6, 7)]
    free[0] = True
    quick = {
        "straight chain": scenes.straight(6),
        "hinges and slides": scenes.mixed(3),
    }
    full = {name: scenes.tree(rng, connect(7), free) for name, connect in scenes.SHAPES.items()}
    full["bodies with six freedoms"] = scenes.tree(rng, range(4), np.ones((4, 6), dtype=bool))
    full["64 rods"] = scenes.straight(64)
    full["heavier outward"] = scenes.planar([10.0**i for i in range(8)])
    full["crane and gripper"] = scenes.planar([1e6, 1.0, 1e-9], [1e3, 1.0, 1e-6])
    return size.pick(quick, quick | full)


def _objection(system: kg.System, precision: Precision) -> str:
    """Return the first line that a compiler or a sanitizer prints; an empty text if neither objects."""
    states = random_states(system, 37, 33).rounded(precision)
    try:
        wrong = printed("sanitized.c", system, precision, states, efforts_for(states, 33), SANITIZER_FLAGS)
    except CommandError as error:
        return error.reason
    return "" if int(wrong) == 0 else "a regular state is refused"


REPLACEMENTS = (
    *("nan", "inf", "1e400", '"word"', "true", "[]", "[1.0, 2.0]", "9223372036854775808"),
    *("-1.0", "0", "0.5", "3", "1e-300", "-1e-300", "1e6", "1e300", "0.1", "1.0"),
)
"""Texts that replace a number of a model file."""


@experiment("X34", "Model files, valid and damaged")
def model_files(size: Size) -> Iterator[Row]:
    """Model files of random trees with masses of 1e-12 to 1e12 kg, as written and with one damaged place.

    A file must be refused with an error of kanegen's own, or its code must keep T(u) in a random state.
    """
    bodies = size.pick(4, 12)
    amounts = {"as written": size.pick(10, 30, 2_000), "one damaged place": size.pick(40, 200, 8_000)}
    for name, amount in amounts.items():
        tally = Tally()
        failed = tally.run(_files(bodies, "damaged" in name), amount)
        over = f"{amount} files, 1 to {bodies} bodies: {tally.text(failed)}"
        yield Row(name, float(failed is not None), 0.0, "an error or T(u)", over)


class Tally:
    """Counts of what became of the examples.

    Attributes:
        refused: Number of files that were refused.
        singular: Number of systems that have no accelerations.
        evaluated: Number of programs whose error was compared with T(u).
        beyond: Number of programs in states without a bound.
    """

    def __init__(self) -> None:
        self.refused = self.singular = self.evaluated = self.beyond = 0

    def text(self, failed: str | None) -> str:
        """Return the counts as a text for the report."""
        accepted = f"{self.singular} singular, {self.evaluated} evaluated, {self.beyond} beyond"
        counts = f"{self.refused} refused, {accepted}"
        return counts if failed is None else f"{counts}; {failed}"

    def run(self, files: st.SearchStrategy[str], amount: int) -> str | None:
        """Try the same examples every time; return the smallest one that fails and its error, or None."""

        @settings(
            max_examples=amount,
            deadline=None,
            database=None,
            derandomize=True,
            suppress_health_check=list(HealthCheck),
        )
        @given(files)
        def accepted_or_refused(text: str) -> None:
            self.evaluate(text)

        try:
            accepted_or_refused()
        except Exception as error:  # any other error is a failure
            return " ".join(f"{type(error).__name__}: {error}".split())[:300].replace("|", "/")
        return None

    def evaluate(self, text: str) -> None:
        """Raise an error unless the file is refused or its code is accurate."""
        with warnings.catch_warnings(action="ignore", category=kg.KanegenWarning):
            with tempfile.TemporaryDirectory() as folder:
                path = Path(folder) / "model.toml"
                path.write_text(text, encoding="utf-8")
                try:
                    system = kg.load(path)
                except kg.KanegenError as error:
                    assert str(error).strip(), "an error without a message"
                    self.refused += 1
                    return
            self._evaluate_code(system)

    def _evaluate_code(self, system: kg.System) -> None:
        """Compare the accelerations in a random state with the exact ones."""
        try:
            library = kg.build(system, FORWARD, flags=FLAGS)
        except (kg.SingularError, kg.ModelError):
            self.singular += 1
            return
        states = random_states(system, 1, 34)
        tau = efforts(system, states, np.random.default_rng(34))
        found = library.forward_dynamics(states.x, states.y, tau)
        try:
            exact = truth(system, states.x[0], states.y[0], tau[0])
        except kg.SingularError:
            self.singular += 1
            return
        limit = promise(exact, DOUBLE)
        if not math.isfinite(limit):
            self.beyond += 1
            return
        right = exact["forward_dynamics"]
        error = errors(found[0], right, exact.units.of("forward_dynamics"), DOUBLE.roundoff).normwise
        assert error <= limit, f"error {error:.1e} where {limit:.1e} is promised, {library.n} freedoms"
        self.evaluated += 1


@st.composite
def _files(draw: st.DrawFn, bodies: int, damage: bool) -> str:
    text = toml_text(draw(_systems(bodies)).as_table())
    return _damaged(text, np.random.default_rng(draw(_SEEDS))) if damage else text


_SEEDS = st.integers(0, 2**32 - 1)


def _damaged(text: str, rng: np.random.Generator) -> str:
    """Return the text with one number replaced, or one line doubled, dropped, cut, or with a strange
    letter."""
    lines = text.splitlines()
    place = int(rng.integers(len(lines)))
    line = lines[place]
    at = int(rng.integers(len(line) + 1))
    match rng.choice(["number", "number", "number", "twice", "gone", "cut", "letter"]):
        case "number":
            return _with_another_number(text, rng)
        case "twice":
            lines.insert(place, line)
        case "gone":
            del lines[place]
        case "cut":
            lines[place] = line[:at]
        case "letter":
            lines[place] = line[:at] + chr(int(rng.integers(1, 0xD800))) + line[at:]
    return "\n".join(lines)


def _with_another_number(text: str, rng: np.random.Generator) -> str:
    """Return the text with one of its numbers replaced."""
    parts = scenes.NUMBER.split(text)
    parts[2 * int(rng.integers(len(parts) // 2)) + 1] = str(rng.choice(REPLACEMENTS))
    return "".join(parts)


@st.composite
def _systems(draw: st.DrawFn, most: int) -> kg.System:
    bodies = draw(st.integers(1, most))
    rng = np.random.default_rng(draw(_SEEDS))
    flags = st.lists(st.booleans(), min_size=6, max_size=6)
    free: list[Any] = [draw(flags) for _ in range(bodies)]
    free[-1][draw(st.integers(0, 5))] = True
    masses = [10.0 ** draw(st.floats(-12, 12)) for _ in range(bodies)]
    below = [draw(st.integers(0, k)) for k in range(bodies)]
    straight = {"joint_orientation": None} if draw(st.booleans()) else {}
    return scenes.tree(rng, below, np.array(free), masses, **straight)
