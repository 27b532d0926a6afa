"""Which functions of C give the results of a function of CasADi, and which give their derivatives."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from kanegen.c.interface import PREPARE, Function
from kanegen.c.source import Source
from kanegen.program.ir import PARAMETERS, PREPARED, Array
from kanegen.recursion.outputs import (
    DERIVATIVES,
    DIFFERENTIATED,
    INTEGRATORS,
    OUTPUTS,
    PRODUCTS,
    RATES,
    differentiates,
)

ODE = "ode"
"""Name of the function of the rates of a state, {xdot} and {ydot}."""


@dataclass(frozen=True)
class Slopes:
    """Derivatives of a result, in columns of an array.

    Attributes:
        call: Function of C that fills the array.
        array: The array.
        columns: Columns of the array by name of the input.
        first_row: Number of rows of the array before those of the result.
    """

    call: Function
    array: Array
    columns: Mapping[str, slice]
    first_row: int = 0


@dataclass(frozen=True)
class Products:
    """Products with derivatives of a result, as functions of C give them, by all inputs.

    Attributes:
        columns: Places of the variables in directions and gradients, by name of the input.
        direction: Name of the array of a direction.
        along: Function of C that gives derivatives along a direction; None if it was not generated.
        gradient: Function of C that gives gradients of weighted sums.
        hessian: Function of C that gives Hessians of these times a direction.
    """

    columns: Mapping[str, slice]
    direction: str
    along: Function | None
    gradient: Function | None
    hessian: Function | None

    @property
    def width(self) -> int:
        """Number of variables, as directions count them."""
        found: int = max(part.stop for part in self.columns.values())
        return found


@dataclass(frozen=True)
class Result:
    """A result of a function of CasADi.

    Attributes:
        array: Its array.
        call: Function of C that fills the array; None for a copy of an input.
        slopes: Its derivatives, in one or several arrays.
        copied: Name of the input of which it is a copy, "" for none.
        products: Products with its derivatives; None if none were generated.
    """

    array: Array
    call: Function | None
    slopes: tuple[Slopes, ...] = ()
    copied: str = ""
    products: Products | None = None

    def reads(self, name: str) -> bool:
        """Return whether it depends on an input."""
        read = {array.name for array in self.call.inputs} if self.call else {self.copied}
        return (PREPARED if name == PARAMETERS else name) in read

    def derivative(self, name: str) -> Slopes | None:
        """Return where its derivatives by an input are, None if there are none."""
        return next((one for one in self.slopes if name in one.columns), None)


@dataclass(frozen=True)
class Derived:
    """A function of CasADi, by what its results and their derivatives are.

    Attributes:
        name: Name without prefix.
        doc: One sentence.
        results: Its results.
    """

    name: str
    doc: str
    results: tuple[Result, ...]

    @property
    def has_derivatives(self) -> bool:
        """Whether every result has derivatives."""
        return all(one.slopes or one.copied for one in self.results)

    @property
    def derivative_calls(self) -> tuple[Function, ...]:
        """Functions of C that fill the arrays of derivatives."""
        return tuple(dict.fromkeys(slopes.call for one in self.results for slopes in one.slopes))

    def inputs(self, source: Source) -> tuple[Array, ...]:
        """Return the inputs of the function and of its derivatives; parameters come last."""
        calls = (*(one.call for one in self.results if one.call), *self.derivative_calls)
        read = dict.fromkeys(array for call in calls for array in call.inputs)
        own = tuple(array for array in read if array.name != PREPARED)
        prepare = next((one for one in source.functions if one.name == PREPARE), None)
        return (*own, *prepare.inputs) if prepare and len(own) < len(read) else own


def differentiable(source: Source) -> Iterator[Derived]:
    """Yield the functions of CasADi that a source gives: its outputs, its steps, and `ODE`."""
    functions = {function.name: function for function in source.functions}
    for name, function in functions.items():
        if name in OUTPUTS and name not in DIFFERENTIATED:
            slopes = tuple(_slopes(source, functions, name))
            products = _products(source, functions, name)
            yield Derived(
                name, function.doc, (Result(function.outputs[0], function, slopes, products=products),)
            )
        elif name in INTEGRATORS and not differentiates(name):
            yield _step(source, functions, function)
    yield from _ode(source, functions)


def _slopes(source: Source, functions: Mapping[str, Function], name: str) -> Iterator[Slopes]:
    """Yield the derivatives of an output."""
    function = functions.get(f"{name}_derivatives")
    if function:
        for one in (function, functions.get(f"{name}_input_derivatives")):
            if one:
                columns = DERIVATIVES[one.name].columns(*_sizes(source), _further(one))
                yield Slopes(one, one.outputs[0], columns)
        if name == "inverse_dynamics" and "mass_matrix" in functions:
            matrix = functions["mass_matrix"]
            yield Slopes(matrix, matrix.outputs[0], {"ydot": slice(0, len(source.model.freedom_names))})


def _products(source: Source, functions: Mapping[str, Function], name: str) -> Products | None:
    """Return the products with derivatives of an output that were generated."""
    along, gradient, hessian = (functions.get(f"{name}_{ending}") for ending in ("jvp", "vjp", "hvp"))
    if along is None and gradient is None:
        return None
    read = {array.name: array.size for one in source.functions for array in one.inputs}
    columns = PRODUCTS[f"{name}_vjp"].columns(*_sizes(source), read)
    return Products(columns, PRODUCTS[f"{name}_jvp"].direction, along, gradient, hessian)


def _step(source: Source, functions: Mapping[str, Function], function: Function) -> Derived:
    """Return the function of one step of a method."""
    found = functions.get(INTEGRATORS[function.name].derivatives)
    first, results = 0, []
    for array in function.outputs:
        columns = DERIVATIVES[f"{RATES[0]}_derivatives"].columns(*_sizes(source))
        slopes = (Slopes(found, found.outputs[-1], columns, first),) if found else ()
        results.append(Result(array, function, slopes))
        first += array.size
    return Derived(function.name, function.doc, tuple(results))


def _ode(source: Source, functions: Mapping[str, Function]) -> Iterator[Derived]:
    """Yield the function of the rates of a state, if the source has what it needs."""
    acceleration, rates = (functions.get(name) for name in RATES)
    if acceleration is None or not (rates or source.model.speeds_are_rates):
        return
    if rates:
        xdot = Result(rates.outputs[0], rates, tuple(_slopes(source, functions, rates.name)))
    else:
        (y,) = (array for array in acceleration.inputs if array.name == "y")
        xdot = Result(Array("xdot", y.shape, y.unit, "{xdot}, which is {y}"), None, copied="y")
    slopes = tuple(_slopes(source, functions, acceleration.name))
    products = _products(source, functions, acceleration.name)
    ydot = Result(acceleration.outputs[0], acceleration, slopes, products=products)
    yield Derived(ODE, "The rates {xdot} and {ydot} of a state.", (xdot, ydot))


def _further(function: Function) -> dict[str, int]:
    """Return the number of elements of each input of a function, by its name."""
    return {array.name: array.size for array in function.inputs}


def _sizes(source: Source) -> tuple[int, int, int]:
    """Return the numbers of coordinates, freedoms and run-time parameters."""
    model = source.model
    return len(model.coordinate_names), len(model.freedom_names), len(model.parameters)
