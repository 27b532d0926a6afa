"""Write the table of all outputs with their costs at the end of docs/outputs.md; takes a few minutes.

python -m benchmarks.output_table [--file FILE]
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path

import kanegen as kg
from benchmarks import models
from kanegen.compiler import compile_module
from kanegen.errors import KanegenError
from kanegen.files import write_whole
from kanegen.recursion.outputs import OUTPUTS
from kanegen.recursion.outputs.differentiated import Differentiated
from kanegen.studies.markdown import markdown_table

PAGE = Path(__file__).parents[1] / "docs" / "outputs.md"
MODELS = ("ur5", "panda", "talos_reduced")
MARK = "## All outputs\n"

INTRODUCTION = """
`python -m benchmarks.output_table` writes this table: what each output is, as headers of generated C say it,
the arguments of its method in Python, and its operations alone. Frames, points and contacts are those of
the last link of an arm and of a foot of talos. "-" stands where a model does not have the output, and for
derivatives of talos_reduced, which take long to count.
"""

LAST = {"ur5": "tool0", "panda": "panda_hand", "talos_reduced": "left_sole_link"}
"""The frame of each model that outputs of frames, points and contacts have."""


def main() -> None:
    """Count the operations of every output and write the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--file", type=Path, default=PAGE)
    page = parser.parse_args().file
    systems = {name: _system(name) for name in MODELS}
    head = ["output", "what it is", "arguments", *MODELS]
    rows = [[f"`{name}`", *_words(name, systems), *_costs(name, systems)] for name in OUTPUTS]
    before = page.read_text(encoding="utf-8").split(MARK)[0]
    write_whole(page, f"{before}{MARK}{INTRODUCTION}\n{markdown_table(head, rows, left=3)}\n")


def _system(name: str) -> kg.System:
    """Return a model with one chosen frame, one point and one contact."""
    frame = LAST[name]
    chosen = models.system(name).with_poses([frame]).with_points({"point": (frame, (0.0, 0.0, 0.0))})
    return chosen.with_contacts(["point"])


def _words(name: str, systems: dict[str, kg.System]) -> tuple[str, str]:
    """Return what an output is, and the arguments of its method."""
    output = OUTPUTS[name]
    array = output.array(next(iter(systems.values())))
    return array.doc, ", ".join(output.arguments)


def _costs(name: str, systems: dict[str, kg.System]) -> Iterator[str]:
    """Yield the operations of an output alone, by model."""
    for model, system in systems.items():
        is_long = isinstance(OUTPUTS[name].derivation, Differentiated) and model == "talos_reduced"
        yield "-" if is_long else _cost(name, system)


def _cost(name: str, system: kg.System) -> str:
    """Return the operations of an output, or "-" for a model that does not have it."""
    try:
        cost = compile_module(system, (name,)).operations
    except KanegenError:
        return "-"
    return f"{cost['add'] + cost['multiply'] + cost['divide']:,}".replace(",", " ")


if __name__ == "__main__":
    main()
