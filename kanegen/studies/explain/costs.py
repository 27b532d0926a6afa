"""Where the operations of a program go: body by body."""

from __future__ import annotations

import re
from collections import Counter

from kanegen.program.count import COUNTED
from kanegen.program.ir import Program

_BODY = re.compile(r"(?:Derivatives\. )?Body (\d+) ")

SYSTEM = 0
"""What belongs to no body."""


def by_body(program: Program) -> dict[int, int]:
    """Operations by number of the body that they are about; `SYSTEM` for those about all.

    The parts of an expression belong to the quantity that it is the value of.
    """
    owners = [SYSTEM] * len(program.instructions)
    for i in reversed(range(len(program.instructions))):
        instruction = program.instructions[i]
        found = _BODY.match(instruction.note) if instruction.name else None
        if found:
            owners[i] = int(found[1])
        if not instruction.name or found:
            for j in instruction.operands:
                if not program.instructions[j].name:
                    owners[j] = owners[i]
    costs = Counter(owners[i] for i, x in enumerate(program.instructions) if x.op in COUNTED)
    return dict(sorted(costs.items()))
