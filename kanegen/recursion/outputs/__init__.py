"""Outputs of the generated code: one table of the arrays that they fill and read, and of their derivations.

`table` has one entry for each output; those that are about motion alone stand in `kinematics`, and
`derivatives` differentiates other entries. Everything else follows from the entry: `recursion.derivation`,
the C functions (`selection.function_signatures`), the methods of `library.Library`, the command line.
`inputs` has the arrays that functions read. A new output is one entry, one function that derives it, one
method of `Library`, and one function of `reference` to compare with.
"""

from kanegen.recursion.outputs.contacts import OF_CONTACTS
from kanegen.recursion.outputs.derivatives import SOLUTION_BY_STATE, SOLUTION_PARTS
from kanegen.recursion.outputs.differentiated import Derivative, Product, SecondDerivative
from kanegen.recursion.outputs.inputs import argument_arrays, input_arrays
from kanegen.recursion.outputs.integrators import (
    INTEGRATORS,
    METHODS,
    RATES,
    RATES_DERIVATIVES,
    Method,
    available_methods,
    composed_of,
    differentiates,
    require_steps,
    together,
)
from kanegen.recursion.outputs.kinematics import MOTIONS_OF_FRAMES
from kanegen.recursion.outputs.operational import OF_FRAMES
from kanegen.recursion.outputs.output import ErrorBound, OfSolution, Output, Recursion, Subject
from kanegen.recursion.outputs.selection import (
    accurately_solved,
    available,
    chosen,
    function_signatures,
    holding,
    method_of_program,
    output_array,
    prerequisites,
    refined_solutions,
    require_available,
    solving,
    takes_long,
)
from kanegen.recursion.outputs.table import (
    DERIVATIVES,
    DIFFERENTIATED,
    EQUATIONS,
    ERROR_BOUNDS,
    OUTPUTS,
    PRODUCTS,
    SECOND_DERIVATIVES,
)

__all__ = [
    "DERIVATIVES",
    "DIFFERENTIATED",
    "EQUATIONS",
    "ERROR_BOUNDS",
    "INTEGRATORS",
    "METHODS",
    "MOTIONS_OF_FRAMES",
    "OF_CONTACTS",
    "OF_FRAMES",
    "OUTPUTS",
    "PRODUCTS",
    "RATES",
    "RATES_DERIVATIVES",
    "SECOND_DERIVATIVES",
    "SOLUTION_BY_STATE",
    "SOLUTION_PARTS",
    "Derivative",
    "ErrorBound",
    "Method",
    "OfSolution",
    "Output",
    "Product",
    "Recursion",
    "SecondDerivative",
    "Subject",
    "accurately_solved",
    "argument_arrays",
    "available",
    "available_methods",
    "chosen",
    "composed_of",
    "differentiates",
    "function_signatures",
    "holding",
    "input_arrays",
    "method_of_program",
    "output_array",
    "prerequisites",
    "refined_solutions",
    "require_available",
    "require_steps",
    "solving",
    "takes_long",
    "together",
]
