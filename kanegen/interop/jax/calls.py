"""One generated function as a function of JAX: its call through XLA, and its derivatives."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from kanegen.errors import OptionError
from kanegen.extras import JAX, module
from kanegen.interop.slopes import Slopes
from kanegen.library.native.status import ON_STATUS

jax = module("jax", "jaxlib", extra=JAX)
jnp = jax.numpy

RULES = {rule: number for number, rule in enumerate(ON_STATUS)}
"""The number by which handlers know each rule for statuses."""

Arrays = Any
"""Arrays of JAX, or what stands for them while JAX compiles or differentiates."""


@dataclass(frozen=True)
class Prepared:
    """The constants of a state that depend on its run-time parameters alone, as a kernel computes them.

    Attributes:
        target: Name by which XLA knows the handler.
        size: How many there are.
        dtype: Type of the numbers.
    """

    target: str
    size: int
    dtype: np.dtype[Any]


@dataclass(frozen=True)
class Signature:
    """A generated function as XLA calls it.

    Attributes:
        name: Name of the function.
        target: Name by which XLA knows its handler.
        inputs: Name of each array that it reads.
        sizes: Numbers for one state in each array that it fills.
        dtype: Type of these numbers.
        rule: What happens with a status other than 0, one of `RULES`.
        device: Where XLA calls it, "cpu" or "cuda".
        prepared: What a kernel takes in place of its first input, the parameters; None if it takes that.
    """

    name: str
    target: str
    inputs: tuple[str, ...]
    sizes: tuple[int, ...]
    dtype: np.dtype[Any]
    rule: str
    device: str = "cpu"
    prepared: Prepared | None = None


Call = Callable[..., Sequence[Arrays]]
"""A function of the arrays that a generated function reads, in order, each (*lead, numbers of one state).

All have the same number of leading axes, which number the states; an array has length 1 where it is the same
for all states. The results are (*lead, numbers of one state) in order.
"""


def differentiable_calls(
    signatures: Mapping[str, Signature], of: Mapping[str, Sequence[Slopes]]
) -> dict[str, Call]:
    """Return the functions of a library by name, each differentiable as far as derivatives were generated.

    Args:
        signatures: The functions by name.
        of: What there is of derivatives of each function, generated or not.
    """
    calls: dict[str, Call] = {}
    for name, signature in signatures.items():
        calls[name] = _differentiable(signature, of[name], signatures, calls)
    return calls


def _differentiable(
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
    call = jax.custom_jvp(_on_gpu(signature) if signature.device == "cuda" else _foreign(signature))

    def rule(primals: Sequence[Arrays], tangents: Sequence[Arrays]) -> tuple[Any, Any]:
        operands = dict(zip(signature.inputs, primals, strict=True))
        moved = {
            name: tangent
            for name, tangent in zip(signature.inputs, tangents, strict=True)
            if not isinstance(tangent, jax.custom_derivatives.SymbolicZero)
        }
        _require_slopes(signature, moved, slopes, signatures)
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


def _foreign(signature: Signature) -> Call:
    """Return the call of a handler, which JAX batches and does not differentiate."""

    def call(*operands: Arrays) -> tuple[Arrays, ...]:
        lead = np.broadcast_shapes(*(operand.shape[:-1] for operand in operands))
        results = [jax.ShapeDtypeStruct((*lead, size), signature.dtype) for size in signature.sizes]
        foreign = jax.ffi.ffi_call(signature.target, results, vmap_method="expand_dims")
        return tuple(foreign(*operands, rule=np.int64(RULES[signature.rule])))

    return call


def _on_gpu(signature: Signature) -> Call:
    """Return the call of a kernel, which JAX batches and does not differentiate, without its statuses."""

    def launch(target: str, sizes: Sequence[int], dtype: np.dtype[Any], operands: Sequence[Arrays]) -> Any:
        lead = operands[0].shape[:-1]
        results = [jax.ShapeDtypeStruct((*lead, size), dtype) for size in sizes]
        status = jax.ShapeDtypeStruct((*lead, 1), np.int32)
        return jax.ffi.ffi_call(target, [*results, status], vmap_method="broadcast_all")(*operands)[:-1]

    def call(*operands: Arrays) -> tuple[Arrays, ...]:
        lead = np.broadcast_shapes(*(operand.shape[:-1] for operand in operands))
        read = [*operands]
        if prepared := signature.prepared:
            read[:1] = launch(prepared.target, [prepared.size], prepared.dtype, read[:1])
        rows = [jnp.broadcast_to(one, (*lead, one.shape[-1])) for one in read]
        return tuple(launch(signature.target, signature.sizes, signature.dtype, rows))

    return call


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


def _require_slopes(
    signature: Signature,
    moved: Mapping[str, Arrays],
    slopes: Sequence[Slopes],
    signatures: Mapping[str, Signature],
) -> None:
    """Make sure that there are derivatives of a function by some of its inputs.

    Raises:
        OptionError: If there are none, or they were not generated.
    """
    name = signature.name
    by = {column: one.function for one in slopes for column in one.columns}
    if missing := [one for one in moved if one not in by]:
        if name.endswith("_derivatives"):
            raise OptionError(
                f"{name}: JAX asks for second derivatives, which are not generated. Use a method that needs "
                "first derivatives alone, such as BFGS or Gauss-Newton."
            )
        known = f"There are derivatives by {', '.join(by)}." if by else "There are no derivatives of it."
        raise OptionError(
            f"{name}: JAX asks for the derivative by {', '.join(missing)}. {known} Where the result counts "
            f"as constant, apply jax.lax.stop_gradient to {missing[0]}, not to the result."
        )
    lacking = {by[one] for one in moved} - signatures.keys()
    if lacking:
        raise OptionError(
            f"{name}: JAX asks for the derivative by {', '.join(moved)}, and the library was built without "
            f"{', '.join(sorted(lacking))}. Ask for it with outputs=(...)."
        )
