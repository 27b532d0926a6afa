"""The call of one generated function through XLA."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from kanegen.extras import JAX, module
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


def foreign_call(signature: Signature) -> Call:
    """Return the call of a function, which JAX batches and does not differentiate."""
    return _on_gpu(signature) if signature.device == "cuda" else _on_cpu(signature)


def _on_cpu(signature: Signature) -> Call:
    """Return the call of a handler."""

    def call(*operands: Arrays) -> tuple[Arrays, ...]:
        lead = np.broadcast_shapes(*(operand.shape[:-1] for operand in operands))
        results = [jax.ShapeDtypeStruct((*lead, size), signature.dtype) for size in signature.sizes]
        foreign = jax.ffi.ffi_call(signature.target, results, vmap_method="expand_dims")
        return tuple(foreign(*operands, rule=np.int64(RULES[signature.rule])))

    return call


def _on_gpu(signature: Signature) -> Call:
    """Return the call of a kernel, without its statuses."""

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
