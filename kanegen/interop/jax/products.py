"""An output and products with its derivatives as operations of JAX, linear in each of their vectors.

JAX differentiates in reverse by transposing what is linear in tangents, and it cannot transpose a call of C.
So these are a primitive of JAX with rules of its own: for values, tangents, transposes and batches. Unlike
those of `jax.custom_jvp` and `jax.custom_vjp`, they serve both modes, and stay in loops that JAX
differentiates once more.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import prod
from typing import Any

import numpy as np

from kanegen.extras import JAX, module
from kanegen.interop.jax.calls import Arrays, Call, Signature, foreign_call
from kanegen.interop.products import CURVATURE, HESSIAN, Form, Products
from kanegen.model.arguments import OF_PRODUCTS

jax = module("jax", "jaxlib", extra=JAX)
jnp = jax.numpy
core = module("jax.extend.core", extra=JAX)
ad, batching, mlir = (module(f"jax.interpreters.{name}", extra=JAX) for name in ("ad", "batching", "mlir"))


@dataclass(frozen=True, eq=False)
class ProductCalls:
    """The products with derivatives of an output, as JAX calls them.

    Attributes:
        products: Which there are.
        signatures: All functions that were generated.
    """

    products: Products
    signatures: Mapping[str, Signature]

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the inputs of the output."""
        one = next(iter(self.products.functions.values()))
        return tuple(name for name in self.signatures[one].inputs if name not in OF_PRODUCTS)

    @property
    def dtype(self) -> np.dtype[Any]:
        """Type of the numbers of results and vectors."""
        return self.signatures[next(iter(self.products.functions.values()))].dtype

    def call(self, name: str, form: Form) -> Call:
        """Return the call of a generated function, which JAX batches and differentiates.

        Args:
            name: Name of the output or of one of its products.
            form: What that is.
        """
        inputs = self.signatures[name].inputs

        def call(*operands: Arrays) -> tuple[Arrays, ...]:
            given = dict(zip(inputs, operands, strict=True))
            vectors = [given[one].astype(self.dtype) for one in OF_PRODUCTS if one in given]
            lead = _lead(*operands) if vectors else ()
            full = [jnp.broadcast_to(one, (*lead, one.shape[-1])) for one in vectors]
            own = (given[one] for one in self.inputs)
            return (_PRODUCT.bind(*own, *full, of=self, form=form, function=name),)

        return call

    def change(
        self, form: Form, given: Mapping[str, Arrays], moved: Mapping[Any, Arrays], vectors: Sequence[Arrays]
    ) -> Arrays:
        """Return the change of a product along a direction of all that it depends on.

        Args:
            form: The product, or the output itself.
            given: Inputs of the output, each (*lead, numbers of one state).
            moved: Their directions by name, and those of the vectors by place, as far as they move.
            vectors: The vectors, each with all leading axes.
        """
        changes = []
        if any(name in moved for name in given):
            direction = self._direction(_lead(*given.values(), *vectors), moved)
            changes.append(self.product(form.along(), given, (*vectors, direction)))
        for place, one in moved.items():
            if place not in given:
                others = (*vectors[:place], one, *vectors[place + 1 :])
                changes.append(self.product(form, given, others))
        return sum(changes[1:], changes[0])

    def product(self, form: Form, given: Mapping[str, Arrays], vectors: Sequence[Arrays]) -> Arrays:
        """Return a product with derivatives, (*lead, elements).

        Args:
            form: The product.
            given: Inputs of the output, each (*lead, numbers of one state), with 1 where a leading axis is
                that of vectors alone.
            vectors: Its vectors, each with all leading axes.

        Raises:
            OptionError: If these are second derivatives and were not generated. For first ones only the value
                of the product raises this, because JAX may be about to transpose it.
        """
        if form.order > 1:
            self.products.require(form, "JAX")
        return _PRODUCT.bind(*map(given.get, self.inputs), *vectors, of=self, form=form, function="")

    def value(
        self, form: Form, given: Mapping[str, Arrays], vectors: Sequence[Arrays], function: str = ""
    ) -> Arrays:
        """Return the value of a product, computed in C.

        Args:
            form: The product, or the output itself.
            given: Inputs of the output.
            vectors: Its vectors.
            function: Function that computes it; "" for that of the fewest operations.

        Raises:
            OptionError: If there is no way to it.
        """
        if function:
            return self._of_function(function, given, vectors)
        self.products.require(form, "JAX")
        if form == CURVATURE:
            return self._curvature(given, *vectors)
        states = prod(_lead(*given.values()))
        if self.products.takes_jacobian(form, prod(vectors[0].shape[:-1]) // max(states, 1)):
            return self._of_jacobian(form, given, vectors[0])
        return self._of_function(self.products.functions[form], given, vectors)

    def _of_function(self, name: str, given: Mapping[str, Arrays], vectors: Sequence[Arrays]) -> Arrays:
        """Return the result of a generated function."""
        signature = self.signatures[name]
        own = [name for name in OF_PRODUCTS if name in signature.inputs]
        every = {**given, **dict(zip(own, vectors, strict=True))}
        (found,) = foreign_call(signature)(*(every[name] for name in signature.inputs))
        return found

    def _curvature(self, given: Mapping[str, Arrays], one: Arrays, other: Arrays) -> Arrays:
        """Return second derivatives along two directions: a Hessian times a direction for each element."""
        rows, lead = self.products.rows, one.shape[:-1]
        weights = jnp.broadcast_to(jnp.eye(rows, dtype=one.dtype), (*lead, rows, rows))
        direction = jnp.broadcast_to(one[..., None, :], (*lead, rows, one.shape[-1]))
        apart = {name: array[..., None, :] for name, array in given.items()}
        hessians = self.value(HESSIAN, apart, (weights, direction))
        return jnp.einsum("...rk,...k->...r", hessians, other, precision="highest")

    def _of_jacobian(self, form: Form, given: Mapping[str, Arrays], vector: Arrays) -> Arrays:
        """Return a product that is computed from the whole Jacobian."""
        products = self.products
        blocks: dict[str, Arrays] = {}
        for one in products.jacobian:
            signature = self.signatures[one.function]
            (found,) = foreign_call(signature)(*(given[name] for name in signature.inputs))
            matrix = found.reshape(*found.shape[:-1], products.rows, -1)
            blocks |= {name: matrix[..., own] for name, own in one.columns.items() if name not in blocks}
        pairs = [(blocks[name], own) for name, own in products.columns.items()]
        if form.is_weighted:
            parts = [jnp.einsum("...rk,...r->...k", b, vector, precision="highest") for b, _ in pairs]
            return jnp.concatenate(parts, axis=-1)
        return sum(
            jnp.einsum("...rk,...k->...r", block, vector[..., own], precision="highest")
            for block, own in pairs
        )

    def _direction(self, lead: tuple[int, ...], moved: Mapping[Any, Arrays]) -> Arrays:
        """Return a direction of all variables, (*lead, K), of which some move."""
        parts = [
            jnp.broadcast_to(moved.get(name, jnp.zeros(own.stop - own.start)), (*lead, own.stop - own.start))
            for name, own in self.products.columns.items()
        ]
        return jnp.concatenate([one.astype(self.dtype) for one in parts], axis=-1)


def _lead(*arrays: Arrays) -> tuple[int, ...]:
    """Return the leading axes to which those of some arrays broadcast."""
    return np.broadcast_shapes(*(one.shape[:-1] for one in arrays))


def _parts(of: ProductCalls, arrays: Sequence[Any]) -> tuple[dict[str, Any], tuple[Any, ...]]:
    """Return the operands of the primitive, by name of the input, and the vectors."""
    inputs = of.inputs
    return dict(zip(inputs, arrays, strict=False)), tuple(arrays[len(inputs) :])


def _value(*arrays: Arrays, of: ProductCalls, form: Form, function: str) -> Arrays:
    """Return the value of the primitive."""
    return of.value(form, *_parts(of, arrays), function)


def _shape(*arrays: Any, of: ProductCalls, form: Form, function: str) -> Any:
    """Return shape and type of the value."""
    return jax.core.ShapedArray((*_lead(*arrays), of.products.size(form)), of.dtype)


def _tangent(
    primals: Any, tangents: Any, *, of: ProductCalls, form: Form, function: str
) -> tuple[Arrays, Arrays]:
    """Return the value, and its change along a direction."""
    given, vectors = _parts(of, primals)
    directions, others = _parts(of, tangents)
    named: dict[Any, Arrays] = {**directions, **dict(enumerate(others))}
    moved = {name: one for name, one in named.items() if type(one) is not ad.Zero}
    value = _PRODUCT.bind(*primals, of=of, form=form, function=function)
    return value, of.change(form, given, moved, vectors)


def _transpose(
    cotangent: Any, *arrays: Any, of: ProductCalls, form: Form, function: str
) -> list[Arrays | None]:
    """Return the transpose with respect to the vector that JAX does not know, None for all others."""
    given, vectors = _parts(of, arrays)
    (place,) = (k for k, one in enumerate(vectors) if ad.is_undefined_primal(one))
    found: list[Any] = [None] * len(arrays)
    if type(cotangent) is ad.Zero:
        found[len(given) + place] = ad.Zero(vectors[place].aval)
    else:
        other, others = form.by_vector(place, vectors, cotangent)
        found[len(given) + place] = of.product(other, given, others)
    return found


def _batch(
    arrays: Sequence[Arrays], places: Sequence[Any], *, of: ProductCalls, form: Form, function: str
) -> tuple[Arrays, int]:
    """Return the values of a batch, whose axis comes first."""
    size = next(a.shape[k] for a, k in zip(arrays, places, strict=True) if k is not None)
    moved = [a[None] if k is None else jnp.moveaxis(a, k, 0) for a, k in zip(arrays, places, strict=True)]
    given, vectors = _parts(of, moved)
    full = [jnp.broadcast_to(one, (size, *one.shape[1:])) for one in vectors]
    return _PRODUCT.bind(*given.values(), *full, of=of, form=form, function=function), 0


_PRODUCT = core.Primitive("kanegen_product")
"""Operands are the inputs of an output and then the vectors; the latter have all leading axes."""

_PRODUCT.def_impl(_value)
_PRODUCT.def_abstract_eval(_shape)
mlir.register_lowering(_PRODUCT, mlir.lower_fun(_value, multiple_results=False))
ad.primitive_jvps[_PRODUCT] = _tangent
ad.primitive_transposes[_PRODUCT] = _transpose
batching.primitive_batchers[_PRODUCT] = _batch
