"""Derivatives of a function of CasADi along a direction, gradients, and derivatives of these.

CasADi looks for them under the name of the function with `fwd1_`, `adj1_` and `fwd1_adj1_` before it. They
are made of products with derivatives: `<output>_jvp`, `<output>_vjp` and `<output>_hvp`. Arguments of a
derivative are those of the function, its results, which are not read, and then directions of the arguments or
weights of the results.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from kanegen.artifacts.casadi.matrix import CasadiFunction, Matrix
from kanegen.artifacts.casadi.pattern import Pattern
from kanegen.artifacts.casadi.sources import Derived, Products, Result
from kanegen.c.interface import Function

WEIGHTS = "weights"
"""Array of the weights of a product."""

_MOVED = "weights_direction"
"""Array of the direction of the weights."""


def directional(function: CasadiFunction, of: Derived) -> Iterator[CasadiFunction]:
    """Yield the derivatives of a function of which the products were generated.

    There are some where one of the results has products, and all others are copies of inputs.

    Args:
        function: The function.
        of: What its results are.
    """
    there = [one.products for one in of.results if not one.copied]
    if len(there) == 1 and there[0] is not None:
        products, made = there[0], _Directional(function, of.results, there[0])
        if products.along:
            yield made.forward(products.along)
        if products.gradient:
            yield made.reverse(products.gradient)
            if products.hessian:
                yield made.forward_of_reverse(products.gradient, products.hessian)


def not_read(prefix: str, matrices: Sequence[Matrix]) -> tuple[Matrix, ...]:
    """Return arguments that CasADi passes and that are not read, without entries.

    Args:
        prefix: Beginning of their names.
        matrices: The matrices whose shapes they have.
    """
    return tuple(
        Matrix(prefix + one.name, Pattern.empty(one.pattern.rows, one.pattern.columns)) for one in matrices
    )


@dataclass(frozen=True)
class _Directional:
    """Derivatives of a function of which one result has products, and all others are copies of inputs.

    Attributes:
        function: The function.
        results: Its results.
        products: Products with derivatives of the one that has them.
    """

    function: CasadiFunction
    results: Sequence[Result]
    products: Products

    def forward(self, along: Function) -> CasadiFunction:
        """Return the derivatives along a direction."""
        function = self.function
        outputs = [
            self._of_variable(self._given(result.copied), self.products.direction)
            if result.copied
            else replace(one, array=along.outputs[0].name)
            for one, result in zip(function.outputs, self.results, strict=True)
        ]
        return CasadiFunction(
            f"fwd1_{function.name}",
            f"The derivatives of {function.name} along a direction.",
            (*function.inputs, *not_read("out_", function.outputs), *self._directions()),
            tuple(
                replace(one, name=f"fwd_{own.name}")
                for one, own in zip(outputs, function.outputs, strict=True)
            ),
            (along,),
        )

    def reverse(self, gradient: Function) -> CasadiFunction:
        """Return the gradient of the weighted sum of all results."""
        function = self.function
        return CasadiFunction(
            f"adj1_{function.name}",
            f"The gradient of the sum of weights times the results of {function.name}.",
            (*function.inputs, *not_read("out_", function.outputs), *self._weights("adj_", WEIGHTS)),
            self._of_variables("adj_", gradient),
            (gradient,),
            added=self._copies("adj_"),
        )

    def forward_of_reverse(self, gradient: Function, hessian: Function) -> CasadiFunction:
        """Return the derivatives of the gradient along a direction.

        They are a Hessian times the direction of the variables, and a gradient with that of the weights.
        """
        function, reverse = self.function, self.reverse(gradient)
        weights = [
            not_read("", [one])[0] if result.copied else one
            for one, result in zip(self._weights("adj_", WEIGHTS), self.results, strict=True)
        ]
        by_weights = (one for one in self._of_variables("fwd_adj_", gradient) if one.array)
        return CasadiFunction(
            f"fwd1_{reverse.name}",
            f"The derivatives of {reverse.name} along a direction.",
            (
                *function.inputs,
                *not_read("out_", function.outputs),
                *weights,
                *not_read("out_", reverse.outputs),
                *self._directions(),
                *not_read("fwd_out_", function.outputs),
                *self._weights("fwd_adj_", _MOVED),
            ),
            self._of_variables("fwd_adj_", hessian),
            (hessian, gradient),
            added=(*by_weights, *self._copies("fwd_adj_")),
            passed={gradient.name: {WEIGHTS: _MOVED}},
        )

    def _given(self, name: str) -> Matrix:
        """Return an input of the function."""
        return next(one for one in self.function.inputs if one.name == name)

    def _of_variable(self, given: Matrix, array: str) -> Matrix:
        """Return what an array of all variables holds for an input; nothing if it is no variable."""
        if given.name not in self.products.columns:
            return not_read("", [given])[0]
        start: int = self.products.columns[given.name].start
        places = tuple(start + place for place in given.places)
        return replace(given, array=array, places=places, size=self.products.width)

    def _of_variables(self, prefix: str, call: Function) -> tuple[Matrix, ...]:
        """Return what the result of a function of C, a gradient, holds for each input.

        Args:
            prefix: Beginning of their names.
            call: The function.
        """
        parts = (self._of_variable(one, call.outputs[0].name) for one in self.function.inputs)
        return tuple(replace(one, name=prefix + one.name) for one in parts)

    def _directions(self) -> tuple[Matrix, ...]:
        """Return the directions of the inputs, which fill one array together."""
        parts = (self._of_variable(one, self.products.direction) for one in self.function.inputs)
        return tuple(replace(one, name=f"fwd_{one.name}") for one in parts)

    def _weights(self, prefix: str, array: str) -> tuple[Matrix, ...]:
        """Return the weights of the results, or their direction.

        Args:
            prefix: Beginning of their names.
            array: Name of the array of those of the result that has products.
        """
        return tuple(
            replace(one, name=prefix + one.name, array=prefix + one.name if result.copied else array)
            for one, result in zip(self.function.outputs, self.results, strict=True)
        )

    def _copies(self, prefix: str) -> tuple[Matrix, ...]:
        """Return what gradients have of results that are copies of an input: the weights of these.

        Args:
            prefix: Beginning of the names of gradients and weights.
        """
        return tuple(
            replace(self._given(result.copied), name=prefix + result.copied, array=prefix + one.name)
            for one, result in zip(self.function.outputs, self.results, strict=True)
            if result.copied
        )
