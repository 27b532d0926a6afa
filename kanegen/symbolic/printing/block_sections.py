"""Sections on the bodies as the notes print them, in 3 x 3 blocks."""

from __future__ import annotations

from collections.abc import Iterator

from kanegen.model.system import System
from kanegen.symbolic.printing.block_terms import Sum, Term
from kanegen.symbolic.printing.blocks import Blocks
from kanegen.symbolic.printing.statements import Section, Written

MOST_BODIES_IN_BLOCKS = 16
"""Rows of more 3 x 3 blocks than two for each of these bodies are no help to a reader."""


def bodies_in_blocks(system: System) -> Iterator[Section]:
    """One for each body, unless there are too many."""
    if system.number_of_bodies > MOST_BODIES_IN_BLOCKS:
        return
    blocks = Blocks(system)
    for k, body in enumerate(system.bodies, start=1):
        statements = (*_columns(blocks, k), *_rows(blocks, k))
        yield Section(f"Body {k} ({body.name}) in blocks", "Blocks are 3 x 3.", statements)


def _columns(blocks: Blocks, k: int) -> Iterator[Written]:
    """What takes one line."""
    columns: list[tuple[str, str, Term]] = [
        ("{p'_G%d}", r"\lbrace p'_{G_{%d}} \rbrace", blocks.position_of_center(k)),
        ("{v'_O%d}", r"\lbrace v'_{O_{%d}} \rbrace", blocks.velocity_of_origin(k)),
        ("{v'_G%d}", r"\lbrace v'_{G_{%d}} \rbrace", blocks.velocity_of_center(k)),
        ("[ω'_%d,y1]", r"[\omega'_{%d,y_1}]", blocks.partial_angular_velocity(k)),
    ]
    for plain, formula, value in columns:
        yield Written(f"{plain % k} = {value.text()}", formula % k, (value.latex(),))


def _rows(blocks: Blocks, k: int) -> Iterator[Written]:
    """What takes a line for each of its terms."""
    rows: list[tuple[str, str, Sum]] = [
        ("[ω̇'_%d,y1]", r"[\dot{\omega}'_{%d,y_1}]", blocks.partial_angular_velocity_rate(k)),
        ("[v'_O%d,y]", r"[v'_{O_{%d},y}]", blocks.partial_velocity_of_origin(k)),
        ("[v̇'_O%d,y]", r"[\dot{v}'_{O_{%d},y}]", blocks.partial_velocity_of_origin_rate(k)),
        ("[v'_G%d,y]", r"[v'_{G_{%d},y}]", blocks.partial_velocity_of_center(k)),
        ("[v̇'_G%d,y]", r"[\dot{v}'_{G_{%d},y}]", blocks.partial_velocity_of_center_rate(k)),
    ]
    for plain, formula, terms in rows:
        text_lines = "\n    ".join([f"{plain % k} =", *terms.lines()])
        yield Written(text_lines, formula % k, tuple(terms.lines("latex")))
