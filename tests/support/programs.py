"""Values of outputs by the programs that become C, in doubles or in high precision."""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.options import STRICT, Variant
from kanegen.program.evaluate import evaluate

Arrays = dict[str, Any]


def values(
    system: kg.System,
    outputs: tuple[str, ...],
    inputs: Arrays,
    number: Any = float,
    variant: Variant = STRICT,
) -> Arrays:
    """Return outputs by array, computed by one program in the arithmetic of `number`."""
    module = compile_module(system, outputs, variant=variant).module
    program = module.functions.get("evaluate") or module.functions[outputs[0]]
    flat = {name: [number(v) for v in np.ravel(value)] for name, value in inputs.items()}
    if module.prepare is not None:
        defaults = [parameter.value for parameter in system.parameters]
        parameters = [number(value) for value in inputs.get("parameters", defaults)]
        flat |= evaluate(
            module.prepare, {"parameters": parameters}, np if number is float else mpmath, number
        )
    found = evaluate(program, flat, np if number is float else mpmath, number)
    return {output.array.name: np.array(found[output.array.name]) for output in program.outputs}
