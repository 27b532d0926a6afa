"""Products with derivatives of an output as functions of NumPy arrays, by the cheapest way."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import prod
from typing import Any

import numpy as np

from kanegen.interop.products import ALONG, CURVATURE, GRADIENT, HESSIAN, Form, Products
from kanegen.interop.torch.signature import Signature
from kanegen.library import Library
from kanegen.model.arguments import OF_PRODUCTS, Floats, Shape

_VECTORS = {
    ALONG: ("direction",),
    GRADIENT: ("weights",),
    HESSIAN: ("weights", "direction"),
    CURVATURE: ("direction", "second_direction"),
}
"""Names of the vectors of products."""


@dataclass(frozen=True)
class ProductFunction:
    """A product with derivatives of an output, which broadcasts the leading dimensions of its arguments.

    Attributes:
        library: The library.
        products: Products that it has.
        form: Which of them this is.
        inputs: Shape for one state of each input of the output, by name.
    """

    library: Library
    products: Products
    form: Form
    inputs: Mapping[str, Shape]

    def signature(self, dtype: Any) -> Signature:
        """Return it as PyTorch calls it, its vectors last.

        Args:
            dtype: Type of the numbers.
        """
        sizes = {"weights": self.products.rows}
        vectors = {name: (sizes.get(name, self.products.width),) for name in _VECTORS[self.form]}
        name = f"{self.products.output}_{'_and_'.join(vectors)}"
        return Signature(name, {**self.inputs, **vectors}, ((self.products.size(self.form),),), dtype)

    def __call__(self, **arrays: Floats) -> Floats:
        """Return the product, (*lead, elements).

        Args:
            arrays: Inputs and vectors by name, each (*lead, *shape of one state).
        """
        given = {name: arrays[name] for name in self.inputs}
        vectors = [arrays[name] for name in _VECTORS[self.form]]
        if self.form == CURVATURE:
            return self._curvature(given, *vectors)
        states = self._lead(given)
        every = np.broadcast_shapes(states, *(one.shape[:-1] for one in vectors))
        if self.products.takes_jacobian(self.form, prod(every) // max(prod(states), 1)):
            return self._of_jacobian(given, np.broadcast_to(vectors[0], (*every, vectors[0].shape[-1])))
        found: Floats = self._of_function(self.form, given, vectors)
        return found

    def _lead(self, given: Mapping[str, Floats]) -> Shape:
        """Return the leading dimensions to which those of the inputs broadcast."""
        shapes = (one.shape[: one.ndim - len(self.inputs[name])] for name, one in given.items())
        return np.broadcast_shapes(*shapes)

    def _of_function(self, form: Form, given: Mapping[str, Floats], vectors: list[Floats]) -> Any:
        """Return the result of the generated function of a product."""
        function = self.library.ufunc(self.products.functions[form])
        names = [name for name in OF_PRODUCTS if name in function.shapes[0]]
        found: Any = function(**given, **dict(zip(names, vectors, strict=True)))
        return found

    def _of_jacobian(self, given: Mapping[str, Floats], vector: Floats) -> Floats:
        """Return a product that is computed from the whole Jacobian.

        Args:
            given: Inputs by name.
            vector: The vector, with all leading dimensions.
        """
        columns = self.products.columns
        blocks: dict[str, Any] = {}
        for one in self.products.jacobian:
            function = self.library.ufunc(one.function)
            matrix: Any = function(**{name: value for name, value in given.items() if _reads(function, name)})
            blocks |= {name: matrix[..., own] for name, own in one.columns.items() if name not in blocks}
        product: Any = np.einsum
        if self.form.is_weighted:
            parts = [product("...rk,...r->...k", blocks[name], vector) for name in columns]
            return np.concatenate(parts, axis=-1)
        changes = [
            product("...rk,...k->...r", blocks[name], vector[..., own]) for name, own in columns.items()
        ]
        total: Floats = sum(changes[1:], changes[0])
        return total

    def _curvature(self, given: Mapping[str, Floats], one: Floats, other: Floats) -> Floats:
        """Return second derivatives along two directions: a Hessian times a direction for each element."""
        apart = {
            name: np.expand_dims(value, value.ndim - len(self.inputs[name])) for name, value in given.items()
        }
        weights = np.eye(self.products.rows, dtype=one.dtype)
        hessians = self._of_function(HESSIAN, apart, [weights, one[..., None, :]])
        found: Floats = np.einsum("...rk,...k->...r", hessians, other)
        return found


def _reads(function: Any, name: str) -> bool:
    """Return whether a function reads an input; parameters are read by all."""
    return name == "parameters" or name in function.shapes[0]
