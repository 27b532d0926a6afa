"""The arrays of the generated functions: what can be asked for, and what each output reads."""

from kanegen.recursion.outputs.functions import functions
from kanegen.recursion.outputs.inputs import input_arrays
from kanegen.recursion.outputs.table import (
    EQUATIONS,
    OUTPUTS,
    available,
    chosen,
    output_array,
    require_available,
)

__all__ = [
    "EQUATIONS",
    "OUTPUTS",
    "available",
    "chosen",
    "functions",
    "input_arrays",
    "output_array",
    "require_available",
]
