"""The generated functions: which arrays each of them reads and fills."""

from __future__ import annotations

from collections.abc import Sequence

from kanegen.model.system import System
from kanegen.program.ir import EVALUATE
from kanegen.program.split import Signature
from kanegen.recursion.outputs.inputs import EVERYWHERE, input_arrays
from kanegen.recursion.outputs.table import OUTPUTS


def functions(system: System, outputs: Sequence[str]) -> dict[str, Signature]:
    """One function for every output, and `EVALUATE` for all of them where there are several."""
    available = [array.name for array in input_arrays(system)]
    read = {name: {*OUTPUTS[name].inputs, *EVERYWHERE} for name in outputs}
    groups: dict[str, tuple[str, ...]] = {name: (name,) for name in outputs}
    if len(outputs) > 1:
        groups[EVALUATE] = tuple(outputs)
    return {
        function: Signature(
            inputs=tuple(a for a in available if any(a in read[name] for name in group)),
            outputs=tuple(OUTPUTS[name].array(system).name for name in group),
        )
        for function, group in groups.items()
    }
