"""The entries in the table of outputs that are made by differentiating programs of other outputs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from kanegen.model.system import System
from kanegen.program.ir import PARAMETERS, Array
from kanegen.recursion.outputs.inputs import input_arrays


@dataclass(frozen=True)
class Differentiated:
    """The variables by which an output is differentiated, and their order along one axis of an array.

    Attributes:
        of: The differentiated quantity, as documented in the generated C.
        needs: Names of the outputs whose programs are differentiated.
        by: Names of the arrays with respect to which they are differentiated, those that a system has.
        by_parameters: Whether they are also differentiated with respect to run-time parameters.
    """

    of: str
    needs: tuple[str, ...]
    by: tuple[str, ...]
    by_parameters: bool = True

    def columns(
        self,
        coordinates: int,
        n: int,
        parameters: int,
        further: Mapping[str, int] = MappingProxyType({}),
    ) -> dict[str, slice]:
        """Return the columns of the output by array of `by`, where there are any; parameters come last.

        Args:
            coordinates: Number of elements of {x}.
            n: Number of freedoms.
            parameters: Number of run-time parameters.
            further: Number of elements of each further array that the system has, such as "force".
        """
        sizes = {
            **further,
            "x": coordinates,
            **dict.fromkeys(("y", "ydot", "tau"), n),
            PARAMETERS: parameters,
        }
        found: dict[str, slice] = {}
        first = 0
        for name in (*self.by, *((PARAMETERS,) if self.by_parameters else ())):
            if size := sizes.get(name, 0):
                found[name] = slice(first, first + size)
                first += size
        return found

    def columns_of(self, system: System) -> dict[str, slice]:
        """Return the columns of the output for a system."""
        sizes = {array.name: array.size for array in input_arrays(system)}
        return self.columns(len(system.coordinates), len(system.freedoms), len(system.parameters), sizes)

    def width(self, system: System) -> int:
        """Return the number of columns for a system."""
        return max((part.stop for part in self.columns_of(system).values()), default=0)

    def places(self, system: System, word: str) -> str:
        """Return the columns for a system as documented in the generated C, where `word` is what they are."""
        columns = self.columns_of(system)
        return ", then ".join(
            f"{one} ({word} {part.start} to {part.stop - 1})" for one, part in columns.items()
        )


@dataclass(frozen=True)
class Derivative(Differentiated):
    """Derivation of an output by differentiating the programs of other outputs.

    Attributes:
        parts: Names of the entries of `PARTS` from which derivatives by {x} and {y} come where a system has
            them: these derivatives, and a further term to differentiate. Empty where there are none.
        alternative: Name of a part that can take the place of `parts` where that costs less; or empty.
    """

    parts: tuple[str, ...] = ()
    alternative: str = ""

    @property
    def method(self) -> str:
        """Name of the algorithm, as documented in the generated C."""
        return "recursions and their tangents" if self.parts else "tangents of the recursions"

    def array(self, system: System, name: str, base: Array) -> Array:
        """Return the array of the output `name`: behind the axes of `base` one for the elements of `by`."""
        places = self.places(system, "columns")
        doc = f"derivatives of {self.of} by {places or 'inputs from outside'}"
        shape, unit = (*base.shape, self.width(system)), f"{base.unit} over the units of these"
        return Array(name, shape, unit, doc, base.condition, base.of_freedoms, base.row_condition)


@dataclass(frozen=True)
class SecondDerivative(Differentiated):
    """Derivation of an output by differentiating the first derivatives of other outputs.

    Attributes:
        parts: Names of parts of first derivatives, as of `Derivative`.
    """

    parts: tuple[str, ...] = ()

    @property
    def method(self) -> str:
        """Name of the algorithm, as documented in the generated C."""
        return "tangents of first derivatives"

    def array(self, system: System, name: str, base: Array) -> Array:
        """Return the array of the output `name`: behind the axis of `base` two for the elements of `by`."""
        width, places = self.width(system), self.places(system, "places")
        doc = f"second derivatives of {self.of}, symmetric in the last two axes, which count {places}"
        unit = f"{base.unit} over the units of two of these"
        return Array(name, (*base.shape, width, width), unit, doc, base.condition, base.of_freedoms)


@dataclass(frozen=True)
class ProductKind:
    """What a product with derivatives is.

    Attributes:
        doc: Its description, with the quantity, the direction and the variables left open.
        unit: Its unit, with that of the quantity left open.
        method: Name of its algorithm.
        is_weighted: Whether weights combine the elements of the quantity.
        is_directed: Whether the variables have a direction.
    """

    doc: str
    unit: str
    method: str
    is_weighted: bool
    is_directed: bool


PRODUCT_KINDS = {
    "jvp": ProductKind(
        "derivatives of {of} along {direction}, their Jacobian times {direction}, which holds {places}",
        "{} if the direction has the units of the variables",
        "tangents along a direction",
        is_weighted=False,
        is_directed=True,
    ),
    "vjp": ProductKind(
        "gradient of the sum of weights times {of}, the weights times the Jacobian, by {places}",
        "{} times the weights, over the units of the variables",
        "adjoints",
        is_weighted=True,
        is_directed=False,
    ),
    "hvp": ProductKind(
        "Hessian of the sum of weights times {of}, times {direction}, by {places}",
        "{} times the weights, over the units of the variables, if the direction has these",
        "adjoints and their tangents along a direction",
        is_weighted=True,
        is_directed=True,
    ),
}
"""The products by the end of their names: Jacobian or Hessian times vector, and vector times Jacobian."""


@dataclass(frozen=True, kw_only=True)
class Product(Differentiated):
    """Derivation of the product of the derivatives of an output with a vector, without these derivatives.

    Attributes:
        kind: Which product it is.
        direction: Name of the array of the direction.
    """

    kind: ProductKind
    direction: str

    @property
    def method(self) -> str:
        """Name of the algorithm, as documented in the generated C."""
        return self.kind.method

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the arrays that it reads beside those of the output."""
        weights = ("weights",) if self.kind.is_weighted else ()
        return (*weights, *((self.direction,) if self.kind.is_directed else ()))

    def array(self, system: System, name: str, base: Array) -> Array:
        """Return the array of the output `name`."""
        kind, places = self.kind, self.places(system, "elements")
        doc = kind.doc.format(of=self.of, direction=self.direction, places=places)
        if not kind.is_weighted:
            return Array(name, base.shape, kind.unit.format(base.unit), doc, base.condition, base.of_freedoms)
        return Array(name, (self.width(system),), kind.unit.format(base.unit), doc, base.condition)
