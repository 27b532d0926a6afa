"""Exact numbers of five trees for other programs to compare with; writes docs/truth.

python -m benchmarks.validation.truth [--only NAME ...] [--docs FOLDER]
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from importlib import metadata
from pathlib import Path

import numpy as np

from benchmarks import models
from benchmarks.validation.tree_numbers import Entry, decimal, hexadecimal, tree_numbers
from kanegen.files import make_folder, write_all
from kanegen.measure import truth
from kanegen.model.system import System
from kanegen.reference.states import random_states

DOCS = Path(__file__).parents[2] / "docs" / "truth"

NAMES = ("ur5", "panda", "hyq", "talos_reduced", "eight_body")
"""Systems, with their names in `benchmarks.models`."""

RANDOM = 7
"""Random states of each system, after one at rest with all coordinates zero."""

UNIT_ROUNDOFF = 2.0**-120
"""Unit roundoff for which results are certified; their radii are 2^-20 of it."""

FORMAT = 1
"""Version of the format that README.md describes."""


def main() -> None:
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.validation.truth", description=__doc__.splitlines()[0]
    )
    parser.add_argument("--only", nargs="+", choices=NAMES, default=NAMES)
    parser.add_argument("--docs", type=Path, default=DOCS)
    arguments = parser.parse_args()
    make_folder(arguments.docs)
    texts = {}
    for name in arguments.only:
        texts[arguments.docs / f"{name}.json"] = text(name)
        print(name, flush=True)
    write_all(texts)


def text(name: str) -> str:
    """Return the file of a system: one line for every array, every body and every movement of a joint."""
    made = system(name)
    head = {"format": FORMAT, "name": name, "origin": origin(name), **tree_numbers(made)}
    return _lines({**head, "states": list(states(made))}, "") + "\n"


def system(name: str) -> System:
    """Return a system of the benchmarks; the orientation of a floating base is a quaternion."""
    found = models.system(name)
    return found.with_coordinates("quaternion") if name in models.FLOATING else found


def origin(name: str) -> str:
    """Return where the numbers of a system come from."""
    stem = {**models.ROBOTS, **models.FLOATING}.get(name)
    if stem is None:
        return f"{models.EIGHT_BODY.name} of kanegen"
    return f"{stem}.urdf of the Python package example-robot-data {metadata.version('example-robot-data')}"


def states(made: System) -> Iterator[Entry]:
    """Yield states with certified [A], {f} and {ydot}."""
    drawn = random_states(made, RANDOM, seed=0)
    for x, y in [_first(made), *zip(drawn.x, drawn.y, strict=True)]:
        exact = truth.truth(made, x, y, unit_roundoff=UNIT_ROUNDOFF)
        n = len(y)
        matrix = exact["mass_matrix"].balls
        yield {
            "x": hexadecimal(x),
            "y": hexadecimal(y),
            "A": [decimal(matrix[n * i + j]) for i in range(n) for j in range(i + 1)],
            "f": [decimal(ball) for ball in exact["forcing"].balls],
            "ydot": [decimal(ball) for ball in exact["forward_dynamics"].balls],
        }


def _first(made: System) -> tuple[np.ndarray, np.ndarray]:
    """Return the state at rest with all coordinates zero, and quaternions that do not turn."""
    x = [float(name.endswith(".e0")) for name in made.coordinate_names]
    return np.array(x), np.zeros(len(made.freedoms))


def _lines(value: object, indent: str) -> str:
    """Return JSON whose objects and lists are broken into lines, but not the innermost ones."""
    items = list(value.items() if isinstance(value, dict) else enumerate(value)) if _is_outer(value) else []
    if not items:
        return json.dumps(value, ensure_ascii=False)
    inner = indent + " "
    opening, closing = "{}" if isinstance(value, dict) else "[]"
    labels = [f"{json.dumps(key)}: " if isinstance(value, dict) else "" for key, _ in items]
    parts = [f"{inner}{label}{_lines(item, inner)}" for label, (_, item) in zip(labels, items, strict=True)]
    return f"{opening}\n" + ",\n".join(parts) + f"\n{indent}{closing}"


def _is_outer(value: object) -> bool:
    """Return whether an object or a list has objects or lists in it."""
    inside = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    return any(isinstance(item, (dict, list)) for item in inside)


if __name__ == "__main__":
    main()
