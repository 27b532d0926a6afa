"""Lowering of derived outputs from SymPy to straight-line code, with those that are derivatives of others."""

from __future__ import annotations

from collections.abc import Sequence

from kanegen.lowering.definitions import lower_definitions
from kanegen.lowering.differentiate import differentiated
from kanegen.lowering.products import with_products
from kanegen.program.constants import DOUBLE_CONSTANTS, Constants
from kanegen.program.ir import Program
from kanegen.recursion import RecursiveForm
from kanegen.recursion.outputs import PRODUCTS, SECOND_DERIVATIVES, input_arrays, output_array


def lower(form: RecursiveForm, outputs: Sequence[str], constants: Constants = DOUBLE_CONSTANTS) -> Program:
    """Return one program for `outputs`, which may include derivatives, with every intermediate shared.

    Args:
        form: The derived outputs, including those that derivatives need.
        outputs: Names of the wanted outputs, in order.
        constants: Precision of the numbers.
    """
    arrays = {output_array(form.system, name, form.methods): found for name, found in form.outputs.items()}
    program = lower_definitions(input_arrays(form.system), form.definitions, arrays, constants)
    lowered = dict(zip(form.outputs, program.outputs, strict=True))
    others = [name for name in outputs if name not in (*PRODUCTS, *SECOND_DERIVATIVES)]
    found = differentiated(program, form.system, lowered, others, constants)
    return with_products(found, program, form, lowered, outputs, constants)
