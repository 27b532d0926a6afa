"""Model files of all kinds, good and bad: X34."""

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
from kanegen.measure.truth import errors, truth
from kanegen.model.saving import toml_text
from kanegen.program.precision import DOUBLE
from kanegen.reference.states import random_states
from tests.battery import scenes
from tests.battery.measuring import FLAGS, FORWARD, efforts, promise
from tests.battery.rows import Row, Size, subject

SPOILT = (
    *("nan", "inf", "1e400", '"word"', "true", "[]", "[1.0, 2.0]", "9223372036854775808"),
    *("-1.0", "0", "0.5", "3", "1e-300", "-1e-300", "1e6", "1e300", "0.1", "1.0"),
)
"""What a number of the file becomes."""


@subject("X34", "Model files of all kinds")
def model_files(size: Size) -> Iterator[Row]:
    """Random trees with any freedoms and masses of 1e-12 to 1e12 kg; then one place of the file spoilt.

    A file is refused with one error that is kanegen's own, or its code keeps T(u) in a random state.
    """
    bodies = size.pick(4, 12)
    amounts = {"as written": size.pick(10, 30, 2_000), "one place spoilt": size.pick(40, 200, 8_000)}
    for name, amount in amounts.items():
        tally = Tally()
        failed = tally.run(_files(bodies, "spoilt" in name), amount)
        over = f"{amount} files, 1 to {bodies} bodies: {tally.words(failed)}"
        yield Row(name, float(failed is not None), 0.0, "an error or T(u)", over)


class Tally:
    """What became of the examples.

    Attributes:
        refused: Files that were not accepted.
        singular: Systems that have no accelerations.
        judged: Programs held to T(u).
        beyond: Programs in states where nothing is promised.
    """

    def __init__(self) -> None:
        self.refused = self.singular = self.judged = self.beyond = 0

    def words(self, failed: str | None) -> str:
        """For the table."""
        counts = (
            f"{self.refused} refused, {self.singular} singular, {self.judged} judged, {self.beyond} beyond"
        )
        return counts if failed is None else f"{counts}; {failed}"

    def run(self, files: st.SearchStrategy[str], amount: int) -> str | None:
        """The smallest example that fails, and how; the same examples every time."""

        @settings(
            max_examples=amount,
            deadline=None,
            database=None,
            derandomize=True,
            suppress_health_check=list(HealthCheck),
        )
        @given(files)
        def accepted_or_refused(text: str) -> None:
            self.judge(text)

        try:
            accepted_or_refused()
        except Exception as error:  # whatever escapes is what this row looks for
            return " ".join(f"{type(error).__name__}: {error}".split())[:300].replace("|", "/")
        return None

    def judge(self, text: str) -> None:
        """Raise unless the file is refused, or its code is right."""
        with warnings.catch_warnings(action="ignore", category=kg.KanegenWarning):
            with tempfile.TemporaryDirectory() as folder:
                path = Path(folder) / "model.toml"
                path.write_text(text, encoding="utf-8")
                try:
                    system = kg.load(path)
                except kg.KanegenError as error:
                    assert str(error).strip(), "an error without words"
                    self.refused += 1
                    return
            self._judge(system)

    def _judge(self, system: kg.System) -> None:
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
        self.judged += 1


@st.composite
def _files(draw: st.DrawFn, bodies: int, spoil: bool) -> str:
    text = toml_text(draw(_systems(bodies)).as_table())
    return _spoilt(text, np.random.default_rng(draw(_SEEDS))) if spoil else text


_SEEDS = st.integers(0, 2**32 - 1)


def _spoilt(text: str, rng: np.random.Generator) -> str:
    """The text with a number respelt, or a line doubled, dropped, cut, or with a strange letter."""
    lines = text.splitlines()
    place = int(rng.integers(len(lines)))
    line = lines[place]
    at = int(rng.integers(len(line) + 1))
    match rng.choice(["number", "number", "number", "twice", "gone", "cut", "letter"]):
        case "number":
            return _respelt(text, rng)
        case "twice":
            lines.insert(place, line)
        case "gone":
            del lines[place]
        case "cut":
            lines[place] = line[:at]
        case "letter":
            lines[place] = line[:at] + chr(int(rng.integers(1, 0xD800))) + line[at:]
    return "\n".join(lines)


def _respelt(text: str, rng: np.random.Generator) -> str:
    """The text with one of its numbers written otherwise."""
    pieces = scenes.NUMBER.split(text)
    pieces[2 * int(rng.integers(len(pieces) // 2)) + 1] = str(rng.choice(SPOILT))
    return "".join(pieces)


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
