"""The part of the table of outputs that are products with derivatives of other outputs.

`<output>_jvp` is the Jacobian times a direction of the variables, `<output>_vjp` weights times the Jacobian,
which is the gradient of the weighted sum of the output, and `<output>_hvp` the Hessian of this sum times a
direction. The variables are all inputs of the output: the state, accelerations or forces, loads, the time,
prescribed motion, and the run-time parameters.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial

from kanegen.model.system import System
from kanegen.program.ir import Array
from kanegen.recursion.outputs.differentiated import PRODUCT_KINDS, Product
from kanegen.recursion.outputs.inputs import LOADS, READ_BY_ALL
from kanegen.recursion.outputs.output import Output

_QUANTITIES = (
    ("forcing", "{f}", ("x", "y"), ("forcing",), "state_direction"),
    ("inverse_dynamics", "[A]{ydot} - {f}", ("x", "y", "ydot"), ("inverse_dynamics",), "direction"),
    ("forward_dynamics", "{ydot}", ("x", "y", "tau"), ("inverse_dynamics", "forward_dynamics"), "direction"),
)
"""Each output that has products: what it is, the arrays of its variables beside loads, time and prescribed
motion, the outputs whose programs are differentiated, and the array of a direction."""


def products_of(outputs: Iterable[Output]) -> tuple[Output, ...]:
    """Return the entries of the outputs that are products with derivatives of `outputs`."""
    entries = {output.name: output for output in outputs}
    return tuple(
        _product(
            entries[base],
            f"{base}_{ending}",
            Product(of=of, needs=needs, by=(*by, *LOADS, *READ_BY_ALL), kind=kind, direction=direction),
        )
        for base, of, by, needs, direction in _QUANTITIES
        for ending, kind in PRODUCT_KINDS.items()
    )


def _product(base: Output, name: str, product: Product) -> Output:
    """Return the entry of a product with derivatives of the output `base`."""
    return Output(name, partial(_array, base, name, product), (*base.inputs, *product.inputs), product)


def _array(base: Output, name: str, product: Product, system: System) -> Array:
    """Return the array of a product."""
    return product.array(system, name, base.array(system))
