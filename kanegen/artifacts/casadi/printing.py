"""The functions of CasADi as C, in the interface of `casadi.external`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from kanegen.artifacts.casadi.functions import SUFFIX, CasadiFunction, Matrix, casadi_functions
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
        spreads=any(port.places for one in printed for port in one.inputs),
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
    needed = [one for name in there if name in OUTPUTS for one in derivatives(source.system, name)]
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
        matrices = [m for one in functions for m in (*one.inputs, *one.unread, *one.outputs)]
        compressed = dict.fromkeys(matrix.pattern.compressed for matrix in matrices)
        self._patterns = {numbers: f"pattern_{i}" for i, numbers in enumerate(compressed)}
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
    """An input or output of a function, ready to be printed.

    Attributes:
        matrix: The matrix.
        number: Its place among the inputs or outputs.
        pattern: Name of the table of its pattern.
        places: Name of the table of its places, "" where it is stored as the array is.
        work: Place of the array in the work vector.
    """

    matrix: Matrix
    number: int
    pattern: str
    places: str
    work: int

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


class _Printed:
    """A function of CasADi, ready to be printed.

    Attributes:
        name: Its name.
        doc: One sentence.
        inputs: Its inputs that are read.
        unread: Further inputs.
        outputs: Its outputs.
        calls: Calls of C.
        work: Size of the work vector.
        reads_parameters: Whether constants are prepared.
    """

    def __init__(self, function: CasadiFunction, source: Source, tables: _Tables) -> None:
        """Lay out the work vector: the arrays of inputs that are spread, then those of results."""
        self.name, self.doc = function.name, function.doc
        self.reads_parameters = function.reads_parameters
        self.work = 0
        self.inputs, self.unread, self.outputs = [], [], []
        for number, matrix in enumerate(function.inputs):
            places = tables.place(matrix)
            self.inputs.append(_Port(matrix, number, tables.pattern(matrix), places, self.work))
            self.work += matrix.size if places else 0
        for number, matrix in enumerate(function.unread, start=len(self.inputs)):
            self.unread.append(_Port(matrix, number, tables.pattern(matrix), "", 0))
        for number, matrix in enumerate(function.outputs):
            self.outputs.append(_Port(matrix, number, tables.pattern(matrix), tables.place(matrix), 0))
        self.calls = [self._call(function, call, source) for call in function.calls]

    def _call(self, function: CasadiFunction, call: Function, source: Source) -> _Call:
        """Return a call of C, whose results get places in the work vector."""
        results = [self.outputs[i] for i in function.results(call)]
        arrays = []
        for array in call.outputs:
            arrays.append((array.name, self.work))
            self.work += array.size
        known = {one.matrix.name for one in self.inputs}
        arguments = [a.name if a.name in (*known, PREPARED) else "zeros" for a in call.inputs]
        return _Call(f"{source.model.name}_{call.name}", tuple(arguments), tuple(arrays), tuple(results))

    @property
    def arguments(self) -> list[_Port]:
        """The inputs that are read, then those that are not, in the order of CasADi."""
        return [*self.inputs, *self.unread]

    @staticmethod
    def wanted(ports: Sequence[_Port]) -> str:
        """Return the condition in C that one of some outputs is wanted."""
        return " || ".join(f"res[{port.number}]" for port in ports)

    @property
    def read(self) -> list[_Port]:
        """The inputs but for the parameters, which `prepare` reads."""
        return [one for one in self.inputs if one.matrix.name != PARAMETERS]

    @property
    def parameters(self) -> _Port | None:
        """The input of parameters, None without one."""
        return next((one for one in self.inputs if one.matrix.name == PARAMETERS), None)

    @property
    def unknown(self) -> list[_Port]:
        """The outputs that the source cannot give."""
        return [one for one in self.outputs if not one.matrix.is_known]

    @property
    def of_inputs(self) -> list[_Port]:
        """The outputs that need no call of C: copies of an input, and ones."""
        called = {id(one) for call in self.calls for one in call.results}
        return [one for one in self.outputs if id(one) not in called and one.matrix.is_known and one.count]


@dataclass(frozen=True)
class _Call:
    """A call of a function of C.

    Attributes:
        name: Name of the function.
        arguments: Its inputs.
        arrays: Names of the arrays that it fills, and their places in the work vector.
        results: Outputs of the function of CasADi that are read from these.
    """

    name: str
    arguments: tuple[str, ...]
    arrays: tuple[tuple[str, int], ...]
    results: tuple[_Port, ...]
