"""The arrays of the generated functions: what can be asked for, and what each output reads."""

from kanegen.signature.functions import functions
from kanegen.signature.inputs import input_arrays
from kanegen.signature.outputs import (
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
