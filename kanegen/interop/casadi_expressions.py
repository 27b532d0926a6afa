"""Programs as expressions of CasADi, instruction by instruction, which CasADi differentiates to any order."""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from kanegen.artifacts.casadi import CasadiFunction, Matrix
from kanegen.program.ir import PARAMETERS, PREPARED, Module, Op, Program


def expressions(package: Any, module: Module, function: CasadiFunction) -> tuple[Any, Any]:
    """Return the symbols of the inputs of a function, and its outputs as expressions of them.

    Where a result does not exist, as {ydot} where [A] is singular, it is NaN.

    Args:
        package: The module `casadi`.
        module: The programs of the code that has the function.
        function: The function.
    """
    inputs = [package.SX.sym(one.name, _sparsity(package, one)) for one in function.inputs]
    given = zip(function.inputs, inputs, strict=True)
    arrays = {one.array: _elements(one, symbol.nonzeros()) for one, symbol in given}
    if module.prepare is not None and PARAMETERS in arrays:
        arrays[PREPARED] = _evaluated(package, module.prepare, arrays)[PREPARED]
    results = dict(arrays)
    for call in function.calls:
        results |= _evaluated(package, module.functions[call.name], arrays)
    outputs = [
        package.SX(_sparsity(package, one), package.vertcat(*(results[one.array][k] for k in one.places)))
        for one in function.outputs
    ]
    return inputs, outputs


def _sparsity(package: Any, matrix: Matrix) -> Any:
    """Return the pattern of a matrix as CasADi has it."""
    pattern = matrix.pattern
    rows, columns = zip(*pattern.entries, strict=True) if pattern.entries else ((), ())
    return package.Sparsity.triplet(pattern.rows, pattern.columns, list(rows), list(columns))


def _elements(matrix: Matrix, entries: Sequence[Any]) -> list[Any]:
    """Return the elements of the array of a matrix, of which those that are not stored are 0."""
    found: list[Any] = [0.0] * matrix.size
    for place, entry in zip(matrix.places, entries, strict=True):
        found[place] = entry
    return found


def _evaluated(package: Any, program: Program, inputs: Mapping[str, Sequence[Any]]) -> dict[str, list[Any]]:
    """Return the elements of every output array of a program as expressions of the elements of its inputs."""
    compute = _functions(package)
    values: list[Any] = []
    for one in program.instructions:
        if one.op is Op.CONSTANT:
            values.append(package.SX(float(one.number)))
        elif one.op is Op.INPUT:
            values.append(package.SX(inputs[one.array][one.index]))
        else:
            values.append(compute[one.op](*(values[operand] for operand in one.operands)))
    found = {}
    for output in program.outputs:
        exists = [values[k] > 0 for k in dict.fromkeys(output.exists_if_positive)]
        filled = [values[k] for k in output.values]
        if exists:
            every = package.logic_all(package.vertcat(*exists))
            filled = [package.if_else(every, value, float("nan")) for value in filled]
        found[output.array.name] = filled
    return found


def _functions(package: Any) -> dict[Op, Callable[..., Any]]:
    """Return CasADi's function for every operation."""
    return {
        Op.ADD: operator.add,
        Op.SUBTRACT: operator.sub,
        Op.MULTIPLY: operator.mul,
        Op.DIVIDE: operator.truediv,
        Op.NEGATE: operator.neg,
        Op.ABS: package.fabs,
        Op.SQRT: package.sqrt,
        Op.SIN: package.sin,
        Op.COS: package.cos,
        Op.SIGN: package.sign,
        Op.MIN: package.fmin,
        Op.MAX: package.fmax,
        Op.SELECT: lambda condition, a, b: package.if_else(condition > 0, a, b),
        Op.EXP: package.exp,
        Op.LOG: package.log,
        Op.TANH: package.tanh,
        Op.ATAN2: package.atan2,
    }
