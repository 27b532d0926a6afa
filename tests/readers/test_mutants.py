"""Mutants of model files, expressions and arrays: one clear error, or code that agrees with the reference.

`python -m tests.readers.test_mutants 5000` prints the figures of docs/reliability.md, 5000 of each kind.
"""

from __future__ import annotations

import collections
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import kanegen as kg
from tests.support import mutants
from tests.support.verdicts import verdict

C_EVERY = 20
"""Of this many mutants one is also saved, loaded again, and compiled."""

JOINT = kg.Joint(free=(False, False, True, True, False, False))
SLIDING_HINGE = kg.System("m", (kg.Body("b", 0, 1.0, np.eye(3), (0.1, 0, 0.2), JOINT),))


def of_file(text: str, file: Path, **options: bool) -> Callable[[], kg.System]:
    file.write_bytes(text.encode("utf-8", "surrogatepass"))
    return lambda: kg.load(file, **options)


def of_toml(number: int, folder: Path) -> Callable[[], kg.System]:
    return of_file(mutants.toml_mutant(number), folder / "model.toml")


def of_urdf(number: int, folder: Path) -> Callable[[], kg.System]:
    return of_file(mutants.urdf_mutant(number), folder / "robot.urdf", floating_base=number % 2 == 0)


def of_mjcf(number: int, folder: Path) -> Callable[[], kg.System]:
    return of_file(mutants.mjcf_mutant(number), folder / "model.xml")


def of_expression(number: int, folder: Path) -> Callable[[], kg.System]:
    """Return the system with an expression as the effort of a drive, or as a potential."""

    def make() -> kg.System:
        effort = kg.parse(mutants.expression_mutant(number), [kg.Parameter("k", 2.0)])
        element = kg.Drive("b.theta3", effort) if number % 3 else kg.Potential(effort)
        return SLIDING_HINGE.with_force_elements(element)

    return make


def of_arrays(number: int, folder: Path) -> Callable[[], kg.System]:
    return lambda: kg.System.from_arrays(**mutants.array_mutant(number))


KINDS = {
    "toml": of_toml,
    "urdf": of_urdf,
    "mjcf": of_mjcf,
    "expression": of_expression,
    "arrays": of_arrays,
}
QUICK = {"toml": 50, "urdf": 50, "mjcf": 50, "expression": 150, "arrays": 150}
"""Number of mutants of each kind that every change must pass."""

SLOW = {"toml": 4000, "urdf": 5000, "mjcf": 2000, "expression": 8000, "arrays": 8000}
"""Number of mutants of each kind in `make slow`."""

PART = 500
"""Number of mutants in one test."""


def verdicts(kind: str, first: int, last: int, folder: Path) -> collections.Counter[str]:
    """Return the number of mutants by verdict; a fault is raised with the number of its mutant."""
    found: collections.Counter[str] = collections.Counter()
    for number in range(first, last):
        try:
            found[verdict(KINDS[kind](number, folder), None if number % C_EVERY else folder)] += 1
        except Exception as error:
            error.add_note(f"{kind} mutant {number}")
            raise
    return found


@pytest.mark.parametrize("kind", KINDS)
def test_mutants(kind: str, tmp_path: Path) -> None:
    found = verdicts(kind, 0, QUICK[kind], tmp_path)
    # A mutator whose mutants are all refused at once, or all accepted, would test nothing.
    assert min(found["refused"], found["compared"]) >= QUICK[kind] // 50


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "first"), [(kind, first) for kind in KINDS for first in range(QUICK[kind], SLOW[kind], PART)]
)
def test_many_mutants(kind: str, first: int, tmp_path: Path) -> None:
    found = verdicts(kind, first, min(first + PART, SLOW[kind]), tmp_path)
    assert min(found.values()) > 0


def main(count: int) -> None:
    """Print how many mutants of each kind are refused, and how many are compared."""
    for kind in KINDS:
        began = time.process_time()
        with tempfile.TemporaryDirectory() as folder:
            found = verdicts(kind, 0, count, Path(folder))
        seconds = time.process_time() - began
        print(f"{kind}: {found['refused']} refused, {found['compared']} compared, {seconds:.0f} s")


if __name__ == "__main__":
    main(int(sys.argv[1]))
