"""The functions of CasADi as C, in the interface of `casadi.external`."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from kanegen.artifacts.casadi.functions import SUFFIX, casadi_functions
from kanegen.artifacts.casadi.matrix import CasadiFunction, Matrix
from kanegen.artifacts.casadi.sources import differentiable
from kanegen.c.context import Context
from kanegen.c.formats import formats
from kanegen.c.interface import PREPARE, Function
from kanegen.c.layout import BREAK, wrap
from kanegen.c.source import Source
from kanegen.c.templates import fill
from kanegen.model.system import System
from kanegen.program.ir import PARAMETERS, PREPARED
from kanegen.program.precision import DOUBLE
from kanegen.recursion.outputs import DERIVATIVES, OUTPUTS, RATES

UNKNOWN = -(2**15)
"""Status of a Jacobian of which a part is wanted that the source does not have."""

_DYNAMICS = ("mass_matrix", "forcing", "inverse_dynamics", "forward_dynamics")
"""Outputs that a source for CasADi has unless others are asked for."""


def file_name(source: Source) -> str:
    """Return the name of the file, `<model>_casadi.c`."""
    return f"{source.model.name}{SUFFIX}.c"


def casadi(source: Source) -> dict[str, str]:
    """Return the text of `<model>_casadi.c`, by its name."""
    functions = casadi_functions(source)
    tables = _Tables(functions)
    printed = [_Printed(one, source, tables) for one in functions]
    ports = [port for one in printed for port in one.outputs if port.count and port.matrix.is_known]
    text = fill(
        "artifacts/casadi/model_casadi.c",
        model=source.model,
        functions=printed,
        patterns=tables.patterns,
        places=tables.places,
        zeros=max(1, *(matrix.size for one in functions for matrix in one.inputs)),
        spreads=any(one.places for function in printed for one in function.read),
        has_products=any(one.name.startswith(("fwd1_", "adj1_")) for one in printed),
        joins=any(one.joined for one in printed),
        adds=any(one.added for one in printed),
        gathers=any(port.places for port in ports),
        copies=any(port.matrix.array and not port.places for port in ports),
        unknown=UNKNOWN,
        **_parameters(source, printed),
    )
    return {file_name(source): text}


def _parameters(source: Source, printed: Sequence[_Printed]) -> Context:
    """Return the variables of the template about run-time parameters."""
    values = [float(value) for _, value in source.model.parameters]
    return {
        "prepare": next((one for one in source.functions if one.name == PREPARE), None),
        "prepared_type": formats(source.variant).of(PREPARED).c_type,
        "uses_defaults": any(one.reads_parameters for one in printed),
        "defaults": wrap(f",{BREAK}".join(map(repr, values))),
        "default": repr(values[0]) if len(set(values)) == 1 else "(double)NAN",
    }


def usual_outputs(system: System) -> tuple[str, ...]:
    """Return the outputs that a source for CasADi has unless a user asks for others."""
    rates = () if system.speeds_are_rates else RATES[1:]
    contacts = ("contact_dynamics",) if system.contacts else ()
    names = (*_DYNAMICS, *contacts, *rates)
    return (*names, *(one for name in names for one in derivatives(system, name)))


def derivatives(system: System, name: str) -> tuple[str, ...]:
    """Return the outputs of which the Jacobian of an output is made, those that a system has."""
    found = [f"{name}_derivatives", f"{name}_input_derivatives"]
    return tuple(one for one in found if one in DERIVATIVES and OUTPUTS[one].is_available(system))


def refusal(source: Source) -> str:
    """Return why `source` cannot have this artifact, with how to mend it, "" if it can."""
    if why := other_numbers(source):
        return why
    if source.system is None:
        return "this source does not carry its system. Generate it anew with kg.generate."
    if next(differentiable(source), None) is None:
        return "the code has no function of an output, only derivatives. Add --output forward_dynamics."
    there = [function.name for function in source.functions]
    without = [one for one in there if one in OUTPUTS and not {f"{one}_jvp", f"{one}_vjp"} & {*there}]
    needed = [one for name in without for one in derivatives(source.system, name)]
    if missing := [name for name in needed if name not in there]:
        options = " ".join(f"--output {name}" for name in missing)
        return f"Jacobians are read from derivatives, which the code lacks. Add {options}, or name none."
    return ""


def other_numbers(source: Source) -> str:
    """Return why CasADi cannot pass its arrays to the functions of `source`, "" if it can."""
    arrays = formats(source.variant)
    if arrays.storage is not DOUBLE:
        return (
            "the numbers of CasADi are doubles, those in the arrays of this code are of precision "
            f"{arrays.storage.name!r}. Take --precision double."
        )
    if arrays.parameters is not DOUBLE and source.model.parameters:
        return (
            "the numbers of CasADi are doubles, the run-time parameters of this code are of precision "
            f"{arrays.parameters.name!r}. Take --precision double."
        )
    return ""


class _Tables:
    """Tables of numbers in the file, each once.

    Attributes:
        patterns: Lines of the numbers of each pattern, by the name of its table.
        places: Lines of the places in an array of the entries of a matrix, by the name of their table.
    """

    def __init__(self, functions: Sequence[CasadiFunction]) -> None:
        """Collect the tables of all functions."""
        matrices = [m for one in functions for m in (*one.inputs, *one.outputs)]
        compressed = dict.fromkeys(matrix.pattern.compressed for matrix in matrices)
        self._patterns = {numbers: f"pattern_{i}" for i, numbers in enumerate(compressed)}
        matrices += [m for one in functions for m in one.added]
        spread = dict.fromkeys(m.places for m in matrices if m.places and not m.is_whole)
        self._places = {numbers: f"places_{i}" for i, numbers in enumerate(spread)}
        self.patterns = {name: _numbers(numbers) for numbers, name in self._patterns.items()}
        self.places = {name: _numbers(numbers) for numbers, name in self._places.items()}

    def pattern(self, matrix: Matrix) -> str:
        """Return the name of the table of a pattern."""
        return self._patterns[matrix.pattern.compressed]

    def place(self, matrix: Matrix) -> str:
        """Return the name of the table of places of a matrix, "" where it is stored as the array is."""
        return self._places.get(matrix.places, "")


def _numbers(numbers: Sequence[int]) -> list[str]:
    """Return the lines between the braces of a table."""
    return wrap(f",{BREAK}".join(map(str, numbers)), hanging="    ")


@dataclass(frozen=True)
class _Port:
    """An input or output of a function, or a term of an output, ready to be printed.

    Attributes:
        matrix: The matrix.
        number: Its place among the inputs or outputs.
        pattern: Name of the table of its pattern.
        places: Name of the table of its places, "" where it is stored as the array is.
    """

    matrix: Matrix
    number: int
    pattern: str
    places: str

    @property
    def count(self) -> int:
        """Number of entries that are stored."""
        return len(self.matrix.pattern.entries)

    @property
    def description(self) -> str:
        """Name, shape and number of stored entries, as CasADi prints them."""
        rows, columns = self.matrix.pattern.rows, self.matrix.pattern.columns
        entries = "" if self.count == rows * columns else f", {self.count} entries"
        return f"{self.matrix.name} [{rows} x {columns}{entries}]"


@dataclass(frozen=True)
class _Given:
    """An array that inputs of a function fill: one input, or several together.

    Attributes:
        name: Its name in C.
        ports: The inputs.
        work: Its place in the work vector, where it is filled there.
    """

    name: str
    ports: tuple[_Port, ...]
    work: int

    @property
    def is_joined(self) -> bool:
        """Whether several inputs fill it."""
        return len(self.ports) > 1

    @property
    def size(self) -> int:
        """Number of elements of the array."""
        return self.ports[0].matrix.size

    @property
    def places(self) -> str:
        """Name of the table of places of its only input, "" where that is stored as the array is."""
        return "" if self.is_joined else self.ports[0].places


class _Printed:
    """A function of CasADi, ready to be printed.

    Attributes:
        name: Its name.
        doc: One sentence.
        is_derivative: Whether it is a derivative of another function.
        arguments: Its inputs.
        given: Arrays that they fill, without the parameters, which `prepare` reads.
        outputs: Its outputs.
        added: Further terms of these.
        calls: Calls of C.
        work: Size of the work vector.
        reads_parameters: Whether constants are prepared.
    """

    def __init__(self, function: CasadiFunction, source: Source, tables: _Tables) -> None:
        """Lay out the work vector: the arrays that inputs fill, then those of results."""
        self.name, self.doc = function.name, function.doc
        self.is_derivative = function.is_derivative
        self.reads_parameters = function.reads_parameters
        self.work = 0
        self.arguments = _ports(enumerate(function.inputs), tables)
        self.outputs = _ports(enumerate(function.outputs), tables)
        numbers = {one.name: number for number, one in enumerate(function.outputs)}
        self.added = _ports(((numbers[one.name], one) for one in function.added), tables)
        self.given = [self._given(name) for name in dict.fromkeys(one.array for one in function.read)]
        self.calls = [self._call(function, call, source) for call in function.calls]

    def _given(self, name: str) -> _Given:
        """Return an array that inputs fill, which gets a place in the work vector if it needs one."""
        found = _Given(name, tuple(one for one in self.arguments if one.matrix.array == name), self.work)
        self.work += found.size if found.is_joined or found.places else 0
        return found

    def _call(self, function: CasadiFunction, call: Function, source: Source) -> _Call:
        """Return a call of C, whose results get places in the work vector."""
        filled = {array.name for array in call.outputs}
        results, added = (
            tuple(one for one in ports if one.matrix.array in filled and one.matrix.places)
            for ports in (self.outputs, self.added)
        )
        arrays = []
        for array in call.outputs:
            arrays.append((array.name, self.work))
            self.work += array.size
        known = {PREPARED, *(one.name for one in self.given)}
        passed = function.passed.get(call.name, {})
        names = [passed.get(array.name, array.name) for array in call.inputs]
        arguments = tuple(name if name in known else "zeros" for name in names)
        return _Call(f"{source.model.name}_{call.name}", arguments, tuple(arrays), results, added)

    @staticmethod
    def wanted(ports: Sequence[_Port]) -> str:
        """Return the condition in C that one of some outputs is wanted."""
        return " || ".join(f"res[{number}]" for number in dict.fromkeys(port.number for port in ports))

    @property
    def read(self) -> list[_Given]:
        """The arrays that inputs fill but for the parameters, which `prepare` reads."""
        return [one for one in self.given if one.name != PARAMETERS]

    @property
    def joined(self) -> list[_Given]:
        """The arrays that several inputs fill."""
        return [one for one in self.read if one.is_joined]

    @property
    def parameters(self) -> _Port | None:
        """The input of parameters, None without one."""
        return next((one for one in self.arguments if one.matrix.name == PARAMETERS), None)

    @property
    def unknown(self) -> list[_Port]:
        """The outputs that the source cannot give."""
        return [one for one in self.outputs if not one.matrix.is_known]

    @property
    def of_inputs(self) -> list[_Port]:
        """The outputs that need no call of C: copies of an input, and ones."""
        called = {id(one) for call in self.calls for one in call.results}
        return [one for one in self.outputs if id(one) not in called and one.matrix.is_known and one.count]

    @property
    def added_inputs(self) -> list[_Port]:
        """The further terms of outputs that are inputs."""
        called = {id(one) for call in self.calls for one in call.added}
        return [one for one in self.added if id(one) not in called]


def _ports(matrices: Iterable[tuple[int, Matrix]], tables: _Tables) -> list[_Port]:
    """Return matrices, with their numbers among the inputs or outputs, ready to be printed."""
    return [_Port(one, number, tables.pattern(one), tables.place(one)) for number, one in matrices]


@dataclass(frozen=True)
class _Call:
    """A call of a function of C.

    Attributes:
        name: Name of the function.
        arguments: Its inputs.
        arrays: Names of the arrays that it fills, and their places in the work vector.
        results: Outputs of the function of CasADi that are read from these.
        added: Outputs to which elements of these are added.
    """

    name: str
    arguments: tuple[str, ...]
    arrays: tuple[tuple[str, int], ...]
    results: tuple[_Port, ...]
    added: tuple[_Port, ...]
