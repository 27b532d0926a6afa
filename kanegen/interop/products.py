"""Products with derivatives of an output, by which programs that differentiate their callers avoid Jacobians.

First derivatives of an output are a form of weights {w} of its elements and of a direction {d} of its
variables, {w}.[J]{d}. Second derivatives are a form of {w} and two directions, the same if these are
exchanged. A product leaves one place of a form open. Transposition, which makes reverse out of forward
derivatives, opens another place, and differentiation by the variables adds a direction. So three generated
functions, `<output>_jvp`, `<output>_vjp` and `<output>_hvp`, are derivatives and transposes of each other.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeVar

from kanegen.c import Source
from kanegen.errors import OptionError
from kanegen.interop.slopes import Slopes, slopes
from kanegen.program.count import count
from kanegen.recursion.outputs import PRODUCTS, Product

Vector = TypeVar("Vector")


@dataclass(frozen=True)
class Form:
    """An output or a product with its derivatives, by the vectors with which they are multiplied.

    The vectors are weights, if there are any, and then directions. With weights the result has an element for
    each variable, and without them one for each element of the output.

    Attributes:
        is_weighted: Whether weights are among the vectors.
        directions: Number of directions.

    Example:
        Form(True, 0).by_variables(("weights",), "cotangent")   # the Hessian times the cotangent
    """

    is_weighted: bool
    directions: int

    @property
    def order(self) -> int:
        """Order of the derivatives, 0 for the output itself."""
        return self.is_weighted + self.directions

    def along(self) -> Form:
        """Return the derivative along a direction of the variables, which is one more vector."""
        return Form(self.is_weighted, self.directions + 1)

    def by_variables(self, vectors: tuple[Vector, ...], weights: Vector) -> tuple[Form, tuple[Vector, ...]]:
        """Return the gradient by the variables of the sum of weights times the elements of the result.

        Args:
            vectors: The vectors of this product.
            weights: The weights, which are a direction where the result has an element for each variable.
        """
        if self.is_weighted:
            return self.along(), (*vectors, weights)
        return Form(True, self.directions), (weights, *vectors)

    def by_vector(
        self, place: int, vectors: tuple[Vector, ...], weights: Vector
    ) -> tuple[Form, tuple[Vector, ...]]:
        """Return the same gradient by one of the vectors: the transpose of the product, linear in it.

        Args:
            place: Place of this vector among `vectors`.
            vectors: The vectors of this product.
            weights: The weights, as for `by_variables`.
        """
        others = vectors[:place] + vectors[place + 1 :]
        if self.is_weighted:
            return Form(place > 0, self.directions + (place == 0)), (*others, weights)
        return Form(True, self.directions - 1), (weights, *others)


VALUE, ALONG, GRADIENT, HESSIAN = Form(False, 0), Form(False, 1), Form(True, 0), Form(True, 1)
"""The output, its derivatives along a direction, gradients, and Hessians times a direction."""

CURVATURE = Form(False, 2)
"""Second derivatives along two directions, computed from `HESSIAN` with a unit weight for each element."""

ENDINGS = {ALONG: "jvp", GRADIENT: "vjp", HESSIAN: "hvp"}
"""Ending of the name of the generated function of a product."""

_WORDS = {
    ALONG: "derivatives along a direction, as in forward mode,",
    GRADIENT: "a gradient, as in reverse mode,",
    HESSIAN: "second derivatives",
    CURVATURE: "second derivatives",
}
"""What is asked for, in error messages."""


@dataclass(frozen=True, eq=False)
class Products:
    """The generated functions that give products with derivatives of an output.

    Attributes:
        output: Name of the output.
        rows: Number of its elements.
        columns: Places of the variables in directions and gradients, by name of the input.
        functions: Names of the functions of products that were generated.
        jacobian: Generated derivatives by all variables; () unless there are those by each.
        operations: Number of operations of each of these functions, where it is known.
    """

    output: str
    rows: int
    columns: Mapping[str, slice]
    functions: Mapping[Form, str]
    jacobian: tuple[Slopes, ...]
    operations: Mapping[str, int]

    @property
    def width(self) -> int:
        """Number of variables, as directions count them."""
        found: int = max(part.stop for part in self.columns.values())
        return found

    def size(self, form: Form) -> int:
        """Return the number of elements of a product."""
        return self.width if form.is_weighted else self.rows

    def takes_jacobian(self, form: Form, several: int) -> bool:
        """Return whether a whole Jacobian is the way to a product: the only one, or that of fewer operations.

        Args:
            form: The product.
            several: Number of vectors that are multiplied with the derivatives in each state.
        """
        if form.order != 1 or not self.jacobian:
            return False
        if form not in self.functions or not self.operations:
            return form not in self.functions
        alone = several * self.operations[self.functions[form]]
        multiplied = 2 * several * self.rows * self.width
        return sum(self.operations[one.function] for one in self.jacobian) + multiplied < alone

    def require(self, form: Form, program: str) -> None:
        """Make sure that there is a way to a product.

        Args:
            form: The product.
            program: Name of the program that asks for it, used in error messages.

        Raises:
            OptionError: If there is none.
        """
        name = self.output
        if form.order > HESSIAN.order:
            raise OptionError(f"{name}: {program} asks for third derivatives, which are not generated.")
        needed = HESSIAN if form == CURVATURE else form
        if needed not in self.functions and not self.takes_jacobian(form, 1):
            raise OptionError(
                f"{name}: {program} asks for {_WORDS[form]} and the library was built without "
                f"{name}_{ENDINGS[needed]}. Ask for it with outputs=(...)."
            )


def products_of(source: Source) -> dict[str, tuple[Products, Form]]:
    """Return the products with derivatives that a source gives, by name of each function that has some.

    These functions are outputs of which a product was generated, and the functions of products themselves;
    with each stands its form.

    Args:
        source: Generated C of the system.

    Raises:
        OptionError: If the code fills only a part of the mass matrix.

    Example:
        products, form = products_of(library.source)["forward_dynamics"]
    """
    found: dict[str, tuple[Products, Form]] = {}
    for output in dict.fromkeys(name.rpartition("_")[0] for name in PRODUCTS):
        endings = {form: f"{output}_{ending}" for form, ending in ENDINGS.items()}
        there = {one.name: one for one in source.functions}
        functions = {form: name for form, name in endings.items() if name in there}
        if functions:
            products = _products(output, functions, source)
            found |= {name: (products, form) for form, name in (functions | {VALUE: output}).items()}
    return found


def _products(output: str, functions: Mapping[Form, str], source: Source) -> Products:
    """Return the products with derivatives of an output."""
    model = source.model
    there = {one.name: one for one in source.functions}
    read = {array.name: array.size for one in source.functions for array in one.inputs}
    sizes = len(model.coordinate_names), len(model.freedom_names), len(model.parameters)
    columns = _table(functions).columns(*sizes, read)
    jacobian = tuple(one for one in slopes(output, source) if one.function in there)
    whole = {name for one in jacobian for name in one.columns} >= columns.keys()
    used = (*functions.values(), *(one.function for one in jacobian))
    programs = source.render_input.selected.functions if source.render_input else {}
    return Products(
        output=output,
        rows=sizes[1],
        columns=columns,
        functions=functions,
        jacobian=jacobian if whole else (),
        operations={name: sum(count(programs[name]).values()) for name in used if name in programs},
    )


def _table(functions: Mapping[Form, str]) -> Product:
    """Return the entry of the table of outputs of one of some products, which have the same variables."""
    return PRODUCTS[next(iter(functions.values()))]
