"""Rules of JAX for the derivatives of generated functions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from kanegen.extras import JAX, module
from kanegen.interop.jax.calls import Arrays, Call, Signature, foreign_call
from kanegen.interop.jax.products import ProductCalls
from kanegen.interop.products import Form, Products
from kanegen.interop.slopes import Slopes, require_slopes

jax = module("jax", "jaxlib", extra=JAX)
jnp = jax.numpy

_IF_CONSTANT = "Where the result counts as constant, apply jax.lax.stop_gradient to {}, not to the result."
"""What helps where the derivative of a result is not meant."""


def differentiable_calls(
    signatures: Mapping[str, Signature],
    of: Mapping[str, Sequence[Slopes]],
    products: Mapping[str, tuple[Products, Form]],
) -> dict[str, Call]:
    """Return the functions of a library by name, each differentiable as far as derivatives were generated.

    Args:
        signatures: The functions by name.
        of: What there is of derivatives of each function, generated or not.
        products: Products with derivatives that were generated, by name of the function, with its own form.
    """
    linear = {one: ProductCalls(one, signatures) for one, _ in products.values()}
    calls: dict[str, Call] = {}
    for name, signature in signatures.items():
        if name in products:
            one, form = products[name]
            calls[name] = linear[one].call(name, form)
        else:
            calls[name] = _by_jacobians(signature, of[name], signatures, calls)
    return calls


def _by_jacobians(
    signature: Signature,
    slopes: Sequence[Slopes],
    signatures: Mapping[str, Signature],
    calls: Mapping[str, Call],
) -> Call:
    """Return the call of a function, with the rule of JAX for the derivative in a direction.

    The rule is linear in the direction, so that JAX makes reverse derivatives of it by transposition.

    Args:
        signature: The function.
        slopes: What there is of its derivatives.
        signatures: All functions that were generated.
        calls: Their calls, which are complete when the rule is used.
    """
    call = jax.custom_jvp(foreign_call(signature))

    def rule(primals: Sequence[Arrays], tangents: Sequence[Arrays]) -> tuple[Any, Any]:
        operands = dict(zip(signature.inputs, primals, strict=True))
        moved = {
            name: tangent
            for name, tangent in zip(signature.inputs, tangents, strict=True)
            if not isinstance(tangent, jax.custom_derivatives.SymbolicZero)
        }
        asks = signature.name, slopes, moved, signatures, "JAX asks for the derivative"
        require_slopes(*asks, _IF_CONSTANT)
        results, change = None, jnp.zeros(())
        for one in slopes:
            own = {name: columns for name, columns in one.columns.items() if name in moved}
            if own:
                found = calls[one.function](*(operands[name] for name in signatures[one.function].inputs))
                results = tuple(found[: one.place]) if one.has_results else results
                change = change + _along(found[one.place], sum(signature.sizes), own, moved)
        if results is None:
            results = call(*primals)
        places = np.cumsum([0, *signature.sizes])
        return results, tuple(
            jnp.broadcast_to(change[..., first:last], result.shape)
            for (first, last), result in zip(pairwise(places), results, strict=True)
        )

    call.defjvp(rule, symbolic_zeros=True)
    found: Call = call
    return found


def _along(slopes: Arrays, rows: int, columns: Mapping[str, slice], moved: Mapping[str, Arrays]) -> Arrays:
    """Return the change of all results, (*lead, rows), along a direction.

    Args:
        slopes: (*lead, rows times K) derivatives, row by row.
        rows: Numbers in all results for one state.
        columns: Columns of the derivatives by each input that moves.
        moved: (*lead, numbers of one state) the direction, by input.
    """
    matrix = slopes.reshape(*slopes.shape[:-1], rows, slopes.shape[-1] // rows)
    return sum(
        jnp.einsum("...rk,...k->...r", matrix[..., own], moved[name], precision="highest")
        for name, own in columns.items()
    )
